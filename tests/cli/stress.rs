//! `stress`: its table, its reports, and names that it does not know.

use super::Folder;

#[test]
fn reports_hold_what_the_table_does() {
    let folder = Folder::new("stress");
    for report in ["r.json", "r.html", "r.md"] {
        let outcome = folder.ok(&["stress", "--case", "no area", "--case", "spot 0°", "-o", report]);
        // Two cases by three integrators, on each accelerator there is.
        let rows = if cfg!(feature = "embree") { 12 } else { 6 };
        assert_eq!(outcome.stdout.lines().count(), rows + 1, "{}", outcome.stdout);
        assert!(outcome.stdout.lines().skip(1).all(|line| line.ends_with("  ok")), "{}", outcome.stdout);
        assert_eq!(outcome.stderr, format!("twinlight: {rows} rows, all as they must be\n"));
    }
    let json = folder.json("r.json");
    let rows = json["rows"].as_array().unwrap();
    assert!(json["failures"] == 0 && rows.iter().all(|row| row["faults"].as_array().unwrap().is_empty()), "{json}");
    assert!(rows.iter().any(|row| row["case"] == "no area" && row["energy_low"] == 0.0 && row["rays"] != 0), "{json}");
    for page in ["r.html", "r.md"] {
        let text = std::fs::read_to_string(folder.path(page)).unwrap();
        let (head, table) = text.split_once(if page == "r.md" { "| case |" } else { "<table>" }).unwrap();
        assert_eq!(table.matches("spot 0°").count(), rows.len() / 2, "{text}");
        assert!(
            head.contains("ok: ")
                && table.contains("judged by")
                && table.contains("<td>same bits<td>") == (page == "r.html"),
            "{text}"
        );
        let made = "Made by `twinlight stress --case \"no area\" --case \"spot 0°\"`; not";
        assert!(page == "r.html" || head.contains(made), "{text}");
    }
}

#[test]
fn unknown_cases_and_reports_are_usage_errors() {
    let folder = Folder::new("stress_usage");
    let outcome = folder.run(&["stress", "--case", "nothing like it"]);
    assert_eq!(outcome.status, Some(2));
    assert!(outcome.stderr.starts_with("twinlight: no case is named like nothing like it; there are: scale 2^-20; "));
    let outcome = folder.run(&["stress", "-o", "report.txt"]);
    assert_eq!(outcome.status, Some(2));
    assert_eq!(outcome.stderr, "twinlight: report.txt: a report is an .html, .json or .md file; give it such a name\n");
    assert!(outcome.stdout.is_empty() && folder.names().is_empty());
}

#[test]
fn a_report_that_cannot_be_written_is_told_before_the_work() {
    let folder = Folder::with_room("stress_unwritable");
    let told = folder.run(&["stress", "-o", "nowhere/report.md"]);
    assert_eq!(told.status, Some(1));
    assert!(told.stderr.contains("cannot write `nowhere/report.md`"), "{}", told.stderr);
    assert_eq!(told.stdout, "");
}

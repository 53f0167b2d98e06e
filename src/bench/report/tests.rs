use std::collections::BTreeMap;

use super::*;
use crate::bench::reference::Origin;
use crate::compare::{Reference, ReferenceNoise};

/// Demands that every tag is closed by its own, and that no `<` or `>` stands for itself.
pub(super) fn assert_balanced(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find(['<', '>']) {
        assert!(rest[at..].starts_with('<'), "a stray > before {}", &rest[at..]);
        let end = rest[at..].find('>').map(|n| at + n).unwrap_or_else(|| panic!("an open tag: {}", &rest[at..]));
        let tag = &rest[at + 1..end];
        assert!(tag.matches('"').count() % 2 == 0 && !tag.contains('<'), "<{tag}>");
        let name = |tag: &'_ str| tag.find([' ', '/', '\n']).unwrap_or(tag.len());
        match tag.strip_prefix('/') {
            Some(closed) => assert_eq!(open.pop(), Some(closed), "</{closed}> closes another"),
            None if tag.ends_with('/') || tag.starts_with('!') => {}
            None => open.push(&tag[..name(tag)]),
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty(), "not closed: {open:?}");
}

/// A report of one scene: `path` with errors well above the noise, `auto` with errors below it in all runs but one.
fn report() -> Report {
    let image = Image { width: 2, height: 1, rgb: vec![[0.5; 3], [0.25; 3]] };
    let noise = 1e-3;
    let run = |index: u32, measured: f64, cpu: f64| RunReport {
        repetition: index,
        seed: 1001 + u64::from(index),
        order: index as usize,
        cpu_seconds: cpu,
        wall_seconds: 1.5 * cpu,
        mse: Figure { measured: 0.3 * measured, noise: Some(0.3 * noise) },
        rel_mse: Figure { measured, noise: Some(noise) },
        rel_mse_trimmed: Figure { measured: 0.9 * measured, noise: Some(0.9 * noise) },
        energy: 1.001,
        pixels: 2,
        rays: Rays { camera: 10, shadow: 5, ..Rays::default() },
        peak_memory: (index > 0).then_some(3 << 20),
        non_finite: u64::from(index == 1),
        overflows: 0,
    };
    let configuration = |integrator, errors: [f64; 3], first: Option<&Vec<Option<f64>>>| {
        let mut c = ConfigurationReport::new(
            &Configuration {
                integrator,
                settings: Settings::default(),
                backend: Backend::Bvh,
                effort: crate::bench::Effort::Seconds(1.0),
            },
            4,
            Some((1.0, Pilot { samples: 2, cpu_seconds: 0.5 })),
        );
        c.runs = errors.iter().zip(0..).map(|(e, i)| run(i, *e, 0.5 + 0.1 * f64::from(i))).collect();
        c.summary = Summary::of(&c.runs, 4, first);
        c.image = Some(image.clone());
        c
    };
    let path = configuration("path", [0.011, 0.021, 0.031], None);
    let auto = configuration("auto", [0.0012, 0.0015, 0.004], Some(&path.efficiencies()));
    let scene = SceneReport {
        name: "a,\"b\"".to_owned(),
        file: "<scene>.json".to_owned(),
        fingerprint: 77,
        resolution: [2, 1],
        max_bounces: 5,
        notes: vec!["a & b".to_owned()],
        measure: Measure {
            reference: Reference { image: image.clone(), noise: ReferenceNoise::Variance(image.clone()) },
            origin: Origin::Halves { integrator: Integrator::Bdpt, samples: 64, cpu_seconds: 3.0 },
            mse: Some(0.3 * noise),
            rel_mse: Some(noise),
        },
        configurations: vec![path, auto],
    };
    Report { scenes: vec![scene], ..Report::new(1, 3) }
}

#[test]
fn no_error_is_told_below_the_noise() {
    let report = report();
    let json = report.json();
    let [path, auto] = [0, 1].map(|i| &json["scenes"][0]["configurations"][i]);
    let (close, value) =
        (|a: &serde_json::Value, b: f64| (a.as_f64().expect("a number") / b - 1.0).abs() < 1e-9, "value");
    assert!(close(&path["runs"][1]["rel_mse"][value], 0.02) && close(&path["runs"][1]["rel_mse"]["measured"], 0.021));
    assert!(close(&path["runs"][1]["efficiency"], 1.0 / (0.02 * 0.6)), "{path}");
    assert!(close(&path["medians"]["rel_mse"]["median"], 0.02) && path["below_reference_noise"] == false);
    assert!(path["medians"]["efficiency_ratio"].is_null(), "the first is what others are compared with");
    let run = &auto["runs"][0];
    assert!(run["rel_mse"][value].is_null() && run["rel_mse"]["below_reference_noise"] == true, "{run}");
    assert!(run["efficiency"].is_null() && auto["medians"]["rel_mse"]["median"].is_null());
    assert!(auto["below_reference_noise"] == true && close(&auto["medians"]["rel_mse"]["high"], 0.003), "{auto}");
    // Of three pairs two lack a value.
    assert!(auto["medians"]["efficiency_ratio"].is_null() && auto["renders_by"] == "bdpt");
    assert!(json["intervals"]["coverage"] == 0.75 && json["scenes"][0]["reference"]["noise"]["rel_mse"] == 1e-3);
    // Not known of one run: not told of all.
    assert!(path["medians"]["peak_memory_bytes"].is_null() && path["runs"][1]["peak_memory_bytes"] == 3 << 20);
    assert_eq!(report.left_out(), [2, 0]);

    let table = table(&report.scenes[0]);
    assert!(table.lines().next().is_some_and(|l| l.contains("0.0200  83.3 [47.6")), "{table}");
    assert!(table.lines().nth(1).is_some_and(|l| l.contains("< noise  -")), "{table}");
    assert!(
        table.contains("its noise, relMSE 0.00100, is subtracted") && table.ends_with("  note: a & b\n"),
        "{table}"
    );
    // The columns stand below their headings.
    let column = |line: &str, text: &str| line.find(text).map(|n| line[..n + text.len()].chars().count());
    let first = table.lines().next().unwrap_or_default();
    assert_eq!(column(HEADING, "relMSE"), column(first, "0.0200"), "{HEADING}\n{first}");
    assert_eq!(column(HEADING, "Mrays/s"), column(first, "2.50e-5"), "{HEADING}\n{first}");
}

#[test]
fn rows_of_spreadsheets_have_their_columns() {
    let csv = report().csv();
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let rows: Vec<BTreeMap<&str, &str>> = lines
        .map(|line| {
            let rest = line.strip_prefix("\"a,\"\"b\"\"\"").unwrap_or_else(|| panic!("{line}"));
            let cells: Vec<&str> = rest.split(',').collect();
            assert_eq!(cells.len(), columns.len(), "{line}");
            columns.iter().copied().zip(cells).collect()
        })
        .collect();
    assert_eq!(rows.len(), 6);
    assert_eq!((rows[1]["integrator"], rows[1]["seed"], rows[1]["rays_total"]), ("path", "1002", "15"));
    assert_eq!((rows[1]["rel_mse_measured"], rows[1]["below_reference_noise"]), ("2.1e-2", "false"));
    assert_eq!((rows[3]["rel_mse"], rows[3]["efficiency"], rows[3]["below_reference_noise"]), ("", "", "true"));
    assert_eq!((rows[3]["peak_memory_bytes"], rows[3]["rel_mse_noise"], rows[4]["non_finite"]), ("", "1e-3", "1"));
}

#[test]
fn the_page_is_well_formed() {
    let page = report().html();
    assert_balanced(&page);
    assert!(page.contains("a,&quot;b&quot;") && page.contains("&lt;scene&gt;.json") && page.contains("a &amp; b"));
    // Nothing from elsewhere: the only address is the name of SVG.
    assert_eq!((page.matches("http").count(), page.matches("<script").count()), (1, 0));
    assert_eq!(page.matches("data:image/png;base64,iVBORw0KGgo").count(), 5);
    assert!(page.contains("<td class=\"rel_mse\" data-value=\"\">&lt; noise</td>"), "{page}");
    assert!(page.contains("auto = bdpt") && page.contains("class=\"below\""));
}

#[test]
fn numbers_in_words() {
    for (x, text) in [
        (0.0, "0"),
        (12.345, "12.3"),
        (999.9, "1000"),
        (0.001_234, "0.00123"),
        (123_456.0, "123000"),
        (1.5e-5, "1.50e-5"),
        (-2.0, "-2.00"),
    ] {
        assert_eq!(text::figures(x), text);
    }
    assert_eq!(
        [1, 2, 3, 4, 11, 12, 21, 32, 113].map(text::ordinal).join(" "),
        "1st 2nd 3rd 4th 11th 12th 21st 32nd 113th"
    );
    let intervals = |n| Report::new(1, n).intervals();
    assert_eq!(intervals(5), "Medians of 5 runs; [least … greatest of them] covers the true median with 93.75 %.");
    assert_eq!(
        intervals(10),
        "Medians of 10 runs; [2nd least … 2nd greatest of them] covers the true median with 97.85 %."
    );
    assert_eq!(intervals(1), "One run of each: no intervals.");
}

#[test]
fn pilots_fix_samples() {
    let pilot = Pilot { samples: 8, cpu_seconds: 0.4 };
    assert_eq!([0.001, 0.1, 1.0, 1e30].map(|s| pilot.samples_for(s)), [1, 2, 20, u32::MAX]);
}

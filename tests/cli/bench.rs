//! `bench`: the same numbers in all its reports, references of both kinds, budgets, and what it refuses.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{Folder, ROOM};

/// Few samples of few runs, by both integrators.
const SMALL: &[&str] = &["bench", "room.json", "--spp", "1,4", "--seeds", "3", "--reference-spp", "64"];

/// A CSV's rows by column; no cell here is quoted.
fn rows(csv: &str) -> Vec<BTreeMap<String, String>> {
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), columns.len(), "{line}");
            columns.iter().zip(cells).map(|(k, v)| ((*k).to_owned(), v.to_owned())).collect()
        })
        .collect()
}

/// The page's numbers of a column, row by row.
fn column(page: &str, class: &str) -> Vec<Option<f64>> {
    let mark = format!("<td class=\"{class}\" data-value=\"");
    page.split(&mark).skip(1).map(|rest| rest.split('"').next().unwrap().parse().ok()).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// JSON's reader is off by a unit in the last place now and then.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-15 * b.abs()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn all_reports_have_the_same_numbers() {
    let folder = Folder::with_room("bench");
    let outcome = folder.ok(&[SMALL, &["-o", "out", "-o", "again.json"]].concat());
    assert_eq!(folder.names(), ["again.json", "out", "room.json"]);
    assert_eq!(folder.json("again.json"), folder.json("out/bench.json"));
    let json = folder.json("out/bench.json");
    let csv = String::from_utf8(folder.bytes("out/bench.csv")).unwrap();
    let page = String::from_utf8(folder.bytes("out/bench.html")).unwrap();

    assert_eq!((&json["repetitions"], &json["threads"]), (&3.into(), &1.into()));
    assert_eq!(number(&json["intervals"]["coverage"]), 0.75);
    assert!(json["version"].is_string() && json["git"].is_string() && json["machine"]["processors"].is_u64());
    let scene = &json["scenes"][0];
    assert_eq!((&scene["name"], &scene["resolution"]), (&"room".into(), &vec![16, 12].into()));
    let floor = number(&scene["reference"]["noise"]["rel_mse"]);
    assert!((1e-5..1e-1).contains(&floor) && scene["reference"]["halves"]["spp"] == 64, "{}", scene["reference"]);
    let configurations = scene["configurations"].as_array().unwrap();
    let kinds: Vec<(&str, u64)> =
        configurations.iter().map(|c| (c["integrator"].as_str().unwrap(), c["spp"].as_u64().unwrap())).collect();
    assert_eq!(kinds, [("path", 1), ("path", 4), ("bdpt", 1), ("bdpt", 4)]);

    let rows = rows(&csv);
    assert_eq!(rows.len(), 12);
    // Turns: in each repetition every configuration once, with one seed.
    let mut orders: Vec<u64> = rows.iter().map(|row| row["order"].parse().unwrap()).collect();
    orders.sort_unstable();
    assert_eq!(orders, (0..12).collect::<Vec<u64>>());
    assert!(
        rows.iter().all(|row| row["order"].parse::<u64>().unwrap() / 4 == row["repetition"].parse::<u64>().unwrap())
    );
    assert!(
        rows.iter().all(|row| row["seed"].parse::<u64>().unwrap() == 1001 + row["repetition"].parse::<u64>().unwrap())
    );

    for (index, c) in configurations.iter().enumerate() {
        let runs = c["runs"].as_array().unwrap();
        for (run, row) in runs.iter().zip(&rows[3 * index..]) {
            for (name, value) in [
                ("cpu_seconds", &run["cpu_seconds"]),
                ("wall_seconds", &run["wall_seconds"]),
                ("mse", &run["mse"]["value"]),
                ("rel_mse", &run["rel_mse"]["value"]),
                ("rel_mse_measured", &run["rel_mse"]["measured"]),
                ("rel_mse_noise", &run["rel_mse"]["noise"]),
                ("rel_mse_trimmed", &run["rel_mse_trimmed"]["value"]),
                ("efficiency", &run["efficiency"]),
                ("energy", &run["energy"]),
                ("rays_total", &run["rays"]["total"]),
                ("rays_per_cpu_second", &run["rays_per_cpu_second"]),
                ("samples_per_cpu_second", &run["samples_per_cpu_second"]),
            ] {
                assert!(same(row[name].parse().unwrap(), number(value)), "{name}: {}, {value}", row[name]);
            }
            let (error, measured) = (number(&run["rel_mse"]["value"]), number(&run["rel_mse"]["measured"]));
            assert!((measured - number(&run["rel_mse"]["noise"]) - error).abs() < 1e-12 && error >= floor);
            let cpu = number(&run["cpu_seconds"]);
            assert!((number(&run["efficiency"]) * error * cpu - 1.0).abs() < 1e-9);
            // 192 pixels.
            let samples = 192.0 * number(&c["spp"]);
            assert!((number(&run["samples_per_cpu_second"]) * cpu / samples - 1.0).abs() < 1e-9);
            assert_eq!(number(&run["paths"]["camera"]), samples);
            assert!((0.3..3.0).contains(&number(&run["energy"])), "{run}");
        }
        for (name, class) in
            [("cpu_seconds", "cpu"), ("rel_mse", "rel_mse"), ("mse", "mse"), ("efficiency", "efficiency")]
        {
            let of = |run: &Value| if run[name].is_number() { number(&run[name]) } else { number(&run[name]["value"]) };
            let expected = median(runs.iter().map(of).collect());
            assert!(same(number(&c["medians"][name]["median"]), expected), "{name}");
            assert!(column(&page, class)[index].is_some_and(|shown| same(shown, expected)), "{name}");
        }
    }
    // Ratios of pairs, to the first.
    let efficiency = |c: usize| configurations[c]["runs"].as_array().unwrap().iter().map(|r| number(&r["efficiency"]));
    let ratios = median(efficiency(3).zip(efficiency(0)).map(|(a, b)| a / b).collect());
    assert!((number(&configurations[3]["medians"]["efficiency_ratio"]["median"]) / ratios - 1.0).abs() < 1e-12);
    assert!(configurations[0]["medians"]["efficiency_ratio"].is_null());

    // The reference, and image and difference of each integrator at its largest number of samples.
    assert_eq!(page.matches("<img ").count(), 5);
    assert!(page.contains("bdpt, embree, 4 spp") || page.contains("bdpt, bvh, 4 spp"));
    assert_eq!((page.matches("class=\"line\"").count(), page.matches("class=\"bar\"").count()), (2, 4));

    let lines: Vec<&str> = outcome.stdout.lines().collect();
    assert_eq!(lines[0], "Medians of 3 runs; [least … greatest of them] covers the true median with 75 %.");
    assert_eq!(lines.iter().filter(|line| line.starts_with("room  ")).count(), 4, "{}", outcome.stdout);
    assert!(outcome.stdout.contains("  reference: mean of two independent halves of 64 spp by bdpt ("));
    assert!(outcome.stderr.contains("room: rendering the reference, 2 × 64 spp\nroom: repetition 1 of 3\n"));
}

/// A run is the render that its settings and seed say it is.
#[test]
fn runs_are_renders_and_only_their_times_vary() {
    let folder = Folder::with_room("bench_runs");
    let reference = folder.rendered("ref.exr", &["--spp", "64", "--seed", "5"]);
    let args = ["bench", "room.json", "--spp", "2", "--seeds", "1", "--reference", "ref.exr", "-q", "-o"];
    let outcome = folder.ok(&[&args[..], &["a.json", "--integrators", "path,auto,light"]].concat());
    assert!(outcome.stderr.is_empty() && outcome.stdout.starts_with("One run of each: no intervals.\n"), "{outcome:?}");
    folder.ok(&[&args[..], &["b.json", "--integrators", "bdpt", "--threads", "2"]].concat());
    let (a, b) = (folder.json("a.json"), folder.json("b.json"));
    let scene = &a["scenes"][0];
    for (index, integrator) in ["path", "auto", "light"].into_iter().enumerate() {
        let image = folder.rendered("run.exr", &["--spp", "2", "--seed", "1001", "--integrator", integrator]);
        let m = twinlight::compare::metrics(&image, &reference).unwrap();
        let c = &scene["configurations"][index];
        let run = &c["runs"][0];
        assert!(c["renders_by"] == integrator && same(number(&run["rel_mse"]["measured"]), m.rel_mse), "{c}");
        // Nothing is known of the noise: nothing is subtracted.
        assert!(same(number(&run["rel_mse"]["value"]), m.rel_mse) && same(number(&run["mse"]["value"]), m.mse));
        assert!(run["rel_mse"]["noise"].is_null() && c["medians"]["rel_mse"]["low"].is_null());
    }
    assert_eq!(scene["configurations"][1]["integrator"], "auto");
    // Of so few pixels it learns nothing.
    assert_eq!(
        scene["configurations"][1]["runs"][0]["rel_mse"],
        b["scenes"][0]["configurations"][0]["runs"][0]["rel_mse"]
    );
    let notes: Vec<&str> = scene["notes"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    assert!(
        notes.len() == 1 && notes[0].starts_with("light: what is seen in mirrors or through smooth glass is missing")
    );
    assert!(notes[0].ends_with("what is missing counts as error, and the energy tells how much it is"), "{notes:?}");
    assert!(outcome.stdout.contains("  reference: ref.exr; its noise is not known and is part of all errors"));
}

#[test]
fn a_given_noise_is_subtracted_and_hides_what_is_below_it() {
    let folder = Folder::with_room("bench_noise");
    folder.rendered("room.exr", &["--spp", "16", "--seed", "5", "--max-bounces", "4"]);
    let args = ["bench", "room.json", "--spp", "2,8", "--seeds", "2", "--references", ".", "-o", "a.json"];
    for (noise, hidden) in [("0.002", false), ("1000", true)] {
        let outcome = folder.ok(&[&args[..], &["--reference-noise", noise, "--integrators", "bdpt"]].concat());
        let json = folder.json("a.json");
        let scene = &json["scenes"][0];
        for c in scene["configurations"].as_array().unwrap() {
            assert_eq!(c["below_reference_noise"], hidden);
            for run in c["runs"].as_array().unwrap() {
                let error = &run["rel_mse"];
                assert_eq!(
                    (number(&error["noise"]), &error["below_reference_noise"]),
                    (noise.parse().unwrap(), &hidden.into())
                );
                assert_eq!((error["value"].is_null(), run["efficiency"].is_null()), (hidden, hidden), "{run}");
                assert!(run["mse"]["value"].is_number() && run["mse"]["noise"].is_null());
            }
        }
        assert_eq!(outcome.stdout.matches("< noise").count(), if hidden { 2 } else { 0 }, "{}", outcome.stdout);
        assert_eq!(scene["notes"][0], "./room.exr was rendered with max_bounces 4, the runs have 5");
    }
}

#[test]
fn budgets_become_samples_before_the_runs() {
    let folder = Folder::with_room("bench_seconds");
    let args = ["bench", "room.json", "--seconds", "0.01,0.04", "--seeds", "2", "--reference-spp", "8", "-o", "a.json"];
    let outcome = folder.ok(&[&args[..], &["--integrators", "path"]].concat());
    let json = folder.json("a.json");
    let [short, long] = [0, 1].map(|i| json["scenes"][0]["configurations"][i].clone());
    assert_eq!(short["budget"]["pilot"], long["budget"]["pilot"], "one pilot for both");
    for (c, seconds) in [(&short, 0.01), (&long, 0.04)] {
        let (pilot, spp) = (&c["budget"]["pilot"], number(&c["spp"]));
        assert_eq!(number(&c["budget"]["cpu_seconds"]), seconds);
        let expected = (seconds * number(&pilot["spp"]) / number(&pilot["cpu_seconds"])).round().max(1.0);
        assert_eq!(spp, expected);
        assert!(c["runs"].as_array().unwrap().iter().all(|run| number(&run["paths"]["camera"]) == 192.0 * spp));
    }
    assert!(outcome.stderr.starts_with("room: pilots\n"), "{outcome:?}");
}

#[test]
fn several_scenes_are_told_apart_by_file_or_folder() {
    let folder = Folder::new("bench_scenes");
    for path in ["one/scene.json", "two/scene.json", "other.json"] {
        std::fs::create_dir_all(folder.path(path).parent().unwrap()).unwrap();
        folder.write(path, ROOM);
    }
    let args =
        ["bench", "one/scene.json", "two/scene.json", "other.json", "--accels", "bvh", "--spp", "1", "--seeds", "1"];
    let options = ["--size", "4x3", "--reference-spp", "4", "--max-bounces", "2", "-o", "out.csv"];
    folder.ok(&[&args[..], &options].concat());
    let csv = String::from_utf8(folder.bytes("out.csv")).unwrap();
    let names: Vec<String> = rows(&csv).into_iter().map(|row| row["scene"].clone()).collect();
    assert_eq!(names, ["one", "one", "two", "two", "other", "other"]);
}

#[cfg(feature = "embree")]
#[test]
fn accelerators_take_turns_and_agree() {
    let folder = Folder::with_room("bench_accels");
    let args = ["bench", "room.json", "--spp", "8", "--seeds", "2", "--reference-spp", "32", "--accels", "bvh,embree"];
    folder.ok(&[&args[..], &["--integrators", "path", "-o", "a.json"]].concat());
    let json = folder.json("a.json");
    let [bvh, embree] = [0, 1].map(|i| json["scenes"][0]["configurations"][i].clone());
    assert_eq!((&bvh["accel"], &embree["accel"]), (&"bvh".into(), &"embree".into()));
    assert!(embree["accel_version"].as_str().unwrap().starts_with("embree 4."), "{embree}");
    let error = |c: &Value| number(&c["medians"]["rel_mse"]["median"]);
    assert!((error(&bvh) / error(&embree) - 1.0).abs() < 0.3, "{} {}", error(&bvh), error(&embree));
    let orders = |c: &Value| [0, 1].map(|r| c["runs"][r]["order"].as_u64().unwrap());
    assert_eq!((orders(&bvh), orders(&embree)), ([0, 2], [1, 3]));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = Folder::with_room("bench_refused");
    folder.write("other.json", ROOM);
    folder.write("bad.json", ROOM.replace("\"albedo\": [0.75", "\"albedo\": [1.75"));
    std::fs::create_dir(folder.path("sub")).unwrap();
    folder.write("sub/room.json", ROOM);
    folder.rendered("ref.exr", &["--spp", "1", "--seed", "1003"]);
    folder.rendered("small.exr", &["--spp", "1", "--size", "8x8"]);
    folder.rendered("crop.exr", &["--spp", "1", "--size", "32x24", "--crop", "0,0,16,12"]);
    folder.ok(&["render", "room.json", "--quiet", "--spp", "1", "-o", "ref.png"]);
    let before = folder.snapshot();
    for (arguments, status, message) in [
        (
            "room.json other.json --reference ref.exr",
            2,
            "twinlight: --reference ref.exr: it can be that of one scene, and there are 2; put one for each into a folder and give \
             --references",
        ),
        (
            "room.json sub/room.json",
            2,
            "twinlight: room.json and sub/room.json would both be named `room` in the reports; give each scene once, or rename one",
        ),
        (
            "room.json --spp 4,8,4",
            2,
            "twinlight: --spp: 4 is given twice; give it once, and --seeds for more runs of it",
        ),
        (
            "room.json --integrators path,bdpt,path",
            2,
            "twinlight: --integrators: path is given twice; give it once, and --seeds for more runs of it",
        ),
        (
            "room.json --reference small.exr",
            65,
            "twinlight: small.exr: the reference has 8 × 8 pixels, the image of room.json 16 × 12; give --size 8x8, or a reference \
             of that size",
        ),
        (
            "room.json --reference crop.exr",
            65,
            "twinlight: crop.exr: this is a crop, and runs render whole images; give a reference that is whole",
        ),
        (
            "room.json --reference ref.png",
            65,
            "twinlight: ref.png: a reference has to be linear and unclipped, an EXR; render it to one",
        ),
        (
            "room.json --reference ref.exr",
            2,
            "twinlight: ref.exr: it was rendered with seed 1003, which is a run's, too: common samples would look like no error; \
             give another --first-seed",
        ),
        (
            "room.json --references sub",
            1,
            "twinlight: cannot read `sub/room.exr`: No such file or directory (os error 2); check the name and the permissions",
        ),
        (
            "room.json -o report.txt",
            2,
            "twinlight: report.txt: a report is a .json, .csv or .html file, or a folder for all three; give it such a name",
        ),
        ("room.json -o room.json", 2, "twinlight: room.json: this is a scene itself; choose another name"),
        (
            "room.json -o a.csv -o ./a.csv",
            2,
            "twinlight: ./a.csv: two reports would be written to this file; choose another name",
        ),
        (
            "room.json -o none/out",
            2,
            "twinlight: cannot write `none/out`: the folder `none` cannot be entered (No such file or directory (os error 2)); \
             create it first",
        ),
        (
            "room.json bad.json",
            65,
            "twinlight: bad.json:6:56: /materials/0/albedo/0: 1.75 is out of range; allowed: 0 to 1",
        ),
        (
            "none.json",
            1,
            "twinlight: none.json: cannot read the scene file: No such file or directory (os error 2); check the name and the \
             permissions",
        ),
    ] {
        let outcome = folder.run(&[vec!["bench"], arguments.split(' ').collect()].concat());
        assert_eq!(
            (outcome.status, outcome.stderr.as_str()),
            (Some(status), format!("{message}\n").as_str()),
            "{arguments}"
        );
        assert!(outcome.stdout.is_empty() && folder.snapshot() == before, "{arguments}");
    }
    // Clap's own words about what cannot be parsed, or not together; its first paragraph.
    for (arguments, message) in [
        ("", "error: the following required arguments were not provided:\n  <SCENE>..."),
        (
            "room.json --seeds 0",
            "error: invalid value '0' for '--seeds <N>': write it as a whole number, 1 or more (at most 1000)",
        ),
        (
            "room.json --seconds 0",
            "error: invalid value '0' for '--seconds <LIST>': write it as a number of seconds from 0.001 to 1000000, for example \
             1.5",
        ),
        (
            "room.json --reference ref.exr --reference-noise -1",
            "error: invalid value '-1' for '--reference-noise <X>': write it as a relMSE, 0 or more (at most 1000000), for example \
             1e-5",
        ),
        ("room.json --spp 4 --seconds 1", "error: the argument '--spp <LIST>' cannot be used with '--seconds <LIST>'"),
        (
            "room.json --reference ref.exr --references .",
            "error: the argument '--reference <FILE.exr>' cannot be used with '--references <DIR>'",
        ),
        (
            "room.json --reference-noise 1",
            "error: the following required arguments were not provided:\n  <--reference <FILE.exr>|--references <DIR>>",
        ),
    ] {
        let arguments: Vec<&str> = arguments.split(' ').filter(|a| !a.is_empty()).collect();
        let outcome = folder.run(&[vec!["bench"], arguments].concat());
        let paragraph = outcome.stderr.split("\n\n").next().unwrap();
        assert_eq!((outcome.status, paragraph), (Some(2), message));
    }
}

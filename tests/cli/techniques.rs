//! `--technique`, `--unweighted` and `--pyramid`.

use std::collections::BTreeSet;

use super::{Folder, difference, exr_header};

/// Three bounces: paths of up to four edges.
const SHORT: [&str; 2] = ["--max-bounces", "3"];

fn techniques() -> Vec<(u32, u32)> {
    (1..=4).flat_map(|edges| (0..=edges).map(move |s| (s, edges + 1 - s))).collect()
}

#[test]
fn the_pyramids_images_are_the_image_taken_apart() {
    let folder = Folder::with_room("pyramid");
    let plain = folder.rendered("plain.exr", &SHORT);
    std::fs::create_dir(folder.path("a")).unwrap();
    let full = folder.rendered("full.exr", &[&SHORT[..], &["--pyramid", "a/pyramid", "--pyramid-edges", "4"]].concat());
    assert!(plain == full, "keeping techniques apart changes the image");
    let written: BTreeSet<String> = std::fs::read_dir(folder.path("a/pyramid"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    let mut sum = twinlight::film::Image::new(full.width, full.height);
    let mut found = 0;
    for (s, t) in techniques() {
        let name = format!("s{s}_t{t}");
        if !written.contains(&format!("{name}.exr")) {
            continue;
        }
        found += 1;
        let image = folder.image(&format!("a/pyramid/{name}.exr"));
        for (x, y) in sum.rgb.iter_mut().flatten().zip(image.rgb.iter().flatten()) {
            *x += y;
        }
        // Alone, the technique is the same image: samples do not depend on what is kept of them.
        let alone = folder.rendered("one.exr", &[&SHORT[..], &["--technique", &format!("{s},{t}")]].concat());
        assert!(difference(&alone, &image) < 1e-5, "{name}: {}", difference(&alone, &image));
        let attributes = exr_header(&folder.path("one.exr")).0;
        assert_eq!(attributes["twinlight:technique"], format!("{s},{t} weighted"));
        // And says the same of itself, but for which run it was part of.
        assert_eq!(exr_header(&folder.path(&format!("a/pyramid/{name}.exr"))).0, attributes, "{name}");
        assert_eq!(folder.image(&format!("a/pyramid/{name}.png")).width, 16);
    }
    assert!(difference(&sum, &full) < 1e-5, "{}", difference(&sum, &full));
    // 14 techniques make paths of up to four edges; a few may have found nothing at 4 samples.
    assert!(found >= 12, "{written:?}");
    assert_eq!(written.len(), 2 * found + 1, "{written:?}");
    let sheet = folder.image("a/pyramid/pyramid.png");
    assert!(sheet.width >= 5 * 16 && sheet.height >= 4 * 12, "{} × {}", sheet.width, sheet.height);
    // An empty, existing folder does as well, and edges limit what is written.
    std::fs::create_dir(folder.path("there")).unwrap();
    folder.rendered("full.exr", &["--pyramid", "there", "--pyramid-edges", "1"]);
    assert!(folder.path("there/s0_t2.exr").exists() && !folder.path("there/s1_t2.exr").exists());
}

#[test]
fn what_a_pyramid_holds_is_told_and_its_sheet_can_be_read() {
    let folder = Folder::with_room("sheet");
    let options = ["--pyramid", "P", "--pyramid-edges", "3", "--spp", "64", "-o", "full.exr"];
    let told = folder.ok(&[&["render", "room.json"], &options[..]].concat()).stderr;
    let line = told.lines().last().unwrap();
    let count = std::fs::read_dir(folder.path("P")).unwrap().count() / 2;
    let rows = line.strip_prefix(&format!(
        "P: images of {count} techniques (sS_tT.exr and .png); the sheet pyramid.png has s growing to the right and a row \
         for each number of edges, brightened: "
    ));
    let rows: Vec<(u32, f64)> = rows
        .unwrap_or_else(|| panic!("{line}"))
        .split(", ")
        .map(|row| row.split_once(" ×").unwrap())
        .map(|(edges, factor)| (edges.parse().unwrap(), factor.parse().unwrap()))
        .collect();
    assert_eq!(rows.iter().map(|row| row.0).collect::<Vec<u32>>(), [1, 2, 3]);
    assert!(rows.is_sorted_by_key(|row| row.1), "{line}");
    let sheet = folder.image("P/pyramid.png");
    for (edges, factor) in rows {
        assert!(factor >= 1.0 && factor.log2().fract() == 0.0, "{factor}");
        // The image is on the sheet at its own size, times the row's factor: one place, and only one, holds it.
        let image = folder.image(&format!("P/s1_t{edges}.exr"));
        let byte = |v: f64| (255.0 * twinlight::output::srgb_encode(v.clamp(0.0, 1.0))).round() as i32;
        let at = |x0: u32, y0: u32| {
            (0..12).all(|y| {
                (0..16).all(|x| {
                    let (shown, value) = (sheet.get(x0 + x, y0 + y), image.get(x, y));
                    shown.iter().zip(value).all(|(s, v)| byte(f64::from(*s)) == byte(f64::from(v) * factor))
                })
            })
        };
        let places = (0..=sheet.height - 12).flat_map(|y| (0..=sheet.width - 16).map(move |x| (x, y)));
        assert_eq!(places.filter(|(x, y)| at(*x, *y)).count(), 1, "s = 1, t = {edges}: ×{factor}");
    }
    // Stops brighten the images and are not undone by the rows' factors where these are 1 already.
    folder.rendered("full.exr", &["--pyramid", "P", "--pyramid-edges", "1", "--exposure", "-3"]);
    let (darker, plain) = (folder.image("P/s0_t2.png"), folder.image("P/s0_t2.exr"));
    assert!(plain.mean()[0] > 0.0 && darker.mean()[0] < 0.2 * plain.mean()[0]);
    // Nothing to show is said as well.
    folder.write("dark.json", r#"{"camera": {"resolution": 2}, "image_samples": 1}"#);
    let told = folder.ok(&["render", "dark.json", "--pyramid", "D"]).stderr;
    assert!(told.ends_with("D: no technique found any light, so that no image was written\n"), "{told}");
    assert_eq!(std::fs::read_dir(folder.path("D")).unwrap().count(), 0);
}

#[test]
fn a_folder_that_is_used_again_holds_one_pyramid() {
    let folder = Folder::with_room("pyramid_again");
    let fresh = |name: &str, edges: &str| {
        let options = ["--max-bounces", "3", "--pyramid", name, "--pyramid-edges", edges, "-o", "full.exr"];
        folder.ok(&[&["render", "room.json"], &options[..]].concat()).stderr
    };
    let files = |name: &str| -> BTreeSet<String> {
        let entries = std::fs::read_dir(folder.path(name)).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    };
    assert!(!fresh("P", "4").contains("removed"));
    fresh("new", "2");
    let many = files("P").len();
    // What no pyramid writes stays: other names, other ways to write the numbers, folders and links.
    let others =
        ["s01_t2.exr", "s+1_t2.png", "s1_t2.jpg", "s1_t2.exr.bak", "xs1_t2.exr", "S1_t2.exr", "s_t2.exr", "s1_t.png"];
    others.iter().for_each(|name| folder.write(&format!("P/{name}"), "another's"));
    std::fs::create_dir(folder.path("P/s40_t1.exr")).unwrap();
    #[cfg(unix)]
    std::os::unix::fs::symlink("s01_t2.exr", folder.path("P/s40_t2.exr")).unwrap();
    // Never made by a run of so few edges, but a pyramid's name.
    folder.write("P/s63_t1.png", "old");
    let told = fresh("P", "2");
    let removed = many + 1 - files("new").len();
    assert!(removed > 8 && told.ends_with(&format!("; removed {removed} files of an earlier pyramid\n")), "{told}");
    let left: BTreeSet<String> = files("P").difference(&files("new")).cloned().collect();
    let mut expected: BTreeSet<String> = others.iter().chain(&["s40_t1.exr"]).map(ToString::to_string).collect();
    if cfg!(unix) {
        expected.insert("s40_t2.exr".to_owned());
    }
    assert_eq!(left, expected);
    for name in files("new") {
        assert!(folder.bytes(&format!("P/{name}")) == folder.bytes(&format!("new/{name}")), "{name}");
    }
    // Nothing is left to be removed; without any light nothing is left at all.
    assert!(!fresh("P", "2").contains("removed"));
    folder.write("dark.json", r#"{"camera": {"resolution": 2}, "image_samples": 1}"#);
    let told = folder.ok(&["render", "dark.json", "--pyramid", "new"]).stderr;
    assert!(told.contains("so that no image was written; removed ") && files("new").is_empty(), "{told}");
    // A render that fails leaves the old one whole.
    let before = folder.snapshot();
    assert_eq!(folder.run(&["render", "room.json", "--pyramid", "P", "--crop", "0,0,99,9"]).status, Some(2));
    assert!(folder.snapshot() == before);
}

#[test]
fn a_pyramid_of_one_technique_says_whether_it_is_weighted() {
    let folder = Folder::with_room("pyramid_one");
    for (options, words) in [(&[][..], "weighted"), (&["--unweighted"], "unweighted")] {
        folder.rendered("a.exr", &[&["--technique", "1,2", "--pyramid", "P"], options].concat());
        assert_eq!(exr_header(&folder.path("P/s1_t2.exr")).0["twinlight:technique"], format!("1,2 {words}"));
    }
}

#[test]
fn a_technique_that_finds_nothing_in_the_scene_is_noted() {
    let folder = Folder::with_room("black_technique");
    let scene = |name: &str, lights: &str, surfaces: &str| {
        let camera = r#"{"transform": {"translate": [0, 0, 1]}, "resolution": 2}"#;
        let text = r#""image_samples": 1, "lights""#;
        folder.write(name, format!(r#"{{"camera": {camera}, {text}: [{lights}], "surfaces": [{surfaces}]}}"#));
    };
    let floor = r#"{"type": "quad", "material": {"type": "lambertian", "albedo": 0.5}}"#;
    let point = r#"{"type": "point", "position": [0, 0.5, 1], "intensity": 1}"#;
    let sky = r#"{"type": "constant", "radiance": 1}"#;
    scene("point.json", point, floor);
    scene("sky.json", sky, floor);
    scene("mirror.json", sky, r#"{"type": "quad", "material": {"type": "mirror"}}"#);
    scene("dark.json", "", floor);
    let chance = "paths can hit no light by chance: all are point, spot or directional lights";
    let area = "no light is a surface, which alone could be connected to the camera";
    let delta = "no surface can be connected to: all are mirrors, smooth glass or reflect nothing";
    for (args, why) in [
        ("room.json --technique 0,2", None),
        ("room.json --technique 1,1", None),
        ("room.json --technique 2,2", None),
        ("point.json --technique 0,2", Some(chance)),
        ("point.json --technique 0,4 --unweighted", Some(chance)),
        ("point.json --technique 1,1 --integrator light", Some(area)),
        ("point.json --technique 1,2", None),
        ("point.json --technique 2,1", None),
        ("sky.json --technique 0,2", None),
        ("sky.json --technique 1,1", Some(area)),
        ("mirror.json --technique 0,3", None),
        ("mirror.json --technique 1,2", Some(delta)),
        ("mirror.json --technique 2,1", Some(delta)),
        ("mirror.json", None),
        ("dark.json --technique 0,2", None),
    ] {
        let said = folder.ok(&[vec!["render"], args.split(' ').collect(), vec!["-o", "a.exr"]].concat()).stderr;
        let notes: Vec<&str> = said.lines().filter_map(|l| l.strip_prefix("note: ")).collect();
        let technique = args.split(' ').nth(2).unwrap_or_default();
        let expected = why.map(|why| format!("--technique {technique}: the image will be black: {why}"));
        assert_eq!(notes, Vec::from_iter(expected), "{args}: {said}");
        // It is, and where nothing is said there is light.
        if !args.starts_with("dark") {
            let options = ["--spp", "64", "--size", "16x16", "-q", "-o", "a.exr"];
            folder.ok(&[vec!["render"], args.split(' ').collect(), options.to_vec()].concat());
            assert_eq!(folder.image("a.exr").mean() == [0.0; 3], why.is_some(), "{args}");
        }
    }
}

#[test]
fn a_pyramid_goes_where_an_output_may_go() {
    let folder = Folder::with_room("pyramid_place");
    folder.write("file", "what was there before");
    #[cfg(unix)]
    std::os::unix::fs::symlink("nowhere", folder.path("link")).unwrap();
    let before = folder.names();
    for (place, why) in [
        (
            "no/such/D3",
            "the folder `no/such` cannot be entered (No such file or directory (os error 2)); create it first",
        ),
        ("no/D3/", "the folder `no` cannot be entered (No such file or directory (os error 2)); create it first"),
        ("file", "`file` is not a folder; choose another place"),
        ("file/D3", "`file` is not a folder; choose another place"),
        ("link", "the folder `link` cannot be entered (No such file or directory (os error 2)); create it first"),
    ] {
        let outcome = folder.run(&["render", "room.json", "-o", "a.exr", "--pyramid", place]);
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stderr.starts_with("twinlight: --pyramid: cannot write `"), "{outcome:?}");
        assert!(outcome.stderr.ends_with(&format!("{why}\n")), "{outcome:?}");
        assert_eq!(folder.names(), before, "{place}");
    }
    // What the pyramid writes, nothing else may; beside it there is room.
    std::fs::create_dir(folder.path("P")).unwrap();
    for name in ["P/pyramid.png", "./P/s12_t1.exr", "P/s0_t2.png"] {
        let outcome = folder.run(&["render", "room.json", "-o", name, "--pyramid", "P"]);
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stderr.contains("the pyramid writes a file of this name there"), "{outcome:?}");
    }
    folder.rendered("P/full.exr", &["--pyramid", "P/", "-o", "s0_t2.exr", "-o", "P/s_t2.exr"]);
}

#[test]
fn a_technique_without_its_weight_is_brighter() {
    let folder = Folder::with_room("unweighted");
    for technique in ["1,2", "2,1", "2,2"] {
        let options = ["--spp", "32", "--technique", technique];
        let weighted = folder.rendered("w.exr", &options);
        let alone = folder.rendered("u.exr", &[&options[..], &["--unweighted"]].concat());
        let attributes = exr_header(&folder.path("u.exr")).0;
        assert_eq!(attributes["twinlight:technique"], format!("{technique} unweighted"));
        assert!(weighted.mean()[0] > 0.0 && alone.mean()[0] > 1.05 * weighted.mean()[0], "{technique}");
        for (w, u) in weighted.rgb.iter().flatten().zip(alone.rgb.iter().flatten()) {
            assert!(*w <= u * 1.00001, "{technique}: a weight above one: {w} of {u}");
        }
    }
    // Unweighted, next-event estimation alone is all of the direct light: what `path` finds less the lamp itself.
    let nee = folder.rendered("u.exr", &["--spp", "256", "--technique", "1,2", "--unweighted", "--crop", "0,0,4,12"]);
    let both = ["--spp", "256", "--integrator", "path", "--crop", "0,0,4,12", "--max-bounces"];
    let direct = folder.rendered("d.exr", &[&both[..], &["1"]].concat());
    let ratio = super::mean_ratio(&nee, &direct);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

#[test]
fn impossible_techniques_are_refused() {
    let folder = Folder::with_room("impossible");
    let before = folder.snapshot();
    let cases: [(&[&str], &str); 13] = [
        (&["--technique", "1,0"], "t counts the camera's own vertex: it is at least 1"),
        (&["--technique", "0,1"], "a path has at least two vertices: s + t must be at least 2"),
        (&["--technique", "2"], "write it as s,t, for example 1,2"),
        (&["--technique", "a,b"], "write it as s,t, for example 1,2"),
        (&["--technique=-1,2"], "write it as s,t, for example 1,2"),
        (&["--technique", "2,2", "--integrator", "path"], "the path integrator has no such technique; use bdpt"),
        (&["--technique", "2,1", "--integrator", "path"], "the path integrator has no such technique; use bdpt"),
        (&["--technique", "1,2", "--integrator", "light"], "the light integrator has no such technique; use bdpt"),
        (&["--technique", "4,4"], "its paths scatter 6 times and max_bounces is 5; give --max-bounces 6 or more"),
        (
            &["--technique", "4294967295,4294967295"],
            "its paths scatter 8589934588 times and max_bounces is 5; give --max-bounces 8589934588 or more",
        ),
        (&["--technique", "2,2", "--light-paths", "0"], "it takes light subpaths; give --light-paths 1 or more"),
        (&["--technique", "2,2", "--connections", "0"], "it takes connections; give --connections 1 or more"),
        (&["--unweighted"], "--technique <s,t>"),
    ];
    for (options, message) in cases {
        let outcome = folder.run(&[&["render", "room.json", "-o", "t.exr"], options].concat());
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stderr.contains(message), "{outcome:?}");
        assert!(folder.snapshot() == before, "{options:?}: a file was touched");
    }
    // At the limits of what is possible.
    for technique in [["--technique", "0,7"], ["--technique", "6,1"]] {
        folder.rendered("t.exr", &technique);
    }
    folder.rendered("t.exr", &["--technique", "2,1", "--connections", "0"]);
    folder.rendered("t.exr", &["--technique", "1,2", "--light-paths", "0"]);
}

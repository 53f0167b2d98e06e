//! `render`: files, metadata, statistics, messages.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::process::Stdio;

use serde_json::Value;
use twinlight::output::{srgb_decode, srgb_encode};

use super::{Folder, ROOM, exr_header};

#[test]
fn by_default_the_scenes_name_goes_into_the_current_folder() {
    let folder = Folder::new("default_output");
    std::fs::create_dir(folder.path("scenes")).unwrap();
    folder.write("scenes/room.v2.json", ROOM);
    folder.ok(&["render", "scenes/room.v2.json", "--quiet"]);
    assert_eq!(folder.names(), ["room.v2.exr", "scenes"]);
    assert_eq!(std::fs::read_dir(folder.path("scenes")).unwrap().count(), 1);
    let image = folder.image("room.v2.exr");
    assert_eq!((image.width, image.height), (16, 12));
    assert!(image.mean().iter().all(|m| (0.05..5.0).contains(m)), "{:?}", image.mean());
}

#[test]
fn several_outputs_hold_one_image() {
    let folder = Folder::with_room("several_outputs");
    folder.write("b.PNG", "what was there before");
    folder.ok(&["render", "room.json", "-q", "-o", "a.exr", "--output", "b.PNG", "-o", "c.png", "-o", "d.exr"]);
    // No default output beside those that were asked for, and no temporary file left.
    assert_eq!(folder.names(), ["a.exr", "b.PNG", "c.png", "d.exr", "room.json"]);
    assert_eq!(folder.bytes("a.exr"), folder.bytes("d.exr"));
    assert_eq!(folder.bytes("b.PNG"), folder.bytes("c.png"));
    let (linear, coded) = (folder.image("a.exr"), folder.image("c.png"));
    let mut clipped = 0;
    for (l, c) in linear.rgb.iter().flatten().zip(coded.rgb.iter().flatten()) {
        let byte = (255.0 * srgb_encode(f64::from(*l).clamp(0.0, 1.0))).round();
        assert!((srgb_decode(byte / 255.0) - f64::from(*c)).abs() < 1e-6, "{l} in the EXR, {c} in the PNG");
        clipped += usize::from(*l > 1.0);
    }
    assert!(clipped > 0 && clipped < linear.rgb.len(), "the scene is to have a lamp in view, and more");
}

#[test]
fn an_exr_says_what_made_it_and_nothing_else() {
    let folder = Folder::with_room("metadata");
    folder.ok(&["render", "room.json", "--spp", "3", "--threads", "1"]);
    let (attributes, window, display) = exr_header(&folder.path("room.exr"));
    let keys: BTreeSet<&str> = attributes.keys().map(String::as_str).collect();
    let expected = [
        "accel",
        "connections",
        "git",
        "heuristic",
        "integrator",
        "light_paths",
        "max_bounces",
        "roulette",
        "sampler",
        "scene",
        "seed",
        "spp",
        "version",
    ];
    assert_eq!(keys, expected.map(|k| format!("twinlight:{k}")).iter().map(String::as_str).collect());
    let get = |key: &str| attributes[&format!("twinlight:{key}")].as_str();
    for (key, value) in [
        ("spp", "3"),
        ("seed", "11"),
        ("integrator", "bdpt"),
        ("heuristic", "power"),
        ("sampler", "sobol"),
        ("max_bounces", "5"),
        ("roulette", "true"),
        ("light_paths", "1"),
        ("connections", "1"),
        ("version", env!("CARGO_PKG_VERSION")),
    ] {
        assert_eq!(get(key), value, "{key}");
    }
    if cfg!(feature = "embree") {
        let words: Vec<&str> = get("accel").split(' ').collect();
        let version: Vec<u32> = words[1].split('.').map(|n| n.parse().unwrap()).collect();
        assert!(words.len() == 3 && words[0] == "embree" && version >= vec![4, 3, 0], "{words:?}");
    }
    assert!(get("scene").len() == 32 && get("scene").chars().all(|c| c.is_ascii_hexdigit()), "{}", get("scene"));
    assert!(!get("git").is_empty());
    assert_eq!((window, display), ([0, 0, 16, 12], [16, 12]));

    // The hash is the scene's: another scene has another, the same one under another name has the same.
    let hash = |name: &str| {
        folder.ok(&["render", name, "-q", "--spp", "1", "-o", "hash.exr"]);
        exr_header(&folder.path("hash.exr")).0["twinlight:scene"].clone()
    };
    folder.write("same.json", ROOM);
    folder.write("other.json", ROOM.replace("0.75", "0.76"));
    assert_eq!(hash("same.json"), get("scene"));
    assert_ne!(hash("other.json"), get("scene"));
}

#[test]
fn the_file_depends_on_neither_threads_nor_the_run() {
    let folder = Folder::with_room("threads");
    for (integrator, accel) in [("bdpt", None), ("path", None), ("light", None), ("bdpt", Some("bvh"))] {
        let mut files = Vec::new();
        // One thread twice: two runs. 37 × 29 pixels in tiles of 16 leave ragged ones.
        for threads in ["1", "1", "2", "5"] {
            let mut args =
                vec!["render", "room.json", "-q", "-o", "t.exr", "-o", "t.png", "--size", "37x29", "--spp", "70"];
            args.extend(["--integrator", integrator, "--threads", threads]);
            args.extend(accel.iter().flat_map(|a| ["--accel", a]));
            folder.ok(&args);
            files.push((folder.bytes("t.exr"), folder.bytes("t.png")));
        }
        for (file, threads) in files[1..].iter().zip(["1 again", "2", "5"]) {
            assert!(*file == files[0], "{integrator}, {accel:?}: {threads} threads write another file than 1");
        }
        assert!(folder.image("t.exr").mean().iter().all(|m| *m > 0.01), "{integrator}: black");
    }
}

#[test]
fn statistics_have_every_field() {
    let folder = Folder::with_room("stats");
    let args = ["render", "room.json", "-q", "-o", "a.exr", "--stats", "s.json"];
    folder
        .ok(&[&args[..], &["--threads", "2", "--crop", "3,2,13,11", "--light-paths", "3", "--connections", "2"]]
            .concat());
    let stats = folder.json("s.json");
    let keys: Vec<&str> = stats.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "accel",
        "connections",
        "crop",
        "git",
        "heuristic",
        "integrator",
        "light_paths",
        "max_bounces",
        "non_finite",
        "overflows",
        "overflows_first",
        "paths",
        "peak_memory_bytes",
        "plan",
        "rays",
        "resolution",
        "roulette",
        "roulette_after",
        "sampler",
        "scene",
        "seconds",
        "seed",
        "spp",
        "technique",
        "threads",
        "version",
    ];
    assert_eq!(keys, expected);
    let attributes = exr_header(&folder.path("a.exr")).0;
    for key in ["accel", "git", "heuristic", "integrator", "sampler", "scene", "version"] {
        assert_eq!(stats[key].as_str().unwrap(), attributes[&format!("twinlight:{key}")], "{key}");
    }
    for (key, value) in [
        ("/seed", 11),
        ("/spp", 4),
        ("/max_bounces", 5),
        ("/light_paths", 3),
        ("/connections", 2),
        ("/threads", 2),
        ("/overflows", 0),
        ("/non_finite/count", 0),
        // Of 10 × 9 pixels with 4 samples each; the light subpaths are those of all 16 × 12, 3 for each sample.
        ("/paths/camera", 360),
        ("/paths/light", 2304),
    ] {
        assert_eq!(stats.pointer(key).and_then(Value::as_u64), Some(value), "{key}: {stats:#}");
    }
    assert_eq!(stats["crop"], serde_json::json!([3, 2, 13, 11]));
    assert_eq!(stats["resolution"], serde_json::json!([16, 12]));
    assert_eq!(stats["roulette"], true);
    assert_eq!(stats["non_finite"]["first"], serde_json::json!([]));

    let rays = stats["rays"].as_object().unwrap();
    let count = |kind: &str| rays[kind].as_u64().unwrap();
    let kinds = ["camera", "light", "shadow", "connection", "lens"];
    assert_eq!(kinds.map(count).iter().sum::<u64>(), count("total"));
    assert_eq!(rays.len(), kinds.len() + 2);
    assert!(count("camera") >= 360 && count("light") >= 2304, "{rays:?}");
    assert!(kinds.iter().all(|kind| count(kind) > 0), "{rays:?}");

    let seconds = stats["seconds"].as_object().unwrap();
    let phases = ["parse", "build", "render", "write"].map(|phase| seconds[phase].as_f64().unwrap());
    assert!(phases.iter().all(|s| *s > 0.0 && *s < 60.0), "{seconds:?}");
    assert_eq!(seconds.len(), 5);
    let per_second = rays["per_second"].as_f64().unwrap();
    assert!((per_second * phases[2] / count("total") as f64 - 1.0).abs() < 1e-6, "{per_second}, {seconds:?}");
    if cfg!(target_os = "linux") {
        assert!((0.0..60.0).contains(&seconds["cpu"].as_f64().unwrap()), "{seconds:?}");
        let memory = stats["peak_memory_bytes"].as_u64().unwrap();
        assert!((1 << 20..1 << 33).contains(&memory), "{memory}");
    }

    // The scatterings free of roulette are those in effect, whether given or the integrator's own.
    for (options, expected) in [
        (&["--integrator", "path"][..], Some(3)),
        (&["--integrator", "light"], Some(2)),
        (&["--integrator", "bdpt"], Some(2)),
        (&["--roulette-after", "7"], Some(7)),
        (&["--no-roulette"], None),
    ] {
        folder.rendered("a.exr", &[options, &["--stats", "s.json", "--spp", "1", "--size", "7x5"]].concat());
        let stats = folder.json("s.json");
        assert_eq!(
            (stats["roulette_after"].as_u64(), stats["roulette"].as_bool()),
            (expected, Some(expected.is_some()))
        );
        assert_eq!((stats["resolution"].clone(), stats["crop"].clone()), ([7, 5].into(), [0, 0, 7, 5].into()));
    }

    // Without a light there is nothing to trace but, at most, primary rays.
    folder.write("dark.json", r#"{"camera": {"resolution": [5, 4]}, "image_samples": 2}"#);
    folder.ok(&["render", "dark.json", "-q", "--stats", "s.json"]);
    let rays = &folder.json("s.json")["rays"];
    assert_eq!(rays["total"], rays["camera"]);
    assert!(rays["camera"].as_u64().unwrap() <= 40, "{rays}");
}

#[test]
fn statistics_go_to_standard_output_as_well() {
    let folder = Folder::with_room("stats_stdout");
    let before = folder.names();
    for quiet in [&[][..], &["--quiet"]] {
        let outcome = folder.ok(&[&["render", "room.json", "-o", "a.exr", "--stats", "-"], quiet].concat());
        let stats: Value = serde_json::from_str(&outcome.stdout).unwrap();
        assert_eq!((stats["spp"].as_u64(), stats["resolution"].clone()), (Some(4), [16, 12].into()));
        assert_eq!(outcome.stderr.is_empty(), !quiet.is_empty(), "{outcome:?}");
        assert_eq!(folder.names(), [&["a.exr".to_owned()], &before[..]].concat());
    }
    // A file of that name can be had.
    folder.ok(&["render", "room.json", "-q", "-o", "a.exr", "--stats", "./-"]);
    assert_eq!(folder.json("-")["spp"], 4);
}

#[test]
fn quiet_says_nothing_and_otherwise_lines_are_plain() {
    let folder = Folder::with_room("quiet");
    // Everything that is said otherwise: a note, warnings, what is rendered by what, the summary.
    let dark = r#"{"camera": {"resolution": 4}, "image_samples": 1, "accelerator": {"type": "bbh"},
        "surfaces": [{"type": "triangle", "positions": [0, 1, 2], "material": {"type": "diffuse light", "emit": 1}}]}"#;
    folder.write("dark.json", dark);
    let quiet = folder.ok(&["render", "dark.json", "--quiet"]);
    assert_eq!((quiet.stdout.as_str(), quiet.stderr.as_str()), ("", ""));
    let loud = folder.ok(&["render", "dark.json"]);
    assert_eq!(loud.stdout, "");
    let lines: Vec<&str> = loud.stderr.lines().collect();
    let expected = [
        "note: dark.json:1:66: /accelerator: the accelerator is ignored: it is chosen on the command line",
        "warning: dark.json:2:22: /surfaces/0: 1 triangle without area dropped, of 1",
        "warning: dark.json:2:22: /surfaces/0: the light has no area: it emits nothing",
        "warning: dark.json:1:12: /camera: nothing in the scene shines: the image will be black",
    ];
    assert_eq!(lines[..4], expected);
    assert!(lines[4].starts_with("dark.json: 4 × 4 pixels, 1 spp, auto, "), "{}", lines[4]);
    let [summary] = lines[5..] else { panic!("{lines:?}") };
    assert!(summary.starts_with("dark.exr: 1 spp in ") && summary.ends_with(" Mrays/s)"), "{summary}");
    assert!(!loud.stderr.contains(['\r', '\x1b']), "{:?}", loud.stderr);
    assert_eq!(folder.image("dark.exr").mean(), [0.0; 3]);
    // The terse message of a failure is said even then.
    assert_ne!(folder.run(&["render", "none.json", "--quiet"]).stderr, "");
}

/// The first line of progress comes after ten seconds. The render is ended then, in its middle: it must leave nothing behind.
#[test]
fn progress_is_told_in_plain_lines_and_a_killed_render_leaves_no_file() {
    let folder = Folder::with_room("progress");
    folder.write("old.exr", "what was there before");
    let before = folder.snapshot();
    let args = ["render", "room.json", "-o", "new.exr", "-o", "old.exr", "--spp", "1000000000", "--threads", "1"];
    let mut child = folder.command(&args).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let (mut first, mut line) = (String::new(), String::new());
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    lines.read_line(&mut first).unwrap();
    lines.read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(first.starts_with("room.json: 16 × 12 pixels, 1000000000 spp, bdpt, 1 thread, "), "{first}");
    // `  0.0 %  2345.6/1000000000 spp  1.23 Mrays/s  12 h 34 min left`
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |i: usize| words[i].parse::<f64>().unwrap();
    assert!(line.ends_with(" left\n") && !line.contains(['\r', '\x1b']), "{line:?}");
    assert_eq!([words[1], words[3], words[5]], ["%", "spp", "Mrays/s"], "{line:?}");
    assert!((0.0..1.0).contains(&number(0)) && number(4) > 0.0, "{line:?}");
    let done: f64 = words[2].strip_suffix("/1000000000").unwrap().parse().unwrap();
    assert!(done > 0.0, "{line:?}");
    assert!(folder.snapshot() == before, "{:?}", folder.names());
}

#[test]
fn what_is_not_finite_is_told_and_the_image_written() {
    let folder = Folder::new("non_finite");
    // Irradiance I/r² leaves 32-bit floats near the foot of the light.
    folder.write(
        "hot.json",
        r#"{"camera": {"resolution": 4, "vfov": 1}, "image_samples": 1, "sampler": {"seed": 5},
            "lights": [{"type": "point", "position": [0, 0, -0.99], "intensity": 1e37}],
            "surfaces": [{"type": "quad", "transform": {"translate": [0, 0, -1]},
                          "material": {"type": "lambertian", "albedo": 1}}]}"#,
    );
    let outcome = folder.run(&["render", "hot.json", "-q", "--integrator", "path", "--stats", "s.json"]);
    assert_eq!(outcome.status, Some(70), "{outcome:?}");
    let lines: Vec<&str> = outcome.stderr.lines().collect();
    assert_eq!(
        lines[..2],
        [
            "twinlight: 16 non-finite and 0 overflowing contributions were left out; the image was written without them",
            "twinlight:   pixel 0,0 sample 0 technique (1,2) seed 5"
        ]
    );
    let stats = folder.json("s.json");
    assert_eq!(stats["non_finite"]["count"], 16);
    assert_eq!(
        stats["non_finite"]["first"][15],
        serde_json::json!({"pixel": [3, 3], "sample": 0, "technique": [1, 2]})
    );
    assert!(folder.image("hot.exr").rgb.iter().flatten().all(|c| c.is_finite()));
}

/// One sample has no variance, and a zero would look like an image without noise.
#[test]
fn the_variance_of_one_sample_is_said_to_be_none() {
    let folder = Folder::with_room("one_sample");
    let told = |spp: &str| {
        let args = ["render", "room.json", "--spp", spp, "--aovs", "variance", "-o", "v.exr"];
        folder.ok(&args).stderr.contains("note: the variance of one sample per pixel cannot be told")
    };
    assert!(told("1") && !told("2"));
}

//! `render`'s options: each does what it says, and the file says so.

use super::{Folder, difference, exr_header, mean_ratio};

/// Renders with options and demands that the EXR names them.
fn says(folder: &Folder, options: &[&str], expected: &[(&str, &str)]) -> twinlight::film::Image {
    let image = folder.rendered("says.exr", options);
    let attributes = exr_header(&folder.path("says.exr")).0;
    for (key, value) in expected {
        assert_eq!(attributes[&format!("twinlight:{key}")], *value, "{key} with {options:?}");
    }
    image
}

#[test]
fn samples_seed_and_sampler() {
    let folder = Folder::with_room("samples");
    let base = folder.rendered("base.exr", &[]);
    // What the scene says is the default.
    assert!(
        base == says(&folder, &["--spp", "4", "--seed", "11", "--sampler", "sobol"], &[("spp", "4"), ("seed", "11")])
    );
    let huge = "18446744073709551615";
    let others = [
        says(&folder, &["--spp", "5"], &[("spp", "5")]),
        says(&folder, &["--seed", "12"], &[("seed", "12")]),
        says(&folder, &["--seed", huge], &[("seed", huge)]),
        says(&folder, &["--sampler", "independent"], &[("sampler", "independent")]),
    ];
    for (i, other) in others.iter().enumerate() {
        assert!(difference(other, &base) > 0.05, "case {i}: the option changes nothing");
        assert!(others[..i].iter().all(|o| o != other));
    }
    // More samples of either sampler agree.
    let [sobol, independent] =
        ["sobol", "independent"].map(|sampler| folder.rendered("s.exr", &["--spp", "256", "--sampler", sampler]));
    let ratio = mean_ratio(&sobol, &independent);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

#[test]
fn size_and_crop() {
    let folder = Folder::with_room("size");
    let sized = folder.rendered("sized.exr", &["--size", "23x9"]);
    assert_eq!((sized.width, sized.height), (23, 9));
    // A crop is a piece of the full image, bit by bit: its light subpaths are the full image's.
    for integrator in ["path", "light", "bdpt"] {
        let options = ["--size", "23x9", "--spp", "5", "--integrator", integrator];
        let full = folder.rendered("full.exr", &options);
        let crop = folder.rendered("crop.exr", &[&options[..], &["--crop", "7,2,20,9"]].concat());
        assert_eq!((crop.width, crop.height), (13, 7));
        for y in 0..7 {
            for x in 0..13 {
                assert_eq!(crop.get(x, y), full.get(x + 7, y + 2), "{integrator}: {x}, {y}");
            }
        }
    }
    let (_, window, display) = exr_header(&folder.path("crop.exr"));
    assert_eq!((window, display), ([7, 2, 13, 7], [23, 9]));
    let one = folder.rendered("one.exr", &["--crop", "15,11,16,12"]);
    assert_eq!((one.width, one.height), (1, 1));
}

#[test]
fn integrators_agree() {
    let folder = Folder::with_room("integrators");
    // Direct light alone: what light tracing cannot see (the ball, which mirrors) is kept out of the crop.
    let common = ["--spp", "300", "--max-bounces", "2", "--crop", "0,0,9,12"];
    let render = |name: &str| {
        says(&folder, &[&common[..], &["--integrator", name]].concat(), &[("integrator", name), ("max_bounces", "2")])
    };
    let images = ["bdpt", "path", "light", "auto"].map(render);
    // The image has too few pixels to learn from.
    assert!(images[3] == images[0], "auto is bdpt there");
    for other in &images[1..3] {
        let ratio = mean_ratio(other, &images[0]);
        assert!(other != &images[0] && (ratio - 1.0).abs() < 0.03, "{ratio}");
    }
}

#[test]
fn the_first_line_says_what_is_rendered_by_what() {
    let folder = Folder::with_room("first_line");
    folder.write("auto.json", super::ROOM.replace("\"bdpt\"", "\"auto\""));
    folder.write("tame.json", super::ROOM.replace("\"max_bounces\"", "\"russian_roulette\": false, \"max_bounces\""));
    let processors = std::thread::available_parallelism().unwrap();
    let default = format!("{processors} thread{}", if processors.get() == 1 { "" } else { "s" });
    for (args, start) in [
        ("room.json --threads 1", "room.json: 16 × 12 pixels, 4 spp, bdpt, 1 thread, "),
        ("room.json --integrator auto --threads 2", "room.json: 16 × 12 pixels, 4 spp, auto, 2 threads, "),
        ("auto.json --spp 3", &format!("auto.json: 16 × 12 pixels, 3 spp, auto, {default}, ")),
        (
            "auto.json --integrator path --crop 1,2,16,12 --threads 1",
            "auto.json: 16 × 12 pixels, of these 1,2 to 16,12, 4 spp, path, 1 thread, ",
        ),
        // What makes it another than a plain render, from the command line or the scene.
        (
            "room.json --technique 1,2 --threads 1",
            "room.json: 16 × 12 pixels, 4 spp, bdpt, technique 1,2 alone, weighted, 1 thread, ",
        ),
        (
            "room.json --technique 2,2 --unweighted --no-roulette --threads 1",
            "room.json: 16 × 12 pixels, 4 spp, bdpt, technique 2,2 alone, unweighted, no roulette, 1 thread, ",
        ),
        (
            "room.json --max-bounces 0 --light-paths 0 --threads 1",
            "room.json: 16 × 12 pixels, 4 spp, bdpt, emitted light only, no light subpaths, 1 thread, ",
        ),
        (
            "room.json --light-paths 3 --connections 2 --threads 1",
            "room.json: 16 × 12 pixels, 4 spp, bdpt, 3 light subpaths per sample (2 connected), 1 thread, ",
        ),
        (
            "room.json --connections 0 --heuristic balance --threads 1",
            "room.json: 16 × 12 pixels, 4 spp, bdpt, balance heuristic, 1 light subpath per sample (0 connected), 1 thread, ",
        ),
        (
            "tame.json --integrator light --light-paths 2 --threads 1",
            "tame.json: 16 × 12 pixels, 4 spp, light, 2 light subpaths per sample, no roulette, 1 thread, ",
        ),
        // What is the default anyway is not news.
        (
            "room.json --max-bounces 1 --light-paths 1 --connections 1 --heuristic power --roulette-after 2 --threads 1",
            "room.json: 16 × 12 pixels, 4 spp, bdpt, 1 thread, ",
        ),
    ] {
        let outcome = folder.ok(&[vec!["render"], args.split(' ').collect(), vec!["-o", "a.exr"]].concat());
        let accel = exr_header(&folder.path("a.exr")).0["twinlight:accel"].clone();
        let mut lines = outcome.stderr.lines().filter(|l| !l.starts_with("note: "));
        assert_eq!(lines.next(), Some(format!("{start}{accel}").as_str()), "{outcome:?}");
        assert_eq!(lines.filter(|l| l.contains("bdpt")).count(), 0, "{outcome:?}");
    }
}

/// What the user surely expects something of is refused (`arguments.rs`); what is idle for another's reasons is noted.
#[test]
fn options_that_change_nothing_are_noted() {
    let folder = Folder::with_room("idle");
    folder.write("tame.json", super::ROOM.replace("\"max_bounces\"", "\"russian_roulette\": false, \"max_bounces\""));
    let one = "the light integrator has one technique for each path, whose weight is 1";
    let notes: [(&str, &[String]); 8] = [
        (
            "room.json --integrator light --heuristic power",
            // The mirror ball is another matter.
            &[
                format!("--heuristic changes nothing: {one}"),
                "what is seen in mirrors or through smooth glass is missing: light subpaths cannot be joined to the camera there; \
                 use bdpt"
                    .to_owned(),
            ],
        ),
        (
            "room.json --integrator light --technique 2,1 --unweighted",
            &[format!("--unweighted changes nothing: {one}")],
        ),
        ("room.json --integrator bdpt --heuristic power", &[]),
        (
            "tame.json --roulette-after 3",
            &["--roulette-after changes nothing: the scene turns roulette off".to_owned()],
        ),
        ("room.json --roulette-after 3", &[]),
        (
            "room.json --pyramid P --pyramid-edges 7",
            &["--pyramid-edges 7 is more than paths can have: max_bounces 5 ends them at 6".to_owned()],
        ),
        ("room.json --pyramid P --pyramid-edges 6", &[]),
        // Six edges are the default, not what anyone asked for.
        ("room.json --pyramid P --max-bounces 1", &[]),
    ];
    for (args, expected) in notes {
        let args = [vec!["render"], args.split(' ').collect(), vec!["-o", "a.exr"]].concat();
        let said = folder.ok(&args).stderr;
        let found: Vec<&str> = said.lines().filter_map(|l| l.strip_prefix("note: ")).collect();
        assert_eq!(found, expected, "{args:?}: {said}");
        assert_eq!(folder.ok(&[&args[..], &["--quiet"]].concat()).stderr, "");
    }
    // Numbers that go together are accepted, given or not.
    for args in [
        &["--light-paths", "0"][..],
        &["--light-paths", "0", "--connections", "0"],
        &["--connections", "1"],
        &["--light-paths", "2", "--connections", "2"],
        &["--integrator", "light", "--light-paths", "2"],
    ] {
        folder.rendered("a.exr", args);
    }
    // A pyramid holds PNG files as well.
    folder.rendered("a.exr", &["--pyramid", "P", "--exposure", "1"]);
}

#[cfg(feature = "embree")]
#[test]
fn accelerators_agree() {
    let folder = Folder::with_room("accel");
    let images = ["embree", "bvh"].map(|accel| {
        let image = folder.rendered("a.exr", &["--accel", accel, "--spp", "64"]);
        let said = exr_header(&folder.path("a.exr")).0["twinlight:accel"].clone();
        assert!(said.starts_with(&format!("{accel} ")) || said.starts_with(&format!("{accel}:")), "{said}");
        image
    });
    assert!(folder.rendered("a.exr", &["--spp", "64"]) == images[0], "embree is the default");
    // The same samples on the same geometry: what differs is the rounding of hits.
    let ratio = mean_ratio(&images[0], &images[1]);
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn bounces() {
    let folder = Folder::with_room("bounces");
    let fine = ["--size", "64x48", "--max-bounces"];
    let options = [&fine[..], &["0", "--integrator", "path"]].concat();
    let none = says(&folder, &options, &[("max_bounces", "0")]);
    // Emitted light alone: the lamp's radiance, nothing, or, in the few pixels on its outline, something between.
    let lit = none.rgb.iter().filter(|p| **p == [6.0, 5.0, 4.0]).count();
    let dark = none.rgb.iter().filter(|p| **p == [0.0; 3]).count();
    assert!(lit >= 40 && dark >= 2800, "{lit} lit, {dark} dark");
    let mut last = 1.0;
    for n in ["1", "2", "100000"] {
        let ratio = mean_ratio(&folder.rendered("n.exr", &[&fine[..], &[n]].concat()), &none);
        assert!(ratio > last * 1.01, "{n} bounces: {ratio}, fewer: {last}");
        last = ratio;
    }
}

#[test]
fn roulette_leaves_the_mean() {
    let folder = Folder::with_room("roulette");
    let common = ["--spp", "200", "--max-bounces", "12", "--integrator", "path"];
    let with = says(&folder, &common, &[("roulette", "true")]);
    let without =
        says(&folder, &[&common[..], &["--no-roulette", "--stats", "s.json"]].concat(), &[("roulette", "false")]);
    assert_eq!(folder.json("s.json")["roulette"], false);
    let ratio = mean_ratio(&with, &without);
    assert!(with != without && (ratio - 1.0).abs() < 0.02, "{ratio}");
    // Free of it for as long as paths can be is the same as none at all.
    let free = says(&folder, &[&common[..], &["--roulette-after", "12"]].concat(), &[("roulette_after", "12")]);
    assert!(free == without);
    assert!(says(&folder, &[&common[..], &["--roulette-after", "1"]].concat(), &[("roulette_after", "1")]) != with);
}

#[test]
fn heuristics_share_one_mean() {
    let folder = Folder::with_room("heuristics");
    let images = ["power", "balance", "uniform"]
        .map(|name| says(&folder, &["--spp", "300", "--heuristic", name], &[("heuristic", name)]));
    for other in &images[1..] {
        let ratio = mean_ratio(other, &images[0]);
        assert!(other != &images[0] && (ratio - 1.0).abs() < 0.03, "{ratio}");
    }
    assert!(images[1] != images[2]);
}

#[test]
fn light_paths_and_connections() {
    let folder = Folder::with_room("light_paths");
    let work = |options: &[&str]| {
        folder.rendered("w.exr", &[options, &["--stats", "s.json"]].concat());
        let stats = folder.json("s.json");
        let count = |key: &str| stats.pointer(key).unwrap().as_u64().unwrap();
        (count("/paths/light"), count("/rays/lens"), count("/rays/connection"), count("/rays/shadow"))
    };
    let samples = 16 * 12 * 4;
    let none = work(&["--light-paths", "0"]);
    assert_eq!((none.0, none.1, none.2), (0, 0, 0));
    assert!(none.3 > 0);
    let one = work(&[]);
    assert_eq!(one.0, samples);
    let unconnected = work(&["--connections", "0"]);
    assert_eq!((unconnected.0, unconnected.1, unconnected.2), (samples, one.1, 0));
    let three = work(&["--light-paths", "3", "--connections", "2"]);
    assert_eq!(three.0, 3 * samples);
    assert!(three.2 > one.2 * 3 / 2, "{three:?} against {one:?}");
    // Without light subpaths it is a path tracer.
    let attributes = [("light_paths", "0"), ("connections", "0"), ("integrator", "bdpt")];
    let bdpt = says(&folder, &["--light-paths", "0", "--spp", "64"], &attributes);
    let path = folder.rendered("p.exr", &["--integrator", "path", "--spp", "64"]);
    let ratio = mean_ratio(&bdpt, &path);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
    // More of them share one mean.
    let many = says(
        &folder,
        &["--light-paths", "4", "--connections", "3", "--spp", "64"],
        &[("light_paths", "4"), ("connections", "3")],
    );
    let ratio = mean_ratio(&many, &path);
    assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
}

#[test]
fn exposure_brightens_png_alone() {
    let folder = Folder::with_room("exposure");
    let render = |stops: &str| {
        folder.ok(&["render", "room.json", "-q", "-o", "e.exr", "-o", "e.png", "--exposure", stops]);
        (folder.bytes("e.exr"), folder.image("e.png"))
    };
    let (exr, plain) = render("0");
    for (stops, factor) in [("-1.5", (-1.5_f64).exp2()), ("1", 2.0)] {
        let (same, changed) = render(stops);
        assert!(same == exr, "an EXR is linear whatever the exposure");
        let mut compared = 0;
        for (a, b) in plain.rgb.iter().flatten().zip(changed.rgb.iter().flatten()) {
            // Neither clipped nor so dark that a step of 8 bits is all there is.
            if (0.05..0.45).contains(a) {
                let ratio = f64::from(*b) / f64::from(*a) / factor;
                assert!((0.9..1.1).contains(&ratio), "{a} became {b}");
                compared += 1;
            }
        }
        assert!(compared > 50, "{compared}");
    }
}

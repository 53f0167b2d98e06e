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

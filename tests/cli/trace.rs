//! `render --trace`: what is replayed is what was rendered, and nothing is written.

use super::Folder;

/// The numbers after `start` on the one line that starts so: one for grey, else three.
fn color(text: &str, start: &str) -> [f32; 3] {
    let lines: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix(start)).collect();
    let [line] = lines[..] else { panic!("not one line starts with {start:?}: {text}") };
    let numbers: Vec<f32> = line.trim_matches(['(', ')']).split(' ').map(|x| x.parse().expect("a number")).collect();
    match numbers[..] {
        [grey] => [grey; 3],
        [r, g, b] => [r, g, b],
        _ => panic!("{line}"),
    }
}

#[test]
fn a_traced_sample_is_the_one_that_was_rendered() {
    let folder = Folder::with_room("trace");
    let image = folder.rendered("one.exr", &["--spp", "1", "--integrator", "path", "--seed", "3"]);
    let before = folder.snapshot();
    let all = || (0..12).flat_map(|y| (0..16).map(move |x| (x, y)));
    let lit: Vec<_> = all().filter(|&(x, y)| image.get(x, y)[0] > 0.0).collect();
    assert!(lit.len() > 20, "a dark image proves nothing");
    for (x, y) in lit.iter().copied().step_by(lit.len() / 5).chain([(0, 0)]) {
        let pixel = format!("{x},{y}");
        // Added to the very command that rendered the image.
        let outcome = folder.ok(&[
            "render",
            "room.json",
            "--quiet",
            "-o",
            "one.exr",
            "--spp",
            "1",
            "--integrator",
            "path",
            "--seed",
            "3",
            "--trace",
            "--pixel",
            &pixel,
            "--sample",
            "0",
        ]);
        assert_eq!(outcome.stderr, "");
        // Nine digits make an f32 again; the film rounds to its quantum.
        let told = color(&outcome.stdout, &format!("to pixel {pixel}: "));
        for (a, b) in told.iter().zip(image.get(x, y)) {
            assert!((a - b).abs() <= 1e-6 * b.abs(), "{pixel}: {told:?} and {:?}", image.get(x, y));
        }
        let parts = ["room.json: pixel", "camera subpath", "z1 camera at", "/surfaces/", "throughput"];
        for word in ["Vec3A", "{", "uv (0"] {
            assert!(!outcome.stdout.contains(word), "{word:?}: {}", outcome.stdout);
        }
        // Not every ray meets a surface.
        for part in &parts[..if told[0] > 0.0 { 5 } else { 3 }] {
            assert!(outcome.stdout.contains(part), "{part:?} is missing: {}", outcome.stdout);
        }
    }
    assert!(folder.snapshot() == before, "something was written");
}

#[test]
fn a_bidirectional_sample_tells_both_subpaths_and_every_weight() {
    let folder = Folder::with_room("trace-bdpt");
    let args = ["render", "room.json", "-q", "--integrator", "bdpt", "--trace", "--pixel", "3,9"];
    let text = folder.ok(&args).stdout;
    for part in
        ["sample 0", "light subpath 1", "y1 light 0", "camera subpath", "sums of the weights", "× weight", "forth"]
    {
        assert!(text.contains(part), "{part:?} is missing: {text}");
    }
    // Another sample is another path, the same one the same.
    assert_eq!(text, folder.ok(&args).stdout);
    assert_ne!(text, folder.ok(&[&args[..], &["--sample", "1"]].concat()).stdout);
}

#[test]
fn a_sample_that_is_not_there_is_refused() {
    let folder = Folder::with_room("trace-wrong");
    for (options, message) in [
        (
            &["--trace", "--pixel", "16,0"][..],
            "twinlight: --pixel 16,0 is outside the image: it is 16 × 12 pixels, counted from 0,0 at the top left\n",
        ),
        (
            &["--trace", "--pixel", "0,0", "--sample", "4"],
            "twinlight: --sample 4: the render takes 4 per pixel, counted from 0; give a smaller number or --spp 5\n",
        ),
    ] {
        let outcome = folder.run(&[&["render", "room.json"], options].concat());
        assert_eq!((outcome.status, outcome.stderr.as_str()), (Some(2), message));
        assert_eq!(outcome.stdout, "");
    }
    for (options, message) in [
        (&["--trace"][..], "required arguments were not provided:\n  --pixel <x,y>"),
        (&["--pixel", "1,1"], "required arguments were not provided:\n  --trace"),
        (&["--trace", "--pixel", "1"], "write it as x,y in pixels, for example 12,40"),
        (&["--trace", "--pixel", "-1,2"], "write it as x,y in pixels, for example 12,40"),
        (&["--sample", "1"], "required arguments were not provided:\n  --pixel <x,y>\n  --trace"),
    ] {
        let outcome = folder.run(&[&["render", "room.json"], options].concat());
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stderr.contains(message), "{outcome:?}");
    }
    assert_eq!(folder.names(), ["room.json"]);
}

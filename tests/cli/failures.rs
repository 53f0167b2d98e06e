//! Every mistake of the tables, and what else can go wrong: the status, the whole message, and no file touched.

use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::process::Stdio;

use super::arguments::{ARGUMENTS, COMMANDS};
use super::assets::MESH_FILES;
use super::assets_images::IMAGES;
use super::mistakes::SCENES;
use super::{Folder, ROOM};
use twinlight::film::Image;
use twinlight::output::{Metadata, write_image, write_png};

const GOOD: &str = r#"{"camera": {"resolution": 8}, "image_samples": 1,
    "lights": [{"type": "point", "position": [0, 0, -1], "intensity": 1}]}"#;

/// A folder in which each kind of output would find something to overwrite.
fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    for old in ["old.exr", "old.png", "old.json", "scene.exr"] {
        folder.write(old, "what was there before");
    }
    folder.write("binary", [0, 1, 2, 0xff]);
    folder.write("utf16.json", b"\xff\xfe{\0}\0");
    folder.write("latin1.json", b"{\"\xe9\": 1}");
    std::fs::create_dir(folder.path("folder.exr")).unwrap();
    write_png(&folder.path("image.png"), &Image::new(2, 2), 0.0).unwrap();
    folder
}

#[test]
fn a_mistake_in_a_scene_is_told_and_touches_no_file() {
    let folder = folder("mistakes");
    let scenes = SCENES.iter().flat_map(|(_, mistakes)| mistakes.iter());
    let scenes = scenes.map(|mistake| (mistake.what, None, mistake.unmarked()));
    let assets = MESH_FILES.iter().chain(IMAGES);
    let assets = assets.map(|asset| (asset.what, Some((asset.name, asset.bytes())), asset.scene()));
    let mut wrong = Vec::new();
    for (what, asset, (text, said)) in scenes.chain(assets) {
        if let Some((name, bytes)) = asset {
            folder.write(name, bytes);
        }
        folder.write("scene.json", text);
        let before = folder.snapshot();
        for outputs in [
            &["render", "scene.json"][..],
            &["render", "scene.json", "-q", "-o", "old.exr", "-o", "new.exr", "-o", "old.png", "--stats", "old.json"],
            &["render", "scene.json", "--stats", "new.json", "--pyramid", "new", "--accel", "bvh"],
        ] {
            let outcome = folder.run(outputs);
            assert_eq!(outcome.status, Some(65), "{what}: {outcome:?}");
            if outcome.stderr != said {
                wrong.push(format!("{what}: said\n{}instead of\n{said}", outcome.stderr));
                break;
            }
            assert_eq!(outcome.stdout, "");
            assert!(folder.snapshot() == before, "{what}: {:?}", folder.names());
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_mistake_in_the_arguments_is_told_and_touches_no_file() {
    let folder = folder("arguments");
    folder.write("scene.json", GOOD);
    folder.write("large.obj", "#".repeat(2 << 20));
    folder.write(
        "large.json",
        r#"{"camera": {}, "surfaces": [{"type": "mesh", "filename": "large.obj", "material": {"type": "mirror"}}]}"#,
    );
    for (name, width) in [("a.exr", 2), ("a.png", 2), ("b.exr", 3)] {
        write_image(&folder.path(name), &Image::new(width, 2), &Metadata::default(), 0.0).unwrap();
    }
    let before = folder.snapshot();
    let render = ARGUMENTS.iter().map(|mistake| (Some("render"), mistake));
    for (command, mistake) in render.chain(COMMANDS.iter().map(|mistake| (None, mistake))) {
        let args: Vec<&str> = command.into_iter().chain(mistake.arguments.split(' ')).collect();
        let outcome = folder.run(&args);
        assert_eq!(outcome.status, Some(mistake.status), "{outcome:?}");
        // What follows a blank line is the usage and where help is.
        let said = outcome.stderr.trim_end().split("\n\n").next();
        assert_eq!(said, Some(mistake.message), "{outcome:?}");
        assert_eq!(outcome.stdout, "");
        assert!(folder.snapshot() == before, "{}: {:?}", mistake.what, folder.names());
    }
    // The scene itself is fine, or all of this would prove little.
    folder.ok(&["render", "scene.json"]);
    assert_eq!(folder.image("scene.exr").width, 8);
}

#[test]
fn meshes_are_named_by_file_and_by_place() {
    let folder = folder("meshes");
    std::fs::create_dir(folder.path("meshes")).unwrap();
    folder.write("meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    folder.write(
        "scene.json",
        r#"{"camera": {}, "surfaces": [
             {"type": "mesh", "filename": "meshes/a.obj", "material": {"type": "mirror"}}]}"#,
    );
    let before = folder.snapshot();
    let outcome = folder.run(&["render", "scene.json", "-o", "old.exr"]);
    assert_eq!(outcome.status, Some(65));
    assert_eq!(
        outcome.stderr,
        "twinlight: meshes/a.obj:4:7: vertex index 4 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before \
         this line) (named by scene.json:2:43: /surfaces/0/filename)\n"
    );
    assert!(folder.snapshot() == before);
    folder.write("meshes/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.ok(&["render", "scene.json", "--spp", "1", "--size", "2x2"]);
}

#[test]
fn no_command_at_all_is_a_usage_error_and_help_is_not() {
    let folder = folder("usage");
    for args in [&[][..], &["rendr", "scene.json"], &["--spp", "1"], &["render", "a.json", "b.json"]] {
        let outcome = folder.run(args);
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(outcome.stderr.contains("Usage: twinlight") && outcome.stdout.is_empty(), "{outcome:?}");
    }
    for args in [&["--help"][..], &["render", "--help"], &["help", "compare"], &["convert", "-h"]] {
        let outcome = folder.ok(args);
        assert!(outcome.stdout.contains("Usage: twinlight") && outcome.stderr.is_empty(), "{outcome:?}");
    }
    assert_eq!(folder.ok(&["--version"]).stdout, format!("twinlight {}\n", env!("CARGO_PKG_VERSION")));
    // Every status of the program is on its help page.
    let help = folder.ok(&["--help"]).stdout;
    for status in ["0 done", "2 usage", "65 bad scene or asset", "70 non-finite contributions", "1 anything else"] {
        assert!(help.contains(status), "{help}");
    }
}

/// The writing end of a pipe that nobody reads any more.
fn closed() -> Stdio {
    let (ours, theirs) = UnixStream::pair().unwrap();
    drop(theirs);
    Stdio::from(OwnedFd::from(ours))
}

#[test]
fn a_reader_that_has_gone_away_is_no_error() {
    let folder = Folder::with_room("closed_pipe");
    folder.ok(&["render", "room.json", "-q"]);
    for args in [
        &["info", "room.json"][..],
        &["info", "room.json", "--json"],
        &["compare", "room.exr", "room.exr"],
        &["compare", "room.exr", "room.exr", "--json", "--difference", "d.png"],
    ] {
        let output = folder.command(args).stdout(closed()).stderr(Stdio::piped()).output().unwrap();
        assert_eq!((output.status.code(), output.stderr.as_slice()), (Some(0), &b""[..]), "{args:?}: {output:?}");
    }
    assert!(folder.path("d.png").exists());
    let help = folder.command(&["--help"]).stdout(closed()).stderr(Stdio::piped()).output().unwrap();
    assert!(!String::from_utf8_lossy(&help.stderr).contains("panicked"), "{help:?}");
    // Messages lost do not lose the image, nor change what a failure says by its status.
    let lost = |args: &[&str]| folder.command(args).stdout(closed()).stderr(closed()).status().unwrap().code();
    assert_eq!(lost(&["render", "room.json", "--integrator", "bdpt", "-o", "a.exr", "-o", "a.png"]), Some(0));
    assert_eq!(folder.bytes("a.exr"), folder.bytes("room.exr"));
    assert!(folder.path("a.png").exists());
    assert_eq!(lost(&["render", "none.json"]), Some(1));
    assert_eq!(lost(&["render", "room.json", "--crop", "0,0,99,99"]), Some(2));
    assert_eq!(lost(&["info", "a.exr"]), Some(65));
}

#[test]
fn an_image_is_no_scene_whatever_its_name() {
    let folder = Folder::with_room("image_as_scene");
    folder.ok(&["render", "room.json", "-q"]);
    folder.write("room.json", folder.bytes("room.exr"));
    let before = folder.snapshot();
    // Its own default output would be the image itself: that is not what is wrong.
    for name in ["room.exr", "room.json"] {
        for command in ["render", "info"] {
            let outcome = folder.run(&[command, name]);
            let said = format!(
                "twinlight: {name}: this is an image (EXR), not a scene; did you mean `twinlight compare` or `twinlight \
                 convert`?\n"
            );
            assert_eq!((outcome.status, outcome.stderr), (Some(65), said));
            assert!(folder.snapshot() == before);
        }
    }
    // Of many scenes in a folder a few are named, in order.
    std::fs::create_dir(folder.path("many")).unwrap();
    (0..8).for_each(|i| folder.write(&format!("many/{}.JSON", 7 - i), ROOM));
    folder.write("many/a.txt", "");
    let outcome = folder.run(&["info", "many"]);
    assert_eq!(outcome.status, Some(1));
    assert!(outcome.stderr.ends_with("(found: 0.JSON, 1.JSON, 2.JSON, 3.JSON, 4.JSON and 3 more)\n"), "{outcome:?}");
}

/// Runs the program where no file may grow beyond 512 bytes, as on a full disk.
fn on_a_full_disk(folder: &Folder, args: &str) -> std::process::Output {
    // Ignoring the signal makes writing beyond the limit an error, not the program's end.
    let script = format!("trap '' XFSZ; ulimit -f 1; exec \"$0\" {args}");
    let mut command = std::process::Command::new("sh");
    command.current_dir(folder.path("")).args(["-c", &script, env!("CARGO_BIN_EXE_twinlight")]);
    command.stdin(Stdio::null()).output().unwrap()
}

#[test]
fn whatever_cannot_be_written_whole_is_not_written_at_all() {
    let folder = Folder::with_room("full_disk");
    for old in ["old.exr", "old.json", "old.png", "P/s0_t2.exr", "P/pyramid.png"] {
        std::fs::create_dir_all(folder.path("P")).unwrap();
        folder.write(old, "what was there before");
    }
    folder.ok(&["render", "room.json", "-q", "--size", "64x64", "-o", "large.exr"]);
    folder.ok(&["render", "room.json", "-q", "--size", "64x64", "--seed", "1", "-o", "other.exr"]);
    for (args, what) in [
        ("render room.json -q -o old.exr", "old.exr"),
        ("render room.json -q --size 64x64 -o old.png", "old.png"),
        ("render room.json -q --size 1x1 -o new.png --stats old.json", "old.json"),
        ("render room.json -q --size 1x1 -o new.png --stats new.json", "new.json"),
        ("render room.json -q --size 1x1 -o new.png --pyramid P", "P/s"),
        ("render room.json -q --size 1x1 -o new.png --pyramid new", "new/s"),
        ("compare large.exr other.exr --difference old.png", "old.png"),
        ("convert large.exr old.png", "old.png"),
    ] {
        let before = folder.snapshot();
        let output = on_a_full_disk(&folder, args);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{args}: {said}");
        assert!(said.starts_with(&format!("twinlight: cannot write `{what}")), "{args}: {said}");
        assert!(said.contains("`: writing the temporary file failed (") && said.ends_with("free space\n"), "{said}");
        // What came before it is whole: the picture, and the pyramid's folder, which is empty.
        let mut after = folder.snapshot();
        let new = [folder.path("new.png"), folder.path("new")];
        after.retain(|path, _| before.contains_key(path) || !new.contains(path));
        assert!(after == before, "{args}: {:?}", after.keys());
        if folder.path("new.png").exists() {
            folder.image("new.png");
            std::fs::remove_file(folder.path("new.png")).unwrap();
        }
    }
}

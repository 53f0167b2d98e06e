//! Bad input: each mistake gives the message that names its place, the offending value and what is allowed.
//!
//! In the tables `«` marks the place that the message must point to (it is taken out before reading), so that line
//! and column are checked without counting. Good input that is easily taken for bad is tested, too.

use std::fs;
use std::path::{Path, PathBuf};

use twinlight::import::scene_from_str;
use twinlight::scene::desc::{MeshDesc, SceneDesc, ShapeDesc};

#[path = "input/environments.rs"]
mod environments;
#[path = "input/good.rs"]
mod good;
#[path = "input/json.rs"]
mod json;
#[path = "input/meshes.rs"]
mod meshes;
#[path = "input/planes.rs"]
mod planes;
#[path = "input/settings.rs"]
mod settings;
#[path = "input/surfaces.rs"]
mod surfaces;
#[path = "input/textures.rs"]
mod textures;

fn read(text: &str) -> Result<SceneDesc, String> {
    scene_from_str(text, "s.json", Path::new("")).map_err(|e| e.to_string())
}

/// The text without its marks, and their lines and columns.
fn unmark(marked: &str) -> (String, Vec<(usize, usize)>) {
    let (mut text, mut places, mut here) = (String::new(), Vec::new(), (1, 1));
    for c in marked.chars() {
        match c {
            '«' => places.push(here),
            '\n' => here = (here.0 + 1, 1),
            _ => here.1 += 1,
        }
        if c != '«' {
            text.push(c);
        }
    }
    (text, places)
}

/// Reads a marked scene and demands exactly these errors, `pointer: message`, in the order of the marks.
fn expect_errors(marked: &str, expected: &[&str]) {
    let (text, places) = unmark(marked);
    assert_eq!(places.len(), expected.len(), "marks and messages differ in number: {marked}");
    let wanted: Vec<String> =
        places.iter().zip(expected).map(|((line, column), e)| format!("s.json:{line}:{column}: {e}")).collect();
    match read(&text) {
        Ok(_) => panic!("read without error: {marked}"),
        Err(found) => assert_eq!(found, wanted.join("\n"), "\nin {marked}"),
    }
}

/// A scene that is right but for one value, which is put in place of `@`.
fn each(scene: &str, cases: &[(&str, &str)]) {
    for (value, message) in cases {
        expect_errors(&scene.replace('@', value), &[message]);
    }
}

fn mesh_of(shape: &ShapeDesc) -> &MeshDesc {
    match shape {
        ShapeDesc::Mesh(mesh) => mesh,
        other => panic!("not a mesh: {other:?}"),
    }
}

fn temporary(name: &str, bytes: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("input");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path
}

/// A folder of scenes that is not part of the project; tests that need it say so when it is absent.
fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes").join(folder);
    if !path.is_dir() {
        println!("skipped: {} is absent", path.display());
        return None;
    }
    Some(path)
}

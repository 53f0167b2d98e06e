//! Files: scenes, meshes, images.

use std::io::Cursor;
use std::path::Path;

use twinlight::accel::AccelOptions;
use twinlight::accel::bvh::BvhAccel;
use twinlight::decode::{ColorSpace, read_from};
use twinlight::import::{MeshFormat, mesh_from_bytes, scene_from_bytes};
use twinlight::scene::desc::{Diagnostic, MeshDesc, SceneDesc, ShapeDesc};
use twinlight::scene::{Scene, prepare};

/// What messages call the file.
const FILE: &str = "fuzzed";

/// Triangles up to which an accelerator is built.
const SMALL: usize = 2000;

/// A message can be printed: it says something, and no control character of the file gets to a terminal.
fn check_text(text: &str) {
    assert!(!text.is_empty(), "an empty message");
    assert!(!text.chars().any(char::is_control), "a control character in {text:?}");
}

/// A diagnostic can be printed, and its place is one of the file's.
fn check_diagnostic(diagnostic: &Diagnostic, bytes: &[u8]) {
    let (at, message) = (&diagnostic.at, &diagnostic.message);
    assert!(!message.is_empty(), "an empty message");
    check_text(&diagnostic.to_string());
    if at.file == FILE && at.line > 0 {
        let line = bytes.split(|b| *b == b'\n').nth(at.line - 1);
        let line = line.unwrap_or_else(|| panic!("line {} of {message:?} is not there", at.line));
        assert!((1..=line.len() + 1).contains(&at.column), "{}:{} of {message:?}", at.line, at.column);
    }
}

/// A scene file: read, prepared, and built if it is small.
pub fn scene_json(bytes: &[u8]) {
    // Whatever the scene names relative to it is not there.
    let scene = match scene_from_bytes(bytes, FILE, Path::new("no such folder")) {
        Ok(scene) => scene,
        Err(error) => {
            assert!(!error.diagnostics.is_empty(), "an error without a word");
            return error.diagnostics.iter().for_each(|d| check_diagnostic(d, bytes));
        }
    };
    scene.notes.iter().for_each(|note| check_text(note));
    match prepare(&scene) {
        Ok(prepared) => {
            prepared.warnings.iter().for_each(|warning| check_text(&warning.to_string()));
            if triangles(&scene) <= SMALL {
                Scene::<BvhAccel>::build(prepared, AccelOptions::default()).expect("small scenes can be built");
            }
        }
        Err(error) => {
            assert!(!error.diagnostics.is_empty(), "an error without a word");
            error.diagnostics.iter().for_each(|d| check_diagnostic(d, bytes));
        }
    }
}

fn triangles(scene: &SceneDesc) -> usize {
    let of = |shape: &ShapeDesc| if let ShapeDesc::Mesh(mesh) = shape { mesh.triangles.len() } else { 2 };
    scene.surfaces.iter().map(|s| of(&s.shape)).sum()
}

/// An OBJ file.
pub fn obj(bytes: &[u8]) {
    mesh(bytes, MeshFormat::Obj);
}

/// A PLY file, text or binary.
pub fn ply(bytes: &[u8]) {
    mesh(bytes, MeshFormat::Ply);
}

fn mesh(bytes: &[u8], format: MeshFormat) {
    match mesh_from_bytes(bytes, format, FILE) {
        Ok(mesh) => check_mesh(&mesh),
        Err(diagnostic) => check_diagnostic(&diagnostic, bytes),
    }
}

fn check_mesh(mesh: &MeshDesc) {
    let MeshDesc { positions, normals, uvs, triangles } = mesh;
    let count = positions.len();
    assert!(!triangles.is_empty(), "a mesh of nothing");
    assert!(triangles.iter().flatten().all(|&i| (i as usize) < count), "an index out of range");
    assert!(normals.is_empty() || normals.len() == count, "{} normals for {count} vertices", normals.len());
    assert!(uvs.is_empty() || uvs.len() == count, "{} texture coordinates for {count} vertices", uvs.len());
    let vectors = positions.iter().chain(normals).flatten();
    assert!(vectors.chain(uvs.iter().flatten()).all(|x| x.is_finite()), "a number that is not finite");
}

/// An image in any of the formats.
pub fn image(bytes: &[u8]) {
    let space = if bytes.len() % 2 == 0 { ColorSpace::OfFile } else { ColorSpace::Srgb };
    match read_from(Cursor::new(bytes), bytes.len() as u64, space) {
        Ok(image) => {
            assert_eq!(image.rgb.len(), image.width as usize * image.height as usize, "pixels missing");
            assert!(!image.rgb.is_empty(), "an image of nothing");
            if let Some(window) = image.about.window {
                let inside =
                    |i: usize, size: u32| u64::from(window.origin[i]) + u64::from(size) <= u64::from(window.full[i]);
                assert!(inside(0, image.width) && inside(1, image.height), "a crop outside its image: {window:?}");
            }
        }
        Err(error) => {
            assert!(error.bad_content, "memory cannot be out of reach: {}", error.why);
            check_text(&error.why);
        }
    }
}

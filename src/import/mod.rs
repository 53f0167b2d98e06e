//! Files to scene descriptions: one module per format.
//!
//! Importers turn text into a [`SceneDesc`] whose every value is checked against the scene format's rules. They build
//! no geometry and choose no defaults that the format does not name; what only the whole scene can show (a light of
//! zero area, say) is left to preparation, which finds each value's [`Place`] in the description.

mod camera;
mod context;
mod fingerprint;
mod inline_mesh;
mod json;
mod lights;
mod materials;
mod mesh_file;
mod models;
mod obj;
mod ply;
mod ply_header;
mod scan;
mod scene_json;
mod settings;
mod surfaces;
mod synonyms;
mod textures;
mod transform;
mod value;

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::{fmt, fs, io};

use crate::scene::desc::{Place, SceneDesc, SceneError};

pub use mesh_file::{MAX_INFLATED_BYTES, MeshFileError, MeshFormat, load_mesh, mesh_from_bytes};

/// Why a scene could not be loaded.
#[derive(Debug)]
pub enum ImportError {
    /// The scene file itself could not be read.
    Io {
        /// The file as the user named it.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The scene file, or an asset that it names, is not a valid scene.
    Scene(SceneError),
}

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, source } => {
                write!(f, "{}: cannot read the scene file: {source}", path.display())?;
                // What the system says needs a hint; what we say of folders holds one.
                if source.raw_os_error().is_some() { f.write_str(CHECK_NAME) } else { Ok(()) }
            }
            Self::Scene(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ImportError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            Self::Scene(error) => Some(error),
        }
    }
}

impl From<SceneError> for ImportError {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

/// Loads a scene file in the native JSON format together with the meshes and images that it names.
///
/// # Errors
/// [`ImportError::Io`] when the scene file cannot be read; [`ImportError::Scene`] with everything that is wrong with
/// its content or its assets.
pub fn load_scene(path: &Path) -> Result<SceneDesc, ImportError> {
    load_scene_within(path, u64::MAX)
}

/// `load_scene` with a limit in bytes to the memory that meshes may take: a file that alone, or with those before it, takes
/// more is an error before it is read. What compressed ones inflate to is known only then, and ends at the limit.
///
/// # Errors
/// As there.
pub fn load_scene_within(path: &Path, memory: u64) -> Result<SceneDesc, ImportError> {
    let bytes = read(path).map_err(|source| ImportError::Io { path: path.to_owned(), source })?;
    let base = path.parent().unwrap_or(Path::new(""));
    Ok(scene_within(&bytes, &path.display().to_string(), base, memory)?)
}

/// Largest scene file in bytes. It may come through a pipe, or be a device that never ends.
pub const MAX_SCENE_BYTES: u64 = 1 << 30;

/// Reads a scene file; of a folder the error names the scenes inside.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    if path.is_dir() {
        return Err(folder(path)?);
    }
    read_at_most(File::open(path)?, MAX_SCENE_BYTES)
}

fn read_at_most(file: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        let message = format!("it has more than {limit} bytes, the most that is allowed; put large meshes into files");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

/// That a folder is no scene, with the scenes inside.
fn folder(path: &Path) -> io::Result<io::Error> {
    let mut names: Vec<String> = fs::read_dir(path)?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case("json")))
        .collect();
    names.sort();
    let found = match names.len() {
        0 => "no .json file is there".to_owned(),
        1..=MAX_NAMES => format!("found: {}", names.join(", ")),
        n => format!("found: {} and {} more", names[..MAX_NAMES].join(", "), n - MAX_NAMES),
    };
    let message = format!("this is a folder; give the scene file inside ({found})");
    Ok(io::Error::new(io::ErrorKind::IsADirectory, message))
}

/// What to do about a file that the system would not open.
const CHECK_NAME: &str = "; check the name and the permissions";

/// Scenes listed in a message.
const MAX_NAMES: usize = 5;

/// Reads a scene from the bytes of a file; see [`scene_from_str`].
///
/// # Errors
/// As there; and where the bytes are not text.
pub fn scene_from_bytes(bytes: &[u8], file_name: &str, base_dir: &Path) -> Result<SceneDesc, SceneError> {
    scene_within(bytes, file_name, base_dir, u64::MAX)
}

fn scene_within(bytes: &[u8], file_name: &str, base_dir: &Path, memory: u64) -> Result<SceneDesc, SceneError> {
    let text = json::decode_utf8(bytes, file_name).map_err(|d| SceneError { diagnostics: vec![d] })?;
    scene_json::read(text, file_name, base_dir, memory)
}

/// Reads a scene from JSON text; `file_name` is what messages call it and `base_dir` is where the files it names lie.
///
/// # Errors
/// Everything that is wrong with the text or with its assets, in file order.
pub fn scene_from_str(text: &str, file_name: &str, base_dir: &Path) -> Result<SceneDesc, SceneError> {
    scene_json::read(text, file_name, base_dir, u64::MAX)
}

/// A place in `file` that is not in JSON.
fn place_in_file(file: &str, line: usize, column: usize) -> Place {
    Place { file: file.to_owned(), line, column, pointer: String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_file_has_an_end() {
        assert_eq!(read_at_most(&b"abc"[..], 3).unwrap(), b"abc");
        let error = read_at_most(io::repeat(7), 3).unwrap_err();
        assert!(error.to_string().starts_with("it has more than 3 bytes"), "{error}");
    }
}

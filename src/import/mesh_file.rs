//! Mesh files: which format, compressed or not, and where an error in one is.

use std::io::{self, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::scan::{MeshError, Spot};
use super::{obj, place_in_file, ply};
use crate::decode::{OpenError, open_regular};
use crate::math::DVec3;
use crate::scene::desc::{Diagnostic, MeshDesc};

/// Largest size in bytes that a compressed mesh may inflate to: a small file can be made to fill any memory.
pub const MAX_INFLATED_BYTES: u64 = 4 << 30;

/// Why a mesh file could not be loaded.
#[derive(Debug)]
pub enum MeshFileError {
    /// It could not be read or inflated: why.
    Unreadable(String),
    /// Its name ends like no known format's.
    UnknownFormat,
    /// Its content is wrong: where and how.
    Invalid(Diagnostic),
}

/// The formats of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// PLY, as text or binary.
    Ply,
}

/// Loads a mesh from an OBJ or PLY file; either may be compressed by gzip.
///
/// # Errors
/// When the file is no regular one, cannot be read, is of no known format (told by its name's ending), or is not a valid
/// mesh.
pub fn load_mesh(path: &Path) -> Result<MeshDesc, MeshFileError> {
    load_mesh_within(path, MAX_INFLATED_BYTES)
}

/// `load_mesh` with a limit in bytes, beside [`MAX_INFLATED_BYTES`], to what a compressed file may inflate to.
///
/// # Errors
/// As there, and when it is more.
pub fn load_mesh_within(path: &Path, memory: u64) -> Result<MeshDesc, MeshFileError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let (stem, compressed) = name.strip_suffix(".gz").map_or((name.as_str(), false), |stem| (stem, true));
    let format = match stem.rsplit_once('.').map(|(_, extension)| extension) {
        Some("obj") => MeshFormat::Obj,
        Some("ply") => MeshFormat::Ply,
        _ => return Err(MeshFileError::UnknownFormat),
    };
    let unreadable = |error: io::Error| MeshFileError::Unreadable(error.to_string());
    let (mut file, _) = open_regular(path).map_err(|error| match error {
        OpenError::System(error) => unreadable(error),
        OpenError::Folder => MeshFileError::Unreadable("it is a folder; give a mesh file inside it".to_owned()),
        OpenError::Special => MeshFileError::Unreadable("it is a pipe or a device; give a regular file".to_owned()),
    })?;
    let mut bytes = Vec::new();
    if compressed {
        inflate(file, memory.min(MAX_INFLATED_BYTES), &mut bytes).map_err(unreadable)?;
    } else {
        file.read_to_end(&mut bytes).map_err(unreadable)?;
    }
    mesh_from_bytes(&bytes, format, &path.display().to_string()).map_err(MeshFileError::Invalid)
}

/// Reads a mesh from the content of a file; `file` is what messages call it.
///
/// # Errors
/// The first thing that is wrong with it, and where.
pub fn mesh_from_bytes(bytes: &[u8], format: MeshFormat, file: &str) -> Result<MeshDesc, Diagnostic> {
    let mesh = match format {
        MeshFormat::Obj => obj::parse(bytes),
        MeshFormat::Ply => ply::parse(bytes),
    };
    mesh.and_then(|mesh| if has_area(&mesh) { Ok(mesh) } else { Err(no_area(&mesh)) }).map_err(|error| {
        let MeshError { at, message } = *error;
        match at {
            Spot::File => Diagnostic { at: place_in_file(file, 0, 0), message },
            Spot::Line(line, column) => Diagnostic { at: place_in_file(file, line, column), message },
            Spot::Byte(byte) => {
                Diagnostic { at: place_in_file(file, 0, 0), message: format!("at byte {byte}: {message}") }
            }
        }
    })
}

/// Whether some triangle has an area.
fn has_area(mesh: &MeshDesc) -> bool {
    mesh.triangles.iter().any(|triangle| {
        let [a, b, c] = triangle.map(|i| DVec3::from(mesh.positions[i as usize].map(f64::from)));
        (b - a).cross(c - a) != DVec3::ZERO
    })
}

fn no_area(mesh: &MeshDesc) -> Box<MeshError> {
    MeshError::file(match mesh.triangles.len() {
        1 => "the mesh's only triangle has no area: its corners are on one line".to_owned(),
        n => format!("none of the mesh's {n} triangles has an area: the corners of each are on one line"),
    })
}

/// Inflates gzip data (of several members, too) of at most `limit` bytes.
fn inflate(compressed: impl Read, limit: u64, bytes: &mut Vec<u8>) -> io::Result<()> {
    MultiGzDecoder::new(compressed).take(limit.saturating_add(1)).read_to_end(bytes)?;
    if bytes.len() as u64 > limit {
        return Err(io::Error::other(format!("it inflates to more than {limit} bytes, the most that is allowed")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn gzip(data: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(data).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn inflation_stops_at_the_limit() {
        let data = gzip(&[7; 1000]);
        let mut out = Vec::new();
        inflate(data.as_slice(), 1000, &mut out).unwrap();
        assert_eq!(out, [7; 1000]);
        let mut out = Vec::new();
        let error = inflate(data.as_slice(), 999, &mut out).unwrap_err().to_string();
        assert_eq!(error, "it inflates to more than 999 bytes, the most that is allowed");
    }

    #[test]
    fn a_compressed_mesh_ends_at_the_limit_given() {
        let path = std::env::temp_dir().join(format!("twinlight-limit-{}.obj.gz", std::process::id()));
        std::fs::write(&path, gzip(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).unwrap();
        let [enough, little] = [32, 31].map(|most| load_mesh_within(&path, most));
        std::fs::remove_file(&path).unwrap();
        assert_eq!(enough.unwrap().triangles.len(), 1);
        assert!(matches!(little, Err(MeshFileError::Unreadable(why)) if why.contains("more than 31 bytes")));
    }

    #[test]
    fn members_are_joined_and_truncation_is_seen() {
        let mut data = gzip(b"abc");
        data.extend(gzip(b"def"));
        let mut out = Vec::new();
        inflate(data.as_slice(), 100, &mut out).unwrap();
        assert_eq!(out, b"abcdef");
        assert!(inflate(&data[..data.len() - 4], 100, &mut Vec::new()).is_err());
    }
}

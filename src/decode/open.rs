//! Opens the files that a scene or a command names, regular ones only.

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// Why a file was not opened.
#[derive(Debug)]
pub enum OpenError {
    /// The system's word.
    System(io::Error),
    /// It is a folder.
    Folder,
    /// It is a pipe, a device or the like, which may never end or never answer.
    Special,
}

/// Opens a regular file and tells its length in bytes. Anything else is refused before it is opened: opening a pipe waits
/// until somebody writes to it.
///
/// # Errors
/// What the system says, or what it is instead of a regular file.
pub fn open_regular(path: &Path) -> Result<(File, u64), OpenError> {
    let kind = fs::metadata(path).map_err(OpenError::System)?;
    if kind.is_dir() {
        return Err(OpenError::Folder);
    }
    if !kind.is_file() {
        return Err(OpenError::Special);
    }
    let file = File::open(path).map_err(OpenError::System)?;
    let length = file.metadata().map_err(OpenError::System)?.len();
    Ok((file, length))
}

//! Image files: written whole or not at all, read with their sizes checked first.

mod atomic;
mod exr;
mod png;
mod read;

use std::fmt;
use std::fs::{self, OpenOptions};
use std::path::{Path, PathBuf};

pub use atomic::write_atomically;
pub use exr::{write_exr, write_exr_layers};
pub use png::{encode_png, write_png};
pub use read::{format_of_content, read_image, read_image_and_metadata, read_layer_and_metadata};

pub use crate::decode::{MAX_PIXELS, Window, layers, srgb_decode, srgb_encode};
use crate::film::{Channel, Image};

/// Longest name of a metadata attribute in bytes: beyond it EXR needs a flag that old readers refuse.
const LONGEST_NAME: usize = 31;

/// Why an image file could not be written or read: what, which file, why, what to do.
#[derive(Debug, Clone)]
pub struct OutputError {
    /// The whole message.
    pub message: String,
    /// Whether the file was read, but its content is no image that can be used.
    pub bad_content: bool,
}

impl OutputError {
    fn new(doing: &str, path: &Path, why: impl fmt::Display) -> Self {
        Self { message: format!("cannot {doing} `{}`: {why}", path.display()), bad_content: false }
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for OutputError {}

/// What an EXR says about its image besides the pixels. Nothing that varies from run to run belongs here.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// String attributes, UTF-8. Their order is of no importance: the file holds them sorted by name.
    pub attributes: Vec<(String, String)>,
    /// Width of a pixel over its height.
    pub pixel_aspect: f32,
    /// The crop's place; `None` when the image is the full one.
    pub window: Option<Window>,
}

impl Default for Metadata {
    fn default() -> Self {
        Self { attributes: Vec::new(), pixel_aspect: 1.0, window: None }
    }
}

/// The formats an image can be written in, told by the file's extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: linear 32-bit floats, lossless.
    Exr,
    /// PNG: 8-bit sRGB.
    Png,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exr => "EXR",
            Self::Png => "PNG",
        })
    }
}

impl Format {
    /// The format that a path's extension (in either case) names.
    ///
    /// # Errors
    /// When it names none.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()) {
            Some(e) if e == "exr" => Ok(Self::Exr),
            Some(e) if e == "png" => Ok(Self::Png),
            Some(e) => {
                let why = format!("the extension `.{e}` names no known format; use `.exr` (linear) or `.png` (sRGB)");
                Err(OutputError::new("write", path, why))
            }
            None => {
                let why = "the name has no extension to choose the format by; add `.exr` (linear) or `.png` (sRGB)";
                Err(OutputError::new("write", path, why))
            }
        }
    }
}

/// Writes an image in the format its extension names; `exposure` (stops) brightens a PNG, `metadata` goes into an EXR.
///
/// # Errors
/// An unknown extension, or whatever keeps the file from being written whole; nothing is left behind then.
pub fn write_image(path: &Path, image: &Image, metadata: &Metadata, exposure: f32) -> Result<(), OutputError> {
    match Format::of(path)? {
        Format::Exr => write_exr(path, image, metadata),
        Format::Png => write_png(path, image, exposure),
    }
}

/// `write_image` with auxiliary images, which go into an EXR; a PNG has no place for them.
///
/// # Errors
/// As there.
pub fn write_with_layers(
    path: &Path,
    image: &Image,
    channels: &[Channel],
    metadata: &Metadata,
    exposure: f32,
) -> Result<(), OutputError> {
    match Format::of(path)? {
        Format::Exr => write_exr_layers(path, image, channels, metadata),
        Format::Png => write_png(path, image, exposure),
    }
}

/// Checks, before the time for a render is spent, that its result can be written. Leaves nothing behind.
///
/// # Errors
/// An unknown extension; a missing folder, or one that cannot be written to; a directory or a read-only file in the
/// file's place.
pub fn check_writable(path: &Path) -> Result<Format, OutputError> {
    let format = Format::of(path)?;
    check_place(path)?;
    Ok(format)
}

/// `check_writable` for a file of any kind.
///
/// # Errors
/// As there, but for the extension.
pub fn check_place(path: &Path) -> Result<(), OutputError> {
    let error = |why: String| Err(OutputError::new("write", path, why));
    if let Ok(there) = fs::metadata(path) {
        if there.is_dir() {
            return error("it is a folder; give a file's name inside it".to_owned());
        }
        if !there.is_file() {
            return error("it is not a regular file, which writing would replace; choose another name".to_owned());
        }
        if there.permissions().readonly() {
            return error("the file there is read-only; remove it or choose another name".to_owned());
        }
    }
    let folder = folder_of(path);
    match fs::metadata(&folder) {
        Err(e) => return error(format!("the folder `{}` cannot be entered ({e}); create it first", folder.display())),
        Ok(there) if !there.is_dir() => {
            return error(format!("`{}` is not a folder; choose another place", folder.display()));
        }
        Ok(_) => {}
    }
    // Permissions, quotas and read-only mounts have one honest test.
    let trial = atomic::temporary_name(&atomic::target(path));
    match OpenOptions::new().write(true).create_new(true).open(&trial) {
        Ok(_) => {
            // It was empty; should its removal fail, writing will, too, and say so.
            let _ = fs::remove_file(&trial);
            Ok(())
        }
        Err(e) => error(format!(
            "no file can be created in `{}` ({e}); check its permissions and the free space, or choose another folder",
            folder.display()
        )),
    }
}

/// The folder a path's file is in.
fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests;

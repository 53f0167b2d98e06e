//! Reading images back: the decoders' numbers as an image.

use std::path::Path;

use super::{Format, OutputError};
use crate::decode::{self, ColorSpace, FileKind};
use crate::film::Image;

/// The format that a file's first bytes show, whatever its name; `None` for any other file, or for none at all.
pub fn format_of_content(path: &Path) -> Option<Format> {
    match decode::kind_of_content(path)? {
        FileKind::Exr => Some(Format::Exr),
        FileKind::Png => Some(Format::Png),
        FileKind::Hdr => None,
    }
}

/// Reads an image as [`decode::read`] does; a PNG is taken as sRGB and made linear.
///
/// # Errors
/// A file that cannot be opened, is of no known format, is too large, damaged, or lacks RGB channels.
pub fn read_image(path: &Path) -> Result<Image, OutputError> {
    let decoded = decode::read(path, ColorSpace::OfFile)
        .map_err(|e| OutputError { bad_content: e.bad_content, ..OutputError::new("read", path, e.why) })?;
    Ok(Image { width: decoded.width, height: decoded.height, rgb: decoded.rgb })
}

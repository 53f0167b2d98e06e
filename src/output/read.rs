//! Reading images back: the decoders' numbers as an image.

use std::path::Path;

use super::{Format, LONGEST_NAME, Metadata, OutputError};
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

/// Prefix of the metadata that are the renderer's own.
const OWN: &str = "twinlight:";

/// Reads an image as `read_image_and_metadata` does, the pixels alone.
///
/// # Errors
/// As there.
pub fn read_image(path: &Path) -> Result<Image, OutputError> {
    read_image_and_metadata(path).map(|(image, _)| image)
}

/// Reads an image as [`decode::read`] does; a PNG is taken as sRGB and made linear.
///
/// Of an EXR's metadata those are kept that `write_exr` takes: the attributes named `twinlight:…`, the pixels' shape and
/// a crop's place, the latter where the data window is part of the display window. Other formats have none.
///
/// # Errors
/// A file that cannot be opened, is of no known format, is too large, damaged, or lacks RGB channels.
pub fn read_image_and_metadata(path: &Path) -> Result<(Image, Metadata), OutputError> {
    let decoded = decode::read(path, ColorSpace::OfFile)
        .map_err(|e| OutputError { bad_content: e.bad_content, ..OutputError::new("read", path, e.why) })?;
    Ok(image_of(decoded))
}

/// Reads a layer of an EXR as [`decode::read_layer`] does, and its metadata as `read_image_and_metadata` does.
///
/// # Errors
/// As there, and when no layer has this name.
pub fn read_layer_and_metadata(path: &Path, layer: &str) -> Result<(Image, Metadata), OutputError> {
    // What is wrong with the file itself is told as without a layer.
    match format_of_content(path) {
        Some(Format::Exr) => {}
        Some(_) => {
            let error = OutputError::new("read", path, "it has no layers: it is no EXR; leave out --layer");
            return Err(OutputError { bad_content: true, ..error });
        }
        None => return read_image_and_metadata(path),
    }
    let decoded = decode::read_layer(path, layer)
        .map_err(|why| OutputError { bad_content: true, ..OutputError::new("read", path, why) })?;
    Ok(image_of(decoded))
}

fn image_of(decoded: decode::Decoded) -> (Image, Metadata) {
    let decode::Decoded { width, height, rgb, about, .. } = decoded;
    let own = |(name, _): &(String, String)| name.starts_with(OWN) && name.len() <= LONGEST_NAME;
    let attributes = about.texts.into_iter().filter(own).collect();
    let metadata = Metadata { attributes, pixel_aspect: about.pixel_aspect, window: about.window };
    (Image { width, height, rgb }, metadata)
}

//! PNG: 8-bit sRGB for looking at.

use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::{MAX_PIXELS, OutputError, write_atomically};
use crate::decode::srgb_encode;
use crate::film::Image;

/// Writes an image as 8-bit sRGB PNG, every value multiplied by `2^exposure_stops` first.
///
/// Values are clipped per channel to [0, 1]; +∞ becomes white, NaN and −∞ black.
///
/// # Errors
/// An empty or too large image, or a file that cannot be written. Nothing half-written is left, and what was there
/// stays.
pub fn write_png(path: &Path, image: &Image, exposure_stops: f32) -> Result<(), OutputError> {
    let file = encode_png(image, exposure_stops).map_err(|why| OutputError::new("write", path, why))?;
    write_atomically(path, &file)
}

/// The bytes of the file that `write_png` writes, for images inside other files.
///
/// # Errors
/// Why there are none: an empty or too large image.
pub fn encode_png(image: &Image, exposure_stops: f32) -> Result<Vec<u8>, String> {
    let pixels = u64::from(image.width) * u64::from(image.height);
    if pixels == 0 || image.rgb.len() as u64 != pixels || pixels > MAX_PIXELS {
        let (w, h) = (image.width, image.height);
        return Err(format!("an image of {w} × {h} pixels cannot be stored; it takes 1 to {MAX_PIXELS} pixels"));
    }
    let scale = f64::from(exposure_stops).exp2();
    let bytes: Vec<u8> = image.rgb.iter().flatten().map(|&c| to_byte(f64::from(c) * scale)).collect();
    let mut file = Vec::new();
    PngEncoder::new_with_quality(&mut file, CompressionType::Default, FilterType::Adaptive)
        .write_image(&bytes, image.width, image.height, ExtendedColorType::Rgb8)
        .map_err(|e| e.to_string())?;
    Ok(file)
}

fn to_byte(linear: f64) -> u8 {
    // The cast takes NaN to 0.
    (255.0 * srgb_encode(linear.clamp(0.0, 1.0))).round() as u8
}

//! Reading images back: EXR, and PNG made linear.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use exr::block::reader::Reader;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, IntegerBounds, Text};
use exr::meta::header::Header;
use exr::prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _};
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder};

use super::png::srgb_decode;
use super::{Format, LONGEST_NAME, MAX_PIXELS, Metadata, OutputError, Window};
use crate::film::Image;

const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
const PNG_MAGIC: [u8; 4] = [0x89, b'P', b'N', b'G'];

/// The format that a file's first bytes show, whatever its name; `None` for any other file, or for none at all.
pub fn format_of_content(path: &Path) -> Option<Format> {
    // Opening a pipe could wait for ever.
    std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
    let mut magic = [0; 4];
    File::open(path).ok()?.read_exact(&mut magic).ok()?;
    format_of_magic(magic)
}

fn format_of_magic(magic: [u8; 4]) -> Option<Format> {
    match magic {
        EXR_MAGIC => Some(Format::Exr),
        PNG_MAGIC => Some(Format::Png),
        _ => None,
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

/// Reads an image, its format told by its first bytes: an EXR's first layer with channels R, G and B (half, float or
/// integer, any compression the `exr` crate knows; other channels and layers are ignored; of a crop, the data window
/// alone), or a PNG of 8 or 16 bits, taken as sRGB and made linear, its alpha ignored.
///
/// Of an EXR's metadata those are kept that `write_exr` takes: the attributes named `twinlight:…`, the pixels' shape and
/// a crop's place, the latter where the data window is part of the display window. A PNG has none.
///
/// The size the header claims is checked against `MAX_PIXELS` and the file's length before memory is taken.
///
/// # Errors
/// A file that cannot be opened, is neither format, is too large, damaged, or lacks RGB channels.
pub fn read_image_and_metadata(path: &Path) -> Result<(Image, Metadata), OutputError> {
    let system = |why: String| OutputError::new("read", path, why);
    let error = |why: String| OutputError { bad_content: true, ..OutputError::new("read", path, why) };
    let io = |e: std::io::Error| system(format!("{e}; check the name and the permissions"));
    let mut file = File::open(path).map_err(io)?;
    let there = file.metadata().map_err(io)?;
    if there.is_dir() {
        return Err(system("it is a folder; give an image file inside it".to_owned()));
    }
    let mut magic = [0; 4];
    if let Err(e) = file.read_exact(&mut magic) {
        return Err(error(format!("it is too short to be an image ({e}); render or copy it again")));
    }
    file.seek(SeekFrom::Start(0)).map_err(io)?;
    match format_of_magic(magic) {
        Some(Format::Exr) => read_exr(BufReader::new(file), there.len()).map_err(error),
        Some(Format::Png) => read_png(BufReader::new(file)).map(|image| (image, Metadata::default())).map_err(error),
        None => Err(error("it is neither an EXR nor a PNG image; convert it to one of them".to_owned())),
    }
}

fn check_size(width: u64, height: u64) -> Result<(), String> {
    // Neither factor exceeds 2³², so that the product does not wrap.
    if width == 0 || height == 0 || width.saturating_mul(height) > MAX_PIXELS {
        return Err(format!("its header claims {width} × {height} pixels; allowed are 1 to {MAX_PIXELS} in all"));
    }
    Ok(())
}

/// Bytes that every chunk takes at the least: its entry in the offset table, its coordinate and its size.
const CHUNK_OVERHEAD: u64 = 16;

fn check_exr_header(header: &Header, file_length: u64) -> Result<(), String> {
    let Vec2(width, height) = header.layer_size;
    check_size(width as u64, height as u64)?;
    let least = (header.chunk_count as u64).saturating_mul(CHUNK_OVERHEAD);
    if least > file_length {
        return Err(format!(
            "its header claims {width} × {height} pixels in {} chunks, which {file_length} bytes cannot hold; the file \
             is cut off or damaged",
            header.chunk_count
        ));
    }
    Ok(())
}

fn read_exr(file: impl Read + Seek, file_length: u64) -> Result<(Image, Metadata), String> {
    let damaged = |e: exr::error::Error| format!("{e}; the file is damaged or uses an unsupported feature");
    let reader = Reader::read_from_buffered(file, false).map_err(damaged)?;
    let has_rgb = |header: &&Header| {
        !header.deep
            && [&b"R"[..], b"G", b"B"].iter().all(|c| header.channels.list.iter().any(|h| h.name.as_slice() == *c))
    };
    for header in reader.headers() {
        check_exr_header(header, file_length)?;
    }
    let Some(header) = reader.headers().iter().find(has_rgb) else {
        let names: Vec<String> = (reader.headers().iter().flat_map(|h| h.channels.list.iter()))
            .map(|c| String::from_utf8_lossy(c.name.as_slice()).into_owned())
            .collect();
        return Err(format!("no layer has the channels R, G and B; there are: {}", names.join(", ")));
    };
    let metadata = metadata(header);
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("R")
        .required("G")
        .required("B")
        .collect_pixels(
            |Vec2(width, height), _| Image::new(width as u32, height as u32),
            |image: &mut Image, Vec2(x, y), (r, g, b): (f32, f32, f32)| {
                image.rgb[y * image.width as usize + x] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_chunks(reader)
        .map_err(damaged)?;
    Ok((read.layer_data.channel_data.pixels, metadata))
}

/// What `write_exr` could say of a layer's image again.
fn metadata(header: &Header) -> Metadata {
    let (shared, own) = (&header.shared_attributes, &header.own_attributes);
    let text = |(name, value): (&Text, &AttributeValue)| {
        let lossy = |text: &Text| String::from_utf8_lossy(text.as_slice()).into_owned();
        let name = lossy(name);
        (name.starts_with(OWN) && name.len() <= LONGEST_NAME).then(|| Some((name, lossy(value.to_text().ok()?))))?
    };
    // A name that both hold, which no file should have, counts once.
    let attributes: BTreeMap<String, String> = shared.other.iter().chain(&own.other).filter_map(text).collect();
    Metadata {
        attributes: attributes.into_iter().collect(),
        pixel_aspect: shared.pixel_aspect,
        window: window(header.layer_size, own.layer_position, &shared.display_window),
    }
}

/// A crop's place; `None` for the full image, and for a data window that leaves the display window.
fn window(size: Vec2<usize>, position: Vec2<i32>, display: &IntegerBounds) -> Option<Window> {
    let axis = |size: usize, position: i32, start: i32, length: usize| {
        let origin = u32::try_from(i64::from(position) - i64::from(start)).ok()?;
        let length = u32::try_from(length).ok()?;
        (u64::from(origin) + size as u64 <= u64::from(length)).then_some((origin, length))
    };
    let (x, width) = axis(size.x(), position.x(), display.position.x(), display.size.x())?;
    let (y, height) = axis(size.y(), position.y(), display.position.y(), display.size.y())?;
    let whole = [width as usize, height as usize] == [size.x(), size.y()];
    (!whole).then_some(Window { full: [width, height], origin: [x, y] })
}

fn read_png(file: impl std::io::BufRead + Seek) -> Result<Image, String> {
    let damaged = |e: image::ImageError| format!("{e}; the file is damaged or uses an unsupported feature");
    let decoder = PngDecoder::new(file).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height))?;
    // Eight bits widen to v·257, and v·257/65535 is v/255 exactly.
    let pixels = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb16();
    let linear = |v: u16| srgb_decode(f64::from(v) / 65_535.0) as f32;
    Ok(Image { width, height, rgb: pixels.pixels().map(|p| p.0.map(linear)).collect() })
}

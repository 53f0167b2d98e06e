//! Image files to numbers: PNG, OpenEXR and Radiance HDR, their sizes checked before memory is taken.
//!
//! A room of its own, because two need it that may not see each other: `output`, which reads renders back, and
//! `import`, which reads textures.

mod guard;
mod layer;
mod open;
mod srgb;

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use exr::block::reader::Reader;
use exr::compression::Compression;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, ChannelDescription, IntegerBounds, SampleType, Text};
use exr::meta::header::Header;
use exr::prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _};
use image::codecs::hdr::HdrDecoder;
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder};

pub use guard::in_decoder;
pub use layer::{layers, read_layer};
pub use open::{OpenError, open_regular};
pub use srgb::{srgb_decode, srgb_encode};

/// The largest image that is read or written, in pixels: 3 GB of it in memory.
pub const MAX_PIXELS: u64 = 1 << 28;

/// A file format, told by a file's first bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// OpenEXR.
    Exr,
    /// PNG.
    Png,
    /// Radiance HDR (RGBE).
    Hdr,
}

/// What the file's numbers are taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// sRGB in integer files (PNG), linear in float files.
    OfFile,
    /// Linear: the numbers as they are, integers divided by their largest.
    Linear,
    /// sRGB-encoded: made linear.
    Srgb,
}

/// An image in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoded {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row-major from the top left; linear, or as `ColorSpace::Linear` says.
    pub rgb: Vec<[f32; 3]>,
    /// The file's format.
    pub kind: FileKind,
    /// What else the file says; of a format other than EXR nothing.
    pub about: About,
}

/// What an EXR says about its image besides the pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// The text attributes that are not of the format itself, by name.
    pub texts: BTreeMap<String, String>,
    /// Width of a pixel over its height.
    pub pixel_aspect: f32,
    /// A crop's place; `None` for the full image, and for a data window that leaves the display window.
    pub window: Option<Window>,
}

impl Default for About {
    fn default() -> Self {
        Self { texts: BTreeMap::new(), pixel_aspect: 1.0, window: None }
    }
}

/// Where a cropped image lies within the full one, in pixels from the top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Width and height of the full image: EXR's display window.
    pub full: [u32; 2],
    /// The full image's column and row of the crop's first pixel; with the image's own size, EXR's data window.
    pub origin: [u32; 2],
}

/// Why an image file could not be read.
#[derive(Clone, Debug)]
pub struct DecodeError {
    /// In words, and what to do.
    pub why: String,
    /// Whether the file was read, but its content is no image that can be used.
    pub bad_content: bool,
}

/// The format that a file's first bytes show, whatever its name; `None` for any other file, or for none at all.
pub fn kind_of_content(path: &Path) -> Option<FileKind> {
    let mut magic = [0; 4];
    open_regular(path).ok()?.0.read_exact(&mut magic).ok()?;
    kind_of_magic(magic)
}

fn kind_of_magic(magic: [u8; 4]) -> Option<FileKind> {
    match &magic {
        [0x76, 0x2f, 0x31, 0x01] => Some(FileKind::Exr),
        b"\x89PNG" => Some(FileKind::Png),
        b"#?RA" | b"#?RG" => Some(FileKind::Hdr),
        _ => None,
    }
}

/// Reads an image file; see [`read_from`].
///
/// # Errors
/// A file that is no regular one or cannot be opened, and what `read_from` says.
pub fn read(path: &Path, space: ColorSpace) -> Result<Decoded, DecodeError> {
    let (file, length) = open_regular(path).map_err(|e| {
        let why = match e {
            OpenError::System(e) => format!("{e}; check the name and the permissions"),
            OpenError::Folder => "it is a folder; give an image file inside it".to_owned(),
            OpenError::Special => "it is a pipe or a device; give a regular file".to_owned(),
        };
        DecodeError { why, bad_content: false }
    })?;
    read_from(BufReader::new(file), length, space)
}

/// Reads an image of `length` bytes, its format told by the first of them: an EXR's first layer with channels R, G and B
/// (half, float or integer, any compression the `exr` crate knows; other channels and layers are ignored; of a crop, the
/// data window alone), a PNG of 8 or 16 bits, its alpha ignored, or a Radiance HDR.
///
/// The size the header claims is checked against `MAX_PIXELS` and against what `length` bytes can hold before memory is
/// taken. A decoder's panic is an error like others.
///
/// # Errors
/// An image that is of no known format, too large, damaged, or lacks RGB channels; or the reader's own.
pub fn read_from(mut file: impl BufRead + Seek, length: u64, space: ColorSpace) -> Result<Decoded, DecodeError> {
    // The decoders' words hold the file's own, which must not steer a terminal.
    let escape = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    let error = |why: String| DecodeError { why: why.chars().map(escape).collect(), bad_content: true };
    let mut magic = [0; 4];
    if let Err(e) = file.read_exact(&mut magic) {
        return Err(error(format!("it is too short to be an image ({e}); render or copy it again")));
    }
    file.seek(SeekFrom::Start(0)).map_err(|e| DecodeError { why: e.to_string(), bad_content: false })?;
    let Some(kind) = kind_of_magic(magic) else {
        return Err(error("it is no EXR, PNG or Radiance HDR image; convert it to one of them".to_owned()));
    };
    let mut about = About::default();
    let (width, height, mut rgb) = guard::guarded(|| match kind {
        FileKind::Exr => read_exr(file, length, &mut about),
        FileKind::Png => read_png(file, length, space != ColorSpace::Linear),
        FileKind::Hdr => read_hdr(file, length),
    })
    .map_err(error)?;
    if space == ColorSpace::Srgb && kind != FileKind::Png {
        rgb.iter_mut().flatten().for_each(|x| *x = srgb_decode(f64::from(*x)) as f32);
    }
    Ok(Decoded { width, height, rgb, kind, about })
}

/// Width, height and pixels.
type Pixels = (u32, u32, Vec<[f32; 3]>);

fn check_size(width: u64, height: u64) -> Result<(), String> {
    // Neither factor exceeds 2³², so that the product does not wrap.
    if width == 0 || height == 0 || width.saturating_mul(height) > MAX_PIXELS {
        return Err(format!("its header claims {width} × {height} pixels; allowed are 1 to {MAX_PIXELS} in all"));
    }
    Ok(())
}

/// Bytes that every chunk takes at the least: its entry in the offset table, its coordinate and its size.
const CHUNK_OVERHEAD: u64 = 16;

/// How many bytes one byte of deflated data makes at the most: a match of 258 bytes takes two bits (RFC 1951).
const DEFLATED: u64 = 1032;

/// Pixels per byte of a file at the most where a format sets no bound: more than flat images have.
const PIXELS_PER_BYTE: u64 = 1 << 15;

/// Refuses a size that a file of `length` bytes cannot hold, `least` being the bytes that such an image takes.
fn check_length(width: u64, height: u64, least: u64, length: u64) -> Result<(), String> {
    if least > length {
        return Err(format!(
            "its header claims {width} × {height} pixels, which {length} bytes cannot hold; the file is cut off or damaged"
        ));
    }
    Ok(())
}

fn check_exr_header(header: &Header, length: u64) -> Result<(), String> {
    let Vec2(width, height) = header.layer_size;
    let (width, height) = (width as u64, height as u64);
    check_size(width, height)?;
    let pixels = match header.compression {
        Compression::Uncompressed
        | Compression::RLE
        | Compression::ZIP1
        | Compression::ZIP16
        | Compression::PXR24
        | Compression::B44
        | Compression::B44A => {
            let channels = &header.channels.list;
            // PXR24 stores three bytes of a float.
            let pxr24 = header.compression == Compression::PXR24;
            let stored = |kind: SampleType| match kind {
                SampleType::F32 if pxr24 => 3,
                kind => kind.bytes_per_sample(),
            };
            let sample = |c: &ChannelDescription| stored(c.sample_type) / c.sampling.area().max(1);
            let bytes: usize = channels.iter().map(sample).sum();
            (width * height).saturating_mul(bytes as u64) / DEFLATED
        }
        _ => width * height / PIXELS_PER_BYTE,
    };
    check_length(width, height, pixels.max((header.chunk_count as u64).saturating_mul(CHUNK_OVERHEAD)), length)
}

fn read_exr(file: impl Read + Seek, length: u64, about: &mut About) -> Result<Pixels, String> {
    let damaged = |e: exr::error::Error| format!("{e}; the file is damaged or uses an unsupported feature");
    let reader = Reader::read_from_buffered(file, false).map_err(damaged)?;
    let has_rgb = |header: &&Header| {
        !header.deep
            && [&b"R"[..], b"G", b"B"].iter().all(|c| header.channels.list.iter().any(|h| h.name.as_slice() == *c))
    };
    for header in reader.headers() {
        check_exr_header(header, length)?;
    }
    let Some(header) = reader.headers().iter().find(has_rgb) else {
        let names: Vec<String> = (reader.headers().iter().flat_map(|h| h.channels.list.iter()))
            .map(|c| String::from_utf8_lossy(c.name.as_slice()).into_owned())
            .collect();
        return Err(format!("no layer has the channels R, G and B; there are: {}", names.join(", ")));
    };
    *about = told_by(header);
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("R")
        .required("G")
        .required("B")
        .collect_pixels(
            |Vec2(width, height), _| (width as u32, height as u32, vec![[0.0; 3]; width * height]),
            |(width, _, rgb): &mut Pixels, Vec2(x, y), (r, g, b): (f32, f32, f32)| {
                rgb[y * *width as usize + x] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_chunks(reader)
        .map_err(damaged)?;
    Ok(read.layer_data.channel_data.pixels)
}

fn told_by(header: &Header) -> About {
    let (shared, own) = (&header.shared_attributes, &header.own_attributes);
    let lossy = |text: &Text| String::from_utf8_lossy(text.as_slice()).into_owned();
    let text = |(name, value): (&Text, &AttributeValue)| Some((lossy(name), lossy(value.to_text().ok()?)));
    About {
        // A name that both hold, which no file should have, counts once.
        texts: shared.other.iter().chain(&own.other).filter_map(text).collect(),
        pixel_aspect: shared.pixel_aspect,
        window: window(header.layer_size, own.layer_position, &shared.display_window),
    }
}

/// See `About::window`.
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

fn read_png(file: impl BufRead + Seek, length: u64, decode: bool) -> Result<Pixels, String> {
    let decoder = PngDecoder::new(file).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height))?;
    // One bit at the least: what the decoder tells are the bits that it makes of them.
    let least = u64::from(width).div_ceil(8) * u64::from(height) / DEFLATED;
    check_length(u64::from(width), u64::from(height), least, length)?;
    // Eight bits widen to v·257, and v·257/65535 is v/255 exactly.
    let pixels = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb16();
    let number = |v: u16| {
        let x = f64::from(v) / 65_535.0;
        (if decode { srgb_decode(x) } else { x }) as f32
    };
    Ok((width, height, pixels.pixels().map(|p| p.0.map(number)).collect()))
}

fn read_hdr(file: impl BufRead, length: u64) -> Result<Pixels, String> {
    let decoder = HdrDecoder::new(file).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    check_size(u64::from(width), u64::from(height))?;
    check_length(u64::from(width), u64::from(height), pixels / PIXELS_PER_BYTE, length)?;
    let pixels = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb32f();
    Ok((width, height, pixels.pixels().map(|p| p.0).collect()))
}

fn damaged(e: image::ImageError) -> String {
    format!("{e}; the file is damaged or uses an unsupported feature")
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    fn read_bytes(bytes: &[u8]) -> Result<Decoded, DecodeError> {
        read_from(Cursor::new(bytes), bytes.len() as u64, ColorSpace::OfFile)
    }

    /// A PNG without pixels whose header is in order.
    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
        let mut chunk = |name: &[u8], data: &[u8]| {
            let mut crc = flate2::Crc::new();
            crc.update(name);
            crc.update(data);
            bytes.extend((data.len() as u32).to_be_bytes());
            bytes.extend([name, data, &crc.sum().to_be_bytes()].concat());
        };
        chunk(b"IHDR", &[&width.to_be_bytes()[..], &height.to_be_bytes(), &[16, 6, 0, 0, 0]].concat());
        chunk(b"IDAT", &[]);
        chunk(b"IEND", &[]);
        bytes
    }

    #[test]
    fn a_small_file_cannot_hold_a_large_image() {
        let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16384 +X 16384\n".to_vec();
        for bytes in [png(16384, 16384), hdr] {
            let why = read_bytes(&bytes).expect_err("no pixels").why;
            let claim = format!("its header claims 16384 × 16384 pixels, which {} bytes cannot hold", bytes.len());
            assert!(why.starts_with(&claim), "{why}");
        }
        // What is merely cut off is the decoder's to tell.
        assert!(!read_bytes(&png(4, 4)).expect_err("no pixels").why.contains("cannot hold"));
    }

    /// Flat images are those that compress best.
    #[test]
    fn flat_images_are_read() {
        let mut bytes = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new_with_quality(
            &mut bytes,
            image::codecs::png::CompressionType::Best,
            image::codecs::png::FilterType::NoFilter,
        );
        let (width, height) = (2048, 2048);
        image::ImageEncoder::write_image(
            encoder,
            &vec![0; width as usize * height as usize],
            width,
            height,
            image::ExtendedColorType::L8,
        )
        .expect("encodes");
        assert_eq!(read_bytes(&bytes).expect("flat").rgb, vec![[0.0; 3]; width as usize * height as usize]);
    }

    /// The decoders' words hold the file's own.
    #[test]
    fn messages_are_printable() {
        let why = read_bytes(b"#?RADIANCE\nFORMAT=\x1b[2J\n\n-Y 1 +X 1\n").expect_err("no format").why;
        assert!(why.contains("\\u{1b}[2J"), "{why}");
    }
}

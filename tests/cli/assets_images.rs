//! Mistakes in images that a scene names: a table behind `docs/ERRORS.md`, as `assets.rs` says.

use std::io::Cursor;

use exr::prelude::{Image, SpecificChannels, WritableImage as _};

use super::assets::{ASSET, Asset, Content};

/// An EXR of 2 × 2 pixels, all of them this but for the last.
fn exr(last: f32) -> Vec<u8> {
    let pixel = move |at: exr::math::Vec2<usize>| if at.x() + at.y() == 2 { (0.5, last, 0.5) } else { (0.5, 0.5, 0.5) };
    let mut bytes = Cursor::new(Vec::new());
    Image::from_channels((2, 2), SpecificChannels::rgb(pixel)).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// An EXR of one channel.
fn grey_exr() -> Vec<u8> {
    let channels = SpecificChannels::build().with_channel("Y").with_pixel_fn(|_| (0.5f32,));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_channels((2, 2), channels).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// An EXR whose header claims another size than it has.
fn claiming_exr(side: i32) -> Vec<u8> {
    let mut bytes = exr(0.5);
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
        for corner in [at + 8, at + 12] {
            bytes[corner..corner + 4].copy_from_slice(&(side - 1).to_le_bytes());
        }
    }
    // Of tiles of 64 × 64 pixels.
    let name = &b"chunkCount\0int\0"[..];
    let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
    let tiles = (side + 63) / 64;
    bytes[at..at + 4].copy_from_slice(&(tiles * tiles).to_le_bytes());
    bytes
}

/// The start of a PNG whose header claims this size, with a right checksum.
fn claiming_png(side: u32) -> Vec<u8> {
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut header = b"IHDR".to_vec();
    header.extend([side.to_be_bytes(), side.to_be_bytes()].concat());
    header.extend([8, 2, 0, 0, 0]);
    for (length, chunk) in [(13u32, header), (0, b"IDAT".to_vec())] {
        let mut crc = flate2::Crc::new();
        crc.update(&chunk);
        bytes.extend(length.to_be_bytes());
        bytes.extend(chunk);
        bytes.extend(crc.sum().to_be_bytes());
    }
    bytes
}

pub const IMAGES: &[Asset] = &[
    Asset {
        what: "No image at all",
        name: "a.png",
        content: Content::Text("no image\n"),
        message: ": it is no EXR, PNG or Radiance HDR image; convert it to one of them",
        ..ASSET
    },
    Asset {
        what: "An empty image file",
        name: "a.exr",
        content: Content::Text(""),
        message: ": it is too short to be an image (failed to fill whole buffer); render or copy it again",
        ..ASSET
    },
    Asset {
        what: "A truncated EXR",
        name: "a.exr",
        content: Content::Bytes("the first half of an EXR", || {
            let whole = exr(0.5);
            whole[..whole.len() / 2].to_vec()
        }),
        message: ": invalid: reference to missing bytes; the file is damaged or uses an unsupported feature",
        ..ASSET
    },
    Asset {
        what: "A truncated PNG",
        name: "a.png",
        content: Content::Bytes("the header of a PNG of 2 × 2 pixels", || claiming_png(2)),
        message: ": unexpected end of file; the file is damaged or uses an unsupported feature",
        ..ASSET
    },
    Asset {
        what: "A size that no memory holds, in an EXR",
        name: "a.exr",
        content: Content::Bytes("an EXR that claims 1000000 × 1000000 pixels", || claiming_exr(1_000_000)),
        message: ": its header claims 1000000 × 1000000 pixels; allowed are 1 to 268435456 in all",
        ..ASSET
    },
    Asset {
        what: "A size that the file cannot hold, in an EXR",
        name: "a.exr",
        content: Content::Bytes("an EXR that claims 16000 × 16000 pixels", || claiming_exr(16_000)),
        message: ": its header claims 16000 × 16000 pixels, which 446 bytes cannot hold; the file is cut off or \
                  damaged",
        ..ASSET
    },
    Asset {
        what: "A size that no memory holds, in a PNG",
        name: "a.png",
        content: Content::Bytes("a PNG that claims 1000000 × 1000000 pixels", || claiming_png(1_000_000)),
        message: ": its header claims 1000000 × 1000000 pixels; allowed are 1 to 268435456 in all",
        ..ASSET
    },
    Asset {
        what: "A size that no memory holds, in a Radiance HDR",
        name: "sky.hdr",
        content: Content::Text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n"),
        message: ": its header claims 2000000000 × 2000000000 pixels; allowed are 1 to 268435456 in all",
        ..ASSET
    },
    Asset {
        what: "Missing channels",
        name: "a.exr",
        content: Content::Bytes("an EXR with the channel Y alone", grey_exr),
        message: ": no layer has the channels R, G and B; there are: Y",
        ..ASSET
    },
    Asset {
        what: "A texel out of range",
        name: "a.exr",
        content: Content::Bytes("an EXR of 2 × 2 pixels, the last of them [0.5, 1.25, 0.5]", || exr(1.25)),
        message: ": the texel in column 1, row 1 (from the top left), [0.5, 1.25, 0.5], is out of range; allowed: 0 to 1",
        user: Some(", used by scene.json:1:72: /materials/0/albedo"),
    },
    Asset {
        what: "A texel that is not finite",
        name: "a.exr",
        content: Content::Bytes("an EXR of 2 × 2 pixels, the last of them [0.5, NaN, 0.5]", || exr(f32::NAN)),
        message: ": the texel in column 1, row 1 (from the top left), [0.5, NaN, 0.5], is not finite; allowed: finite numbers",
        ..ASSET
    },
    Asset {
        what: "An environment that is negative",
        name: "sky.exr",
        content: Content::Bytes("an EXR of 2 × 2 pixels, the last of them [0.5, −0.25, 0.5]", || exr(-0.25)),
        message: ": the texel in column 1, row 1 (from the top left), [0.5, -0.25, 0.5], is out of range; allowed: 0 to 3.4e38",
        ..ASSET
    },
    Asset {
        what: "An environment that is not finite",
        name: "sky.exr",
        content: Content::Bytes("an EXR of 2 × 2 pixels, the last of them [0.5, ∞, 0.5]", || exr(f32::INFINITY)),
        message: ": the texel in column 1, row 1 (from the top left), [0.5, inf, 0.5], is not finite; allowed: finite numbers",
        ..ASSET
    },
];

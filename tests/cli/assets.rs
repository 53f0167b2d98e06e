//! Mistakes in the files that a scene names, meshes and images, and what users are told: a table behind
//! `docs/ERRORS.md`.

use std::io::Cursor;

use exr::prelude::{Image, SpecificChannels, WritableImage as _};

/// A file with a mistake in it.
pub struct Asset {
    /// In words.
    pub what: &'static str,
    /// The file's name, which tells the scene that names it: its ending, and for a sky its start.
    pub name: &'static str,
    pub content: Content,
    /// What is said after the file's name, and before the place that names it.
    pub message: &'static str,
    /// The parameter that uses an image, where the message names it.
    pub user: Option<&'static str>,
}

const ASSET: Asset = Asset { what: "", name: "", content: Content::Text(""), message: "", user: None };

/// A file's bytes.
pub enum Content {
    Text(&'static str),
    /// What is in it, in words, and how it is made.
    Bytes(&'static str, fn() -> Vec<u8>),
}

impl Asset {
    pub fn bytes(&self) -> Vec<u8> {
        match self.content {
            Content::Text(text) => text.as_bytes().to_vec(),
            Content::Bytes(_, make) => make(),
        }
    }

    /// The scene that names the file, and what must be said of it, whole.
    pub fn scene(&self) -> (String, String) {
        let name = self.name;
        let (before, pointer, after) = if name.ends_with("obj") || name.contains(".ply") {
            (r#""surfaces": [{"type": "mesh", "#, "/surfaces/0/filename", r#", "material": {"type": "mirror"}}]"#)
        } else if name.starts_with("sky") {
            (r#""background": {"type": "image", "#, "/background/filename", "}")
        } else {
            (
                r#""materials": [{"name": "m", "type": "mirror", "albedo": {"type": "image", "#,
                "/materials/0/albedo/filename",
                "}}]",
            )
        };
        let before = format!(r#"{{"camera": {{}}, {before}"filename": "#);
        let place = format!("scene.json:1:{}: {pointer}", before.len() + 1);
        let used = self.user.unwrap_or_default();
        let said = format!("twinlight: {name}{} (named by {place}{used})\n", self.message);
        (format!(r#"{before}"{name}"{after}}}"#), said)
    }
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A text after three vertices.
macro_rules! obj {
    ($text:literal) => {
        Content::Text(concat!("v 0 0 0\nv 1 0 0\nv 0 1 0\n", $text, "\n"))
    };
}

/// A PLY of a triangle in text: these header lines of the vertices, and these lines of data.
macro_rules! ply {
    ($vertices:literal, $more:literal, $data:literal) => {
        Content::Text(concat!(
            "ply\nformat ascii 1.0\nelement vertex ",
            $vertices,
            "\nproperty float x\nproperty float y\nproperty float z\n",
            $more,
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n",
            $data,
            "\n"
        ))
    };
}

pub const MESH_FILES: &[Asset] = &[
    Asset {
        what: "OBJ: an index too large",
        name: "a.obj",
        content: obj!("f 1 2 4"),
        message: ":4:7: vertex index 4 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before this line)",
        ..ASSET
    },
    Asset {
        what: "OBJ: an index of 0",
        name: "a.obj",
        content: obj!("f 1 0 2"),
        message: ":4:5: vertex index 0 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before this line)",
        ..ASSET
    },
    Asset {
        what: "OBJ: an index that goes back too far",
        name: "a.obj",
        content: obj!("f -1 -2 -4"),
        message: ":4:9: vertex index -4 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before this line)",
        ..ASSET
    },
    Asset {
        what: "OBJ: texture coordinates that are not there",
        name: "a.obj",
        content: obj!("f 1/1 2/1 3/1"),
        message: ":4:5: texture coordinate index 1 is out of range; none is defined before this line",
        ..ASSET
    },
    Asset {
        what: "OBJ: corners of several forms",
        name: "a.obj",
        content: obj!("vn 0 0 1\nf 1//1 2 3//1"),
        message: ":5:8: the corners of a face must all have the same form: v, v/vt, v//vn or v/vt/vn",
        ..ASSET
    },
    Asset {
        what: "OBJ: a normal of length 0",
        name: "a.obj",
        content: obj!("vn 0 0 0\nf 1//1 2//1 3//1"),
        message: ":5:6: normal 1 is [0, 0, 0]; a normal must have a direction",
        ..ASSET
    },
    Asset {
        what: "OBJ: a position that is not finite",
        name: "a.obj",
        content: Content::Text("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n"),
        message: ":2:5: y `nan` is not finite; allowed: -3.4e38 to 3.4e38",
        ..ASSET
    },
    Asset {
        what: "OBJ: a position of two numbers",
        name: "a.obj",
        content: Content::Text("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n"),
        message: ":2:6: the line ends where a number (z) is expected",
        ..ASSET
    },
    Asset {
        what: "OBJ: no number",
        name: "a.obj",
        content: obj!("f 1 2 x"),
        message: ":4:7: expected a whole number (vertex), found `x`",
        ..ASSET
    },
    Asset {
        what: "OBJ: too much on a line",
        name: "a.obj",
        content: obj!("vn 0 0 1 1\nf 1 2 3"),
        message: ":4:10: `1` follows the normal; the line should end here",
        ..ASSET
    },
    Asset {
        what: "OBJ: a face of two corners",
        name: "a.obj",
        content: obj!("f 1 2"),
        message: ":4:1: a face of 2 corners; allowed: 3 or more",
        ..ASSET
    },
    Asset {
        what: "OBJ: no face at all",
        name: "a.obj",
        content: Content::Text(TRIANGLE),
        message: ": the mesh has no faces; it needs at least one `f` line",
        ..ASSET
    },
    Asset {
        what: "OBJ: an empty file",
        name: "a.obj",
        content: Content::Text(""),
        message: ": the mesh has no faces; it needs at least one `f` line",
        ..ASSET
    },
    Asset {
        what: "OBJ: another format",
        name: "a.obj",
        content: Content::Text("solid cube\n"),
        message: ":1:1: unknown statement `solid`; allowed: v, vt, vn, f, g, o, s, usemtl, mtllib",
        ..ASSET
    },
    Asset {
        what: "PLY: another format",
        name: "a.ply",
        content: Content::Text("solid cube\n"),
        message: ":1:6: not a PLY file: the first line must be `ply`",
        ..ASSET
    },
    Asset {
        what: "PLY: an empty file",
        name: "a.ply",
        content: Content::Text(""),
        message: ":1:1: not a PLY file: the first line must be `ply`",
        ..ASSET
    },
    Asset {
        what: "PLY: half a header",
        name: "a.ply",
        content: Content::Text("ply\nformat ascii 1.0\n"),
        message: ":3:1: the header has no `end_header`; is the file truncated?",
        ..ASSET
    },
    Asset {
        what: "PLY: an unknown format",
        name: "a.ply",
        content: Content::Text("ply\nformat text 1.0\nend_header\n"),
        message: ":2:12: unknown format `text`; allowed: ascii, binary_little_endian, binary_big_endian",
        ..ASSET
    },
    Asset {
        what: "PLY: an unknown type",
        name: "a.ply",
        content: ply!("3", "property real nx\n", "0 0 0 0\n1 0 0 0\n0 1 0 0\n3 0 1 2"),
        message: ":7:14: unknown type `real`; allowed: char, uchar, short, ushort, int, uint, float, double, or int8 … float64",
        ..ASSET
    },
    Asset {
        what: "PLY: half a normal",
        name: "a.ply",
        content: ply!("3", "property float nx\n", "0 0 0 0\n1 0 0 0\n0 1 0 0\n3 0 1 2"),
        message: ": the vertices have only some of nx, ny, nz; allowed: all or none",
        ..ASSET
    },
    Asset {
        what: "PLY: a count beyond the file",
        name: "a.ply",
        content: ply!("4000000000", "", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2"),
        message: ": the header counts 4000000000 of element `vertex`, 6 bytes or more each, but only 26 bytes follow; is \
                  the file truncated?",
        ..ASSET
    },
    Asset {
        what: "PLY: a negative count",
        name: "a.ply",
        content: ply!("-3", "", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2"),
        message: ":3:18: element `vertex` has the count -3; allowed: 0 or more",
        ..ASSET
    },
    Asset {
        what: "PLY: an index too large",
        name: "a.ply",
        content: ply!("3", "", "0 0 0\n1 0 0\n0 1 0\n3 0 1 3"),
        message: ":13:7: vertex index 3 is out of range; allowed: 0 to 2",
        ..ASSET
    },
    Asset {
        what: "PLY: a negative index",
        name: "a.ply",
        content: ply!("3", "", "0 0 0\n1 0 0\n0 1 0\n3 0 -1 2"),
        message: ":13:5: vertex index -1 is out of range; allowed: 0 to 2",
        ..ASSET
    },
    Asset {
        what: "PLY: a list of negative length",
        name: "a.ply",
        content: ply!("3", "", "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2"),
        message: ":13:1: list `vertex_indices` has the length -3; allowed: 0 or more",
        ..ASSET
    },
    Asset {
        what: "PLY: a face of two corners",
        name: "a.ply",
        content: ply!("3", "", "0 0 0\n1 0 0\n0 1 0\n2 0 1"),
        message: ":13:1: a face of 2 corners; allowed: 3 or more",
        ..ASSET
    },
    Asset {
        what: "PLY: a position that is not finite",
        name: "a.ply",
        content: ply!("3", "", "0 0 0\n1 inf 0\n0 1 0\n3 0 1 2"),
        message: ":11:3: y `inf` is not finite; allowed: -3.4e38 to 3.4e38",
        ..ASSET
    },
    Asset {
        what: "PLY: a normal of length 0",
        name: "a.ply",
        content: ply!(
            "3",
            "property float nx\nproperty float ny\nproperty float nz\n",
            "0 0 0 0 0 1\n1 0 0 0 0 0\n0 1 0 0 0 1\n3 0 1 2"
        ),
        message: ": the normal of vertex 1 is [0, 0, 0]; a normal must have a direction",
        ..ASSET
    },
    Asset {
        what: "PLY: no face at all",
        name: "a.ply",
        content: Content::Text(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face \
             0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
        ),
        message: ": the mesh has no faces; it needs at least one",
        ..ASSET
    },
    Asset {
        what: "PLY: something after the end",
        name: "a.ply",
        content: ply!("3", "", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n7"),
        message: ":14:1: `7` follows the last element; the line should end here",
        ..ASSET
    },
    Asset {
        what: "PLY: something after the end of a binary file",
        name: "a.ply",
        content: Content::Bytes("a triangle, and 3 bytes more", || {
            [binary_ply(0.0, [3, 0, 1, 2]).as_slice(), b"abc"].concat()
        }),
        message: ": at byte 217: 3 bytes follow the last element; allowed: none",
        ..ASSET
    },
    Asset {
        what: "PLY: a truncated binary file",
        name: "a.ply",
        content: Content::Bytes("a triangle, cut off after its second corner", || {
            let whole = binary_ply(0.0, [3, 0, 1, 2]);
            whole[..whole.len() - 4].to_vec()
        }),
        message: ": at byte 213: the file ends within property `vertex_indices`; is it truncated?",
        ..ASSET
    },
    Asset {
        what: "PLY: a list of negative length in a binary file",
        name: "a.ply",
        content: Content::Bytes("a face of −1 corners", || binary_ply(0.0, [-1, 0, 1, 2])),
        message: ": at byte 204: list `vertex_indices` has the length -1; allowed: 0 or more",
        ..ASSET
    },
    Asset {
        what: "PLY: an index too large in a binary file",
        name: "a.ply",
        content: Content::Bytes("a triangle with the corners 0, 1 and 3", || binary_ply(0.0, [3, 0, 1, 3])),
        message: ": at byte 213: vertex index 3 is out of range; allowed: 0 to 2",
        ..ASSET
    },
    Asset {
        what: "PLY: a position that is not finite in a binary file",
        name: "a.ply",
        content: Content::Bytes("a triangle whose first x is not a number", || binary_ply(f32::NAN, [3, 0, 1, 2])),
        message: ": at byte 168: x NaN is not finite; allowed: -3.4e38 to 3.4e38",
        ..ASSET
    },
];

/// A binary PLY of a triangle: x of its first vertex, and its face as corner count and corners.
fn binary_ply(x: f32, [count, corners @ ..]: [i32; 4]) -> Vec<u8> {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list char int vertex_indices\nend_header\n"
        .to_vec();
    for coordinate in [x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(coordinate.to_le_bytes());
    }
    bytes.push(count as i8 as u8);
    for corner in corners {
        bytes.extend(corner.to_le_bytes());
    }
    bytes
}

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
        message: ": its header claims 16000 × 16000 pixels in 62500 chunks, which 446 bytes cannot hold; the file is cut off or \
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
        ..ASSET
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

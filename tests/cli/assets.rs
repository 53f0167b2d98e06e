//! Mistakes in the files that a scene names, meshes and images, and what users are told: tables behind
//! `docs/ERRORS.md`.

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

pub const ASSET: Asset = Asset { what: "", name: "", content: Content::Text(""), message: "", user: None };

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
        what: "OBJ: triangles without area",
        name: "a.obj",
        content: Content::Text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 3 2 1\n"),
        message: ": none of the mesh's 2 triangles has an area: the corners of each are on one line",
        ..ASSET
    },
    Asset {
        what: "OBJ: a position out of range",
        name: "a.obj",
        content: Content::Text("v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n"),
        message: ":2:3: x 1e39 is out of range; allowed: -3.4e38 to 3.4e38 (32-bit floats)",
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
        message: ":1:1: unknown statement `solid`; allowed: v, vt, vn, f, l, p, g, o, s, usemtl, mtllib",
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
        what: "PLY: an unknown line in the header",
        name: "a.ply",
        content: Content::Text("ply\nformat ascii 1.0\nvertices 3\nend_header\n"),
        message: ":3:9: unknown header line `vertices`; allowed: format, element, property, comment, obj_info, end_header",
        ..ASSET
    },
    Asset {
        what: "PLY: an unknown version",
        name: "a.ply",
        content: Content::Text("ply\nformat ascii 2.0\nend_header\n"),
        message: ":2:17: unknown version `2.0`; allowed: 1.0",
        ..ASSET
    },
    Asset {
        what: "PLY: no format",
        name: "a.ply",
        content: Content::Text("ply\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"),
        message: ":5:1: the header has no `format` line",
        ..ASSET
    },
    Asset {
        what: "PLY: an element that is there twice",
        name: "a.ply",
        content: Content::Text("ply\nformat ascii 1.0\nelement face 0\nelement face 0\nend_header\n"),
        message: ":4:15: duplicate element `face`",
        ..ASSET
    },
    Asset {
        what: "PLY: a property of nothing",
        name: "a.ply",
        content: Content::Text("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
        message: ":3:9: a property before the first element",
        ..ASSET
    },
    Asset {
        what: "PLY: an element of nothing",
        name: "a.ply",
        content: Content::Text("ply\nformat ascii 1.0\nelement vertex 1\nelement face 0\nend_header\n0\n"),
        message: ": element `vertex` has no properties",
        ..ASSET
    },
    Asset {
        what: "PLY: no faces in the header",
        name: "a.ply",
        content: Content::Text(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
        ),
        message: ": the header has no element `face`",
        ..ASSET
    },
    Asset {
        what: "PLY: vertices without a place",
        name: "a.ply",
        content: Content::Text(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty uchar red\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0\n",
        ),
        message: ": the vertices have no x, y, z",
        ..ASSET
    },
    Asset {
        what: "PLY: faces without corners",
        name: "a.ply",
        content: Content::Text(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty int flags\nend_header\n0 0 0\n7\n",
        ),
        message: ": the faces have no list `vertex_indices`",
        ..ASSET
    },
    Asset {
        what: "PLY: corners that are no whole numbers",
        name: "a.ply",
        content: Content::Text(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar float vertex_indices\nend_header\n0 0 0\n3 0 0 0\n",
        ),
        message: ": `vertex_indices` must be of a whole-number type",
        ..ASSET
    },
    Asset {
        what: "PLY: a list whose length is no whole number",
        name: "a.ply",
        content: Content::Text(
            "ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\nend_header\n",
        ),
        message: ":4:20: a list's length must be of a whole-number type",
        ..ASSET
    },
    Asset {
        what: "PLY: a truncated text",
        name: "a.ply",
        content: Content::Text(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0.5 0.25 1\n",
        ),
        message: ":11:1: the file ends before vertex 1; is it truncated?",
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

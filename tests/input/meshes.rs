//! Meshes, inline and in files.

use std::fs;
use std::io::Write;

use twinlight::import::{MeshFileError, load_mesh, load_scene, scene_from_bytes};

use super::{each, expect_errors, mesh_of, shared, temporary};

#[test]
fn inline_meshes() {
    each(
        r#"{"camera": {}, "surfaces": [{"type": "mesh", "material": {"type": "mirror"}, "positions": [[0,0,0],[1,0,0],[0,1,0]], @}]}"#,
        &[
            (
                r#""indices": [[0, 1, «3]]"#,
                "/surfaces/0/indices/0/2: 3 is out of range; allowed: whole numbers from 0 to 2",
            ),
            (
                r#""indices": [[0, 1, 2], [0, «-1, 2]]"#,
                "/surfaces/0/indices/1/1: -1 is out of range; allowed: whole numbers from 0 to 2",
            ),
            (
                r#""indices": [[0, 1, «1.5]]"#,
                "/surfaces/0/indices/0/2: 1.5 is out of range; allowed: whole numbers from 0 to 2",
            ),
            (r#""indices": [«[0, 1]]"#, "/surfaces/0/indices/0: a face has 3 or 4 corners, found 2"),
            (r#""indices": [«[0, 1, 2, 0, 1]]"#, "/surfaces/0/indices/0: a face has 3 or 4 corners, found 5"),
            (r#""indices": «[]"#, "/surfaces/0/indices: the mesh has no faces; it needs at least one"),
            (
                r#""indices": [[0, 1, 2]], "normals": «[[0, 0, 1]]"#,
                "/surfaces/0/normals: 1 normals for 3 positions; allowed: one each",
            ),
            (
                r#""indices": [[0, 1, 2]], "uvs": «[[0, 0], [1, 1]]"#,
                "/surfaces/0/uvs: 2 uvs for 3 positions; allowed: one each",
            ),
            (
                r#""indices": [[0, 1, 2]], "normals": [[0, 0, 1], «[0, 0, 0], [0, 0, 1]]"#,
                "/surfaces/0/normals/1: the normal [0, 0, 0] has no direction; it must not be zero",
            ),
            (
                r#""filename": «"a.obj""#,
                "/surfaces/0/filename: a mesh has either a \"filename\" or inline \"positions\", not both",
            ),
        ],
    );
    each(
        r#"{"camera": {}, "surfaces": [{"type": "mesh", "material": {"type": "mirror"}, "indices": [[0, 1, 2]], "positions": @}]}"#,
        &[
            (
                "[[0,0,0], [1,0,0], [0, «1e999, 0]]",
                "/surfaces/0/positions/2/1: 1e999 is not a finite 64-bit number; allowed: -3.4e38 to 3.4e38 (32-bit floats)",
            ),
            (
                "[[0,0,0], [1,0,0], [0, «1e39, 0]]",
                "/surfaces/0/positions/2/1: 1e39 is out of range; allowed: -3.4e38 to 3.4e38 (32-bit floats)",
            ),
            (
                "[[0,0,0], «[1,0], [0,1,0]]",
                "/surfaces/0/positions/1: expected an array of 3 numbers, or one number for all, found an array of 2",
            ),
            ("[[0,0,0], [1,«null,0], [0,1,0]]", "/surfaces/0/positions/1/1: expected a number, found null"),
            ("«4", "/surfaces/0/positions: expected an array of arrays of 3 numbers, found the number 4"),
        ],
    );
    expect_errors(
        r#"{"camera": {}, "surfaces": [{"type": "triangle", "material": {"type": "mirror"}, "positions": «[[0,0,0],[1,0,0]]}]}"#,
        &["/surfaces/0/positions: a triangle has 3 positions, found 2"],
    );
    expect_errors(
        r#"{"camera": {}, "surfaces": [«{"type": "mesh", "material": {"type": "mirror"}}]}"#,
        &["/surfaces/0: a mesh needs a \"filename\", or inline \"positions\" and \"indices\""],
    );
}

/// Loads a mesh file with the given bytes; the error without the folder's name.
fn mesh_error(name: &str, bytes: &[u8]) -> String {
    let path = temporary(name, bytes);
    match load_mesh(&path) {
        Err(MeshFileError::Invalid(d)) => d.to_string().replace(&path.display().to_string(), name),
        other => panic!("{name}: {other:?}"),
    }
}

#[test]
fn obj_files() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (text, message) in [
        (
            "f 1 2 4",
            "a.obj:4:7: vertex index 4 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before this line)",
        ),
        (
            "f 1 0 2",
            "a.obj:4:5: vertex index 0 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before this line)",
        ),
        (
            "f 1 2 -4",
            "a.obj:4:7: vertex index -4 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before this line)",
        ),
        (
            "f 1 2 99999999999999999999",
            "a.obj:4:7: vertex index 9223372036854775807 is out of range; allowed: 1 to 3, or -3 to -1 (those defined before this line)",
        ),
        ("f 1/1 2/1 3/1", "a.obj:4:5: texture coordinate index 1 is out of range; none is defined before this line"),
        ("f 1//1 2//1 3//1", "a.obj:4:6: normal index 1 is out of range; none is defined before this line"),
        ("vn 0 0 0\nf 1//1 2//1 3//1", "a.obj:5:6: normal 1 is [0, 0, 0]; a normal must have a direction"),
        (
            "vn 0 0 1\nf 1//1 2 3//1",
            "a.obj:5:8: the corners of a face must all have the same form: v, v/vt, v//vn or v/vt/vn",
        ),
        ("f 1 2", "a.obj:4:1: a face of 2 corners; allowed: 3 or more"),
        ("f", "a.obj:4:1: a face of 0 corners; allowed: 3 or more"),
        ("f 1 2 x", "a.obj:4:7: expected a whole number (vertex), found `x`"),
        ("f 1 2 3.5", "a.obj:4:7: expected a whole number (vertex), found `3.5`"),
        ("v 0 nan 0", "a.obj:4:5: y `nan` is not finite; allowed: -3.4e38 to 3.4e38"),
        ("v 0 0 1e39", "a.obj:4:7: z 1e39 is out of range; allowed: -3.4e38 to 3.4e38 (32-bit floats)"),
        ("v 0 0", "a.obj:4:6: the line ends where a number (z) is expected"),
        ("v 0 0 zero", "a.obj:4:7: expected a number (z), found `zero`"),
        ("vn 0 0 1 1", "a.obj:4:10: `1` follows the normal; the line should end here"),
        ("vertex 1 2 3", "a.obj:4:1: unknown statement `vertex`; allowed: v, vt, vn, f, l, p, g, o, s, usemtl, mtllib"),
        ("", "a.obj: the mesh has no faces; it needs at least one `f` line"),
    ] {
        assert_eq!(mesh_error("a.obj", format!("{triangle}{text}").as_bytes()), message, "\nin {text}");
    }
    assert_eq!(mesh_error("empty.obj", b""), "empty.obj: the mesh has no faces; it needs at least one `f` line");
}

const ASCII_PLY: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

#[test]
fn ascii_ply_files() {
    for (from, to, message) in [
        ("ply\n", "plx\n", "a.ply:1:4: not a PLY file: the first line must be `ply`"),
        ("ascii", "text", "a.ply:2:12: unknown format `text`; allowed: ascii, binary_little_endian, binary_big_endian"),
        ("1.0", "2.0", "a.ply:2:17: unknown version `2.0`; allowed: 1.0"),
        (
            "float x",
            "real x",
            "a.ply:5:14: unknown type `real`; allowed: char, uchar, short, ushort, int, uint, float, double, or int8 … float64",
        ),
        ("float x", "float w", "a.ply: the vertices have only some of x, y, z; allowed: all or none"),
        (
            "float z",
            "float z\nproperty float nx",
            "a.ply: the vertices have only some of nx, ny, nz; allowed: all or none",
        ),
        (
            "end_header",
            "end_heade",
            "a.ply:10:10: unknown header line `end_heade`; allowed: format, element, property, comment, obj_info, end_header",
        ),
        ("element vertex 4", "element vertex -4", "a.ply:4:18: element `vertex` has the count -4; allowed: 0 or more"),
        (
            "element vertex 4",
            "element vertex 4000000000",
            "a.ply: the header counts 4000000000 of element `vertex`, 6 bytes or more each, but only 34 bytes follow; is the file truncated?",
        ),
        ("element vertex 4", "element vertex 5", "a.ply:15:7: `2` follows the vertex; the line should end here"),
        ("element vertex 4", "element vertex 3", "a.ply:14:1: a face of 0 corners; allowed: 3 or more"),
        ("element face", "element polygon", "a.ply: the header has no element `face`"),
        ("int vertex_indices", "float vertex_indices", "a.ply: `vertex_indices` must be of a whole-number type"),
        ("vertex_indices", "corners", "a.ply: the faces have no list `vertex_indices`"),
        ("1 1 0", "1 nan 0", "a.ply:13:3: y `nan` is not finite; allowed: -3.4e38 to 3.4e38"),
        ("1 1 0", "1 1", "a.ply:13:4: the line ends where a number (z) is expected"),
        ("4 0 1 2 3", "4 0 1 2 4", "a.ply:15:9: vertex index 4 is out of range; allowed: 0 to 3"),
        ("4 0 1 2 3", "4 0 1 2 -1", "a.ply:15:9: vertex index -1 is out of range; allowed: 0 to 3"),
        ("4 0 1 2 3", "-4 0 1 2 3", "a.ply:15:1: list `vertex_indices` has the length -4; allowed: 0 or more"),
        ("4 0 1 2 3", "2 0 1", "a.ply:15:1: a face of 2 corners; allowed: 3 or more"),
        ("4 0 1 2 3", "4 0 1 2", "a.ply:15:8: the line ends where a whole number (vertex_indices) is expected"),
        ("4 0 1 2 3\n", "4 0 1 2 3\n7\n", "a.ply:16:1: `7` follows the last element; the line should end here"),
        ("4 0 1 2 3\n", "      \n", "a.ply:16:1: the file ends before face 0; is it truncated?"),
    ] {
        assert!(ASCII_PLY.contains(from), "{from}");
        assert_eq!(mesh_error("a.ply", ASCII_PLY.replace(from, to).as_bytes()), message, "\nfor {to}");
    }
    assert_eq!(mesh_error("empty.ply", b""), "empty.ply:1:1: not a PLY file: the first line must be `ply`");
    assert_eq!(
        mesh_error("short.ply", b"ply\nformat ascii 1.0\n"),
        "short.ply:3:1: the header has no `end_header`; is the file truncated?"
    );
    let no_faces = ASCII_PLY.replace("face 1", "face 0").replace("4 0 1 2 3\n", "");
    assert_eq!(
        mesh_error("points.ply", no_faces.as_bytes()),
        "points.ply: the mesh has no faces; it needs at least one"
    );
}

/// A binary PLY of a quad, with an element and properties to skip, in either byte order.
fn binary_ply(big_endian: bool) -> (usize, Vec<u8>) {
    let order = if big_endian { "big" } else { "little" };
    let mut bytes = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement extra 2\r\nproperty list ushort double values\r\n\
         element vertex 4\r\nproperty uchar red\r\nproperty double x\r\nproperty float y\r\nproperty float z\r\n\
         property float s\r\nproperty float t\r\nelement face 1\r\nproperty list uchar uint vertex_index\r\n\
         property char flag\r\nend_header\r\n"
    )
    .into_bytes();
    let header = bytes.len();
    let mut put = |raw: &[u8]| {
        let mut raw = raw.to_vec();
        if big_endian {
            raw.reverse();
        }
        bytes.extend(raw);
    };
    put(&1u16.to_le_bytes());
    put(&3.5f64.to_le_bytes());
    put(&0u16.to_le_bytes());
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
        put(&[255]);
        put(&f64::from(x).to_le_bytes());
        for value in [y, 0.25, x, y] {
            put(&f32::to_le_bytes(value));
        }
    }
    put(&[4]);
    for index in 0..4u32 {
        put(&index.to_le_bytes());
    }
    put(&[7]);
    (header, bytes)
}

#[test]
fn binary_ply_files() {
    for big_endian in [false, true] {
        let (_, bytes) = binary_ply(big_endian);
        let mesh = load_mesh(&temporary("good.ply", &bytes)).unwrap();
        assert_eq!(mesh.positions, [[0.0, 0.0, 0.25], [1.0, 0.0, 0.25], [1.0, 1.0, 0.25], [0.0, 1.0, 0.25]]);
        assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert!(mesh.normals.is_empty());
    }
    let (header, good) = binary_ply(false);
    let (vertex, face) = (header + 12, header + 12 + 4 * 25);
    let end = good.len();
    let changed = |at: usize, new: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + new.len()].copy_from_slice(new);
        mesh_error("b.ply", &bytes)
    };
    assert_eq!(
        changed(vertex + 9, &f32::NAN.to_le_bytes()),
        format!("b.ply: at byte {}: y NaN is not finite; allowed: -3.4e38 to 3.4e38", vertex + 9)
    );
    assert_eq!(
        changed(vertex + 1, &1e39f64.to_le_bytes()),
        format!("b.ply: at byte {}: x {} is not finite; allowed: -3.4e38 to 3.4e38", vertex + 1, 1e39)
    );
    assert_eq!(
        changed(face + 5, &9u32.to_le_bytes()),
        format!("b.ply: at byte {}: vertex index 9 is out of range; allowed: 0 to 3", face + 5)
    );
    assert_eq!(changed(face, &[2]), format!("b.ply: at byte {face}: a face of 2 corners; allowed: 3 or more"));
    assert_eq!(
        changed(face, &[200]),
        format!("b.ply: at byte {end}: the file ends within property `vertex_index`; is it truncated?"),
        "a face longer than the file"
    );
    assert_eq!(
        changed(header, &u16::MAX.to_le_bytes()),
        format!("b.ply: at byte {end}: the file ends within property `values`; is it truncated?")
    );
    let mut long = good.clone();
    long.extend([1, 2, 3]);
    assert_eq!(
        mesh_error("b.ply", &long),
        format!("b.ply: at byte {end}: 3 bytes follow the last element; allowed: none")
    );
    // Cut anywhere: always an error, never a panic.
    for length in 0..end {
        mesh_error("cut.ply", &good[..length]);
    }
    let huge = String::from_utf8_lossy(&good[..header]).replace("vertex 4", "vertex 3000000000");
    let error = mesh_error("b.ply", &[huge.as_bytes(), &good[header..]].concat());
    assert!(error.contains("the header counts 3000000000 of element `vertex`, 25 bytes or more each"), "{error}");
}

#[test]
fn negative_list_lengths_in_binary() {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list char int vertex_indices\nend_header\n"
        .to_vec();
    let face = bytes.len() + 12;
    bytes.extend([0; 12]);
    bytes.push(0xff);
    bytes.extend([0; 12]);
    assert_eq!(
        mesh_error("b.ply", &bytes),
        format!("b.ply: at byte {face}: list `vertex_indices` has the length -1; allowed: 0 or more")
    );
}

#[test]
fn zero_normals_matter_where_they_are_used() {
    let ply = |normal: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             property float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n\
             0 0 0 {normal}\n1 0 0 0 0 1\n1 1 0 0 0 1\n9 9 9 0 0 0\n3 0 1 2\n"
        )
    };
    // The fourth vertex has a zero normal, but no face uses it.
    assert_eq!(load_mesh(&temporary("n.ply", ply("0 0 1").as_bytes())).unwrap().normals.len(), 4);
    assert_eq!(
        mesh_error("n.ply", ply("0 0 0").as_bytes()),
        "n.ply: the normal of vertex 0 is [0, 0, 0]; a normal must have a direction"
    );
}

#[test]
fn mesh_files_named_by_a_scene() {
    temporary("quad.ply", ASCII_PLY.as_bytes());
    temporary("bad.obj", b"v 0 0 0\nf 1 2 3\n");
    temporary("quad.stl", b"");
    let mut gz = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gz.write_all(ASCII_PLY.as_bytes()).unwrap();
    let compressed = gz.finish().unwrap();
    temporary("quad.ply.gz", &compressed);
    temporary("cut.ply.gz", &compressed[..compressed.len() - 20]);
    let scene = |name: &str| {
        let text = format!(
            "{{\"camera\": {{}}, \"surfaces\": [{{\"type\": \"mesh\", \"material\": {{\"type\": \"mirror\"}},\n\"filename\": \"{name}\"}}]}}"
        );
        let path = temporary("scene.json", text.as_bytes());
        let folder = format!("{}/", path.parent().unwrap().display());
        load_scene(&path).map_err(|e| e.to_string().replace(&folder, ""))
    };
    for good in ["quad.ply", "quad.ply.gz"] {
        let scene = scene(good).unwrap();
        assert_eq!(mesh_of(&scene.surfaces[0].shape).triangles, [[0, 1, 2], [0, 2, 3]], "{good}");
    }
    for (name, message) in [
        (
            "bad.obj",
            "bad.obj:2:5: vertex index 2 is out of range; allowed: 1 to 1, or -1 to -1 (those defined before this line) \
             (named by scene.json:2:13: /surfaces/0/filename)",
        ),
        (
            "quad.stl",
            "scene.json:2:13: /surfaces/0/filename: \"quad.stl\" is no mesh format; allowed: .obj, .ply, .obj.gz, .ply.gz",
        ),
        (
            "none.obj",
            "scene.json:2:13: /surfaces/0/filename: cannot read none.obj: No such file or directory (os error 2); check the name and \
             the permissions",
        ),
    ] {
        assert_eq!(scene(name).unwrap_err(), message);
    }
    let cut = scene("cut.ply.gz").unwrap_err();
    assert!(cut.starts_with("scene.json:2:13: /surfaces/0/filename: cannot read cut.ply.gz: "), "{cut}");
}

#[test]
fn meshes_of_the_ajar_door_load() {
    let Some(folder) = shared("veach-ajar/models") else { return };
    let mut files = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let mesh = load_mesh(&path).unwrap_or_else(|e| panic!("{}: {e:?}", path.display()));
        assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < mesh.positions.len()));
        for (count, what) in [(mesh.normals.len(), "normals"), (mesh.uvs.len(), "uvs")] {
            assert!(count == 0 || count == mesh.positions.len(), "{}: {what}", path.display());
        }
        if path.ends_with("Mesh009.ply") {
            // The header counts these.
            assert_eq!((mesh.positions.len(), mesh.triangles.len()), (39086, 78176));
        }
        files += 1;
    }
    assert_eq!(files, 17);
}

/// Whatever is no regular file could make the renderer wait or read for ever.
#[cfg(unix)]
#[test]
fn assets_are_regular_files() {
    let folder = temporary("regular", b"").with_extension("folder");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("folder.ply")).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(folder.join("pipe.obj")).status().unwrap().success());
    std::os::unix::fs::symlink("/dev/zero", folder.join("zero.ply.gz")).unwrap();
    std::os::unix::fs::symlink("pipe.obj", folder.join("pipe.png")).unwrap();
    let error = |text: &str| scene_from_bytes(text.as_bytes(), "s.json", &folder).unwrap_err().to_string();
    for (name, message) in [
        ("folder.ply", "it is a folder; give a mesh file inside it"),
        ("pipe.obj", "it is a pipe or a device; give a regular file"),
        ("zero.ply.gz", "it is a pipe or a device; give a regular file"),
    ] {
        let mesh = format!("{{\"type\": \"mesh\", \"material\": {{\"type\": \"mirror\"}}, \"filename\": \"{name}\"}}");
        let found = error(&format!("{{\"camera\": {{}}, \"surfaces\": [{mesh}]}}"));
        let path = folder.join(name);
        assert_eq!(found, format!("s.json:1:90: /surfaces/0/filename: cannot read {}: {message}", path.display()));
    }
    let found = error(r#"{"camera": {}, "background": {"type": "image", "filename": "pipe.png"}}"#);
    assert!(found.ends_with("pipe.png: it is a pipe or a device; give a regular file"), "{found}");
    // A scene may come through a pipe.
    let scene = folder.join("scene.json");
    assert!(std::process::Command::new("mkfifo").arg(&scene).status().unwrap().success());
    let writer = std::thread::spawn({
        let scene = scene.clone();
        move || fs::write(scene, "{\"camera\": {}}").unwrap()
    });
    assert!(load_scene(&scene).is_ok());
    writer.join().unwrap();
}

/// The header of a file that ends in it has as many lines as it has.
#[test]
fn the_last_line_of_a_mesh() {
    assert_eq!(
        mesh_error("unended.ply", b"ply\nformat ascii 1.0\ncomment no end"),
        "unended.ply:3:15: the header has no `end_header`; is the file truncated?"
    );
}

/// Names of properties and elements are told in messages: they must not steer a terminal.
#[test]
fn names_in_a_mesh_are_printable() {
    let header = |vertex: &str, names: [&str; 2]| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\n{vertex}property float {}\nelement {} 1\nproperty float x\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n",
            names[0], names[1]
        )
    };
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let found = mesh_error(
        "property.ply",
        (header(xyz, ["a\u{1b}", "b"]) + "0 0 0\n0 0 0 0\n0 0 0 0\n0\n3 0 1 2\n").as_bytes(),
    );
    assert_eq!(found, "property.ply:13:6: the line ends within property `a\\u{1b}`");
    let bytes = header(xyz, ["a", "b\u{1b}"]) + "0 0 0 0\n0 0 0 0\n0 0 0 0\n1 2\n3 0 1 2\n";
    let found = mesh_error("element.ply", bytes.as_bytes());
    assert_eq!(found, "element.ply:16:3: `2` follows b\\u{1b}; the line should end here");
}

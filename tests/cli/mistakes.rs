//! What users get wrong in a scene, and what they are told: the tables behind `docs/ERRORS.md`, with those of
//! `arguments.rs`.
//!
//! In a scene `«` marks the place that the message must name (it is taken out before reading), so that line and column
//! are checked without counting. A place is the file, line, column and JSON pointer.

/// A scene file with mistakes in it.
pub struct Scene {
    /// In words.
    pub what: &'static str,
    /// Its text, marked; `[128×X]` stands for 128 times X.
    pub text: &'static str,
    /// What is said after `scene.json:LINE:COLUMN: `, one per mark.
    pub messages: &'static [&'static str],
}

/// The sections of the page: a title and its mistakes. All of them end with status 65.
pub const SCENES: [(&str, &[Scene]); 5] = [
    ("JSON", JSON),
    ("Names", NAMES),
    ("Camera and sampling", CAMERA),
    ("Lights and materials", LIGHTS),
    ("Meshes", MESHES),
];

const JSON: &[Scene] = &[
    Scene {
        what: "An empty file",
        text: "«",
        messages: &["the file is empty; expected a JSON object with a \"camera\""],
    },
    Scene {
        what: "A truncated file",
        text: "{\"camera\": {\n  \"vfov\": 40«",
        messages: &["invalid JSON: EOF while parsing an object: the file ends before the scene does; is it truncated?"],
    },
    Scene {
        what: "A comma too many",
        text: r#"{"camera": {"vfov": 40, «}}"#,
        messages: &["invalid JSON: key must be a string, found `}`"],
    },
    Scene {
        what: "Something after the end",
        text: "{\"camera\": {}}\n«{}",
        messages: &["invalid JSON: trailing characters, found `{`"],
    },
    Scene {
        what: "Nested too deeply",
        text: "[128×[]«[[128×]]]",
        messages: &["nested more than 128 deep; allowed: at most 128 levels"],
    },
    Scene { what: "No camera", text: "«{}", messages: &["\"camera\" is missing"] },
    Scene {
        what: "An unknown key",
        text: r#"{"camera": {«"vfovv": 40}}"#,
        messages: &[
            "/camera/vfovv: unknown key \"vfovv\"; did you mean \"vfov\"? allowed: type, transform, resolution, vfov, \
             fdist, aperture, filter",
        ],
    },
    Scene {
        what: "A slip in the name of a key that must be there",
        text: r#"{"camera": {}, "materials": [{"name": "m", "type": "lambertian", «"albdo": 0.5}]}"#,
        messages: &[
            "/materials/0/albdo: unknown key \"albdo\"; did you mean \"albedo\"? allowed: type, name, albedo, two_sided, \
             emit, emit_two_sided",
        ],
    },
    Scene {
        what: "A duplicate key",
        text: "{\"camera\": {\"vfov\": 40,\n  «\"vfov\": 50}}",
        messages: &["/camera/vfov: duplicate key \"vfov\"; it is already given on line 1"],
    },
    Scene {
        what: "A wrong type",
        text: r#"{"camera": {"vfov": «"wide"}}"#,
        messages: &["/camera/vfov: expected a number, found the string \"wide\""],
    },
    Scene {
        what: "A wrong arity",
        text: r#"{"camera": {"transform": {"translate": «[1, 2]}}}"#,
        messages: &[
            "/camera/transform/translate: expected an array of 3 numbers, or one number for all, found an array of 2",
        ],
    },
    Scene {
        what: "A number beyond 64-bit floats",
        text: r#"{"camera": {"fdist": «1e999}}"#,
        messages: &["/camera/fdist: 1e999 is not a finite 64-bit number; allowed: above 0"],
    },
    Scene {
        what: "Several mistakes are all told, in the file's order",
        text: "{\"camera\": {\"vfov\": «0},\n \"surfaces\": [{\"type\": \"quad\", \"size\": «-1, \"material\": «\"white\"}]}",
        messages: &[
            "/camera/vfov: 0 is out of range; allowed: between 0 and 180 degrees",
            "/surfaces/0/size: -1 is out of range; allowed: above 0",
            "/surfaces/0/material: no material is named \"white\"; there are no named materials",
        ],
    },
];

const NAMES: &[Scene] = &[
    Scene {
        what: "A dangling name",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"white\", \"type\": \"mirror\"}],\n \"surfaces\": [{\"type\": \
               \"quad\", \"material\": «\"whit\"}]}",
        messages: &["/surfaces/0/material: no material is named \"whit\"; did you mean \"white\"? known: white"],
    },
    Scene {
        what: "A duplicate name",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"m\", \"type\": \"mirror\"},\n  {\"name\": «\"m\", \"type\": \"null\"}]}",
        messages: &["/materials/1/name: duplicate material name \"m\"; names must differ"],
    },
    Scene {
        what: "A cyclic name (only groups could make one)",
        text: "{\"camera\": {}, \"surfaces\": [{\"type\": «\"group\", \"name\": \"a\",\n  \"surfaces\": [{\"type\": \
               \"instance\", \"name\": \"a\"}]}]}",
        messages: &[
            "/surfaces/0/type: surface type \"group\" is not supported yet; supported: quad, sphere, disk, triangle, \
             mesh, delta point",
        ],
    },
    Scene {
        what: "An unknown type",
        text: r#"{"camera": {}, "materials": [{"name": "m", "type": «"lambertain", "albedo": 1}]}"#,
        messages: &[
            "/materials/0/type: unknown material type \"lambertain\"; did you mean \"lambertian\"? allowed: lambertian, \
             mirror, metal, dielectric, diffuse light, point light, spot light, null, conductor, plastic, thin dielectric, phong, \
             blinnphong, beckmann, oren-nayar, blend",
        ],
    },
    Scene {
        what: "An unknown type hides no other mistake",
        text: "{\"camera\": {}, \"surfaces\": [\n  {\"type\": «\"spher\", \"radius\": «-1, \"material\": «\"white\"},\n  \
               «{\"type\": «\"teapot\", \"transform\": «{\"scale\": 0}, «\"sise\": 2}]}",
        messages: &[
            "/surfaces/0/type: unknown surface type \"spher\"; did you mean \"sphere\"? allowed: quad, sphere, disk, \
             triangle, mesh, delta point",
            "/surfaces/0/radius: -1 is out of range; allowed: above 0",
            "/surfaces/0/material: no material is named \"white\"; there are no named materials",
            "/surfaces/1: \"material\" is missing",
            "/surfaces/1/type: unknown surface type \"teapot\"; allowed: quad, sphere, disk, triangle, mesh, delta point",
            "/surfaces/1/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
            "/surfaces/1/sise: unknown key \"sise\"; did you mean \"size\"? allowed: type, transform, material, \
             flip_normals, size, radius, filename, positions, indices, normals, uvs, opacity, \
             normal_map, bump_map",
        ],
    },
];

const CAMERA: &[Scene] = &[
    Scene {
        what: "A size of zero",
        text: r#"{"camera": {"resolution": [64, «0]}}"#,
        messages: &["/camera/resolution/1: 0 is out of range; allowed: whole numbers from 1 to 65536"],
    },
    Scene {
        what: "An absurd size",
        text: r#"{"camera": {"resolution": [«100000, 64]}}"#,
        messages: &["/camera/resolution/0: 100000 is out of range; allowed: whole numbers from 1 to 65536"],
    },
    Scene {
        what: "An absurd area",
        text: r#"{"camera": {"resolution": «[65536, 65536]}}"#,
        messages: &["/camera/resolution: 65536 × 65536 pixels are too many; allowed: 268435456 in all"],
    },
    Scene {
        what: "No field of view",
        text: r#"{"camera": {"vfov": «0}}"#,
        messages: &["/camera/vfov: 0 is out of range; allowed: between 0 and 180 degrees"],
    },
    Scene {
        what: "A field of view of a half space or more",
        text: r#"{"camera": {"vfov": «180}}"#,
        messages: &["/camera/vfov: 180 is out of range; allowed: between 0 and 180 degrees"],
    },
    Scene {
        what: "The eye in the target",
        text: r#"{"camera": {"transform": «{"from": [1, 2, 3], "at": [1, 2, 3]}}}"#,
        messages: &["/camera/transform: \"from\" and \"at\" are the same point [1, 2, 3]; they must differ"],
    },
    Scene {
        what: "Up along the view",
        text: r#"{"camera": {"transform": {"from": [0, 5, 0], "at": 0, "up": «[0, 2, 0]}}}"#,
        messages: &["/camera/transform/up: \"up\" [0, 2, 0] is parallel to the view [0, -5, 0]; it must not be"],
    },
    Scene {
        what: "The same by the default up, y",
        text: r#"{"camera": {"transform": «{"from": [0, 5, 0], "at": 0}}}"#,
        messages: &["/camera/transform: \"up\" [0, 1, 0] is parallel to the view [0, -5, 0]; it must not be"],
    },
    Scene {
        what: "A singular transform",
        text: r#"{"camera": {"transform": [{"translate": 1}, «{"scale": [1, 0, 1]}]}}"#,
        messages: &[
            "/camera/transform/1: the transform is singular: it flattens space; allowed: matrices with an inverse",
        ],
    },
    Scene {
        what: "A transform that is not finite",
        text: r#"{"camera": {"transform": «[{"scale": 1e200}, {"scale": 1e200}]}}"#,
        messages: &["/camera/transform: the transform overflows; allowed: finite matrices"],
    },
    Scene {
        what: "A camera that shears",
        text: r#"{"camera": «{"transform": {"x": [1, 0, 0], "y": [1, 1, 0]}}}"#,
        messages: &[
            "/camera: the camera's transform shears: its axes must stay at right angles; use from/at/up, a rotation, a \
             translation or a scale",
        ],
    },
    Scene {
        what: "A film that does not suit the scene",
        text: r#"{"camera": «{"type": "orthographic", "height": 1e20}, "surfaces": [{"type": "quad", "material": {"type": "mirror"}}]}"#,
        messages: &[
            "/camera: the camera's height 100000000000000000000 does not suit the size of the scene; allowed: 1e-6 to \
             1e6",
        ],
    },
    Scene {
        what: "A filter that is too wide",
        text: r#"{"camera": {"filter": {"type": "tent", "radius": «200}}}"#,
        messages: &["/camera/filter/radius: 200 is out of range; allowed: 0.01 to 100 pixels"],
    },
    Scene {
        what: "No samples",
        text: r#"{"camera": {}, "image_samples": «0}"#,
        messages: &["/image_samples: 0 is out of range; allowed: whole numbers from 1 to 4294967295"],
    },
    Scene {
        what: "Part of a sample",
        text: r#"{"camera": {}, "sampler": {"samples": «1.5}}"#,
        messages: &["/sampler/samples: 1.5 is out of range; allowed: whole numbers from 1 to 4294967295"],
    },
];

const LIGHTS: &[Scene] = &[
    Scene {
        what: "Negative emission",
        text: r#"{"camera": {}, "lights": [{"type": "point", "position": 0, "intensity": [1, «-2, 1]}]}"#,
        messages: &["/lights/0/intensity/1: -2 is out of range; allowed: 0 to 3.4e38"],
    },
    Scene {
        what: "A spot that aims nowhere",
        text: "{\"camera\": {}, \"lights\": [{\"type\": \"spot\", \"position\": [1, 2, 3], \"at\": «[1, 2, 3],\n  \
               \"intensity\": 1, \"inner_angle\": 10, \"outer_angle\": 20}]}",
        messages: &["/lights/0/at: the spot's axis has length 0: [1, 2, 3] gives it no direction"],
    },
    Scene {
        what: "A spot's inner cone outside its outer one",
        text: "{\"camera\": {}, \"lights\": [{\"type\": \"spot\", \"position\": 0, \"direction\": 1,\n  \
               \"intensity\": 1, \"inner_angle\": «30, \"outer_angle\": 20}]}",
        messages: &["/lights/0/inner_angle: inner_angle 30 exceeds outer_angle 20; allowed: at most as large"],
    },
    Scene {
        what: "A spot's profile that there is not, and one that takes no exponent",
        text: "{\"camera\": {}, \"lights\": [\n  {\"type\": \"spot\", \"position\": 0, \"direction\": 1, \
               \"intensity\": 1,\n   \"inner_angle\": 10, \"outer_angle\": 20, \"profile\": «\"linear\"},\n  \
               {\"type\": \"spot\", \"position\": 0, \"direction\": 1, \"intensity\": 1,\n   \"inner_angle\": 10, \
               \"outer_angle\": 20, \"profile\": \"angle\", \"falloff\": «2}]}",
        messages: &[
            "/lights/0/profile: unknown spot profile \"linear\"; allowed: cosine, angle",
            "/lights/1/falloff: the spot profile \"angle\" falls linearly and takes no \"falloff\"; leave it out, or \
             choose the profile \"cosine\"",
        ],
    },
    Scene {
        what: "An albedo above 1",
        text: r#"{"camera": {}, "materials": [{"name": "m", "type": "lambertian", "albedo": «1.01}]}"#,
        messages: &["/materials/0/albedo: 1.01 is out of range; allowed: 0 to 1"],
    },
    Scene {
        what: "An index of refraction of zero",
        text: r#"{"camera": {}, "materials": [{"name": "m", "type": "dielectric", "ior": «0}]}"#,
        messages: &["/materials/0/ior: 0 is out of range; allowed: 0.001 to 1000"],
    },
    Scene {
        what: "A light's material without a delta point",
        text: r#"{"camera": {}, "surfaces": [{"type": "quad", "material": «{"type": "point light", "emit": 1}}]}"#,
        messages: &[
            "/surfaces/0/material: a \"point light\" material has no place on a \"quad\"; allowed: on a \"delta point\"",
        ],
    },
    Scene {
        what: "A surface carried too far away",
        text: "{\"camera\": {}, \"surfaces\": [\n  «{\"type\": \"quad\", \"transform\": {\"translate\": [1e31, 0, 0]}, \
               \"material\": {\"type\": \"mirror\"}}]}",
        messages: &[
            "/surfaces/0: the transform carries a point to [10000000000000000000000000000000, -0.5, 0]: coordinates must \
             stay below 1e30",
        ],
    },
];

const MESHES: &[Scene] = &[
    Scene {
        what: "A file that is not there",
        text: r#"{"camera": {}, "surfaces": [{"type": "mesh", "filename": «"none.obj", "material": {"type": "mirror"}}]}"#,
        messages: &["/surfaces/0/filename: cannot read none.obj: No such file or directory (os error 2)"],
    },
    Scene {
        what: "A file of another format",
        text: r#"{"camera": {}, "surfaces": [{"type": "mesh", "filename": «"a.stl", "material": {"type": "mirror"}}]}"#,
        messages: &["/surfaces/0/filename: \"a.stl\" is no mesh format; allowed: .obj, .ply, .obj.gz, .ply.gz"],
    },
    Scene {
        what: "An index out of range",
        text: "{\"camera\": {}, \"surfaces\": [{\"type\": \"mesh\", \"material\": {\"type\": \"mirror\"},\n  \
               \"positions\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], \"indices\": [[0, 1, «3]]}]}",
        messages: &["/surfaces/0/indices/0/2: 3 is out of range; allowed: whole numbers from 0 to 2"],
    },
    Scene {
        what: "A position that is not finite",
        text: r#"{"camera": {}, "surfaces": [{"type": "triangle", "positions": [0, 1, [0, «1e39, 0]], "material": {"type": "mirror"}}]}"#,
        messages: &["/surfaces/0/positions/2/1: 1e39 is out of range; allowed: -3.4e38 to 3.4e38 (32-bit floats)"],
    },
];

impl Scene {
    /// The text as the program reads it, and what it must say, whole.
    pub fn unmarked(&self) -> (String, String) {
        let (mut text, mut places, mut here) = (String::new(), Vec::new(), (1, 1));
        let written_out = self.text.replace("[128×[]", &"[".repeat(128)).replace("[128×]]", &"]".repeat(128));
        for c in written_out.chars() {
            match c {
                '«' => places.push(here),
                '\n' => here = (here.0 + 1, 1),
                _ => here.1 += 1,
            }
            if c != '«' {
                text.push(c);
            }
        }
        assert_eq!(places.len(), self.messages.len(), "{}: marks and messages differ in number", self.what);
        let said = places.iter().zip(self.messages);
        let said = said.map(|((line, column), m)| format!("twinlight: scene.json:{line}:{column}: {m}\n")).collect();
        (text, said)
    }
}

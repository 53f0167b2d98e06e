//! What users get wrong, and what they are told: the tables behind `docs/ERRORS.md`.
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

/// A command line, after `twinlight render`, with a mistake in it.
pub struct Arguments {
    /// In words.
    pub what: &'static str,
    /// The arguments, separated by spaces.
    pub arguments: &'static str,
    /// The exit status.
    pub status: i32,
    /// The first paragraph of what is said.
    pub message: &'static str,
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
             mirror, metal, dielectric, diffuse light, point light, spot light, null",
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

/// What is wrong with the command line itself. `scene.json` is right.
pub const ARGUMENTS: [Arguments; 25] = [
    Arguments {
        what: "A scene that is not there",
        arguments: "none.json",
        status: 1,
        message: "twinlight: none.json: cannot read the scene file: No such file or directory (os error 2)",
    },
    Arguments {
        what: "No scene",
        arguments: "--spp 4",
        status: 2,
        message: "error: the following required arguments were not provided:\n  <SCENE>",
    },
    Arguments {
        what: "An unknown option",
        arguments: "scene.json --sp 4",
        status: 2,
        message: "error: unexpected argument '--sp' found",
    },
    Arguments {
        what: "No samples",
        arguments: "scene.json --spp 0",
        status: 2,
        message: "error: invalid value '0' for '--spp <N>': 0 is not in 1..=4294967295",
    },
    Arguments {
        what: "A size of zero",
        arguments: "scene.json --size 0x64",
        status: 2,
        message: "error: invalid value '0x64' for '--size <WxH>': each side must be 1 to 65536 pixels, the area at most \
                  268435456",
    },
    Arguments {
        what: "An absurd size",
        arguments: "scene.json --size 65536x65536",
        status: 2,
        message: "error: invalid value '65536x65536' for '--size <WxH>': each side must be 1 to 65536 pixels, the area \
                  at most 268435456",
    },
    Arguments {
        what: "Half a size",
        arguments: "scene.json --size 64",
        status: 2,
        message: "error: invalid value '64' for '--size <WxH>': write it as 640x480",
    },
    Arguments {
        what: "An empty crop",
        arguments: "scene.json --crop 4,4,4,8",
        status: 2,
        message: "error: invalid value '4,4,4,8' for '--crop <x0,y0,x1,y1>': no pixel lies in columns 4..4 and rows 4..8: \
                  the ends are exclusive and must come after the starts",
    },
    Arguments {
        what: "A crop outside the image",
        arguments: "scene.json --crop 0,0,9,8",
        status: 2,
        message: "twinlight: --crop 0,0,9,8 reaches outside the image: it is 8 × 8 pixels, the ends of a crop are exclusive",
    },
    Arguments {
        what: "A crop of three numbers",
        arguments: "scene.json --crop 0,0,8",
        status: 2,
        message: "error: invalid value '0,0,8' for '--crop <x0,y0,x1,y1>': write it as x0,y0,x1,y1 in pixels, for \
                  example 0,0,64,64",
    },
    Arguments {
        what: "No threads",
        arguments: "scene.json --threads 0",
        status: 2,
        message: "error: invalid value '0' for '--threads <N>': 0 is not in 1..=4096",
    },
    Arguments {
        what: "A negative seed",
        arguments: "scene.json --seed=-1",
        status: 2,
        message: "error: invalid value '-1' for '--seed <N>': write it as a whole number from 0 to 18446744073709551615",
    },
    Arguments {
        what: "An unknown integrator",
        arguments: "scene.json --integrator bpdt",
        status: 2,
        message: "error: invalid value 'bpdt' for '--integrator <X>'\n  [possible values: auto, bdpt, path, light]",
    },
    Arguments {
        what: "An exposure that is no number",
        arguments: "scene.json --exposure nan",
        status: 2,
        message: "error: invalid value 'nan' for '--exposure <STOPS>': write it as a number of stops from -100 to 100, \
                  for example 1.5",
    },
    Arguments {
        what: "A light tracer without light subpaths",
        arguments: "scene.json --integrator light --light-paths 0",
        status: 2,
        message: "twinlight: --light-paths 0 leaves the light tracer nothing to do: give at least 1",
    },
    Arguments {
        what: "A technique that the integrator has not",
        arguments: "scene.json --integrator path --technique 2,2",
        status: 2,
        message: "twinlight: --technique 2,2: the path integrator has no such technique; use bdpt",
    },
    Arguments {
        what: "A technique of too long paths",
        arguments: "scene.json --technique 3,3 --max-bounces 2",
        status: 2,
        message: "twinlight: --technique 3,3: its paths scatter 4 times and max_bounces is 2; give --max-bounces 4 or more",
    },
    Arguments {
        what: "An output of no known format",
        arguments: "scene.json -o image.jpg",
        status: 2,
        message: "twinlight: cannot write `image.jpg`: the extension `.jpg` names no known format; use `.exr` (linear) or \
                  `.png` (sRGB)",
    },
    Arguments {
        what: "An output in no folder",
        arguments: "scene.json -o none/image.exr",
        status: 2,
        message: "twinlight: cannot write `none/image.exr`: the folder `none` cannot be entered (No such file or \
                  directory (os error 2)); create it first",
    },
    Arguments {
        what: "An output in a file's place",
        arguments: "scene.json -o old.exr/image.exr",
        status: 2,
        message: "twinlight: cannot write `old.exr/image.exr`: `old.exr` is not a folder; choose another place",
    },
    Arguments {
        what: "An output in a folder's place",
        arguments: "scene.json -o folder.exr",
        status: 2,
        message: "twinlight: cannot write `folder.exr`: it is a folder; give a file's name inside it",
    },
    Arguments {
        what: "The scene as an output",
        arguments: "scene.json --stats ./scene.json",
        status: 2,
        message: "twinlight: ./scene.json: this is the scene itself; choose another name",
    },
    Arguments {
        what: "Two outputs of one name",
        arguments: "scene.json -o image.exr --stats ./image.exr",
        status: 2,
        message: "twinlight: ./image.exr: two outputs would be written to this file; choose another name",
    },
    Arguments {
        what: "Statistics in no folder",
        arguments: "scene.json --stats none/stats.json",
        status: 2,
        message: "twinlight: cannot write `none/stats.json`: the folder `none` cannot be entered (No such file or \
                  directory (os error 2)); create it first",
    },
    Arguments {
        what: "A pyramid in a file's place",
        arguments: "scene.json --pyramid old.exr",
        status: 2,
        message: "twinlight: --pyramid: cannot write `old.exr/s0_t2.exr`: `old.exr` is not a folder; choose another place",
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

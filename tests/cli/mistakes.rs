//! What users get wrong in a scene as a whole, and what they are told: tables behind `docs/ERRORS.md`, with those of
//! `mistakes_in_parts.rs`, `assets.rs`, `arguments.rs` and `notes.rs`.
//!
//! In a scene `«` marks the place that the message must name (it is taken out before reading), so that line and column
//! are checked without counting. A place is the file, line, column and JSON pointer.

use super::mistakes_in_parts::{LIGHTS, MATERIALS, MESHES, SURFACES, TRANSFORMS};

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
pub const SCENES: [(&str, &[Scene]); 9] = [
    ("JSON", JSON),
    ("Names", NAMES),
    ("Words of other renderers", FOREIGN),
    ("Camera and sampling", CAMERA),
    ("Transforms", TRANSFORMS),
    ("Lights", LIGHTS),
    ("Materials and textures", MATERIALS),
    ("Surfaces", SURFACES),
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
        text: "{\"camera\": {\"vfov\": 40«,\n}}",
        messages: &["invalid JSON: trailing comma before `}`; delete it"],
    },
    Scene {
        what: "A comma too many in an array",
        text: r#"{"camera": {"resolution": [64, 48«, ]}}"#,
        messages: &["invalid JSON: trailing comma before `]`; delete it"],
    },
    Scene {
        what: "A comma too few",
        text: "{\"camera\": {}\n «\"surfaces\": []}",
        messages: &["invalid JSON: expected `,` or `}`, found `\"surfaces\":`"],
    },
    Scene {
        what: "What is no number in JSON",
        text: r#"{"camera": {"vfov": «NaN}}"#,
        messages: &["invalid JSON: expected value, found `NaN`; JSON has finite numbers only"],
    },
    Scene {
        what: "An infinite number",
        text: r#"{"camera": {"vfov": «Infinity}}"#,
        messages: &["invalid JSON: expected value, found `Infinity`; JSON has finite numbers only"],
    },
    Scene {
        what: "Single quotes",
        text: "{\"camera\": {«'vfov': 40}}",
        messages: &[
            "invalid JSON: key must be a string, found `'vfov':`; JSON's keys and strings take double quotes (\")",
        ],
    },
    Scene {
        what: "A byte order mark",
        text: "«\u{feff}{\"camera\": {}}",
        messages: &["the file starts with a byte order mark, which JSON does not allow: save it as UTF-8 without"],
    },
    Scene {
        what: "A comment",
        text: "{\"camera\": {} «// the default\n}",
        messages: &["invalid JSON: expected `,` or `}`, found `//`; JSON has no comments: delete it"],
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
    Scene {
        what: "No object", text: "«[]", messages: &["expected an object with a \"camera\", found an empty array"]
    },
    Scene {
        what: "No camera",
        text: "«{}",
        messages: &[
            "\"camera\" is missing; for example \"camera\": {\"transform\": {\"from\": [0, 1, 5], \"at\": [0, 0, 0], \"up\": [0, 1, 0]}, \"vfov\": 40}",
        ],
    },
    Scene {
        what: "A key that is no text",
        text: r#"{"camera": {«"\ud800": 1}}"#,
        messages: &["/camera: the key \"\\ud800\" is not a valid string"],
    },
    Scene {
        what: "A word that is no text",
        text: r#"{"camera": {}, "integrator": «"\ud800"}"#,
        messages: &["/integrator: \"\\ud800\" holds an invalid escape"],
    },
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
        what: "No arrays where there must be some",
        text: "{\"camera\": {\"transform\": «3}, \"integrator\": «3, \"textures\": «{}, \"materials\": «{}, \"surfaces\": «{}, \
               \"lights\": «3, \"media\": «3}",
        messages: &[
            "/camera/transform: expected an object or an array of objects, found the number 3",
            "/integrator: expected an object or a string, found the number 3",
            "/textures: expected an array of textures, found an object",
            "/materials: expected an array of materials, found an object",
            "/surfaces: expected an array of surfaces, found an object",
            "/lights: expected an array of lights, found the number 3",
            "/media: expected an array, found the number 3",
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
        what: "A texture within itself, and one that is written below (so that none can be cyclic)",
        text: "{\"camera\": {}, \"textures\": [\n  {\"name\": \"a\", \"type\": \"checker\", \"even\": «\"a\", \"odd\": «\"b\"},\n  \
               {\"name\": \"b\", \"type\": \"checker\", \"even\": \"a\", \"odd\": 0}]}",
        messages: &[
            "/textures/0/even: no texture is named \"a\"; there are no named textures here",
            "/textures/0/odd: the texture \"b\" is defined below, on line 3; move it before what is made of it",
        ],
    },
    Scene {
        what: "A material used before it is defined",
        text: "{\"camera\": {}, \"materials\": [\n  {\"name\": \"m\", \"type\": \"blend\", \"a\": «\"white\", \"b\": «\"white\", \"amount\": 0.5},\n  {\"name\": \"white\", \"type\": \"lambertian\", \"albedo\": 1}]}",
        messages: &[
            "/materials/0/a: the material \"white\" is defined below, on line 3; move it before what is made of it",
            "/materials/0/b: the material \"white\" is defined below, on line 3; move it before what is made of it",
        ],
    },
    Scene {
        what: "A material within itself",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"white\", \"type\": \"mirror\"},\n  {\"name\": \"m\", \"type\": \
               \"blend\", \"a\": \"white\", \"b\": «\"m\", \"amount\": 0.5}]}",
        messages: &["/materials/1/b: no material is named \"m\"; known: white"],
    },
    Scene {
        what: "A duplicate texture",
        text: "{\"camera\": {}, \"textures\": [{\"name\": \"t\", \"type\": \"constant\", \"color\": 1},\n  {\"name\": «\"t\", \
               \"type\": \"constant\", \"color\": 0}]}",
        messages: &["/textures/1/name: duplicate texture name \"t\"; names must differ"],
    },
    Scene {
        what: "A material without a name",
        text: r#"{"camera": {}, "materials": [«{"type": "mirror"}]}"#,
        messages: &["/materials/0: \"name\" is missing"],
    },
    Scene {
        what: "A number for a material",
        text: r#"{"camera": {}, "surfaces": [{"type": "quad", "material": «7}]}"#,
        messages: &["/surfaces/0/material: expected the name of a material or a material object, found the number 7"],
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

/// Only those that a reader of this page would look for; the others are in the table of `import/synonyms.rs`.
const FOREIGN: &[Scene] = &[
    Scene {
        what: "Of a material",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"m\", \"type\": «\"matte\", «\"reflectance\": 0.5, «\"emission\": 1}]}",
        messages: &[
            "/materials/0/type: unknown material type \"matte\"; did you mean \"lambertian\"? allowed: lambertian, mirror, \
             metal, dielectric, diffuse light, point light, spot light, null, conductor, plastic, thin dielectric, phong, \
             blinnphong, beckmann, oren-nayar, blend",
            "/materials/0/reflectance: unknown key \"reflectance\"; did you mean \"albedo\"? allowed: type, name, albedo, \
             two_sided, emit, emit_two_sided",
            "/materials/0/emission: unknown key \"emission\"; did you mean \"emit\"? allowed: type, name, albedo, two_sided, \
             emit, emit_two_sided",
        ],
    },
    Scene {
        what: "Of a camera",
        text: r#"{"camera": {«"fov": 40, «"look_at": [0, 0, 0]}}"#,
        messages: &[
            "/camera/fov: unknown key \"fov\"; did you mean \"vfov\"? allowed: type, transform, resolution, vfov, fdist, \
             aperture, filter",
            "/camera/look_at: unknown key \"look_at\"; did you mean \"transform\"? allowed: type, transform, resolution, vfov, \
             fdist, aperture, filter",
        ],
    },
    Scene {
        what: "Of a surface",
        text: r#"{"camera": {}, "surfaces": [{"type": «"rectangle", «"to_world": {"scale": 2}, «"bsdf": {"type": "mirror"}}]}"#,
        messages: &[
            "/surfaces/0/type: unknown surface type \"rectangle\"; did you mean \"quad\"? allowed: quad, sphere, disk, triangle, \
             mesh, delta point",
            "/surfaces/0/to_world: unknown key \"to_world\"; did you mean \"transform\"? allowed: type, transform, material, \
             flip_normals, size, opacity, normal_map, bump_map",
            "/surfaces/0/bsdf: unknown key \"bsdf\"; did you mean \"material\"? allowed: type, transform, material, flip_normals, \
             size, opacity, normal_map, bump_map",
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
        what: "An unknown camera",
        text: r#"{"camera": {"type": «"fisheye"}}"#,
        messages: &["/camera/type: unknown camera type \"fisheye\"; allowed: perspective, orthographic"],
    },
    Scene {
        what: "A parallel camera without its height",
        text: r#"{"camera": «{"type": "orthographic"}}"#,
        messages: &["/camera: \"height\" is missing"],
    },
    Scene {
        what: "A negative lens, focused on itself",
        text: r#"{"camera": {"aperture": «-0.1, "fdist": «0}}"#,
        messages: &[
            "/camera/aperture: -0.1 is out of range; allowed: 0 or above",
            "/camera/fdist: 0 is out of range; allowed: above 0",
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
    Scene {
        what: "An unknown filter, sampler, integrator and heuristic",
        text: "{\"camera\": {\"filter\": {\"type\": «\"mitchell\"}},\n  \"sampler\": {\"type\": «\"poisson\"},\n  \"integrator\": \
               {\"type\": «\"bpdt\", \"heuristic\": «\"max\", \"max_bounces\": «-1, \"russian_roulette\": «1}}",
        messages: &[
            "/camera/filter/type: unknown filter \"mitchell\"; allowed: box, tent, gaussian",
            "/sampler/type: unknown sampler \"poisson\"; allowed: sobol, independent, stratified, halton",
            "/integrator/type: unknown integrator \"bpdt\"; did you mean \"bdpt\"? allowed: auto, bdpt, path, light, \
             path_tracer_mis, path_tracer_nee, path_tracer_mats, path_tracer_mixture, path_tracer_simple",
            "/integrator/heuristic: unknown heuristic \"max\"; allowed: power, balance, uniform",
            "/integrator/max_bounces: -1 is out of range; allowed: whole numbers from 0 to 1000000",
            "/integrator/russian_roulette: expected true or false, found the number 1",
        ],
    },
    Scene {
        what: "An integrator that is an auxiliary image here",
        text: r#"{"camera": {}, "integrator": «"normals"}"#,
        messages: &[
            "/integrator: \"normals\" is no integrator here: auxiliary images (AOVs), such as the shading normal, come beside \
             the picture (--aovs); allowed: auto, bdpt, path, light, path_tracer_mis, path_tracer_nee, path_tracer_mats, \
             path_tracer_mixture, path_tracer_simple",
        ],
    },
];

impl Scene {
    /// The text as the program reads it, and what it must say, whole.
    pub fn unmarked(&self) -> (String, String) {
        let (text, places) = marked(self.text);
        assert_eq!(places.len(), self.messages.len(), "{}: marks and messages differ in number", self.what);
        let said = places.iter().zip(self.messages);
        let said = said.map(|((line, column), m)| format!("twinlight: scene.json:{line}:{column}: {m}\n")).collect();
        (text, said)
    }
}

/// A text without its marks, and their lines and columns.
pub fn marked(text: &str) -> (String, Vec<(usize, usize)>) {
    let (mut out, mut places, mut here) = (String::new(), Vec::new(), (1, 1));
    let written_out = text.replace("[128×[]", &"[".repeat(128)).replace("[128×]]", &"]".repeat(128));
    for c in written_out.chars() {
        match c {
            '«' => places.push(here),
            '\n' => here = (here.0 + 1, 1),
            _ => here.1 += 1,
        }
        if c != '«' {
            out.push(c);
        }
    }
    (out, places)
}

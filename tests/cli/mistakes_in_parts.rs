//! What users get wrong in lights, materials, surfaces and meshes: more tables behind `docs/ERRORS.md`, as
//! `mistakes.rs` says.

use super::mistakes::Scene;

pub const LIGHTS: &[Scene] = &[
    Scene {
        what: "Negative emission",
        text: r#"{"camera": {}, "lights": [{"type": "point", "position": 0, "intensity": [1, «-2, 1]}]}"#,
        messages: &["/lights/0/intensity/1: -2 is out of range; allowed: 0 to 3.4e38"],
    },
    Scene {
        what: "A spot that aims nowhere",
        text: "{\"camera\": {}, \"lights\": [{\"type\": \"spot\", \"position\": [1, 2, 3], \"at\": «[1, 2, 3],\n  \
               \"intensity\": 1, \"inner_angle\": 10, \"outer_angle\": 20}]}",
        messages: &["/lights/0/at: \"at\" [1, 2, 3] is the spot's own position: it points nowhere; they must differ"],
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
        what: "Emission that is not finite",
        text: "{\"camera\": {}, \"lights\": [{\"type\": \"point\", \"position\": 0, \"intensity\": [0, «1e39, «1e999]},\n  {\"type\": \
               \"constant\", \"radiance\": «-1e999}]}",
        messages: &[
            "/lights/0/intensity/1: 1e39 is out of range; allowed: 0 to 3.4e38",
            "/lights/0/intensity/2: 1e999 is not a finite 64-bit number; allowed: 0 to 3.4e38",
            "/lights/1/radiance: -1e999 is not a finite 64-bit number; allowed: 0 to 3.4e38",
        ],
    },
    Scene {
        what: "A light too bright for its size",
        text: "{\"camera\": {}, \"surfaces\": [\n  «{\"type\": \"quad\", \"size\": 2, \"material\": {\"type\": \"diffuse light\", \
               \"emit\": 3e38}}]}",
        messages: &[
            "/surfaces/0: the light is too bright: its power exceeds 3e38 in render space (the scene scaled to about unit \
             size); lower its emission",
        ],
    },
    Scene {
        what: "A direction of length 0",
        text: "{\"camera\": {}, \"lights\": [{\"type\": \"directional\", \"direction\": «[0, 0, 0], \"irradiance\": 1},\n  {\"type\": \
               \"spot\", \"position\": 0, \"direction\": «0, \"intensity\": 1, \"inner_angle\": 10, \"outer_angle\": 20}]}",
        messages: &[
            "/lights/0/direction: the direction [0, 0, 0] has length 0: it points nowhere; it must not be zero",
            "/lights/1/direction: the direction 0 has length 0: it points nowhere; it must not be zero",
        ],
    },
    Scene {
        what: "A spot that aims twice, and one that does not aim",
        text: "{\"camera\": {}, \"lights\": [\n  {\"type\": \"spot\", \"position\": 0, \"at\": «1, \"direction\": 1, \
               \"intensity\": 1, \"inner_angle\": 10, \"outer_angle\": 20},\n  «{\"type\": \"spot\", \"position\": 0, \"intensity\": 1, \
               \"inner_angle\": 10, \"outer_angle\": «181}]}",
        messages: &[
            "/lights/0/at: \"at\" and \"direction\" both aim the spot; give one of them",
            "/lights/1: \"at\" or \"direction\" is missing: the spot aims nowhere",
            "/lights/1/outer_angle: 181 is out of range; allowed: 0 to 180 degrees",
        ],
    },
    Scene {
        what: "A texture where none can stand",
        text: r#"{"camera": {}, "lights": [{"type": "constant", "radiance": «"sky.exr"}]}"#,
        messages: &["/lights/0/radiance: no texture can stand here; allowed: a number or an array of numbers"],
    },
    Scene {
        what: "A sky that is not only turned",
        text: "{\"camera\": {}, \"lights\": [\n  «{\"type\": \"environment\", \"transform\": «{\"scale\": 2}},\n  «{\"type\": \
               \"environment\", \"transform\": «{\"translate\": [0, 1, 0]}}]}",
        messages: &[
            "/lights/0: \"filename\" is missing",
            "/lights/0/transform: the transform scales, shears or mirrors: what is infinitely far away can only be turned; \
             allowed: rotations ({\"rotate\": [degrees, x, y, z]}, say)",
            "/lights/1: \"filename\" is missing",
            "/lights/1/transform: the transform moves: what is infinitely far away can only be turned; allowed: rotations \
             ({\"rotate\": [degrees, x, y, z]}, say)",
        ],
    },
];

pub const MATERIALS: &[Scene] = &[
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
        what: "A negative roughness, α, and one above 1",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"m\", \"type\": \"conductor\", \"albedo\": 1, \"roughness\": [«-0.1, \
               0.1]},\n  {\"name\": \"n\", \"type\": \"plastic\", \"albedo\": 1, \"roughness\": «1.5}]}",
        messages: &[
            "/materials/0/roughness/0: -0.1 is out of range; allowed: 0 to 1",
            "/materials/1/roughness: 1.5 is out of range; allowed: 0 to 1",
        ],
    },
    Scene {
        what: "Other numbers out of range",
        text: "{\"camera\": {}, \"materials\": [\n  {\"name\": \"a\", \"type\": \"plastic\", \"albedo\": 1, \"ior\": «0.9},\n  {\"name\": \
               \"b\", \"type\": \"conductor\", \"eta\": «0, \"k\": «-1},\n  {\"name\": \"c\", \"type\": \"oren-nayar\", \"albedo\": 1, \
               \"sigma\": «20},\n  {\"name\": \"d\", \"type\": \"phong\", \"albedo\": 1, \"exponent\": «-1},\n  {\"name\": \"e\", \"type\": \
               \"spot light\", \"emit\": 1, \"inner_angle\": 10, \"outer_angle\": 20, \"falloff\": «-1}]}",
        messages: &[
            "/materials/0/ior: 0.9 is out of range; allowed: 1 to 1000",
            "/materials/1/eta: 0 is out of range; allowed: 0.001 to 1000",
            "/materials/1/k: -1 is out of range; allowed: 0 to 1000",
            "/materials/2/sigma: 20 is out of range; allowed: 0 to 1.5 radians",
            "/materials/3/exponent: -1 is out of range; allowed: 0 to 1000000",
            "/materials/4/falloff: -1 is out of range; allowed: 0 to 10000",
        ],
    },
    Scene {
        what: "A conductor that is told twice what it reflects, and one that is not",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"m\", \"type\": \"conductor\", \"eta\": 1, \"k\": 3, \"albedo\": «1},\n  \
               «{\"name\": \"n\", \"type\": \"conductor\"}]}",
        messages: &[
            "/materials/0/albedo: \"albedo\" has no place beside \"eta\" and \"k\": they say what is reflected",
            "/materials/1: \"albedo\", or \"eta\" and \"k\", is missing",
        ],
    },
    Scene {
        what: "A window that shines",
        text: r#"{"camera": {}, "materials": [{"name": "m", "type": "null", "emit": «1}]}"#,
        messages: &[
            "/materials/0/emit: a \"null\" surface cannot emit: it is not there; give the light a surface of its own",
        ],
    },
    Scene {
        what: "Parts that no blend can have",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"lamp\", \"type\": \"diffuse light\", \"emit\": 1}, {\"name\": \"hole\", \
               \"type\": \"null\"},\n  {\"name\": \"a\", \"type\": \"blend\", \"a\": «\"lamp\", \"b\": «{\"type\": \"point light\", \
               \"emit\": 1}, \"amount\": «1.5},\n  {\"name\": \"b\", \"type\": \"blend\", \"a\": \"hole\", \"b\": \"hole\", \
               \"amount\": 0.5, \"emit\": «1}]}",
        messages: &[
            "/materials/2/a: a part of a blend cannot emit; give the blend itself an \"emit\"",
            "/materials/2/b: a \"point light\" cannot be part of a blend: it has no surface",
            "/materials/2/amount: 1.5 is out of range; allowed: 0 to 1",
            "/materials/3/emit: a blend with a \"null\" part cannot emit; give the light a surface of its own",
        ],
    },
    Scene {
        what: "A texture out of the range of what it is used for",
        text: "{\"camera\": {}, \"textures\": [{\"name\": \"t\", \"type\": \"checker\", \"even\": [0, 0.5, «1.5], \"odd\": 0}],\n  \
               \"materials\": [{\"name\": \"m\", \"type\": \"lambertian\", \"albedo\": \"t\", \"emit\": \"t\"}]}",
        messages: &[
            "/textures/0/even/2: 1.5 is out of range; allowed: 0 to 1 (used by scene.json:2:63: /materials/0/albedo)",
        ],
    },
    Scene {
        what: "Mistakes in textures",
        text: "{\"camera\": {}, \"textures\": [\n  {\"name\": \"a\", \"type\": «\"noise\"},\n  «{\"name\": \"b\", \"type\": \"image\", \
               \"scale\": «0, \"wrap\": «\"mirror\", \"filter\": «\"cubic\", \"colorspace\": «\"aces\"},\n  {\"name\": \"c\", \"type\": \
               \"constant\", \"color\": «\"red\"},\n  «{\"name\": \"d\", \"type\": \"checker\", \"odd\": 0}]}",
        messages: &[
            "/textures/0/type: unknown texture type \"noise\"; allowed: constant, checker, marble, image",
            "/textures/1: \"filename\" is missing",
            "/textures/1/scale: 0 is out of range; allowed: above 0",
            "/textures/1/wrap: unknown wrap \"mirror\"; allowed: repeat, clamp",
            "/textures/1/filter: unknown filter \"cubic\"; allowed: nearest, bilinear",
            "/textures/1/colorspace: unknown colorspace \"aces\"; allowed: srgb, linear",
            "/textures/2/color: expected an array of 3 numbers, or one number for all, found the string \"red\"",
            "/textures/3: \"even\" is missing",
        ],
    },
    Scene {
        what: "An image that is not there",
        text: "{\"camera\": {}, \"materials\": [{\"name\": \"m\", \"type\": \"lambertian\",\n  \"albedo\": {\"type\": \"image\", \
               \"filename\": «\"none.png\"}}]}",
        messages: &[
            "/materials/0/albedo/filename: cannot read none.png: No such file or directory (os error 2); check the name and \
             the permissions",
        ],
    },
    Scene {
        what: "A folder for an image",
        text: r#"{"camera": {}, "background": {"type": "image", "filename": «"folder.exr"}}"#,
        messages: &["/background/filename: cannot read folder.exr: it is a folder; give an image file inside it"],
    },
    Scene {
        what: "Integers for numbers that are taken for sRGB colours",
        text: "{\"camera\": {}, \"textures\": [{\"name\": \"t\", \"type\": \"image\", \"filename\": \"image.png\"}],\n  \"surfaces\": \
               [{\"type\": \"quad\", \"material\": {\"type\": \"mirror\"}, \"opacity\": «\"t\"}]}",
        messages: &[
            "/surfaces/0/opacity: the texture \"t\" is an image of integers, taken for sRGB colours; where numbers or normals \
             are asked for, it has to say its \"colorspace\": \"linear\" or \"srgb\"",
        ],
    },
];

pub const SURFACES: &[Scene] = &[
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
    Scene {
        what: "A point of what has no light",
        text: r#"{"camera": {}, "surfaces": [{"type": "delta point", "material": «{"type": "mirror"}}]}"#,
        messages: &[
            "/surfaces/0/material: a \"delta point\" cannot be \"mirror\": it has no area; allowed: \"point light\", \"spot \
             light\"",
        ],
    },
    Scene {
        what: "A length too small for 32 bits",
        text: r#"{"camera": {}, "surfaces": [{"type": "sphere", "radius": «1e-46, "material": {"type": "mirror"}}]}"#,
        messages: &["/surfaces/0/radius: 1e-46 is 0 as a 32-bit float; allowed: 1e-45 or more"],
    },
    Scene {
        what: "Sizes of zero or less",
        text: "{\"camera\": {}, \"surfaces\": [{\"type\": \"quad\", \"size\": [1, «0], \"material\": {\"type\": \"mirror\"}},\n  \
               {\"type\": \"sphere\", \"radius\": «-2, \"material\": {\"type\": \"mirror\"}, \"flip_normals\": «\"yes\"}]}",
        messages: &[
            "/surfaces/0/size/1: 0 is out of range; allowed: above 0",
            "/surfaces/1/radius: -2 is out of range; allowed: above 0",
            "/surfaces/1/flip_normals: expected true or false, found the string \"yes\"",
        ],
    },
    Scene {
        what: "A lamp that is not all there",
        text: "{\"camera\": {}, \"surfaces\": [{\"type\": \"quad\", \"material\": {\"type\": \"diffuse light\", \"emit\": 1},\n  \
               \"opacity\": «0.5}]}",
        messages: &[
            "/surfaces/0/opacity: a surface that shines has to be opaque: a texture as its \"emit\" makes parts of it dark, and \
             another surface can stand where it is cut out; allowed: 1",
        ],
    },
    Scene {
        what: "Two maps of the normal, and one that is no texture",
        text: "{\"camera\": {}, \"textures\": [{\"name\": \"t\", \"type\": \"constant\", \"color\": 0.5}],\n  \"surfaces\": [{\"type\": \
               \"quad\", \"material\": {\"type\": \"mirror\"}, \"normal_map\": \"t\", \"bump_map\": «\"t\"},\n   {\"type\": \"quad\", \
               \"material\": {\"type\": \"mirror\"}, \"bump_map\": «1}]}",
        messages: &[
            "/surfaces/0/bump_map: \"normal_map\" and \"bump_map\" both turn the normal; give one of them",
            "/surfaces/1/bump_map: expected the name of a texture or a texture object, found the number 1",
        ],
    },
    Scene {
        what: "An image over a surface that has no place for it",
        text: "{\"camera\": {}, \"surfaces\": [\n  «{\"type\": \"triangle\", \"positions\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],\n   \
               \"material\": {\"type\": \"mirror\", \"albedo\": {\"type\": \"image\", \"filename\": \"image.png\"}}}]}",
        messages: &[
            "/surfaces/0: an image is laid over this surface, which has no texture coordinates; give its mesh uvs (`vt` in \
             OBJ, `u` and `v` in PLY, \"uvs\" inline), or use a checker or marble texture",
        ],
    },
    Scene {
        what: "A medium",
        text: r#"{"camera": {}, "surfaces": [{"type": "quad", "material": {"type": "mirror"}, «"medium": "fog"}]}"#,
        messages: &[
            "/surfaces/0/medium: \"medium\": participating media are not supported; supported here: type, transform, \
             material, flip_normals, size, opacity, normal_map, bump_map",
        ],
    },
];

pub const MESHES: &[Scene] = &[
    Scene {
        what: "A file that is not there",
        text: r#"{"camera": {}, "surfaces": [{"type": "mesh", "filename": «"none.obj", "material": {"type": "mirror"}}]}"#,
        messages: &[
            "/surfaces/0/filename: cannot read none.obj: No such file or directory (os error 2); check the name and the permissions",
        ],
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
    Scene {
        what: "A mesh of nothing, and one of everything",
        text: "{\"camera\": {}, \"surfaces\": [«{\"type\": \"mesh\", \"material\": {\"type\": \"mirror\"}},\n  {\"type\": \"mesh\", \
               \"material\": {\"type\": \"mirror\"}, \"filename\": «\"a.obj\", \"positions\": [], \"indices\": []}]}",
        messages: &[
            "/surfaces/0: a mesh needs a \"filename\", or inline \"positions\" and \"indices\"",
            "/surfaces/1/filename: a mesh has either a \"filename\" or inline \"positions\", not both",
        ],
    },
    Scene {
        what: "No arrays in a mesh, and no positions for its faces",
        text: "{\"camera\": {}, \"surfaces\": [\n  {\"type\": \"mesh\", \"material\": {\"type\": \"mirror\"}, \"positions\": «4, \
               \"indices\": []},\n  {\"type\": \"mesh\", \"material\": {\"type\": \"mirror\"}, \"positions\": [[0, 0, 0]], \"indices\": \
               «7},\n  {\"type\": \"mesh\", \"material\": {\"type\": \"mirror\"}, \"positions\": [[0, 0, 0]], \"indices\": [«7]},\n  {\"type\": \
               \"mesh\", \"material\": {\"type\": \"mirror\"}, \"positions\": [], \"indices\": [«[0, 1, 2]]}]}",
        messages: &[
            "/surfaces/0/positions: expected an array of arrays of 3 numbers, found the number 4",
            "/surfaces/1/indices: expected an array of faces, each an array of 3 or 4 indices, found the number 7",
            "/surfaces/2/indices/0: expected an array of 3 or 4 indices, found the number 7",
            "/surfaces/3/indices/0: the mesh has no positions for its faces",
        ],
    },
    Scene {
        what: "Faces of no or too many corners, or none",
        text: "{\"camera\": {}, \"surfaces\": [{\"type\": \"mesh\", \"material\": {\"type\": \"mirror\"},\n  \"positions\": [[0, 0, \
               0], [1, 0, 0], [0, 1, 0]], \"indices\": [«[0, 1], «[0, 1, 2, 0, 1]]},\n {\"type\": \"mesh\", \"material\": {\"type\": \
               \"mirror\"}, \"positions\": [[0, 0, 0]], \"indices\": «[]}]}",
        messages: &[
            "/surfaces/0/indices/0: a face has 3 or 4 corners, found 2",
            "/surfaces/0/indices/1: a face has 3 or 4 corners, found 5",
            "/surfaces/1/indices: the mesh has no faces; it needs at least one",
        ],
    },
    Scene {
        what: "Normals of length 0, and too few of them",
        text: "{\"camera\": {}, \"surfaces\": [{\"type\": \"triangle\", \"material\": {\"type\": \"mirror\"},\n  \"positions\": [[0, 0, \
               0], [1, 0, 0], [0, 1, 0]], \"normals\": [[0, 0, 1], «[0, 0, 0], [0, 0, 1]],\n  \"uvs\": «[[0, 0]]}]}",
        messages: &[
            "/surfaces/0/normals/1: the normal [0, 0, 0] has no direction; it must not be zero",
            "/surfaces/0/uvs: 1 uvs for 3 positions; allowed: one each",
        ],
    },
    Scene {
        what: "A triangle of two corners",
        text: r#"{"camera": {}, "surfaces": [{"type": "triangle", "positions": «[[0, 0, 0], [1, 0, 0]], "material": {"type": "mirror"}}]}"#,
        messages: &["/surfaces/0/positions: a triangle has 3 positions, found 2"],
    },
];

pub const TRANSFORMS: &[Scene] = &[
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
        what: "Up that points nowhere",
        text: r#"{"camera": {"transform": {"from": [0, 5, 0], "at": 0, "up": «[0, 0, 0]}}}"#,
        messages: &["/camera/transform/up: \"up\" [0, 0, 0] has length 0: it points nowhere; it must not be zero"],
    },
    Scene {
        what: "Two words for one thing",
        text: r#"{"camera": {"transform": «{"from": [0, 0, 5], "at": 0, "to": 0}}}"#,
        messages: &["/camera/transform: \"at\" and \"to\" mean the same; give one of them"],
    },
    Scene {
        what: "A frame's axis of length 0",
        text: r#"{"camera": {"transform": {"x": [1, 0, 0], "y": «[0, 0, 0]}}}"#,
        messages: &["/camera/transform/y: the axis \"y\" has length 0: it points nowhere; it must not be zero"],
    },
    Scene {
        what: "A rotation about nothing",
        text: r#"{"camera": {"transform": [{"axis": «[0, 0, 0], "angle": 90}, {"rotate": «[90, 0, 0, 0]}]}}"#,
        messages: &[
            "/camera/transform/0/axis: the rotation's axis [0, 0, 0] has length 0: it points nowhere; it must not be zero",
            "/camera/transform/1/rotate: the rotation's axis [0, 0, 0] has length 0: it points nowhere; it must not be zero",
        ],
    },
    Scene {
        what: "A perspective matrix, and one of nine numbers",
        text: "{\"camera\": {\"transform\": [{\"matrix\": «[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]},\n  {\"matrix\": \
               «[1,0,0, 0,1,0, 0,0,1]}]}}",
        messages: &[
            "/camera/transform/0/matrix: the last row is [0.0, 0.0, 1.0, 1.0]; allowed: 0, 0, 0, 1 (no perspective)",
            "/camera/transform/1/matrix: expected an array of 16 numbers, row by row, found an array of 9",
        ],
    },
    Scene {
        what: "No transform",
        text: r#"{"camera": {"transform": «{}}}"#,
        messages: &[
            "/camera/transform: no transform; allowed: {from, at, up}, {o, x, y, z}, {translate}, {scale}, {axis, angle}, \
             {rotate}, {matrix}",
        ],
    },
    Scene {
        what: "Two transforms in one object",
        text: r#"{"camera": {"transform": {"translate": 1, «"scale": 2}}}"#,
        messages: &["/camera/transform/scale: unknown key \"scale\"; allowed: translate"],
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
];

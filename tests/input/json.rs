//! JSON itself: syntax, encoding, nesting, keys, types, numbers.

use std::path::Path;

use twinlight::import::{ImportError, load_scene, scene_from_str};

use super::{each, expect_errors, read, temporary};

#[test]
fn json_syntax() {
    for (marked, message) in [
        ("«", "the file is empty; expected a JSON object with a \"camera\""),
        ("«\n \n", "the file is empty; expected a JSON object with a \"camera\""),
        (
            "{\"camera\": {\n  \"vfov\": 40«",
            "invalid JSON: EOF while parsing an object: the file ends before the scene does; is it truncated?",
        ),
        (
            "{\"name\": \"abc«",
            "invalid JSON: EOF while parsing a string: the file ends before the scene does; is it truncated?",
        ),
        ("{\"a\": «nan}", "invalid JSON: expected value, found `nan`; JSON has finite numbers only"),
        ("{\"a\": «NaN}", "invalid JSON: expected value, found `NaN`; JSON has finite numbers only"),
        (
            "{\"é\": 1,\n «'b': 2}",
            "invalid JSON: key must be a string, found `'b':`; JSON's keys and strings take double quotes (\")",
        ),
        ("{\"a\": 1«, }", "invalid JSON: trailing comma before `}`; delete it"),
        ("[1«, ]", "invalid JSON: trailing comma before `]`; delete it"),
        // Where the comma is, not where it is noticed; one in a text is none.
        ("{\"a\": [1, 2]«,\n\n  }", "invalid JSON: trailing comma before `}`; delete it"),
        ("{\"a\": \",\" «]}", "invalid JSON: expected `,` or `}`, found `]`"),
        ("[«,]", "invalid JSON: expected value, found `,`"),
        ("{\"a\": «}", "invalid JSON: expected value, found `}`"),
        ("{\"a\": 1}\n«garbage", "invalid JSON: trailing characters, found `garbage`"),
        ("«\u{feff}{}", "the file starts with a byte order mark, which JSON does not allow: save it as UTF-8 without"),
    ] {
        expect_errors(marked, &[message]);
    }
}

#[test]
fn json_nesting() {
    let marked = format!("{{\"camera\": {}«[{}", "[".repeat(127), "]".repeat(128));
    expect_errors(&marked, &["nested more than 128 deep; allowed: at most 128 levels"]);
    // Far more must not overflow any stack.
    assert!(read(&"[".repeat(1_000_000)).unwrap_err().contains("nested more than 128 deep"));
    assert!(read(&"{\"a\":".repeat(1_000_000)).unwrap_err().contains("nested more than 128 deep"));
}

#[test]
fn file_encoding() {
    let error = |name: &str, bytes: &[u8]| {
        let path = temporary(name, bytes);
        load_scene(&path).unwrap_err().to_string().replace(&format!("{}:", path.display()), "")
    };
    assert_eq!(error("latin1.json", b"{\n \"\xe9\": 1}"), "2:3: byte 0xe9 is not UTF-8; a scene must be UTF-8 text");
    assert_eq!(
        error("utf16.json", b"\xff\xfe{\0}\0"),
        "1:1: the file is UTF-16; a scene must be UTF-8 text: save it as UTF-8 without a byte order mark"
    );
    assert_eq!(error("binary.json", b"\x7fELF\0\xff"), " this is a binary file, not a scene; a scene is JSON text");
    assert!(error("bom.json", b"\xef\xbb\xbf{}").starts_with("1:1: the file starts with a byte order mark"));
    match load_scene(Path::new("no/such/scene.json")) {
        Err(ImportError::Io { path, source }) => {
            assert_eq!(path, Path::new("no/such/scene.json"));
            assert_eq!(source.kind(), std::io::ErrorKind::NotFound);
        }
        other => panic!("{other:?}"),
    }
}

/// What is said of a scene without a camera.
const NO_CAMERA: &str = "\"camera\" is missing; for example \"camera\": {\"transform\": {\"from\": [0, 1, 5], \"at\": [0, 0, 0], \
                         \"up\": [0, 1, 0]}, \"vfov\": 40}";

#[test]
fn keys() {
    for (marked, message) in [
        ("«[]", "expected an object with a \"camera\", found an empty array"),
        ("«{}", NO_CAMERA),
        (
            r#"{"camera": {}, «"surface": []}"#,
            "/surface: unknown key \"surface\"; did you mean \"surfaces\"? allowed: camera, integrator, sampler, \
             image_samples, background, textures, materials, surfaces, lights",
        ),
        (
            r#"{"camera": {«"vfovv": 40}}"#,
            "/camera/vfovv: unknown key \"vfovv\"; did you mean \"vfov\"? allowed: type, transform, resolution, vfov, \
             fdist, aperture, filter",
        ),
        (
            r#"{"camera": {«"a/b~c": 1}}"#,
            "/camera/a~1b~0c: unknown key \"a/b~c\"; allowed: type, transform, resolution, vfov, fdist, aperture, \
             filter",
        ),
        (
            "{\"camera\": {\"vfov\": 40,\n  «\"vfov\": 50}}",
            "/camera/vfov: duplicate key \"vfov\"; it is already given on line 1",
        ),
        ("{\"camera\": {},\n «\"camera\": {}}", "/camera: duplicate key \"camera\"; it is already given on line 1"),
        (r#"{"camera": {«"\ud800": 1}}"#, "/camera: the key \"\\ud800\" is not a valid string"),
    ] {
        expect_errors(marked, &[message]);
    }
}

#[test]
fn wrong_types_and_arity() {
    each(
        r#"{"camera": @}"#,
        &[
            ("«40", "/camera: expected an object, found the number 40"),
            ("«null", "/camera: expected an object, found null"),
            (r#"{"vfov": «"wide"}"#, "/camera/vfov: expected a number, found the string \"wide\""),
            (r#"{"vfov": «[40]}"#, "/camera/vfov: expected a number, found an array of 1"),
            (r#"{"vfov": «true}"#, "/camera/vfov: expected a number, found true"),
            (
                r#"{"resolution": «[1, 2, 3]}"#,
                "/camera/resolution: expected an array of 2 numbers, or one number for all, found an array of 3",
            ),
            (
                r#"{"resolution": «{}}"#,
                "/camera/resolution: expected an array of 2 numbers, or one number for all, found an object",
            ),
            (r#"{"resolution": [64, «"x"]}"#, "/camera/resolution/1: expected a whole number, found the string \"x\""),
            (
                r#"{"transform": {"translate": «[1, 2]}}"#,
                "/camera/transform/translate: expected an array of 3 numbers, or one number for all, found an array of 2",
            ),
        ],
    );
    each(
        r#"{"camera": {}, @}"#,
        &[
            (r#""surfaces": «{}"#, "/surfaces: expected an array of surfaces, found an object"),
            (r#""surfaces": [«1]"#, "/surfaces/0: expected an object, found the number 1"),
            (r#""materials": [«"white"]"#, "/materials/0: expected an object, found the string \"white\""),
            (r#""lights": «3"#, "/lights: expected an array of lights, found the number 3"),
            (
                r#""integrator": {"russian_roulette": «1}"#,
                "/integrator/russian_roulette: expected true or false, found the number 1",
            ),
            (r#""integrator": {"type": «1}"#, "/integrator/type: expected a string, found the number 1"),
            (r#""integrator": {"type": «"a\ud800"}"#, "/integrator/type: \"a\\ud800\" holds an invalid escape"),
        ],
    );
}

#[test]
fn numbers_that_are_not_finite() {
    each(
        r#"{"camera": {"vfov": @}}"#,
        &[
            ("«1e999", "/camera/vfov: 1e999 is not a finite 64-bit number; allowed: between 0 and 180 degrees"),
            ("«-1e999", "/camera/vfov: -1e999 is not a finite 64-bit number; allowed: between 0 and 180 degrees"),
        ],
    );
    let long = "9".repeat(400);
    expect_errors(
        &format!(r#"{{"camera": {{"fdist": «{long}}}}}"#),
        &[&format!("/camera/fdist: {}… is not a finite 64-bit number; allowed: above 0", &long[..40])],
    );
    each(
        r#"{"camera": {}, "materials": [{"name": "m", "type": "lambertian", "albedo": 0, "emit": @}]}"#,
        &[
            ("«1e400", "/materials/0/emit: 1e400 is not a finite 64-bit number; allowed: 0 to 3.4e38"),
            ("[0, «1e39, 0]", "/materials/0/emit/1: 1e39 is out of range; allowed: 0 to 3.4e38"),
        ],
    );
}

#[test]
fn all_mistakes_of_a_file_are_reported_in_its_order() {
    expect_errors(
        r#"{
  "surfaces": [
    {"type": "sphere", "radius": «-1, "material": «"glas"},
    {"type": "quad", «"sise": 2, "material": "glass"},
    {"type": "quad", "material": "broken"}
  ],
  "materials": [
    {"name": "glass", "type": "dielectric", "ior": «0},
    {"name": "broken", "type": «"lambertain", "albedo": 1}
  ],
  "camera": {"vfov": «180, "resolution": [«0, 4], "transform": «{"scale": 0}}
}"#,
        &[
            "/surfaces/0/radius: -1 is out of range; allowed: above 0",
            "/surfaces/0/material: no material is named \"glas\"; did you mean \"glass\"? known: glass, broken",
            "/surfaces/1/sise: unknown key \"sise\"; did you mean \"size\"? allowed: type, transform, material, \
             flip_normals, size, opacity, normal_map, bump_map",
            "/materials/0/ior: 0 is out of range; allowed: 0.001 to 1000",
            "/materials/1/type: unknown material type \"lambertain\"; did you mean \"lambertian\"? allowed: lambertian, \
             mirror, metal, dielectric, diffuse light, point light, spot light, null, conductor, plastic, thin dielectric, phong, \
             blinnphong, beckmann, oren-nayar, blend",
            "/camera/vfov: 180 is out of range; allowed: between 0 and 180 degrees",
            "/camera/resolution/0: 0 is out of range; allowed: whole numbers from 1 to 65536",
            "/camera/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
        ],
    );
}

/// A slip in a key's name is one mistake, not a key too many and one too few.
#[test]
fn a_slip_in_a_key_is_told_once() {
    const MATERIAL: &str = "allowed: type, name, albedo, two_sided, emit, emit_two_sided";
    const SPOT: &str = "allowed: type, position, at, direction, intensity, inner_angle, outer_angle, falloff, profile";
    for (scene, messages) in [
        (
            r#"{«"camra": {}}"#,
            &["/camra: unknown key \"camra\"; did you mean \"camera\"? allowed: camera, integrator, sampler, \
               image_samples, background, textures, materials, surfaces, lights"
                .to_owned()][..],
        ),
        (
            r#"{"camera": {}, "materials": [{«"nmae": "m", "type": "lambertian", «"albdo": 0.5}]}"#,
            &[
                format!("/materials/0/nmae: unknown key \"nmae\"; did you mean \"name\"? {MATERIAL}"),
                format!("/materials/0/albdo: unknown key \"albdo\"; did you mean \"albedo\"? {MATERIAL}"),
            ],
        ),
        // Nothing near is missing: then two mistakes are two; and a key that is there is not what was meant.
        (
            r#"{"camera": {}, "materials": [«{"name": "m", "type": "lambertian", «"fluff": 0.5}]}"#,
            &[
                "/materials/0: \"albedo\" is missing".to_owned(),
                format!("/materials/0/fluff: unknown key \"fluff\"; {MATERIAL}"),
            ],
        ),
        (
            r#"{"camera": {}, "materials": [{"name": "m", "type": "lambertian", "albedo": 0.5, «"albdo": 0.5}]}"#,
            &[format!("/materials/0/albdo: unknown key \"albdo\"; did you mean \"albedo\"? {MATERIAL}")],
        ),
        (
            r#"{"camera": {}, "lights": [{"type": "spot", «"postion": 0, «"dirction": 1, «"intensty": 1,
                «"iner_angle": 1, "outer_angle": 2}]}"#,
            &["postion position", "dirction direction", "intensty intensity", "iner_angle inner_angle"].map(|slip| {
                let (wrong, right) = slip.split_once(' ').unwrap();
                format!("/lights/0/{wrong}: unknown key \"{wrong}\"; did you mean \"{right}\"? {SPOT}")
            }),
        ),
        (
            r#"{"camera": {}, "surfaces": [{«"tpye": "quad", "material": {"type": "null"}}]}"#,
            &["/surfaces/0/tpye: unknown key \"tpye\"; did you mean \"type\"? allowed: type, transform, material, \
               flip_normals, size, radius, filename, positions, indices, normals, uvs, opacity, normal_map, bump_map"
                .to_owned()],
        ),
        (
            r#"{"camera": {}, "surfaces": [{"type": "mesh", «"filname": "a.obj", "material": {"type": "null"}}]}"#,
            &["/surfaces/0/filname: unknown key \"filname\"; did you mean \"filename\"? allowed: type, transform, \
               material, flip_normals, filename, positions, indices, normals, uvs, opacity, normal_map, bump_map"
                .to_owned()],
        ),
        (
            r#"{"camera": {"transform": {«"tranlate": [1, 2, 3]}}}"#,
            &["/camera/transform/tranlate: unknown key \"tranlate\"; did you mean \"translate\"? allowed: from, at, to, \
               up, o, x, y, z, translate, scale, axis, angle, rotate, matrix"
                .to_owned()],
        ),
    ] {
        expect_errors(scene, &messages.iter().map(String::as_str).collect::<Vec<&str>>());
    }
}

#[test]
fn a_flood_of_errors_is_cut() {
    let surfaces = vec!["1"; 150].join(",");
    let error = scene_from_str(&format!(r#"{{"camera": {{}}, "surfaces": [{surfaces}]}}"#), "s.json", Path::new(""));
    let diagnostics = error.unwrap_err().diagnostics;
    assert_eq!(diagnostics.len(), 101);
    assert_eq!(diagnostics[100].to_string(), "s.json: 50 more errors are not shown");
}

/// Keys come up in messages as the places of what they hold: they must not steer a terminal.
#[test]
fn places_are_printable() {
    let found = read("{\"camera\": {}, \"surfaces\": [{\"ty\u{7f}pe\": 1, \"b\\u001b[2J\": {}}]}").unwrap_err();
    assert!(
        found.contains("/surfaces/0/ty\\u{7f}pe: unknown key") && found.contains("/surfaces/0/b\\u{1b}[2J"),
        "{found}"
    );
    let missing =
        r#"{"camera": {}, "surfaces": [{"type": "mesh", "material": {"type": "mirror"}, "filename": "\u001b.obj"}]}"#;
    assert!(read(missing).unwrap_err().contains("cannot read \\u{1b}.obj: "));
}

//! Textures, blends, and what textures do to surfaces: each mistake, and what is right.

use std::path::Path;

use twinlight::film::Image;
use twinlight::output::{Metadata, srgb_decode, write_image};
use twinlight::scene::desc::{Filter, MaterialKind, Param, SceneDesc, TextureDesc, Wrap};
use twinlight::scene::prepare;

use super::{each, expect_errors, read, temporary};

/// A file of these texels, and its name as a scene writes it.
pub fn file(name: &str, width: u32, rgb: Vec<[f32; 3]>) -> String {
    let path = temporary(name, b"");
    let image = Image { width, height: rgb.len() as u32 / width, rgb };
    write_image(&path, &image, &Metadata::default(), 0.0).expect("writable");
    path.to_str().expect("UTF-8").to_owned()
}

fn albedo(texture: &str) -> String {
    format!(r#"{{"camera": {{}}, "materials": [{{"name": "m", "type": "lambertian", "albedo": {texture}}}]}}"#)
}

#[test]
fn texture_objects() {
    each(
        r#"{"camera": {}, "textures": [{"name": "t", @}]}"#,
        &[
            (
                r#""type": «"chequer", "even": 0, "odd": 1"#,
                "/textures/0/type: unknown texture type \"chequer\"; did you mean \"checker\"? allowed: constant, checker, \
                 marble, image",
            ),
            (
                r#""type": "constant", "color": «"red""#,
                "/textures/0/color: expected an array of 3 numbers, or one number for all, found the string \"red\"",
            ),
            (
                r#""type": "checker", "even": 0, "odd": 1, «"scael": 3"#,
                "/textures/0/scael: unknown key \"scael\"; did you mean \"scale\"? allowed: type, name, scale, even, odd",
            ),
            (
                r#""type": "marble", "base": 0, "veins": 1, "scale": «[1, 2, 3]"#,
                "/textures/0/scale: expected a number, found an array of 3",
            ),
            (
                r#""type": "image", "filename": «"no/such.png""#,
                "/textures/0/filename: cannot read no/such.png: No such file or directory (os error 2); check the name and \
                 the permissions",
            ),
            (
                r#""type": "checker", "even": «"wood", "odd": 1"#,
                "/textures/0/even: no texture is named \"wood\"; there are no named textures here",
            ),
        ],
    );
    expect_errors(
        r#"{"camera": {}, "textures": [«{"name": "t", "type": "image", "scale": «0, "wrap": «"mirror",
            "filter": «"cubic", "colorspace": «"aces"}]}"#,
        &[
            "/textures/0: \"filename\" is missing",
            "/textures/0/scale: 0 is out of range; allowed: above 0",
            "/textures/0/wrap: unknown wrap \"mirror\"; allowed: repeat, clamp",
            "/textures/0/filter: unknown filter \"cubic\"; allowed: nearest, bilinear",
            "/textures/0/colorspace: unknown colorspace \"aces\"; allowed: srgb, linear",
        ],
    );
    expect_errors(
        r#"{"camera": {}, "textures": [«{"type": "constant", "color": 1}, {"name": "t", "type": "constant", "color": 1},
            «{"name": «"t", "type": "checker", "odd": 0}]}"#,
        &[
            "/textures/0: \"name\" is missing",
            "/textures/2: \"even\" is missing",
            "/textures/2/name: duplicate texture name \"t\"; names must differ",
        ],
    );
    // A texture may use those above it, not itself or those below: nothing is cyclic.
    expect_errors(
        r#"{"camera": {}, "textures": [{"name": "a", "type": "checker", "even": «"a", "odd": «"b"},
            {"name": "b", "type": "checker", "even": "a", "odd": 0}]}"#,
        &[
            "/textures/0/even: no texture is named \"a\"; there are no named textures here",
            "/textures/0/odd: the texture \"b\" is defined below, on line 2; move it before what is made of it",
        ],
    );
}

#[test]
fn values_are_held_to_the_range_of_the_parameter() {
    const USED: &str = "(used by s.json:1:76: /materials/0/albedo)";
    for (texture, key, value) in [
        (r#"{"type": "constant", "color": [0, 0.5, «1.5]}"#, "/color/2", "1.5"),
        (r#"{"type": "checker", "even": «-0.5, "odd": 1}"#, "/even", "-0.5"),
        (r#"{"type": "marble", "veins": 0, "base": {"type": "constant", "color": «2}}"#, "/base/color", "2"),
    ] {
        let message = format!("/materials/0/albedo{key}: {value} is out of range; allowed: 0 to 1 {USED}");
        expect_errors(&albedo(texture), &[&message]);
    }
    for (texture, message) in [
        (r#"«"wood""#, "no texture is named \"wood\"; there are no named textures here"),
        (r#"«true"#, "expected an array of 3 numbers, or one number for all, found true"),
    ] {
        expect_errors(&albedo(texture), &[&format!("/materials/0/albedo: {message}")]);
    }
    // A named one is told where it is written, once for each parameter that it does not suit.
    expect_errors(
        r#"{"camera": {}, "textures": [{"name": "t", "type": "checker", "even": ««3, "odd": 0}], "materials": [
            {"name": "m", "type": "phong", "albedo": "t", "exponent": "t"},
            {"name": "n", "type": "mirror", "albedo": "t"}]}"#,
        &[
            "/textures/0/even: 3 is out of range; allowed: 0 to 1 (used by s.json:2:54: /materials/0/albedo)",
            "/textures/0/even: 3 is out of range; allowed: 0 to 1 (used by s.json:3:55: /materials/1/albedo)",
        ],
    );
    // The same numbers are good where they are in range.
    let bright = r#"{"camera": {}, "materials": [{"name": "m", "type": "diffuse light",
        "emit": {"type": "checker", "even": 5, "odd": 0}}]}"#;
    assert!(matches!(read(bright).unwrap().materials[0].emit, Param::Texture(0)));
}

/// One error, at the image's file, that holds all of these.
pub fn expect_in_image(scene: &str, name: &str, message: &str) {
    let found = read(scene).expect_err(scene);
    assert!(found.starts_with(name) && found.contains(message) && found.lines().count() == 1, "{found}");
    assert!(found.contains("(named by s.json:1:"), "{found}");
}

#[test]
fn texels() {
    let image = |name: &str| format!(r#"{{"type": "image", "filename": "{name}"}}"#);
    let good = [0.25, 0.5, 1.0];
    let with = |bad: [f32; 3]| vec![good, good, good, good, bad, good];
    let out = file("out.exr", 3, with([0.5, 1.25, 0.0]));
    expect_in_image(
        &albedo(&image(&out)),
        &out,
        "the texel in column 1, row 1 (from the top left), [0.5, 1.25, 0], is out of range; allowed: 0 to 1",
    );
    let negative = file("negative.exr", 3, with([0.5, -0.25, 0.0]));
    expect_in_image(
        &albedo(&image(&negative)),
        &negative,
        "column 1, row 1 (from the top left), [0.5, -0.25, 0], is out of range",
    );
    // Where the file is named, and what it does not suit.
    let named = format!(
        r#"{{"camera": {{}}, "textures": [{{"name": "t", "type": "image", "filename": "{negative}"}}],
        "materials": [{{"name": "m", "type": "mirror", "albedo": "t"}}]}}"#
    );
    let places =
        "allowed: 0 to 1 (named by s.json:1:72: /textures/0/filename, used by s.json:2:65: /materials/0/albedo)";
    expect_in_image(&named, &negative, places);
    for (name, bad) in [("nan.exr", f32::NAN), ("inf.exr", f32::INFINITY)] {
        let name = file(name, 3, with([0.0, 0.0, bad]));
        expect_in_image(&albedo(&image(&name)), &name, "is not finite; allowed: finite numbers");
    }
    // The scale counts.
    let half = file("half.exr", 1, vec![[0.5; 3]]);
    assert!(read(&albedo(&format!(r#"{{"type": "image", "filename": "{half}", "scale": 2}}"#))).is_ok());
    expect_in_image(
        &albedo(&format!(r#"{{"type": "image", "filename": "{half}", "scale": 2.5}}"#)),
        &half,
        "[0.5, 0.5, 0.5], times the scale 2.5 is out of range; allowed: 0 to 1",
    );
    // Files that are no images.
    for (name, bytes, message) in [
        ("text.png", &b"no image at all"[..], "it is no EXR, PNG or Radiance HDR image"),
        ("empty.exr", b"", "it is too short to be an image"),
        ("cut.png", b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0", "damaged"),
        (
            "huge.png",
            b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\x02\0\0\0\x9b\xab\x9c\x31",
            "the file is damaged or uses an unsupported feature",
        ),
        (
            "huge.hdr",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n",
            "its header claims 2000000000 × 2000000000 pixels",
        ),
    ] {
        let path = temporary(name, bytes);
        let path = path.to_str().unwrap();
        expect_in_image(&albedo(&image(path)), path, message);
    }
}

fn image_of(scene: &SceneDesc, index: usize) -> (Vec<[f32; 3]>, f64, Wrap, Filter) {
    match &scene.textures[index] {
        TextureDesc::Image { texels, scale, wrap, filter } => (texels.rgb.to_vec(), *scale, *wrap, *filter),
        other => panic!("{other:?}"),
    }
}

#[test]
fn images_are_read_as_their_colour_space_says() {
    // What 8 bits hold exactly: 51/255.
    let linear = srgb_decode(0.2) as f32;
    let png = file("fifth.png", 2, vec![[linear; 3]; 2]);
    let exr = file("fifth.exr", 2, vec![[0.2; 3]; 2]);
    let hdr =
        temporary("two.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x40\x80\x00\x80");
    let albedo_of = |filename: &str, rest: &str| {
        let scene = read(&albedo(&format!(r#"{{"type": "image", "filename": "{filename}"{rest}}}"#))).unwrap();
        image_of(&scene, 0).0
    };
    let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} {b}");
    near(albedo_of(&png, "")[1][2], linear);
    near(albedo_of(&png, r#", "colorspace": "srgb""#)[1][2], linear);
    near(albedo_of(&png, r#", "colorspace": "linear""#)[1][2], 0.2);
    near(albedo_of(&exr, "")[1][2], 0.2);
    near(albedo_of(&exr, r#", "colorspace": "srgb""#)[1][2], linear);
    // RGBE with exponents 129 and 128: the mantissas over 128 and 256.
    let hdr = albedo_of(hdr.to_str().unwrap(), "");
    near(hdr[0][0], 1.0);
    near(hdr[1][0], 0.25);
    near(hdr[1][2], 0.0);
    // Numbers and normals are linear; a named image has to say so.
    let scene = |textures: &str, opacity: &str| {
        format!(
            r#"{{"camera": {{}}, "textures": [{textures}], "surfaces": [{{"type": "quad", "material": {{"type": "mirror"}},
                "opacity": {opacity}}}]}}"#
        )
    };
    let inline = read(&scene("", &format!(r#"{{"type": "image", "filename": "{png}"}}"#))).unwrap();
    near(image_of(&inline, 0).0[0][0], 0.2);
    let named =
        |space: &str| scene(&format!(r#"{{"name": "t", "type": "image", "filename": "{png}"{space}}}"#), "«\"t\"");
    expect_errors(
        &named(""),
        &[
            "/surfaces/0/opacity: the texture \"t\" is an image of integers, taken for sRGB colours; where numbers or normals \
           are asked for, it has to say its \"colorspace\": \"linear\" or \"srgb\"",
        ],
    );
    assert!(read(&named(r#", "colorspace": "linear""#).replace('«', "")).is_ok());
    // One file is held once.
    let twice = read(&format!(
        r#"{{"camera": {{}}, "textures": [{{"name": "a", "type": "image", "filename": "{exr}"}},
            {{"name": "b", "type": "image", "filename": "{exr}", "wrap": "clamp", "filter": "nearest", "scale": 3}}]}}"#
    ))
    .unwrap();
    let [TextureDesc::Image { texels: a, .. }, TextureDesc::Image { texels: b, .. }] = &twice.textures[..] else {
        panic!()
    };
    assert!(std::sync::Arc::ptr_eq(a, b));
    assert_eq!((image_of(&twice, 0).2, image_of(&twice, 0).3), (Wrap::Repeat, Filter::Bilinear));
    assert_eq!(
        (image_of(&twice, 1).1, image_of(&twice, 1).2, image_of(&twice, 1).3),
        (3.0, Wrap::Clamp, Filter::Nearest)
    );
}

#[test]
fn names_are_relative_to_the_scene_file() {
    let name = file("beside.exr", 1, vec![[0.5; 3]]);
    let folder = Path::new(&name).parent().unwrap();
    let scene = albedo(r#"{"type": "image", "filename": "beside.exr"}"#);
    let found = twinlight::import::scene_from_str(&scene, "s.json", folder).unwrap();
    assert_eq!(image_of(&found, 0).0, [[0.5; 3]]);
    // The fingerprint is of the texels, wherever they are.
    let fingerprint = |value: f32| {
        file("beside.exr", 1, vec![[value; 3]]);
        twinlight::import::scene_from_str(&scene, "s.json", folder).unwrap().fingerprint
    };
    assert_eq!(fingerprint(0.5), found.fingerprint);
    assert_ne!(fingerprint(0.25), found.fingerprint);
}

/// What looks into a texture or blend visits each way to its parts: with two ways to every part of a chain, 2ⁿ of them.
#[test]
fn nesting_is_limited() {
    let chain = |key: &str, first: &str, link: &dyn Fn(usize) -> String| {
        let links: Vec<String> = (0..40).map(link).collect();
        format!(r#"{{"camera": {{}}, "{key}": [{{"name": "n0", {first}}}, {}]}}"#, links.join(", "))
    };
    let checkers = chain("textures", r#""type": "constant", "color": 0"#, &|i| {
        format!(r#"{{"name": "n{}", "type": "checker", "even": "n{i}", "odd": "n{i}"}}"#, i + 1)
    });
    let blends = chain("materials", r#""type": "mirror""#, &|i| {
        format!(r#"{{"name": "n{}", "type": "blend", "a": "n{i}", "b": "n{i}", "amount": 0.5}}"#, i + 1)
    });
    for (json, message) in [
        (checkers, "/textures/11: textures of textures 11 deep; allowed: at most 10"),
        (blends, "/materials/11: blends of blends 11 deep; allowed: at most 10"),
    ] {
        let error = twinlight::import::scene_from_str(&json, "s.json", Path::new("")).expect_err("too deep");
        assert_eq!(error.diagnostics.len(), 1, "{error}");
        assert!(error.to_string().contains(message), "{error}");
    }
}

#[test]
fn a_blend_with_a_part_that_is_not_there_cannot_shine() {
    expect_errors(
        r#"{"camera": {}, "materials": [{"name": "hole", "type": "null"},
            {"name": "inner", "type": "blend", "a": "hole", "b": {"type": "mirror"}, "amount": 0.5},
            {"name": "m", "type": "blend", "a": {"type": "mirror"}, "b": "inner", "amount": 0.5, "emit": «1}]}"#,
        &["/materials/2/emit: a blend with a \"null\" part cannot emit; give the light a surface of its own"],
    );
}

#[test]
fn blends() {
    each(
        r#"{"camera": {}, "materials": [{"name": "white", "type": "lambertian", "albedo": 1},
            {"name": "lamp", "type": "diffuse light", "emit": 1}, {"name": "m", "type": "blend", @},
            {"name": "below", "type": "mirror"}]}"#,
        &[
            (
                r#""a": "white", "b": «"below", "amount": 0.5"#,
                "/materials/2/b: the material \"below\" is defined below, on line 3; move it before what is made of it",
            ),
            (
                r#""a": "white", "b": «"m", "amount": 0.5"#,
                "/materials/2/b: no material is named \"m\"; known: white, lamp",
            ),
            (
                r#""a": "white", "b": "white", "amount": «1.5"#,
                "/materials/2/amount: 1.5 is out of range; allowed: 0 to 1",
            ),
            (
                r#""a": «"lamp", "b": "white", "amount": 0.5"#,
                "/materials/2/a: a part of a blend cannot emit; give the blend itself an \"emit\"",
            ),
            (
                r#""a": «{"type": "point light", "emit": 1}, "b": "white", "amount": 0.5"#,
                "/materials/2/a: a \"point light\" cannot be part of a blend: it has no surface",
            ),
        ],
    );
    expect_errors(
        r#"{"camera": {}, "materials": [«{"name": "m", "type": "blend", "a": {"type": "mirror"}, "b": {"type": "mirror"}}]}"#,
        &["/materials/0: \"amount\" is missing"],
    );
    let scene = read(
        r#"{"camera": {}, "materials": [{"name": "w", "type": "lambertian", "albedo": 1}, {"name": "m", "type": "blend",
            "a": "w", "b": {"type": "blend", "a": "w", "b": {"type": "mirror"}, "amount": 0.25}, "amount": 1, "emit": 2}]}"#,
    )
    .unwrap();
    let MaterialKind::Blend { a: 0, b, .. } = scene.materials[scene.materials.len() - 1].kind else { panic!() };
    assert!(matches!(scene.materials[b].kind, MaterialKind::Blend { a: 0, amount: Param::Value(0.25), .. }));
}

#[test]
fn finishes() {
    each(
        r#"{"camera": {}, "surfaces": [{"type": "quad", "material": {"type": "mirror"}, @}]}"#,
        &[
            (r#""opacity": «1.5"#, "/surfaces/0/opacity: 1.5 is out of range; allowed: 0 to 1"),
            (r#""opacity": «[1, 1, 1]"#, "/surfaces/0/opacity: expected a number, found an array of 3"),
            (
                r#""normal_map": «1"#,
                "/surfaces/0/normal_map: expected the name of a texture or a texture object, found the number 1",
            ),
            (
                r#""bump_map": «"b.png""#,
                "/surfaces/0/bump_map: no texture is named \"b.png\"; there are no named textures here",
            ),
            (
                r#""normal_map": {"type": "constant", "color": [0, 0, «1.5]}"#,
                "/surfaces/0/normal_map/color/2: 1.5 is out of range; allowed: 0 to 1 (used by s.json:1:92: \
                 /surfaces/0/normal_map)",
            ),
            (
                r#""normal_map": {"type": "constant", "color": [0.5, 0.5, 1]}, "bump_map": «{"type": "marble", "base": -1, "veins": 2}"#,
                "/surfaces/0/bump_map: \"normal_map\" and \"bump_map\" both turn the normal; give one of them",
            ),
        ],
    );
    expect_errors(
        r#"{"camera": {}, "surfaces": [{"type": "quad", "material": {"type": "mirror", "emit": 1}, "opacity": «0.5},
            {"type": "delta point", "material": {"type": "point light", "emit": 1}, «"opacity": 1}]}"#,
        &[
            "/surfaces/0/opacity: a surface that shines has to be opaque: a texture as its \"emit\" makes parts of it dark, and \
             another surface can stand where it is cut out; allowed: 1",
            "/surfaces/1/opacity: unknown key \"opacity\"; allowed: type, transform, material, flip_normals",
        ],
    );
}

#[test]
fn an_image_needs_texture_coordinates() {
    let exr = file("grey.exr", 1, vec![[0.5; 3]]);
    let image = format!(r#"{{"type": "image", "filename": "{exr}"}}"#);
    let positions = r#""type": "triangle", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]"#;
    let scene = |surface: String| read(&format!(r#"{{"camera": {{}}, "surfaces": [{{{surface}}}]}}"#)).unwrap();
    for (key, good) in [
        (format!(r#""material": {{"type": "mirror", "albedo": {image}}}"#), false),
        (format!(r#""material": {{"type": "mirror", "emit": {image}}}"#), false),
        (format!(r#""material": {{"type": "mirror"}}, "opacity": {image}"#), false),
        (format!(r#""material": {{"type": "mirror"}}, "bump_map": {image}"#), false),
        (r#""material": {"type": "mirror"}, "normal_map": {"type": "constant", "color": [0.5, 0.5, 1]}"#.into(), false),
        (
            format!(
                r#""material": {{"type": "blend", "a": {{"type": "mirror", "albedo": {image}}}, "b": {{"type": "mirror"}}, "amount": 0}}"#
            ),
            false,
        ),
        (r#""material": {"type": "mirror", "albedo": {"type": "checker", "even": 1, "odd": 0}}"#.into(), true),
        (r#""material": {"type": "mirror"}, "bump_map": {"type": "marble", "base": 0, "veins": 1}"#.into(), true),
    ] {
        let without = prepare(&scene(format!("{positions}, {key}")));
        match without {
            Ok(_) => assert!(good, "{key}"),
            Err(e) => assert!(!good && e.to_string().contains("which has no texture coordinates"), "{key}: {e}"),
        }
        let with = prepare(&scene(format!(r#"{positions}, "uvs": [[0, 0], [1, 0], [0, 1]], {key}"#)));
        assert!(with.is_ok(), "{key}: {:?}", with.err());
    }
}

/// Whatever describes a material, but an index of refraction of what lies behind it.
#[test]
fn parameters_of_all_models() {
    let t = r#"{"type": "checker", "even": 0.2, "odd": 0.4}"#;
    for (material, textures) in [
        (format!(r#""type": "lambertian", "albedo": {t}, "emit": {t}"#), 2),
        (format!(r#""type": "mirror", "albedo": {t}"#), 1),
        (format!(r#""type": "metal", "albedo": {t}, "roughness": {t}"#), 2),
        (format!(r#""type": "dielectric", "transmittance": {t}, "roughness": [{t}, 0.1]"#), 2),
        (format!(r#""type": "conductor", "eta": {t}, "k": {t}, "roughness": [0.1, {t}]"#), 3),
        (format!(r#""type": "beckmann", "albedo": {t}, "fresnel": "none", "roughness": [{t}, {t}]"#), 3),
        (format!(r#""type": "plastic", "albedo": {t}, "roughness": {t}"#), 2),
        (format!(r#""type": "oren-nayar", "albedo": {t}, "sigma": {t}"#), 2),
        (format!(r#""type": "phong", "albedo": {t}, "exponent": {t}"#), 2),
        (format!(r#""type": "blinnphong", "albedo": {t}, "exponent": {t}"#), 2),
    ] {
        let scene =
            read(&format!(r#"{{"camera": {{}}, "surfaces": [{{"type": "quad", "material": {{{material}}}}}]}}"#))
                .unwrap();
        assert_eq!(scene.textures.len(), textures, "{material}");
        assert!(prepare(&scene).is_ok(), "{material}");
    }
    each(
        r#"{"camera": {}, "materials": [{"name": "m", @}]}"#,
        &[
            (
                r#""type": "conductor", "albedo": 1, "roughness": [0.1, {"type": "constant", "color": «1.5}]"#,
                "/materials/0/roughness/1/color: 1.5 is out of range; allowed: 0 to 1 (used by s.json:1:97: \
                 /materials/0/roughness/1)",
            ),
            (
                r#""type": "conductor", "albedo": 1, "roughness": «true"#,
                "/materials/0/roughness: expected an array of 2 numbers, or one number for all, found true",
            ),
            (
                r#""type": "conductor", "k": 1, "eta": {"type": "constant", "color": «0}"#,
                "/materials/0/eta/color: 0 is out of range; allowed: 0.001 to 1000 (used by s.json:1:80: /materials/0/eta)",
            ),
            (
                r#""type": "plastic", "albedo": 1, "roughness": «"rough""#,
                "/materials/0/roughness: no texture is named \"rough\"; there are no named textures here",
            ),
            (
                r#""type": "oren-nayar", "albedo": 1, "sigma": {"type": "checker", "even": 0, "odd": «20}"#,
                "/materials/0/sigma/odd: 20 is out of range; allowed: 0 to 1.5 radians (used by s.json:1:88: \
                 /materials/0/sigma)",
            ),
        ],
    );
}

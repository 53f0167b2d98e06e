//! Lights at infinity and the background: each mistake, and what is right.

use twinlight::math::{DMat3, DVec3};
use twinlight::scene::desc::InfiniteLightKind;
use twinlight::scene::prepare;

use super::textures::{expect_in_image, file};
use super::{each, expect_errors, read};

#[test]
fn directional_and_constant_lights() {
    each(
        r#"{"camera": {}, "lights": [@]}"#,
        &[
            (
                r#"{"type": "directional", "direction": «0, "irradiance": 1}"#,
                "/lights/0/direction: the direction 0 has length 0: it points nowhere; it must not be zero",
            ),
            (
                r#"{"type": "directional", "direction": 1, "irradiance": [1, 2, «-3]}"#,
                "/lights/0/irradiance/2: -3 is out of range; allowed: 0 to 3.4e38",
            ),
            (r#"«{"type": "directional", "irradiance": 1}"#, "/lights/0: \"direction\" is missing"),
            (r#"«{"type": "directional", "direction": 1}"#, "/lights/0: \"irradiance\" is missing"),
            (r#"«{"type": "constant"}"#, "/lights/0: \"radiance\" is missing"),
            (
                r#"{"type": "constant", "radiance": «"blue"}"#,
                "/lights/0/radiance: no texture can stand here; allowed: a number or an array of numbers",
            ),
            (
                r#"{"type": "constant", "radiance": 1, «"color": 1}"#,
                "/lights/0/color: unknown key \"color\"; did you mean \"radiance\"? allowed: type, radiance",
            ),
        ],
    );
    let scene = read(
        r#"{"camera": {}, "lights": [{"type": "directional", "direction": [0, -2, 0], "irradiance": 3},
            {"type": "constant", "radiance": [1, 2, 3]}]}"#,
    )
    .unwrap();
    assert!(matches!(
        scene.infinite_lights[0].kind,
        InfiniteLightKind::Directional { direction, irradiance: [3.0, 3.0, 3.0] } if direction == -DVec3::Y
    ));
    assert!(matches!(scene.infinite_lights[1].kind, InfiniteLightKind::Constant { radiance: [1.0, 2.0, 3.0] }));
}

#[test]
fn backgrounds() {
    each(
        r#"{"camera": {}, "background": @}"#,
        &[
            ("«-1", "/background: -1 is out of range; allowed: 0 to 3.4e38"),
            (
                r#"«"blue""#,
                "/background: expected an array of 3 numbers, or one number for all, found the string \"blue\"",
            ),
            (r#"«{"type": "constant"}"#, "/background: \"color\" is missing"),
            (r#"«{"color": 1}"#, "/background: \"type\" is missing"),
            (
                r#"{"type": "constant", "color": 1, «"filename": "sky.exr"}"#,
                "/background/filename: unknown key \"filename\"; allowed: type, color",
            ),
            (
                r#"{"type": «"sky", "scale": 1}"#,
                "/background/type: unknown background type \"sky\"; allowed: constant, image",
            ),
        ],
    );
    for black in ["0", r#"{"type": "constant", "color": 0}"#] {
        assert!(read(&format!(r#"{{"camera": {{}}, "background": {black}}}"#)).unwrap().infinite_lights.is_empty());
    }
    let grey = read(r#"{"camera": {}, "background": 0.5}"#).unwrap();
    assert!(matches!(grey.infinite_lights[0].kind, InfiniteLightKind::Constant { radiance: [0.5, 0.5, 0.5] }));
}

/// The same as a light and as the background.
fn image(keys: &str) -> [String; 2] {
    [
        format!(r#"{{"camera": {{}}, "lights": [{{"type": "environment", {keys}}}]}}"#),
        format!(r#"{{"camera": {{}}, "background": {{"type": "image", {keys}}}}}"#),
    ]
}

#[test]
fn mistakes_in_images() {
    let sky = file("sky.exr", 2, vec![[1.0, 0.5, 0.0]; 2]);
    let missing = r#""scale": 1"#;
    for (text, place) in image(missing).into_iter().zip(["/lights/0", "/background"]) {
        let marked = text.replacen(r#"{"type""#, r#"«{"type""#, 1);
        expect_errors(&marked, &[&format!("{place}: \"filename\" is missing")]);
    }
    let turned = |transform: &str| format!(r#""filename": "{sky}", "transform": «{transform}"#);
    let only =
        "what is infinitely far away can only be turned; allowed: rotations ({\"rotate\": [degrees, x, y, z]}, say)";
    for (keys, key, message) in [
        (format!(r#""filename": "{sky}", "scale": «0"#), "scale", "0 is out of range; allowed: above 0".to_owned()),
        (
            r#""filename": «"no/such.exr""#.to_owned(),
            "filename",
            "cannot read no/such.exr: No such file or directory (os error 2); check the name and the permissions"
                .to_owned(),
        ),
        (
            format!(r#""filename": "{sky}", «"radiance": 1"#),
            "radiance",
            "unknown key \"radiance\"; allowed: type, filename, scale, transform".to_owned(),
        ),
        (turned(r#"{"scale": 2}"#), "transform", format!("the transform scales, shears or mirrors: {only}")),
        (turned(r#"{"scale": [-1, 1, 1]}"#), "transform", format!("the transform scales, shears or mirrors: {only}")),
        (turned(r#"{"translate": [0, 1, 0]}"#), "transform", format!("the transform moves: {only}")),
    ] {
        for (text, place) in image(&keys).iter().zip(["/lights/0", "/background"]) {
            expect_errors(text, &[&format!("{place}/{key}: {message}")]);
        }
    }
    let good = [0.25, 0.5, 1.0];
    for (name, bad, scale, message) in [
        (
            "sky_negative.exr",
            [0.5, -0.25, 0.0],
            "1",
            "the texel in column 1, row 1 (from the top left), [0.5, -0.25, 0], is out of range; allowed: 0 to 3.4e38",
        ),
        ("sky_nan.exr", [f32::NAN, 0.0, 0.0], "1", "column 1, row 1 (from the top left), [NaN, 0, 0], is not finite"),
        ("sky_bright.exr", [0.0, 3e38, 0.0], "2", "times the scale 2 is out of range; allowed: 0 to 3.4e38"),
    ] {
        let name = file(name, 2, vec![good, good, good, bad]);
        for text in image(&format!(r#""filename": "{name}", "scale": {scale}"#)) {
            expect_in_image(&text, &name, message);
        }
    }
    let huge = super::temporary("sky_huge.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n");
    let huge = huge.to_str().unwrap();
    for text in image(&format!(r#""filename": "{huge}""#)) {
        expect_in_image(&text, huge, "its header claims 2000000000 × 2000000000 pixels");
    }
}

#[test]
fn images() {
    let texels = vec![[1.0, 0.5, 0.0], [0.0, 2.0, 4.0]];
    let sky = file("sky_good.exr", 2, texels);
    let turn = r#""scale": 0.5, "transform": [{"rotate": [90, 0, 1, 0]}, {"rotate": [90, 1, 0, 0]}]"#;
    let found = image(&format!(r#""filename": "{sky}", {turn}"#)).map(|text| read(&text).unwrap());
    for scene in &found {
        let InfiniteLightKind::Image { size, texels, transform } = &scene.infinite_lights[0].kind else { panic!() };
        assert_eq!((*size, &texels[..]), ([2, 1], &[[0.5, 0.25, 0.0], [0.0, 1.0, 2.0]][..]));
        // Quarter turns are exact: −z, the middle, goes to −x, which x's turn leaves alone.
        assert_eq!(*transform * -DVec3::Z, -DVec3::X);
        assert_eq!(*transform * DVec3::Y, DVec3::Z);
    }
    // Four digits are enough for a rotation, which then is made one to all digits.
    let rough = image(&format!(
        r#""filename": "{sky}", "transform": {{"matrix": [0.7071, 0, 0.7071, 0, 0, 1, 0, 0, -0.7071, 0, 0.7071, 0, 0, 0, 0, 1]}}"#
    ));
    let rough = read(&rough[0]).unwrap();
    let InfiniteLightKind::Image { transform, .. } = &rough.infinite_lights[0].kind else { panic!() };
    assert!((transform.transpose() * *transform).abs_diff_eq(DMat3::IDENTITY, 1e-12));
    // Both may be there; the fingerprint is of the texels.
    let both = format!(
        r#"{{"camera": {{}}, "background": {{"type": "image", "filename": "{sky}"}},
            "lights": [{{"type": "environment", "filename": "{sky}"}}]}}"#
    );
    let before = read(&both).unwrap();
    assert_eq!(before.infinite_lights.len(), 2);
    assert_eq!(read(&both).unwrap().fingerprint, before.fingerprint);
    file("sky_good.exr", 2, vec![[1.0, 0.5, 0.0], [0.0, 2.0, 4.5]]);
    assert_ne!(read(&both).unwrap().fingerprint, before.fingerprint);
    // A black one is left out, with a word.
    let black = file("sky_black.exr", 2, vec![[0.0; 3]; 2]);
    let prepared = prepare(&read(&image(&format!(r#""filename": "{black}""#))[1]).unwrap()).unwrap();
    let warning = &prepared.warnings[0];
    assert_eq!(warning.message, "the image is all black: the light emits no power and is left out");
    assert_eq!((warning.at.pointer.as_str(), prepared.lights.len()), ("/background", 0));
}

//! Checkers over surfaces in planes of their own pattern: said to be of one colour exactly where they are.

use twinlight::scene::prepare;

use super::read;

/// The axes named by warnings for a surface, with its albedo of a texture.
fn warned(surface: &str, texture: &str) -> Vec<String> {
    let scene = format!(
        r#"{{"camera": {{}}, "background": 1, "textures": [{{"name": "t", {texture}}}], "surfaces": [
            {{{surface}, "material": {{"type": "lambertian", "albedo": "t"}}}},
            {{"type": "sphere", "radius": 4, "material": {{"type": "mirror"}}}}]}}"#
    );
    let prepared = prepare(&read(&scene).unwrap()).unwrap();
    let plane = |w: &str| w.split_once("the plane ").map(|(_, rest)| rest[..rest.find(',').unwrap()].to_owned());
    prepared.warnings.iter().filter_map(|w| plane(&w.message)).collect()
}

const CHECKER: &str = r#""type": "checker", "even": 0.8, "odd": 0.2"#;

#[test]
fn a_surface_in_a_plane_of_its_checker_is_said_to_be_even() {
    let quad = |transform: &str| format!(r#""type": "quad", "transform": {transform}"#);
    for (surface, planes) in [
        (quad("[]"), &["z = 0"][..]),
        (r#""type": "disk""#.to_owned(), &["z = 0"]),
        (quad(r#"{"rotate": [-90, 1, 0, 0]}"#), &["y = 0"]),
        (quad(r#"[{"rotate": [90, 0, 1, 0]}, {"translate": [0, 2, 3]}]"#), &["x = 0"]),
        (quad(r#"{"translate": [0, 0, 3.141592653589793]}"#), &["z = 3.141592653589793"]),
        (r#""type": "triangle", "positions": [[1, 0, 0], [2, 0, 0], [1, 0, 3]]"#.to_owned(), &["y = 0"]),
        // Not in one: beside it, tilted, or not flat.
        (quad(r#"{"translate": [0, 0, 1e-3]}"#), &[]),
        (quad(r#"{"rotate": [1, 1, 0, 0]}"#), &[]),
        (r#""type": "sphere""#.to_owned(), &[]),
        (r#""type": "triangle", "positions": [[1, 0, 0], [2, 0, 0], [1, 1e-3, 3]]"#.to_owned(), &[]),
    ] {
        assert_eq!(warned(&surface, CHECKER), planes, "{surface}");
    }
    let above = quad(r#"{"translate": [0, 0, 0.5]}"#);
    for (texture, planes) in [
        (r#""type": "checker", "scale": 6.283185307179586, "even": 0.8, "odd": 0.2"#, &["z = 0.5"][..]),
        (r#""type": "checker", "scale": [1, 1, 6.283185307179586], "even": 0.8, "odd": 0.2"#, &["z = 0.5"]),
        (r#""type": "checker", "scale": [6.283185307179586, 6.283185307179586, 1], "even": 0.8, "odd": 0.2"#, &[]),
        // Within another.
        (
            r#""type": "marble", "base": 0,
               "veins": {"type": "checker", "scale": [1, 1, 6.283185307179586], "even": 0.8, "odd": 0.2}"#,
            &["z = 0.5"],
        ),
        (r#""type": "marble", "base": 0, "veins": 1"#, &[]),
        (r#""type": "constant", "color": 0.5"#, &[]),
    ] {
        assert_eq!(warned(&above, texture), planes, "{texture}");
    }
}

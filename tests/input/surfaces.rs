//! Materials, surfaces and lights.

use super::{each, expect_errors, read};

const MATERIALS: &str = "lambertian, mirror, metal, dielectric, diffuse light, point light, spot light, null, conductor, \
                         plastic, thin dielectric, phong, blinnphong, beckmann, oren-nayar, blend";

#[test]
fn materials() {
    each(
        r#"{"camera": {}, "materials": [{"name": "m", @}]}"#,
        &[
            (r#""type": "lambertian", "albedo": «1.01"#, "/materials/0/albedo: 1.01 is out of range; allowed: 0 to 1"),
            (
                r#""type": "lambertian", "albedo": [0, 0, «-0.1]"#,
                "/materials/0/albedo/2: -0.1 is out of range; allowed: 0 to 1",
            ),
            (
                r#""type": "point light", "emit": «{"type": "checker"}"#,
                "/materials/0/emit: no texture can stand here; allowed: a number or an array of numbers",
            ),
            (r#""type": "mirror", "albedo": «2"#, "/materials/0/albedo: 2 is out of range; allowed: 0 to 1"),
            (r#""type": "metal", "roughness": «-1"#, "/materials/0/roughness: -1 is out of range; allowed: 0 to 1"),
            (
                r#""type": "conductor", "albedo": 1, "roughness": [0.1, «1.5]"#,
                "/materials/0/roughness/1: 1.5 is out of range; allowed: 0 to 1",
            ),
            (
                r#""type": "conductor", "albedo": 1, "roughness": «[0.1]"#,
                "/materials/0/roughness: expected an array of 2 numbers, or one number for all, found an array of 1",
            ),
            (
                r#""type": "conductor", "albedo": 1, "fresnel": «"exact""#,
                "/materials/0/fresnel: unknown fresnel \"exact\"; allowed: schlick, none",
            ),
            (
                r#""type": "conductor", "eta": 0.2, "k": [3, «-1, 2]"#,
                "/materials/0/k/1: -1 is out of range; allowed: 0 to 1000",
            ),
            (
                r#""type": "conductor", "eta": «0, "k": 3"#,
                "/materials/0/eta: 0 is out of range; allowed: 0.001 to 1000",
            ),
            (
                r#""type": "conductor", "eta": 1, "k": 3, "albedo": «1"#,
                "/materials/0/albedo: \"albedo\" has no place beside \"eta\" and \"k\": they say what is reflected",
            ),
            (
                r#""type": "conductor", "eta": 1, "k": 3, "fresnel": «"none""#,
                "/materials/0/fresnel: \"fresnel\" has no place beside \"eta\" and \"k\": they say what is reflected",
            ),
            (
                r#""type": "conductor", "albedo": 1, "masking": «"smith""#,
                "/materials/0/masking: unknown masking \"smith\"; allowed: height_correlated, separable",
            ),
            (
                r#""type": "beckmann", "albedo": 1, «"ab": 0.1"#,
                "/materials/0/ab: unknown key \"ab\"; allowed: type, name, albedo, fresnel, eta, k, roughness, masking, two_sided, emit, emit_two_sided",
            ),
            (
                r#""type": "plastic", "albedo": 1, "ior": «0.9"#,
                "/materials/0/ior: 0.9 is out of range; allowed: 1 to 1000",
            ),
            (
                r#""type": "plastic", "albedo": 1, "nonlinear": «1"#,
                "/materials/0/nonlinear: expected true or false, found the number 1",
            ),
            (r#""type": "thin dielectric", "ior": «0"#, "/materials/0/ior: 0 is out of range; allowed: 0.001 to 1000"),
            (
                r#""type": "phong", "albedo": 1, "exponent": «-1"#,
                "/materials/0/exponent: -1 is out of range; allowed: 0 to 1000000",
            ),
            (
                r#""type": "blinnphong", "albedo": «1.2, "exponent": 1"#,
                "/materials/0/albedo: 1.2 is out of range; allowed: 0 to 1",
            ),
            // Degrees, say.
            (
                r#""type": "oren-nayar", "albedo": 1, "sigma": «20"#,
                "/materials/0/sigma: 20 is out of range; allowed: 0 to 1.5 radians",
            ),
            (r#""type": "dielectric", "ior": «0"#, "/materials/0/ior: 0 is out of range; allowed: 0.001 to 1000"),
            (r#""type": "dielectric", "ior": «-1.5"#, "/materials/0/ior: -1.5 is out of range; allowed: 0.001 to 1000"),
            (
                r#""type": "dielectric", "transmittance": «1.5"#,
                "/materials/0/transmittance: 1.5 is out of range; allowed: 0 to 1",
            ),
            (
                r#""type": "diffuse light", "emit": [1, «-1, 1]"#,
                "/materials/0/emit/1: -1 is out of range; allowed: 0 to 3.4e38",
            ),
            (
                r#""type": "diffuse light", "emit": 1, "two_sided": «1"#,
                "/materials/0/two_sided: expected true or false, found the number 1",
            ),
            (
                r#""type": "mirror", "emit": 1, "emit_two_sided": «"yes""#,
                "/materials/0/emit_two_sided: expected true or false, found the string \"yes\"",
            ),
            (
                r#""type": "null", "emit": «1"#,
                "/materials/0/emit: a \"null\" surface cannot emit: it is not there; give the light a surface of its own",
            ),
            (
                r#""type": "mirror", «"opacity": 1"#,
                "/materials/0/opacity: unknown key \"opacity\"; allowed: type, name, albedo, emit, emit_two_sided",
            ),
            (
                r#""type": "metal", «"color": 1"#,
                "/materials/0/color: unknown key \"color\"; did you mean \"albedo\"? allowed: type, name, albedo, roughness, emit, emit_two_sided",
            ),
            (
                r#""type": "diffuse light", "emit": 1, «"color": 1"#,
                "/materials/0/color: unknown key \"color\"; did you mean \"emit\"? allowed: type, name, emit, two_sided",
            ),
            // A slip in one is told all the same.
            (
                r#""type": "metal", «"rougness": 1"#,
                "/materials/0/rougness: unknown key \"rougness\"; did you mean \"roughness\"? allowed: type, name, albedo, roughness, emit, emit_two_sided",
            ),
        ],
    );
    expect_errors(
        r#"{"camera": {}, "materials": [«{"name": "m", "type": "lambertian"}]}"#,
        &["/materials/0: \"albedo\" is missing"],
    );
    expect_errors(
        r#"{"camera": {}, "materials": [«{"name": "m", "type": "diffuse light"}]}"#,
        &["/materials/0: \"emit\" is missing"],
    );
    expect_errors(r#"{"camera": {}, "materials": [«{"type": "mirror"}]}"#, &["/materials/0: \"name\" is missing"]);
    expect_errors(
        r#"{"camera": {}, "materials": [{"name": "m", "type": "mirror"}, {"name": «"m", "type": "null"}]}"#,
        &["/materials/1/name: duplicate material name \"m\"; names must differ"],
    );
    for (keys, missing) in [
        (r#""type": "plastic""#, "\"albedo\""),
        (r#""type": "oren-nayar", "albedo": 1"#, "\"sigma\""),
        (r#""type": "phong", "albedo": 1"#, "\"exponent\""),
        (r#""type": "blinnphong", "exponent": 1"#, "\"albedo\""),
        (r#""type": "conductor", "eta": 1"#, "\"k\""),
        (r#""type": "conductor", "k": 1"#, "\"eta\""),
        (r#""type": "conductor""#, "\"albedo\", or \"eta\" and \"k\","),
    ] {
        expect_errors(
            &format!(r#"{{"camera": {{}}, "materials": [«{{"name": "m", {keys}}}]}}"#),
            &[&format!("/materials/0: {missing} is missing")],
        );
    }
}

#[test]
fn dangling_names() {
    expect_errors(
        r#"{"camera": {}, "surfaces": [{"type": "quad", "material": «"white"}]}"#,
        &["/surfaces/0/material: no material is named \"white\"; there are no named materials"],
    );
    expect_errors(
        r#"{"camera": {}, "surfaces": [{"type": "quad", "material": «"whit"}],
            "materials": [{"name": "red", "type": "mirror"}, {"name": "white", "type": "mirror"}]}"#,
        &["/surfaces/0/material: no material is named \"whit\"; did you mean \"white\"? known: red, white"],
    );
    expect_errors(
        r#"{"camera": {}, "surfaces": [{"type": "quad", "material": «7}]}"#,
        &["/surfaces/0/material: expected the name of a material or a material object, found the number 7"],
    );
}

#[test]
fn surfaces() {
    each(
        r#"{"camera": {}, "surfaces": [{"material": {"type": "mirror"}, @}]}"#,
        &[
            (r#""type": "sphere", "radius": «0"#, "/surfaces/0/radius: 0 is out of range; allowed: above 0"),
            (r#""type": "sphere", "radius": «-2"#, "/surfaces/0/radius: -2 is out of range; allowed: above 0"),
            (r#""type": "disk", "radius": «0"#, "/surfaces/0/radius: 0 is out of range; allowed: above 0"),
            (r#""type": "quad", "size": [1, «0]"#, "/surfaces/0/size/1: 0 is out of range; allowed: above 0"),
            (
                r#""type": "quad", "transform": «{"scale": [0, 1, 1]}"#,
                "/surfaces/0/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
            ),
            (
                r#""type": "quad", "flip_normals": «"yes""#,
                "/surfaces/0/flip_normals: expected true or false, found the string \"yes\"",
            ),
            (
                r#""type": "quad", «"radius": 1"#,
                "/surfaces/0/radius: unknown key \"radius\"; allowed: type, transform, material, flip_normals, size, opacity, normal_map, bump_map",
            ),
        ],
    );
    for later in ["cube", "cylinder", "group", "instance"] {
        expect_errors(
            &format!(r#"{{"camera": {{}}, "surfaces": [{{"type": «"{later}", "name": "x"}}]}}"#),
            &[&format!(
                "/surfaces/0/type: surface type \"{later}\" is not supported yet; supported: quad, sphere, disk, triangle, \
                 mesh, delta point"
            )],
        );
    }
    expect_errors(
        r#"{"camera": {}, "surfaces": [«{"material": {"type": "mirror"}}]}"#,
        &["/surfaces/0: \"type\" is missing"],
    );
    expect_errors(r#"{"camera": {}, "surfaces": [«{"type": "quad"}]}"#, &["/surfaces/0: \"material\" is missing"]);
}

/// What does not depend on the mistake is checked all the same: the rest as that type which was surely meant, or else
/// what all types share.
#[test]
fn a_mistake_in_the_type_hides_no_other() {
    const SURFACES: &str = "quad, sphere, disk, triangle, mesh, delta point";
    // What was meant is near: everything is checked.
    expect_errors(
        r#"{"camera": {}, "surfaces": [{"type": «"qaud", "size": [1, «0], «"sise": 1, "transform": «{"scale": 0},
            "flip_normals": «1, "material": {"type": «"dieletric", "ior": «0, "transmittance": «2}}]}"#,
        &[
            &format!("/surfaces/0/type: unknown surface type \"qaud\"; did you mean \"quad\"? allowed: {SURFACES}"),
            "/surfaces/0/size/1: 0 is out of range; allowed: above 0",
            "/surfaces/0/sise: unknown key \"sise\"; did you mean \"size\"? allowed: type, transform, material, flip_normals, size, opacity, normal_map, bump_map",
            "/surfaces/0/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
            "/surfaces/0/flip_normals: expected true or false, found the number 1",
            &format!(
                "/surfaces/0/material/type: unknown material type \"dieletric\"; did you mean \"dielectric\"? allowed: {MATERIALS}"
            ),
            "/surfaces/0/material/ior: 0 is out of range; allowed: 0.001 to 1000",
            "/surfaces/0/material/transmittance: 2 is out of range; allowed: 0 to 1",
        ],
    );
    // Nothing is near, or the type is missing or no string: what all share.
    expect_errors(
        r#"{"camera": {}, "materials": [
            «{"type": «"velvet", "albedo": «2, «"fluff": 1}, ««{"albedo": 0, "emit": «-1}, {"type": «3, "name": «4}],
           "surfaces": [«{"type": «"teapot", "flip_normals": «0}, «{"material": «"none", "transform": «1}],
           "lights": [{"type": «"lava", "position": «"up"}]}"#,
        &[
            "/materials/0: \"name\" is missing",
            &format!("/materials/0/type: unknown material type \"velvet\"; allowed: {MATERIALS}"),
            "/materials/0/albedo: 2 is out of range; allowed: 0 to 1",
            "/materials/0/fluff: unknown key \"fluff\"; allowed: type, name, albedo, two_sided, emit, emit_two_sided, ior, transmittance, inner_angle, outer_angle, falloff, profile, a, b, amount, roughness, eta, k, fresnel, masking, nonlinear, exponent, sigma",
            "/materials/1: \"type\" is missing",
            "/materials/1: \"name\" is missing",
            "/materials/1/emit: -1 is out of range; allowed: 0 to 3.4e38",
            "/materials/2/type: expected a string, found the number 3",
            "/materials/2/name: expected a string, found the number 4",
            "/surfaces/0: \"material\" is missing",
            &format!("/surfaces/0/type: unknown surface type \"teapot\"; allowed: {SURFACES}"),
            "/surfaces/0/flip_normals: expected true or false, found the number 0",
            "/surfaces/1: \"type\" is missing",
            "/surfaces/1/material: no material is named \"none\"; there are no named materials",
            "/surfaces/1/transform: expected an object or an array of objects, found the number 1",
            "/lights/0/type: unknown light type \"lava\"; allowed: point, spot, directional, constant, environment",
            "/lights/0/position: expected an array of 3 numbers, or one number for all, found the string \"up\"",
        ],
    );
    // Of a type that is still to come only what every surface has is known.
    expect_errors(
        r#"{"camera": {"type": «"fisheye", "vfov": «0}, "surfaces": [
            {"type": «"cube", "edge": 1, "transform": «{"scale": 0}, "material": «"none"}]}"#,
        &[
            "/camera/type: unknown camera type \"fisheye\"; allowed: perspective, orthographic",
            "/camera/vfov: 0 is out of range; allowed: between 0 and 180 degrees",
            &format!("/surfaces/0/type: surface type \"cube\" is not supported yet; supported: {SURFACES}"),
            "/surfaces/0/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
            "/surfaces/0/material: no material is named \"none\"; there are no named materials",
        ],
    );
    // Within one light, one background, one transform.
    expect_errors(
        r#"{"camera": {"transform": «{"from": «"here", "at": 0, "to": 0}}, "background": {"type": «"constnat", "color": «-1},
            "lights": [{"type": "spot", "position": «"here", "at": «"there", "intensity": 1, "inner_angle": «30,
                        "outer_angle": 20, "profile": «"square"}]}"#,
        &[
            "/camera/transform: \"at\" and \"to\" mean the same; give one of them",
            "/camera/transform/from: expected an array of 3 numbers, or one number for all, found the string \"here\"",
            "/background/type: unknown background type \"constnat\"; did you mean \"constant\"? allowed: constant, image",
            "/background/color: -1 is out of range; allowed: 0 to 3.4e38",
            "/lights/0/position: expected an array of 3 numbers, or one number for all, found the string \"here\"",
            "/lights/0/at: expected an array of 3 numbers, or one number for all, found the string \"there\"",
            "/lights/0/inner_angle: inner_angle 30 exceeds outer_angle 20; allowed: at most as large",
            "/lights/0/profile: unknown spot profile \"square\"; allowed: cosine, angle",
        ],
    );
}

#[test]
fn delta_points_and_their_lights() {
    each(
        r#"{"camera": {}, "surfaces": [{"type": "delta point", "material": @}]}"#,
        &[
            (
                r#"«{"type": "mirror"}"#,
                "/surfaces/0/material: a \"delta point\" cannot be \"mirror\": it has no area; allowed: \"point light\", \"spot light\"",
            ),
            (r#"«{"type": "point light"}"#, "/surfaces/0/material: \"emit\" is missing"),
            (
                r#"{"type": "point light", "emit": «-1}"#,
                "/surfaces/0/material/emit: -1 is out of range; allowed: 0 to 3.4e38",
            ),
            (
                r#"{"type": "spot light", "emit": 1, "inner_angle": «40, "outer_angle": 30}"#,
                "/surfaces/0/material/inner_angle: inner_angle 40 exceeds outer_angle 30; allowed: at most as large",
            ),
            (
                r#"{"type": "spot light", "emit": 1, "inner_angle": 20, "outer_angle": «181}"#,
                "/surfaces/0/material/outer_angle: 181 is out of range; allowed: 0 to 180 degrees",
            ),
            (
                r#"{"type": "spot light", "emit": 1, "inner_angle": «-1, "outer_angle": 30}"#,
                "/surfaces/0/material/inner_angle: -1 is out of range; allowed: 0 to 180 degrees",
            ),
            (
                r#"{"type": "spot light", "emit": 1, "inner_angle": 20, "outer_angle": 30, "falloff": «-1}"#,
                "/surfaces/0/material/falloff: -1 is out of range; allowed: 0 to 10000",
            ),
            (
                r#"{"type": "spot light", "emit": 1, "inner_angle": 20, "outer_angle": 30, "profile": «"angel"}"#,
                "/surfaces/0/material/profile: unknown spot profile \"angel\"; did you mean \"angle\"? allowed: cosine, angle",
            ),
            (
                r#"{"type": "spot light", "emit": 1, "inner_angle": 20, "outer_angle": 30, "profile": «3}"#,
                "/surfaces/0/material/profile: expected a string, found the number 3",
            ),
            (
                r#"{"type": "spot light", "emit": 1, "inner_angle": 20, "outer_angle": 30, "profile": "angle", "falloff": «0.5}"#,
                "/surfaces/0/material/falloff: the spot profile \"angle\" falls linearly and takes no \"falloff\"; leave it out, or choose the profile \"cosine\"",
            ),
        ],
    );
    expect_errors(
        r#"{"camera": {}, "surfaces": [{"type": "sphere", "material": «{"type": "point light", "emit": 1}}]}"#,
        &[
            "/surfaces/0/material: a \"point light\" material has no place on a \"sphere\"; allowed: on a \"delta point\"",
        ],
    );
    for (inner, outer) in [(0, 0), (30, 30), (0, 90), (180, 180)] {
        read(&format!(
            r#"{{"camera": {{}}, "surfaces": [{{"type": "delta point", "material":
                {{"type": "spot light", "emit": 1, "inner_angle": {inner}, "outer_angle": {outer}}}}}]}}"#
        ))
        .unwrap();
    }
}

#[test]
fn lights() {
    each(
        r#"{"camera": {}, "lights": [{"position": [1, 2, 3], "intensity": 1, "inner_angle": 10, "outer_angle": 20, @}]}"#,
        &[
            (
                r#""type": "spot", "at": «[1, 2, 3]"#,
                "/lights/0/at: \"at\" [1, 2, 3] is the spot's own position: it points nowhere; they must differ",
            ),
            (
                r#""type": "spot", "direction": «0"#,
                "/lights/0/direction: the direction 0 has length 0: it points nowhere; it must not be zero",
            ),
            (
                r#""type": "spot", "direction": 1, "at": «0"#,
                "/lights/0/at: \"at\" and \"direction\" both aim the spot; give one of them",
            ),
        ],
    );
    expect_errors(
        r#"{"camera": {}, "lights": [«{"type": "spot", "position": 0, "intensity": 1, "inner_angle": 1, "outer_angle": 2}]}"#,
        &["/lights/0: \"at\" or \"direction\" is missing: the spot aims nowhere"],
    );
    expect_errors(
        r#"{"camera": {}, "lights": [{"type": "point", "position": 0, "intensity": «-2}]}"#,
        &["/lights/0/intensity: -2 is out of range; allowed: 0 to 3.4e38"],
    );
    expect_errors(
        r#"{"camera": {}, "lights": [{"type": "spot", "position": 0, "direction": 1, "intensity": 1, "inner_angle": «3, "outer_angle": 2}]}"#,
        &["/lights/0/inner_angle: inner_angle 3 exceeds outer_angle 2; allowed: at most as large"],
    );
}

#[test]
fn what_is_not_supported_yet() {
    each(
        r#"{"camera": {}, @}"#,
        &[(
            r#""media": [{}], "surfaces": [{"type": "quad", "material": {"type": "mirror"}, «"medium": "fog"}]"#,
            "/surfaces/0/medium: \"medium\": participating media are not supported; supported here: type, transform, material, flip_normals, size, opacity, normal_map, bump_map",
        )],
    );
}

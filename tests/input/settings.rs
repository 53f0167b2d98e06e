//! Camera, transforms, integrator, sampler.

use super::{each, expect_errors, read};

#[test]
fn camera() {
    each(
        r#"{"camera": {@}}"#,
        &[
            (
                r#""resolution": [64, «0]"#,
                "/camera/resolution/1: 0 is out of range; allowed: whole numbers from 1 to 65536",
            ),
            (r#""resolution": «-1"#, "/camera/resolution: -1 is out of range; allowed: whole numbers from 1 to 65536"),
            (
                r#""resolution": [«65537, 1]"#,
                "/camera/resolution/0: 65537 is out of range; allowed: whole numbers from 1 to 65536",
            ),
            (
                r#""resolution": [64, «1.5]"#,
                "/camera/resolution/1: 1.5 is out of range; allowed: whole numbers from 1 to 65536",
            ),
            (
                r#""resolution": «[32768, 8193]"#,
                "/camera/resolution: 32768 × 8193 pixels are too many; allowed: 268435456 in all",
            ),
            (r#""vfov": «0"#, "/camera/vfov: 0 is out of range; allowed: between 0 and 180 degrees"),
            (r#""vfov": «180"#, "/camera/vfov: 180 is out of range; allowed: between 0 and 180 degrees"),
            (r#""vfov": «-40"#, "/camera/vfov: -40 is out of range; allowed: between 0 and 180 degrees"),
            (r#""fdist": «0"#, "/camera/fdist: 0 is out of range; allowed: above 0"),
            (r#""aperture": «-0.1"#, "/camera/aperture: -0.1 is out of range; allowed: 0 or above"),
            (
                r#""type": «"fisheye", "height": 1, "vfov": 3"#,
                "/camera/type: unknown camera type \"fisheye\"; allowed: perspective, orthographic",
            ),
            (r#""type": "orthographic", "height": «0"#, "/camera/height: 0 is out of range; allowed: above 0"),
            (
                r#""type": "orthographic", "height": 1, «"vfov": 40"#,
                "/camera/vfov: unknown key \"vfov\"; allowed: type, transform, resolution, height, filter",
            ),
            (
                r#"«"height": 1"#,
                "/camera/height: unknown key \"height\"; allowed: type, transform, resolution, vfov, fdist, aperture, \
                 filter",
            ),
            (r#""filter": «{"radius": 1}"#, "/camera/filter: \"type\" is missing"),
            (
                r#""filter": {"type": «"mitchell"}"#,
                "/camera/filter/type: unknown filter \"mitchell\"; allowed: box, tent, gaussian",
            ),
            (
                r#""filter": {"type": "tent", "radius": «0}"#,
                "/camera/filter/radius: 0 is out of range; allowed: 0.01 to 100 pixels",
            ),
            (
                r#""filter": {"type": "gaussian", «"sigma": 1}"#,
                "/camera/filter/sigma: unknown key \"sigma\"; allowed: type, radius",
            ),
        ],
    );
    expect_errors(r#"{"camera": «{"type": "orthographic"}}"#, &["/camera: \"height\" is missing"]);
    for good in [
        "",
        r#""aperture": 0.1, "fdist": 2, "filter": {"type": "gaussian"}"#,
        r#""type": "orthographic", "height": 3, "filter": {"type": "tent", "radius": 0.5}"#,
        r#""vfov": 0.001"#,
        r#""vfov": 179.9"#,
        r#""resolution": 1"#,
        r#""resolution": [1, 65536]"#,
        r#""resolution": [65536, 4096]"#,
        r#""aperture": 0, "type": "perspective", "filter": {"type": "box", "radius": 0.5}"#,
    ] {
        read(&format!(r#"{{"camera": {{{good}}}}}"#)).unwrap();
    }
}

#[test]
fn transforms() {
    each(
        r#"{"camera": {"transform": @}}"#,
        &[
            (
                r#"«{"from": [1, 2, 3], "at": [1, 2, 3]}"#,
                "/camera/transform: \"from\" and \"at\" are the same point [1, 2, 3]; they must differ",
            ),
            (
                r#"{"from": [0, 5, 0], "at": 0, "up": «[0, 2, 0]}"#,
                "/camera/transform/up: \"up\" [0, 2, 0] is parallel to the view [0, -5, 0]; it must not be",
            ),
            (
                r#"{"from": [0, 5, 0], "at": 0, "up": «0}"#,
                "/camera/transform/up: \"up\" [0, 0, 0] has length 0: it points nowhere; it must not be zero",
            ),
            (
                r#"{"x": 1, "y": [0, 2, 0], "z": «0}"#,
                "/camera/transform/z: the axis \"z\" has length 0: it points nowhere; it must not be zero",
            ),
            // The default up vector is y.
            (
                r#"«{"from": [0, 5, 0], "at": 0}"#,
                "/camera/transform: \"up\" [0, 1, 0] is parallel to the view [0, -5, 0]; it must not be",
            ),
            (r#"«{"at": 0, "to": 0}"#, "/camera/transform: \"at\" and \"to\" mean the same; give one of them"),
            (
                r#"«{"scale": [1, 0, 1]}"#,
                "/camera/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
            ),
            (
                r#"[{"translate": 1}, «{"scale": 0}]"#,
                "/camera/transform/1: the transform is singular: it flattens space; allowed: matrices with an inverse",
            ),
            (
                r#"«{"x": [1, 2, 3], "y": [4, 5, 6], "z": [7, 8, 9]}"#,
                "/camera/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
            ),
            (
                r#"«{"matrix": [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1]}"#,
                "/camera/transform: the transform is singular: it flattens space; allowed: matrices with an inverse",
            ),
            (
                r#"{"matrix": «[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]}"#,
                "/camera/transform/matrix: the last row is [0.0, 0.0, 1.0, 1.0]; allowed: 0, 0, 0, 1 (no perspective)",
            ),
            (
                r#"{"matrix": «[1, 0, 0]}"#,
                "/camera/transform/matrix: expected an array of 16 numbers, row by row, found an array of 3",
            ),
            (
                r#"{"axis": «0, "angle": 90}"#,
                "/camera/transform/axis: the rotation's axis [0, 0, 0] has length 0: it points nowhere; it must not be zero",
            ),
            (r#"«{"axis": [0, 0, 1]}"#, "/camera/transform: \"angle\" is missing"),
            (
                r#"{"rotate": «[90, 0, 0, 0]}"#,
                "/camera/transform/rotate: the rotation's axis [0, 0, 0] has length 0: it points nowhere; it must not be zero",
            ),
            (
                r#"{"translate": [0, «1e999, 0]}"#,
                "/camera/transform/translate/1: 1e999 is not a finite 64-bit number; allowed: any finite number",
            ),
            (r#"{"translate": 1, «"scale": 2}"#, "/camera/transform/scale: unknown key \"scale\"; allowed: translate"),
            (
                r#"«{}"#,
                "/camera/transform: no transform; allowed: {from, at, up}, {o, x, y, z}, {translate}, {scale}, {axis, angle}, {rotate}, {matrix}",
            ),
            (
                r#"«[{"scale": 1e200}, {"scale": 1e200}]"#,
                "/camera/transform: the transform overflows; allowed: finite matrices",
            ),
            (r#"«3"#, "/camera/transform: expected an object or an array of objects, found the number 3"),
        ],
    );
}

#[test]
fn integrator_and_sampler() {
    const INTEGRATORS: &str = "auto, bdpt, path, light, path_tracer_mis, path_tracer_nee, path_tracer_mats, path_tracer_mixture, path_tracer_simple";
    each(
        r#"{"camera": {}, @}"#,
        &[
            (
                r#""integrator": «"bpdt""#,
                &format!("/integrator: unknown integrator \"bpdt\"; did you mean \"bdpt\"? allowed: {INTEGRATORS}"),
            ),
            (
                r#""integrator": {"type": «"normals"}"#,
                &format!(
                    "/integrator/type: \"normals\" is no integrator here: auxiliary images (AOVs), such as the shading normal, come beside the picture (--aovs); allowed: {INTEGRATORS}"
                ),
            ),
            (
                r#""integrator": {"max_bounces": «-1}"#,
                "/integrator/max_bounces: -1 is out of range; allowed: whole numbers from 0 to 1000000",
            ),
            (
                r#""integrator": {"heuristic": «"max"}"#,
                "/integrator/heuristic: unknown heuristic \"max\"; allowed: power, balance, uniform",
            ),
            (
                r#""image_samples": «0"#,
                "/image_samples: 0 is out of range; allowed: whole numbers from 1 to 4294967295",
            ),
            (
                r#""image_samples": «1.5"#,
                "/image_samples: 1.5 is out of range; allowed: whole numbers from 1 to 4294967295",
            ),
            (
                r#""sampler": {"samples": «0}"#,
                "/sampler/samples: 0 is out of range; allowed: whole numbers from 1 to 4294967295",
            ),
            (
                r#""sampler": {"type": «"poisson"}"#,
                "/sampler/type: unknown sampler \"poisson\"; allowed: sobol, independent, stratified, halton",
            ),
            (
                r#""sampler": {"seed": «-1}"#,
                "/sampler/seed: -1 is out of range; allowed: whole numbers from 0 to 18446744073709551615",
            ),
        ],
    );
    assert!(read(r#"{"camera": {}, "integrator": "ao"}"#).unwrap_err().contains("(AOVs), such as the depth"));
}

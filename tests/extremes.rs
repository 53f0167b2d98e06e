//! Samplers at the ends of their numbers, 0 and the last below 1: a sample or none, never a broken one. (BSDFs, warps, filters
//! and the film have such tests beside them.)

mod common;

use serde_json::{Value, json};
use twinlight::camera::LensNumbers;
use twinlight::light::{LightPoint, Receiver};
use twinlight::math::Vec3;
use twinlight::scene::Scene;

use common::{DefaultAccel, scene};

/// The last numbers below 1 of f32 and of f64.
const LAST: f32 = 1.0 - 0.5 * f32::EPSILON;
const LAST_F64: f64 = 1.0 - 0.5 * f64::EPSILON;

const ENDS: [f32; 5] = [0.0, f32::MIN_POSITIVE, 0.5, 0.999_999_9, LAST];
const ENDS_F64: [f64; 4] = [0.0, f64::MIN_POSITIVE, 0.5, LAST_F64];

/// Every kind of light.
fn lights() -> Vec<(&'static str, Value)> {
    let surface = |shape: Value| {
        let mut shape = shape;
        shape["material"] = json!({ "type": "diffuse light", "emit": [3, 2, 1] });
        json!({ "surfaces": [shape] })
    };
    let light = |light: Value| json!({ "lights": [light] });
    let spot = |inner: f64, outer: f64, profile: Value| {
        let mut spot = json!({ "type": "spot", "position": [0.1, 0.8, 0.2], "at": [0, 0, 0], "intensity": 2,
                               "inner_angle": inner, "outer_angle": outer });
        spot.as_object_mut().expect("an object").extend(profile.as_object().expect("an object").clone());
        light(spot)
    };
    let mesh = json!({ "type": "mesh", "indices": [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]],
        "positions": [[0, 0, 0.15], [0.25, 0.2, 0], [-0.2, 0.2, 0], [-0.2, -0.25, 0], [0.2, -0.2, 0]] });
    vec![
        ("quad", surface(json!({ "type": "quad", "size": [0.5, 0.3] }))),
        (
            "skewed quad",
            surface(json!({ "type": "mesh", "indices": [[0, 1, 2, 3]],
            "positions": [[0, 0, 0], [1, 0, 0], [1.3, 0.5, 0], [0.3, 0.5, 0]] })),
        ),
        ("triangle", surface(json!({ "type": "triangle", "positions": [[0, 0, 0], [0.6, 0.1, 0], [0.1, 0.5, 0.1]] }))),
        ("needle", surface(json!({ "type": "triangle", "positions": [[0, 0, 0], [1, 0, 0], [0.5, 1e-7, 0]] }))),
        ("mesh", surface(mesh)),
        ("sphere", surface(json!({ "type": "sphere", "radius": 0.2 }))),
        ("ellipsoid", surface(json!({ "type": "sphere", "transform": { "scale": [0.1, 0.3, 0.2] } }))),
        ("disk", surface(json!({ "type": "disk", "radius": 0.3 }))),
        ("point", light(json!({ "type": "point", "position": [0.1, 0.8, 0.2], "intensity": 1 }))),
        ("spot", spot(10.0, 40.0, json!({ "falloff": 2.0 }))),
        ("hard spot", spot(30.0, 30.0, json!({}))),
        ("narrow spot", spot(0.0, 1e-4, json!({}))),
        ("spot all around", spot(180.0, 180.0, json!({}))),
        ("linear spot", spot(10.0, 40.0, json!({ "profile": "angle" }))),
        ("directional", light(json!({ "type": "directional", "direction": [0.2, -1, 0.3], "irradiance": 1 }))),
        ("constant", light(json!({ "type": "constant", "radiance": 0.5 }))),
    ]
}

fn with_a_floor(mut file: Value) -> Scene<DefaultAccel> {
    let floor = json!({ "type": "quad", "size": 2, "transform": [{ "rotate": [-90, 1, 0, 0] }, { "translate": [0, -0.5, 0] }],
                        "material": { "type": "lambertian", "albedo": 0.5 } });
    file["camera"] = json!({ "transform": { "from": [0, 0, 3], "at": [0, 0, 0] }, "resolution": [4, 4] });
    if file.get("surfaces").is_none() {
        file["surfaces"] = json!([]);
    }
    file["surfaces"].as_array_mut().expect("surfaces").push(floor);
    scene(&file)
}

fn is_unit(w: Vec3) -> bool {
    (w.length() - 1.0).abs() < 1e-5
}

fn is_there(point: &LightPoint) -> bool {
    match point {
        LightPoint::Surface(at) => at.p().is_finite() && is_unit(at.ng),
        LightPoint::Delta(place) => place.p.is_finite(),
        LightPoint::Infinite(toward) => is_unit(*toward),
    }
}

#[test]
fn light_subpaths_start_well_at_the_ends() {
    for (name, file) in lights() {
        let scene = with_a_floor(file);
        let light = &scene.lights[0];
        let mut seen = 0;
        for u_part in ENDS_F64 {
            for (a, b) in ENDS.iter().flat_map(|a| ENDS.map(|b| (*a, b))) {
                for (c, d) in ENDS.iter().flat_map(|c| ENDS.map(|d| (*c, d))) {
                    let Some(s) = light.sample_emission(&scene.geometry, u_part, [a, b], [c, d]) else { continue };
                    let case = format!("{name} at {u_part} {a} {b} {c} {d}: {s:?}");
                    assert!(is_there(&s.point) && s.origin.is_finite() && is_unit(s.w), "{case}");
                    assert!(s.le.is_finite() && s.le.min_element() >= 0.0, "{case}");
                    let (position, direction) = (s.pdf_position.0, s.pdf_direction.0);
                    assert!(position > 0.0 && position.is_finite(), "{case}");
                    assert!(direction > 0.0 && direction.is_finite(), "{case}");
                    // What a light subpath starts with.
                    let beta = s.le * (s.point.cos(s.w) / (position * direction)) as f32;
                    assert!(beta.is_finite(), "{case}");
                    // What was sampled has the density that it is asked for later.
                    let again = light.pdf_emission_position(&scene.geometry, &s.point).0;
                    assert!((again / position - 1.0).abs() < 1e-4, "{case}: {again}");
                    let again = light.pdf_emission_direction(&s.point, s.w).0;
                    // Even at a spot's rim: what rounding carries out of the cone is no sample.
                    assert!((again / direction - 1.0).abs() < 1e-3, "{case}: {again}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 500, "{name}: {seen} samples");
    }
}

#[test]
fn next_event_estimation_chooses_well_at_the_ends() {
    for (name, file) in lights() {
        let scene = with_a_floor(file);
        let choice = scene.light_choice.as_ref().expect("a light");
        let light = &scene.lights[0];
        let mut seen = 0;
        for from in [[0.3, -0.5, 0.2], [0.0, 1e-4, 0.0], [-0.9, 0.3, 0.4], [0.01, 0.01, 0.02]].map(Vec3::from_array) {
            let receiver = Receiver::anywhere(from);
            for u in ENDS_F64 {
                let Some((id, part, pmf)) = choice.sample_direct(&receiver, || u) else { continue };
                assert!(id == 0 && pmf.0 > 0.0 && pmf.0 <= 1.0, "{name}: {id} {pmf:?}");
                for (a, b) in ENDS.iter().flat_map(|a| ENDS.map(|b| (*a, b))) {
                    let Some(s) = light.sample_direct(&scene.geometry, from, part, 0.0, [a, b]) else { continue };
                    let case = format!("{name} from {from} at {u} {a} {b}: {s:?}");
                    assert!(is_there(&s.point) && s.pdf.0 > 0.0 && s.pdf.0.is_finite(), "{case}");
                    let again = light.pdf_direct(&scene.geometry, from, &s.point).0;
                    assert!((again / s.pdf.0 - 1.0).abs() < 1e-3, "{case}: {again}");
                    let Some(edge) = s.point.edge_from(from) else { continue };
                    assert!(is_unit(edge.wi) && edge.d2 > 0.0 && (0.0..=1.0 + 1e-6).contains(&edge.cos), "{case}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 50, "{name}: {seen} samples");
    }
}

#[test]
fn cameras_are_sound_at_the_ends() {
    let look = json!({ "from": [0, 0, 3], "at": [0, 0, 0] });
    for camera in [
        json!({ "transform": look, "vfov": 60 }),
        json!({ "transform": look, "vfov": 179.9 }),
        json!({ "transform": look, "vfov": 0.001, "filter": { "type": "tent", "radius": 1.5 } }),
        json!({ "transform": look, "vfov": 60, "aperture": 0.2, "fdist": 2, "filter": { "type": "gaussian" } }),
        json!({ "transform": look, "type": "orthographic", "height": 2, "filter": { "type": "box", "radius": 2 } }),
    ] {
        let mut camera = camera;
        camera["resolution"] = json!([3, 2]);
        let file = json!({ "camera": camera, "surfaces": [{ "type": "quad", "size": 1,
                           "material": { "type": "diffuse light", "emit": 1 } }] });
        let scene = scene(&file);
        let mut seen = 0;
        for (x, y) in (0..3).flat_map(|x| (0..2).map(move |y| (x, y))) {
            for (a, b) in ENDS.iter().flat_map(|a| ENDS.map(|b| (*a, b))) {
                for lens in ENDS.iter().flat_map(|c| ENDS.map(|d| [*c, d])) {
                    let ray = scene.camera.generate_ray([x, y], [a, b], lens);
                    assert!(ray.ray.o.is_finite() && is_unit(ray.ray.d), "{camera}: {ray:?}");
                    // At the very end of a filter that reaches over the image's edge no pixel covers the place.
                    let covered = camera.get("filter").is_none() || ![a, b].iter().any(|u| *u < 1e-3 || *u > 0.999);
                    assert!(ray.pdf.0.is_finite() && ray.cos > 0.0, "{camera}: {ray:?}");
                    assert!(if covered { ray.pdf.0 > 0.0 } else { ray.pdf.0 >= 0.0 }, "{camera}: {ray:?}");
                    // The point that the ray sees, seen from there.
                    let numbers = LensNumbers { lens, pixel: [a, b] };
                    let Some(back) = scene.camera.sample_lens(ray.ray.o + ray.ray.d * 0.7, &numbers) else { continue };
                    let [px, py] = back.pixel;
                    assert!(px < 3 && py < 2 && is_unit(back.wi), "{camera}: {back:?}");
                    assert!(back.pdf.0 > 0.0 && back.pdf.0.is_finite(), "{camera}: {back:?}");
                    seen += 1;
                }
            }
        }
        assert!(seen > 1000, "{camera}: {seen}");
    }
}

//! Powers of two are exact: brighter lights and larger scenes change the image by exactly their factor, or not at all.

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};

use crate::common::{render_once, scene, settings};

/// A scene whose lengths are multiplied by `scale` and whose emission by `brightness`; intensities follow the scale's
/// square, so that radiance stays.
fn scaled(scale: f64, brightness: f64) -> Value {
    let at = |p: [f64; 3]| json!(p.map(|x| x * scale));
    let material = |albedo: f64| json!({ "type": "lambertian", "albedo": [albedo, 0.5 * albedo, 0.3] });
    let plane = |from: [f64; 3], to: [f64; 3], size: f64, material: Value| {
        // The camera transform's form puts local −z towards `at`: turned over, the quad faces `to`.
        json!({
            "type": "quad", "size": size * scale, "material": material,
            "transform": [{ "from": [0, 0, 0], "at": [from[0] - to[0], from[1] - to[1], from[2] - to[2]], "up": [0.3, 0.7, 0.6] },
                          { "translate": at(from) }]
        })
    };
    let intensity = |i: f64| i * scale * scale * brightness;
    json!({
        "camera": {
            "transform": { "from": at([0.3, 0.4, 3.1]), "at": at([0.0, -0.1, 0.0]), "up": [0, 1, 0] },
            "vfov": 45, "resolution": [16, 12]
        },
        "surfaces": [
            plane([0.1, -1.0, 0.0], [0.1, 0.0, 0.0], 3.0, material(0.8)),
            plane([0.0, 0.0, -1.3], [0.0, 0.1, 0.0], 3.0, material(0.5)),
            plane([0.2, 1.3, 0.1], [0.1, 0.0, 0.0], 0.9, json!({ "type": "diffuse light", "emit": 3.7 * brightness })),
            {
                "type": "sphere", "radius": 0.4 * scale, "transform": { "translate": at([-0.5, -0.6, 0.2]) },
                "material": { "type": "dielectric", "ior": 1.5 }
            },
            {
                "type": "disk", "radius": 0.3 * scale, "material": { "type": "lambertian", "albedo": 0.2, "emit": 1.1 * brightness },
                "transform": [{ "axis": [1, 2, 3], "angle": 50 }, { "translate": at([0.6, -0.3, 0.1]) }]
            },
            {
                "type": "mesh", "positions": [at([0.2, -0.9, 0.4]), at([0.9, -0.8, 0.5]), at([0.5, -0.2, 0.7])],
                "indices": [[0, 1, 2]], "material": { "type": "lambertian", "albedo": 0.6, "two_sided": true }
            }
        ],
        "lights": [
            { "type": "point", "position": at([-0.8, 0.9, 0.3]), "intensity": intensity(1.3) },
            {
                "type": "spot", "position": at([0.9, 0.9, 0.9]), "at": at([0.0, -0.5, 0.0]), "intensity": intensity(2.1),
                "inner_angle": 12, "outer_angle": 33, "falloff": 0.5
            }
        ]
    })
}

const INTEGRATORS: [Integrator; 3] = [Integrator::Path, Integrator::Light, Integrator::Bdpt];

fn image(json: &Value, integrator: Integrator) -> Vec<[f32; 3]> {
    let image = render_once(&scene(json), Settings { seed: 5, ..settings(integrator, 6) }, 8, None).image;
    assert!(image.mean().iter().all(|m| *m > 0.0), "a black image proves nothing");
    image.rgb
}

#[test]
fn emission_times_a_power_of_two_is_the_image_times_it() {
    for integrator in INTEGRATORS {
        let plain = image(&scaled(1.0, 1.0), integrator);
        for k in [-20, -1, 20] {
            let factor = f64::powi(2.0, k);
            let brighter = image(&scaled(1.0, factor), integrator);
            let expected: Vec<[f32; 3]> = plain.iter().map(|p| p.map(|x| x * factor as f32)).collect();
            assert_eq!(brighter, expected, "{integrator:?}, 2^{k}");
        }
    }
}

/// The scene through another camera, whose lengths scale with it.
fn through(scale: f64, camera: usize) -> Value {
    let mut json = scaled(scale, 1.0);
    let keys = match camera {
        0 => json!({}),
        1 => json!({ "aperture": 0.1 * scale, "fdist": 3.0 * scale, "filter": { "type": "gaussian" } }),
        _ => json!({ "type": "orthographic", "height": 2.5 * scale, "filter": { "type": "tent", "radius": 0.7 } }),
    };
    if let (Some(all), Some(keys)) = (json["camera"].as_object_mut(), keys.as_object()) {
        if keys.contains_key("height") {
            all.remove("vfov");
        }
        all.extend(keys.clone());
    }
    json
}

#[test]
fn a_scene_a_power_of_two_larger_is_the_same_image() {
    for integrator in INTEGRATORS {
        for camera in 0..3 {
            let plain = image(&through(1.0, camera), integrator);
            for k in [-20, -3, 20] {
                let larger = image(&through(f64::powi(2.0, k), camera), integrator);
                assert_eq!(larger, plain, "{integrator:?}, camera {camera}, 2^{k}");
            }
        }
    }
}

//! How far rounding takes what `bdpt` makes: contributions and weights of its own samples against f64, and that what is off
//! is off no further than the rounding of the path's points explains.

mod common;

use std::path::Path;

use serde_json::{Value, json};
use twinlight::accel::AccelOptions;
use twinlight::import::scene_from_str;
use twinlight::integrator::{Integrator, Settings};
use twinlight::scene::{Scene, prepare};
use twinlight::stress::{Precision, precision};

use common::{SceneOnDefault, everything, settings};

/// A scene of the project's, small.
fn of_file(name: &str) -> Value {
    let path = format!("{}/scenes/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let mut scene: Value = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{path}: {e}"));
    scene["camera"]["resolution"] = json!([48, 48]);
    scene
}

fn judged(scene: &Value, settings: Settings) -> Precision {
    let desc = scene_from_str(&scene.to_string(), "test.json", Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    let prepared = prepare(&desc).unwrap_or_else(|e| panic!("{e}"));
    let scene: SceneOnDefault = Scene::build(prepared, AccelOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    precision(&scene, settings, 4)
}

#[test]
fn contributions_and_weights_are_those_of_f64_but_for_the_rounding_of_points() {
    let mut lens = everything();
    lens["camera"]["aperture"] = json!(0.1);
    lens["camera"]["fdist"] = json!(2.5);
    lens["camera"]["filter"] = json!({ "type": "gaussian" });
    let mut sky = everything();
    sky["lights"] = json!([{ "type": "constant", "radiance": 0.3 },
                           { "type": "directional", "direction": [0.3, -1, -0.5], "irradiance": 1 }]);
    // Lobes whose half vectors are short, near index 1, and lobes seen from far outside.
    let mut lobes = everything();
    lobes["surfaces"][4]["material"] = json!({ "type": "dielectric", "ior": 1.05, "roughness": 0.1 });
    lobes["surfaces"][5]["material"] = json!({ "type": "phong", "albedo": 0.8, "exponent": 400 });
    let mut facets = everything();
    facets["surfaces"][4]["material"] = json!({ "type": "conductor", "albedo": 0.9, "roughness": [0.02, 0.2] });
    facets["surfaces"][5]["material"] = json!({ "type": "blinnphong", "albedo": 0.8, "exponent": 400 });
    let scenes = [
        ("area", of_file("reference/cornell_area.json")),
        ("glossy", of_file("reference/cornell_glossy.json")),
        ("glass", of_file("reference/cornell_glass.json")),
        ("spot", of_file("reference/cornell_spot.json")),
        ("many lamps", of_file("many-lamps/scene.json")),
        ("everything", everything()),
        ("everything through a lens", lens),
        ("everything below a sky", sky),
        ("lobes", lobes),
        ("facets", facets),
    ];
    for (name, scene) in scenes {
        let found = judged(&scene, settings(Integrator::Bdpt, 8));
        println!("{name}:\n{}", found.text());
        assert!(found.paths() > 2000, "{name}: {} paths", found.paths());
        assert!(found.unjudged() * 100 < found.paths(), "{name}: {} paths are not judged", found.unjudged());
        let [contribution, weight] = found.median();
        assert!(contribution < 2e-7 && weight < 1e-6, "{name}: {contribution:.1e} {weight:.1e}");
        // The rounding of an f32 product is 6e-8 for each of some ten factors.
        let [sum, sizes] = found.image();
        assert!(sum.abs() < 1e-6 && sizes < 1e-5, "{name}: the image is off by {sum:.1e}, its parts by {sizes:.1e}");
        assert!(found.faults().count == 0, "{name}: {}", found.faults());
        let (unbounded, largest) = found.unbounded();
        assert!(unbounded * 1000 < found.paths() && largest < 0.1, "{name}: {unbounded} off by {largest}");
        let [contribution, weight] = found.worst_over_condition();
        // The power heuristic squares densities: a weight is off by up to twice what they are (measured: at most 1.5 times, among
        // many lamps, elsewhere 0.9; contributions 0.7).
        assert!(contribution < 1.0, "{name}: {contribution} times the condition");
        assert!(weight < 2.0, "{name}: {weight} times the condition");
    }
}

/// Render space is recentred: precision does not depend on where the file's origin is.
#[test]
fn a_scene_far_from_its_origin_is_as_precise_as_at_it() {
    let near = everything();
    let mut far = everything();
    let shift = [1024.0, -2048.0, 512.0];
    for surface in far["surfaces"].as_array_mut().expect("surfaces") {
        let own = surface["transform"].take();
        surface["transform"] = match own {
            Value::Array(mut chain) => {
                chain.push(json!({ "translate": shift }));
                Value::Array(chain)
            }
            one => json!([one, { "translate": shift }]),
        };
    }
    let own = far["camera"]["transform"].take();
    far["camera"]["transform"] = json!([own, { "translate": shift }]);
    for light in far["lights"].as_array_mut().expect("lights") {
        for (x, d) in light["position"].as_array_mut().expect("a position").iter_mut().zip(shift) {
            *x = json!(x.as_f64().expect("a number") + d);
        }
        if let Some(at) = light.get_mut("at") {
            for (x, d) in at.as_array_mut().expect("a point").iter_mut().zip(shift) {
                *x = json!(x.as_f64().expect("a number") + d);
            }
        }
    }
    let [near, far] = [near, far].map(|scene| judged(&scene, settings(Integrator::Bdpt, 6)));
    for (near, far) in near.median().into_iter().zip(far.median()) {
        assert!(far < 1.1 * near, "{near:.2e} at the origin, {far:.2e} far from it");
    }
    let [near, far] = [near, far].map(|p| p.image()[1]);
    assert!(far < 2.0 * near, "{near:.2e} at the origin, {far:.2e} far from it");
}

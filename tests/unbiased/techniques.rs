//! Each way of making a path, alone and unweighted, finds all of the light that it can sample.

use std::collections::BTreeMap;

use serde_json::{Value, json};
use twinlight::film::Image;
use twinlight::integrator::{Integrator, Settings, Technique};

use crate::common::{Bounds, Budget, SceneOnDefault, assert_same, images_by_edges, render_once, scene, settings};
use crate::gap_box;

/// Independent images per technique of the unweighted bidirectional integrator.
pub fn unweighted(scene: &SceneOnDefault, budget: Budget, edges: u32) -> BTreeMap<Technique, Vec<Image>> {
    let mut all: BTreeMap<Technique, Vec<Image>> = BTreeMap::new();
    let base = Settings { weighted: false, roulette: false, ..settings(Integrator::Bdpt, edges - 1) };
    for run in 0..u64::from(budget.runs) {
        let settings = Settings { seed: budget.seed + run, ..base };
        for (technique, image) in render_once(scene, settings, budget.samples, Some(edges)).techniques {
            all.entry(technique).or_default().push(image);
        }
    }
    all
}

/// Demands that every technique with `fewest_s` light vertices and more, alone, has the path tracer's image of its
/// length; `bounds` of the mean by number of edges. What is seen of the light itself is compared only where it stands
/// on surfaces: a delta light is not seen, and of one at infinity (1,1) makes nothing.
fn each_alone(what: &str, json: &Value, fewest_s: u32, samples: u32, bounds: [f64; 4], seed: u64) {
    let on_surfaces = json["lights"].as_array().is_none_or(Vec::is_empty);
    let seen = fewest_s == 0 && on_surfaces;
    let scene = scene(json);
    let path = Settings { roulette: false, ..settings(Integrator::Path, 3) };
    let reference = images_by_edges(&scene, path, Budget::new(2 * samples, seed), 4);
    let mut techniques = unweighted(&scene, Budget::new(samples, seed + 1), 4);
    for edges in 1..=4_u32 {
        for s in fewest_s..=edges {
            let t = edges + 1 - s;
            if edges == 1 && !seen {
                techniques.remove(&Technique { s, t });
                continue;
            }
            let what = format!("{what}: ({s},{t}) alone");
            let images = techniques.remove(&Technique { s, t }).unwrap_or_else(|| panic!("{what} contributes nothing"));
            let bound = bounds[edges as usize - 1];
            assert_same(&what, &images, &reference[edges as usize - 1], Bounds::new([2, 2], 4.0 * bound, bound));
        }
    }
    assert!(techniques.is_empty(), "{what}: techniques that are not there: {:?}", techniques.keys());
}

fn area_light() -> Value {
    gap_box(vec![], true, vec![])
}

/// Under a delta light s = 0 has nothing to hit and (1,1) nothing to see; all others must agree.
fn delta_lights() -> Value {
    let lights = vec![
        json!({ "type": "point", "position": [0.3, 0.4, -0.2], "intensity": [1.0, 0.8, 0.6] }),
        json!({
            "type": "spot", "position": [-0.3, 0.3, 0.1], "direction": [0.3, -1, -0.6], "intensity": 2.0,
            "inner_angle": 25, "outer_angle": 50
        }),
    ];
    gap_box(vec![], false, lights)
}

/// The gaps between the walls let in a sky that is brighter on one side. Seen from outside all around, so that light
/// subpaths that enter are few: they are compared with more patience.
fn skies() -> [(&'static str, Value, u32); 2] {
    let sky = json!({ "type": "constant", "radiance": [1.0, 2.0, 3.0] });
    let sun = json!({ "type": "directional", "direction": [0.2, -1.0, -0.45], "irradiance": [3.0, 2.0, 1.0] });
    let open = |light| {
        let mut scene = gap_box(vec![], false, vec![light]);
        // Without its ceiling.
        scene["surfaces"].as_array_mut().expect("surfaces").remove(1);
        scene
    };
    [("sky", open(sky), 0), ("sun", open(sun), 1)]
}

#[test]
fn every_technique_alone_under_light_from_infinity() {
    for (n, (what, json, fewest_s)) in skies().into_iter().enumerate() {
        each_alone(what, &json, fewest_s, 1 << 14, [0.0, 0.025, 0.05, 0.1], 640 + 2 * n as u64);
    }
}

#[test]
#[ignore = "deep"]
fn every_technique_alone_under_light_from_infinity_looked_at_closely() {
    for (n, (what, json, fewest_s)) in skies().into_iter().enumerate() {
        each_alone(what, &json, fewest_s, 1 << 18, [0.0, 0.005, 0.01, 0.02], 660 + 2 * n as u64);
    }
}

#[test]
fn every_technique_alone() {
    each_alone("area light", &area_light(), 0, 1 << 14, [0.01, 0.02, 0.04, 0.06], 600);
    each_alone("delta lights", &delta_lights(), 1, 1 << 14, [0.01, 0.015, 0.03, 0.05], 610);
}

#[test]
#[ignore = "deep"]
fn every_technique_alone_looked_at_closely() {
    each_alone("area light", &area_light(), 0, 1 << 18, [0.005, 0.0075, 0.0125, 0.02], 620);
    each_alone("delta lights", &delta_lights(), 1, 1 << 18, [0.005, 0.0075, 0.0125, 0.02], 630);
}

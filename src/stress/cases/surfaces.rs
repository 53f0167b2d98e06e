//! Materials at their limits.

use serde_json::{Value, json};

use super::super::{Case, Expected};
use super::room::{Room, alone, ball};

pub fn cases(full: bool) -> Vec<Case> {
    let mut all = Vec::new();
    windows(&mut all);
    mirrors(&mut all);
    white(&mut all, full);
    all
}

/// A room with a ball of this material in the middle.
fn ball_in_room(material: Value) -> Value {
    Room::new().with(vec![ball([0.1, -0.1, -0.1], 0.4, material)]).json()
}

fn windows(all: &mut Vec<Case>) {
    for ior in [1.0, 1.0 - 1e-6, 1.0 + 1e-6] {
        let scene = ball_in_room(json!({ "type": "dielectric", "ior": ior }));
        // Light through the ball is found by hitting the lamp alone: noise that the plain room has not.
        let expected = Expected::SameAs { scene: Room::new().json(), times: 1.0 };
        let case = Case::new(format!("ior {ior}"), "a ball of glass that does not bend", scene.clone(), expected);
        all.push(Case { bounces: 12, ..case.closed().from_camera().samples(16).within(0.04) });
        // A window has the same noise; it does not count as a bounce.
        let expected = Expected::SameAs { scene: ball_in_room(json!({ "type": "null" })), times: 1.0 };
        let what = "a ball of glass that does not bend, against a window";
        let case = Case::new(format!("ior {ior}, window"), what, scene, expected);
        all.push(Case { bounces: 24, ..case.closed().from_camera().samples(16).within(0.04) });
    }
}

fn mirrors(all: &mut Vec<Case>) {
    let conductor = |roughness: Value| {
        ball_in_room(json!({ "type": "conductor", "albedo": 0.9, "fresnel": "none", "roughness": roughness }))
    };
    let mirror = ball_in_room(json!({ "type": "mirror", "albedo": 0.9 }));
    let expected = Expected::SameAs { scene: mirror, times: 1.0 };
    let what = "a nearly smooth metal against a mirror";
    let case = Case::new("α 1e-4", what, conductor(json!(1e-4)), expected).closed().from_camera();
    all.push(case.samples(8).within(0.03));
    let what = "a metal brushed one way alone, against itself brushed almost as much";
    let brushed = |narrow: f64| conductor(json!([narrow, 0.5]));
    let expected = Expected::SameAs { scene: brushed(1e-3), times: 1.0 };
    let case = Case::new("α 1e-4 and 0.5", what, brushed(1e-4), expected).closed().from_camera();
    all.push(case.samples(16).within(0.03));
    // Half vectors of refraction are short near index 1.
    let nearly = |roughness: Value| ball_in_room(json!({ "type": "dielectric", "ior": 1.05, "roughness": roughness }));
    let expected = Expected::SameAs { scene: nearly(json!(1e-3)), times: 1.0 };
    let what = "frosted glass that hardly bends, against clear";
    let case = Case::new("ior 1.05, α 0.02", what, nearly(json!(0.02)), expected).closed().from_camera();
    all.push(Case { bounces: 12, ..case.samples(16).within(0.06) });
    let rough = ball_in_room(json!({ "type": "dielectric", "ior": 1.5, "roughness": 1e-4 }));
    let smooth = ball_in_room(json!({ "type": "dielectric", "ior": 1.5 }));
    let expected = Expected::SameAs { scene: smooth, times: 1.0 };
    let what = "nearly smooth glass against smooth glass";
    let case = Case::new("glass, α 1e-4", what, rough, expected).closed().from_camera().samples(32).within(0.06);
    all.push(Case { bounces: 12, ..case });
}

fn white(all: &mut Vec<Case>, full: bool) {
    // Σ ρᵏ L over k = 0 … n, with ρ = 1.
    let mut shell = ball([0.0; 3], 1.0, json!({ "type": "lambertian", "albedo": 1, "emit": 1 }));
    shell["flip_normals"] = json!(true);
    let mut room = alone(vec![shell], vec![]);
    room.camera["resolution"] = json!([1, 1]);
    let bounces = if full { 1000 } else { 100 };
    let case = Case::new(
        format!("white, {bounces} bounces"),
        "a white ball that shines inwards: as many times as bright as paths have edges",
        room.json(),
        Expected::Mean(f64::from(bounces) + 1.0),
    );
    let case = case.closed().samples(if full { 1 } else { 4 }).within(0.02);
    all.push(Case { bounces, roulette: false, ..case.from_camera() });
}

//! The equivalences again, sharply: inside a sphere cosθ cosθ′/d² is 1/(4R²) for every pair of points, so that each
//! connection has the value of its mean, and the radiance of every length of path is known.
//!
//! What varies elsewhere (who sees whom, how much a connection carries) is constant here; the other files have that.

use std::f64::consts::PI;

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;

use crate::common::{
    Bounds, Budget, View, assert_closed, diffuse, expect_colored, facing, images_by_edges, point, quad, scene,
    scene_json, settings, shining_diffuse, sphere,
};
use crate::techniques::unweighted;

const EMITTED: [f64; 3] = [1.0, 0.5, 2.0];
const ALBEDO: [f64; 3] = [0.8, 0.5, 0.4];
const EDGES: u32 = 5;
const CAMERA: DVec3 = DVec3::new(-0.55, 0.55, 0.0);
const AHEAD: DVec3 = DVec3::new(1.0, 0.2, 0.1);

/// Across the sphere, past the centre where light and window are: what is seen is far away, so that splats differ
/// little.
fn view() -> View {
    View { from: CAMERA, at: CAMERA + AHEAD, up: DVec3::Y, vfov: 70.0, resolution: [2, 2] }
}

fn walls(emits: bool) -> Value {
    let material = if emits { shining_diffuse(EMITTED.to_vec(), ALBEDO.to_vec()) } else { diffuse(ALBEDO.to_vec()) };
    sphere(DVec3::ZERO, 1.0, true, material)
}

/// The sphere whose wall shines, with windows.
fn shining(windows: Vec<Value>) -> Value {
    scene_json(view().json(), [vec![walls(true)], windows].concat(), vec![])
}

/// The sphere with a point light of intensity πE at its centre, with windows.
fn point_lit(windows: Vec<Value>) -> Value {
    let light = json!({ "type": "point", "position": point(DVec3::ZERO), "intensity": EMITTED.map(|e| PI * e) });
    scene_json(view().json(), [vec![walls(false)], windows].concat(), vec![light])
}

/// E ρ^(n−1) after n edges in every tile. A point light of intensity πE gives the wall the irradiance πE, which is
/// what a first bounce leaves of a wall that shines E: the same series, but for its first term.
fn radiance(edges: u32) -> Vec<f64> {
    let color = [0, 1, 2].map(|c| EMITTED[c] * ALBEDO[c].powi(edges as i32 - 1));
    expect_colored(&[1.0; 4], color)
}

/// Bounds of the mean; a quarter of the image is held to four times as much.
fn bounds(mean: f64) -> Bounds {
    // Short connections: cosines of points a few hundredths apart are known to that many ulps.
    Bounds { rounding: 5e-5, ..Bounds::new([2, 2], 4.0 * mean, mean) }
}

/// What is asked of every estimate, and what of those that land where chance has them (light tracing).
#[derive(Clone, Copy)]
struct Tier {
    samples: u32,
    bound: f64,
    bound_of_splats: f64,
    seed: u64,
}

const FAST: Tier = Tier { samples: 1 << 13, bound: 0.005, bound_of_splats: 0.015, seed: 640 };
const DEEP: Tier = Tier { samples: 1 << 17, bound: 0.0025, bound_of_splats: 0.005, seed: 1640 };

#[test]
fn every_technique_alone_in_the_sphere() {
    every_technique(FAST);
}

#[test]
#[ignore = "deep"]
fn every_technique_alone_in_the_sphere_looked_at_closely() {
    every_technique(DEEP);
}

#[test]
fn windows_in_the_sphere_change_nothing() {
    windows(FAST);
}

#[test]
#[ignore = "deep"]
fn windows_in_the_sphere_looked_at_closely() {
    windows(DEEP);
}

fn every_technique(tier: Tier) {
    for (what, json, fewest_s, seed) in
        [("shining sphere", shining(vec![]), 0, tier.seed), ("point-lit sphere", point_lit(vec![]), 1, tier.seed + 1)]
    {
        let mut techniques = unweighted(&scene(&json), Budget::new(tier.samples, seed), EDGES);
        for edges in 1 + fewest_s..=EDGES {
            for s in fewest_s..=edges {
                let technique = twinlight::integrator::Technique { s, t: edges + 1 - s };
                let what = format!("{what}: ({s},{}) alone", technique.t);
                let images = techniques.remove(&technique).unwrap_or_else(|| panic!("{what} contributes nothing"));
                let bound = if technique.t == 1 { tier.bound_of_splats } else { tier.bound };
                assert_closed(&what, &images, &radiance(edges), bounds(bound));
            }
        }
        assert!(techniques.is_empty(), "{what}: techniques that are not there: {:?}", techniques.keys());
    }
}

fn windows(tier: Tier) {
    let null = || json!({ "type": "null" });
    let before_wall = sphere(DVec3::ZERO, 0.97, false, null());
    // Both so small that what they keep from each other besides is within rounding.
    let around_light = sphere(DVec3::ZERO, 0.004, false, null());
    let before_camera = quad(&facing(CAMERA + 0.004 * AHEAD, AHEAD), [0.009; 2], null());
    let middle = quad(&facing(DVec3::new(0.0, -0.1, 0.0), DVec3::new(0.1, 1.0, 0.2)), [4.0; 2], null());
    let (path, light, bdpt) = (Integrator::Path, Integrator::Light, Integrator::Bdpt);
    let everywhere = vec![before_wall.clone(), before_camera.clone(), middle.clone()];
    let light_and_camera = vec![around_light.clone(), before_camera.clone()];
    // Who can make the paths, and from how many edges on: see windows.rs.
    let cases = [
        ("before the shining wall", shining(vec![before_wall]), 1, vec![path, bdpt]),
        ("before the camera", shining(vec![before_camera.clone()]), 1, vec![path, bdpt]),
        ("across the middle", shining(vec![middle]), 1, vec![path, bdpt]),
        ("everywhere", shining(everywhere), 1, vec![path, bdpt]),
        ("around the point light", point_lit(vec![around_light]), 2, vec![light, bdpt]),
        ("before the camera, point-lit", point_lit(vec![before_camera]), 2, vec![path, bdpt]),
        ("around the point light and before the camera", point_lit(light_and_camera), 3, vec![bdpt]),
    ];
    for (n, (place, json, fewest, integrators)) in cases.into_iter().enumerate() {
        let scene = scene(&json);
        for integrator in integrators {
            let settings = Settings { roulette: false, ..settings(integrator, EDGES - 1) };
            let splats = integrator == light;
            let samples = if splats { 2 * tier.samples } else { tier.samples / 2 };
            let budget = Budget::new(samples, tier.seed + 10 + n as u64);
            let images = images_by_edges(&scene, settings, budget, EDGES);
            for edges in fewest..=EDGES {
                // Light through a window to the first wall has to be splatted from there.
                let splats = splats || place == "around the point light" && edges == 2;
                let bound = if splats { tier.bound_of_splats } else { tier.bound };
                let what = format!("windows {place}, {integrator:?}, {edges} edges");
                assert_closed(&what, &images[edges as usize - 1], &radiance(edges), bounds(bound));
            }
        }
    }
}

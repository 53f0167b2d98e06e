//! Caustics by light tracing, which carries importance through glass, and by path tracing, which carries radiance.
//!
//! Part of the light starts within the glass: of what crosses the glass in and out again any power of η cancels, of what
//! crosses it once it does not. The glass itself lies out of view: seen directly, light tracing cannot make it.

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;

use crate::common::{
    Bounds, Budget, View, assert_same, diffuse, facing, images_by_edges, quad, scene, scene_json, settings, shining,
    shining_diffuse, sphere,
};

const EDGES: u32 = 5;

/// A room whose ceiling shines; a glass ball and a mirror ball hang behind a camera that looks down on the floor.
fn room(ior: f64) -> Value {
    let view = View {
        from: DVec3::new(0.0, -0.37, 0.0),
        at: DVec3::new(0.0, -1.0, 0.0),
        up: DVec3::Z,
        vfov: 90.0,
        resolution: [2, 2],
    };
    let wall = |z: DVec3| quad(&facing(-z, z), [2.0; 2], diffuse(vec![0.7, 0.6, 0.5]));
    scene_json(
        view.json(),
        vec![
            wall(DVec3::Y),
            wall(DVec3::X),
            wall(-DVec3::X),
            wall(DVec3::Z),
            wall(-DVec3::Z),
            quad(&facing(DVec3::Y, -DVec3::Y), [1.2; 2], shining(vec![4.0, 5.0, 6.0])),
            sphere(DVec3::new(-0.35, 0.1, -0.1), 0.45, false, json!({ "type": "dielectric", "ior": ior })),
            sphere(DVec3::new(-0.35, 0.1, -0.1), 0.15, false, shining_diffuse(vec![9.0, 6.0, 3.0], 0.6)),
            sphere(DVec3::new(0.5, 0.2, -0.2), 0.3, false, json!({ "type": "mirror", "albedo": 0.9 })),
        ],
        vec![],
    )
}

/// Compares light tracing, path tracing and their combination, length by length.
fn agree(iors: &[f64], samples: u32, bounds: [f64; EDGES as usize], seed: u64) {
    for (n, &ior) in iors.iter().enumerate() {
        let scene = scene(&room(ior));
        let by_edges = |integrator, factor, seed| {
            let settings = Settings { roulette: false, ..settings(integrator, EDGES - 1) };
            images_by_edges(&scene, settings, Budget::new(factor * samples, seed), EDGES)
        };
        let seed = seed + 3 * n as u64;
        let path = by_edges(Integrator::Path, 6, seed);
        let light = by_edges(Integrator::Light, 12, seed + 1);
        let bdpt = by_edges(Integrator::Bdpt, 2, seed + 2);
        // One edge would be the lamp seen directly: it is out of view, too.
        for k in 1..EDGES as usize {
            let bounds = Bounds::new([2, 2], 4.0 * bounds[k], bounds[k]);
            let what = |pair: &str| format!("caustics of ior {ior:.3}, {pair}, {} edges", k + 1);
            assert_same(&what("light = path"), &light[k], &path[k], bounds);
            assert_same(&what("bdpt = path"), &bdpt[k], &path[k], bounds);
        }
    }
}

#[test]
fn caustics_by_light_and_by_camera() {
    agree(&[1.5], 1 << 12, [0.0, 0.0125, 0.02, 0.02, 0.06], 770);
}

#[test]
#[ignore = "deep"]
fn caustics_looked_at_closely() {
    agree(&[1.5, 1.0 / 1.5], 1 << 17, [0.0, 0.005, 0.006, 0.0075, 0.0125], 780);
}

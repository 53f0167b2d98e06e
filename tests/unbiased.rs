//! The estimators against each other: whatever is sampled, weighted, skipped or cut, the mean is the same.

mod common;

#[path = "unbiased/bits.rs"]
mod bits;
#[path = "unbiased/cameras.rs"]
mod cameras;
#[path = "unbiased/caustics.rs"]
mod caustics;
#[path = "unbiased/integrators.rs"]
mod integrators;
#[path = "unbiased/random_scenes.rs"]
mod random_scenes;
#[path = "unbiased/settings.rs"]
mod settings;
#[path = "unbiased/sphere.rs"]
mod sphere;
#[path = "unbiased/techniques.rs"]
mod techniques;
#[path = "unbiased/textures.rs"]
mod textures;
#[path = "unbiased/windows.rs"]
mod windows;

use serde_json::Value;
use twinlight::math::DVec3;

use common::{View, diffuse, facing, quad, scene_json, shining_diffuse};

/// A diffuse box whose walls keep a distance from each other and a ceiling that shines all over: unweighted
/// connections then have a bounded geometry term, so that their error is what their variance says. Where walls meet,
/// ∫G² diverges.
fn gap_box(extra: Vec<Value>, shines: bool, lights: Vec<Value>) -> Value {
    let view = View {
        from: DVec3::new(0.05, 0.1, 0.75),
        at: DVec3::new(0.0, 0.05, -1.0),
        up: DVec3::Y,
        vfov: 90.0,
        // Few pixels with many samples each: a sampler's points are even within a pixel's own sequence.
        resolution: [2, 2],
    };
    let wall = |z: DVec3, material: Value| quad(&facing(-z, z), [1.3; 2], material);
    let ceiling = [0.4, 0.5, 0.6].to_vec();
    let mut surfaces = vec![
        wall(DVec3::Y, diffuse(vec![0.8, 0.7, 0.6])),
        wall(-DVec3::Y, if shines { shining_diffuse(vec![2.0, 1.5, 1.0], ceiling) } else { diffuse(ceiling) }),
        wall(DVec3::X, diffuse(vec![0.7, 0.2, 0.2])),
        wall(-DVec3::X, diffuse(vec![0.2, 0.7, 0.2])),
        wall(DVec3::Z, diffuse(0.6)),
    ];
    surfaces.extend(extra);
    scene_json(view.json(), surfaces, lights)
}

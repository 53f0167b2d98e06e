//! Valid scenes: rendered by each integrator on each accelerator, with the invariants of `twinlight stress`.

use std::path::Path;

use twinlight::accel::bvh::BvhAccel;
use twinlight::accel::embree::EmbreeAccel;
use twinlight::accel::{Accel, AccelOptions};
use twinlight::geometry::{Geometry, triangle_area};
use twinlight::import::scene_from_str;
use twinlight::integrator::{Integrator, Settings};
use twinlight::scene::desc::SceneDesc;
use twinlight::scene::{Scene, prepare};
use twinlight::stress::{WEIGHTS, audit, faults_of_weights, measure, weights};

use super::generator::{Made, make};

/// Samples per pixel.
const SAMPLES: u32 = 4;

/// Walks that look for self-hits.
const WALKS: u32 = 64;

/// Paths whose weights are judged.
const JUDGED: u32 = 64;

/// A valid scene made of the bytes.
pub fn scenes(bytes: &[u8]) {
    let Ok(made) = make(bytes) else { return };
    let text = made.scene.to_string();
    if std::env::var_os("TWINLIGHT_FUZZ_PRINT").is_some() {
        println!("{:#}\n{:?}", made.scene, made.settings);
    }
    let desc = scene_from_str(&text, "fuzzed.json", Path::new("no such folder"))
        .unwrap_or_else(|e| panic!("the generator makes what the format does not allow: {e}"));
    on::<BvhAccel>(&made, &desc);
    on::<EmbreeAccel>(&made, &desc);
}

fn on<A: Accel>(made: &Made, desc: &SceneDesc) {
    // A scene may be refused, a light without area being in it, say.
    let Ok(prepared) = prepare(desc) else { return };
    let scene = Scene::<A>::build(prepared, AccelOptions::default()).expect("an accelerator");
    for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
        let settings = Settings { integrator, ..made.settings };
        let measured = measure(&scene, settings, SAMPLES, 1);
        if !made.blinding {
            let (rejected, first) = (measured.rejected, measured.first);
            assert_eq!(rejected, 0, "{}, {integrator:?}: contributions that are not finite: {first}", A::NAME);
        }
    }
    let walked = audit(&scene, false, WALKS);
    // Embree computes a triangle's plane from its edges in f32, of which a needle's are nearly parallel.
    if A::NAME != EmbreeAccel::NAME || !has_needles(&scene.geometry) {
        let (self_hits, rays) = (walked.self_hits, walked.rays);
        assert_eq!(self_hits, 0, "{}: {self_hits} of {rays} rays meet what they left", A::NAME);
    }
    if made.blinding {
        return;
    }
    let seen = weights(&scene, made.settings, JUDGED);
    // Peaked lobes magnify the rounding of directions, differently for each technique.
    let faults = faults_of_weights(&seen, if made.peaked { 2e-2 } else { WEIGHTS });
    let path = seen.failure.unwrap_or_default();
    assert!(faults.is_empty(), "{}: {}; {path}", A::NAME, faults.join("; "));
}

/// Whether some triangle is less than a hundredth as high as it is long.
fn has_needles(geometry: &Geometry) -> bool {
    let is_needle = |triangle: u32| {
        let corners = geometry.corners(triangle);
        let longest = [0, 1, 2].map(|i| f64::from((corners[i] - corners[(i + 1) % 3]).length_squared()));
        2.0 * triangle_area(corners) < 0.01 * longest.into_iter().fold(0.0, f64::max)
    };
    (0..geometry.triangles.len() as u32).any(is_needle)
}

//! Valid scenes: rendered by each integrator on each accelerator, with the invariants of `twinlight stress`.

use std::path::Path;

use twinlight::accel::bvh::BvhAccel;
use twinlight::accel::embree::EmbreeAccel;
use twinlight::accel::{Accel, AccelOptions};
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
    let (self_hits, rays) = (walked.self_hits, walked.rays);
    assert_eq!(self_hits, 0, "{}: {self_hits} of {rays} rays meet what they left", A::NAME);
    if made.blinding {
        return;
    }
    let seen = weights(&scene, made.settings, JUDGED);
    // Peaked lobes magnify the rounding of directions, differently for each technique.
    let faults = faults_of_weights(&seen, if made.peaked { 2e-2 } else { WEIGHTS });
    let path = seen.structural.first.map(|f| f.to_string()).or(seen.failure).unwrap_or_default();
    assert!(faults.is_empty(), "{}: {}; {path}", A::NAME, faults.join("; "));
}

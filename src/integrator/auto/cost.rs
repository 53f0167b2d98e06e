//! What samples cost: counted work, with fixed weights.

use super::Lane;
use crate::integrator::Rays;

/// A visibility ray: the unit.
pub const RAY: f64 = 1.0;

/// Nearest-hit ray of a camera subpath, with what is done at its end.
const CAMERA: f64 = 2.4;
/// The same in `bdpt`, which carries sums.
const CAMERA_BDPT: f64 = 2.9;
/// Nearest-hit ray of a light subpath, with what is done at its end.
const LIGHT: f64 = 2.6;
/// Visibility ray of next-event estimation, with the sampling of the light.
const SHADOW: f64 = 2.0;
/// Visibility ray of a connection, with its evaluation.
const CONNECTION: f64 = 1.6;
/// Visibility ray to the camera, with its evaluation and splat.
const LENS: f64 = 1.8;

/// Work per camera sample in a lane, in visibility rays, by the pilot's counts.
pub fn of(lane: &Lane, rays: &Rays) -> f64 {
    let per_sample = |n: u64| n as f64 / rays.camera_paths.max(1) as f64;
    let [light_paths, connections] = lane.counts();
    let camera = if lane.light_paths == 0 { CAMERA } else { CAMERA_BDPT };
    per_sample(rays.camera) * camera
        + per_sample(rays.shadow) * SHADOW
        + light_paths * (per_sample(rays.light) * LIGHT + per_sample(rays.lens) * LENS)
        + connections * per_sample(rays.connection) * CONNECTION
}

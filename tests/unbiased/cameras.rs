//! Path tracing, light tracing and bidirectional path tracing make the same image through every camera and filter.

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;

use crate::common::{Bounds, Budget, assert_same, diffuse, images, scene, settings, sphere};
use crate::gap_box;

/// A diffuse box under a shining ceiling with a ball in it, seen at a slant.
fn room(camera: Value) -> Value {
    let mut room = gap_box(vec![sphere(DVec3::new(0.1, -0.3, -0.4), 0.35, false, diffuse(0.7))], true, vec![]);
    room["camera"] = json!({
        "transform": { "from": [-0.2, 0.3, 0.75], "at": [0.1, -0.2, -0.6], "up": [0.1, 1, 0] }, "resolution": [3, 2]
    });
    if let (Some(all), Some(keys)) = (room["camera"].as_object_mut(), camera.as_object()) {
        all.extend(keys.clone());
    }
    room
}

/// `closely` times the samples, the bounds by its root.
fn agree(what: &str, camera: Value, seed: u64, closely: u32) {
    let scene = scene(&room(camera));
    let run = |integrator, samples: u32, n: u64| {
        let settings = Settings { roulette: false, ..settings(integrator, 3) };
        images(&scene, settings, Budget::new(samples * closely, seed + n))
    };
    let bdpt = run(Integrator::Bdpt, 1 << 11, 0);
    let finer = 1.0 / f64::from(closely).sqrt();
    for (n, (integrator, samples)) in
        [(Integrator::Path, 1 << 11), (Integrator::Light, 1 << 13)].into_iter().enumerate()
    {
        let images = run(integrator, samples, n as u64 + 1);
        let bounds = Bounds::new([3, 2], 0.1 * finer, 0.02 * finer);
        assert_same(&format!("{what}: {integrator:?} against bdpt"), &images, &bdpt, bounds);
    }
}

fn thin_lens() -> Value {
    json!({ "vfov": 60, "aperture": 0.2, "fdist": 1.0 })
}

fn thin_lens_gaussian() -> Value {
    json!({ "vfov": 60, "aperture": 0.2, "fdist": 2.0, "filter": { "type": "gaussian" } })
}

fn orthographic() -> Value {
    json!({ "type": "orthographic", "height": 0.9 })
}

fn orthographic_tent() -> Value {
    json!({ "type": "orthographic", "height": 0.9, "filter": { "type": "tent" } })
}

fn pinhole_box() -> Value {
    json!({ "vfov": 60, "filter": { "type": "box", "radius": 0.8 } })
}

#[test]
fn the_integrators_agree_through_a_thin_lens() {
    agree("thin lens", thin_lens(), 660, 1);
}

#[test]
fn the_integrators_agree_through_a_thin_lens_and_a_gaussian_filter() {
    agree("thin lens, Gaussian", thin_lens_gaussian(), 663, 1);
}

#[test]
fn the_integrators_agree_on_parallel_rays() {
    agree("orthographic", orthographic(), 666, 1);
}

#[test]
fn the_integrators_agree_on_parallel_rays_and_a_tent_filter() {
    agree("orthographic, tent", orthographic_tent(), 669, 1);
}

#[test]
fn the_integrators_agree_through_a_pinhole_and_a_wide_box_filter() {
    agree("pinhole, box", pinhole_box(), 672, 1);
}

#[test]
#[ignore = "deep"]
fn through_every_camera_the_integrators_agree_closely() {
    let cameras = [thin_lens(), thin_lens_gaussian(), orthographic(), orthographic_tent(), pinhole_box()];
    for (n, camera) in cameras.into_iter().enumerate() {
        agree(&camera.to_string(), camera, 680 + 3 * n as u64, 16);
    }
}

//! Closed rooms of known radiance: the furnace and the integrating sphere.

use std::f64::consts::PI;

use serde_json::json;
use twinlight::film::Image;
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;

use crate::common::{
    Bounds, Budget, View, assert_closed, combined, diffuse, expect_colored, facing, images, images_by_edges, point,
    quad, render_once, scene, scene_json, settings, shining_diffuse, sphere,
};

/// From beside the centre of the unit sphere, towards its far side.
fn inside(resolution: [u32; 2]) -> View {
    View { from: DVec3::new(0.3, 0.2, -0.4), at: DVec3::new(-0.5, 0.1, 0.6), up: DVec3::Y, vfov: 100.0, resolution }
}

const INTEGRATORS: [Integrator; 3] = [Integrator::Path, Integrator::Light, Integrator::Bdpt];

#[test]
fn the_furnace_bounce_by_bounce() {
    let (emitted, albedo) = ([1.0, 0.5, 2.0], [0.8, 0.5, 0.4]);
    let view = inside([2, 2]);
    let walls = sphere(DVec3::ZERO, 1.0, true, shining_diffuse(emitted.to_vec(), albedo.to_vec()));
    let scene = scene(&scene_json(view.json(), vec![walls], vec![]));
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        let samples = if integrator == Integrator::Light { 8192 } else { 2048 };
        let upto = |bounces| Settings { roulette: false, ..settings(integrator, bounces) };
        // The same seeds make the same paths, so that the difference of two limits is one bounce's own image: so much
        // is demanded of one render, and the closed form then of the images by length.
        let by_edges = images_by_edges(&scene, upto(4), Budget::new(samples, 300 + n as u64), 5);
        let limited: Vec<Image> = (0..=4).map(|k| render_once(&scene, upto(k), 64, None).image).collect();
        let lengths = images_by_edges(&scene, upto(4), Budget { runs: 1, samples: 64, seed: 0 }, 5);
        for (k, images) in by_edges.iter().enumerate() {
            let shorter = if k == 0 { Image::new(2, 2) } else { limited[k - 1].clone() };
            let one = combined(&limited[k], &shorter, -1.0);
            for (a, b) in one.rgb.iter().zip(&lengths[k][0].rgb) {
                for c in 0..3 {
                    assert!(
                        (a[c] - b[c]).abs() < 2e-6,
                        "{integrator:?}, bounce {k}: {} by limits, {} alone",
                        a[c],
                        b[c]
                    );
                }
            }
            let color = [0, 1, 2].map(|c| emitted[c] * f64::powi(albedo[c], k as i32));
            let what = format!("furnace, bounce {k}, {integrator:?}");
            let mean = if integrator == Integrator::Light { 0.01 } else { 0.005 };
            let bounds = Bounds::new([2, 2], 0.03, mean);
            assert_closed(&what, images, &expect_colored(&[1.0; 4], color), bounds);
        }
        let total = [0, 1, 2].map(|c| emitted[c] * (1.0 - f64::powi(albedo[c], 5)) / (1.0 - albedo[c]));
        let images = images(&scene, upto(4), Budget::new(samples, 305 + n as u64));
        let bounds = Bounds::new([2, 2], 0.02, 0.0075);
        assert_closed(&format!("furnace, {integrator:?}"), &images, &expect_colored(&[1.0; 4], total), bounds);
    }
}

/// The unit sphere of Kd ½ with a point light of I = π at its centre: ρI/(πR²(1−ρ)) = 1 everywhere.
fn integrating_sphere(view: &View) -> serde_json::Value {
    let light = json!({ "type": "point", "position": point(DVec3::ZERO), "intensity": PI });
    scene_json(view.json(), vec![sphere(DVec3::ZERO, 1.0, true, diffuse(0.5))], vec![light])
}

/// The unit sphere that shines ½ and reflects ½: ½/(1−½) = 1 everywhere.
fn shining_sphere(view: &View) -> serde_json::Value {
    scene_json(view.json(), vec![sphere(DVec3::ZERO, 1.0, true, shining_diffuse(0.5, 0.5))], vec![])
}

/// Demands a radiance of 1 ± `tile` in every tile. Without roulette the series is cut at `bounces`, which is known.
fn is_one(
    what: &str,
    json: &serde_json::Value,
    settings: Settings,
    samples: u32,
    grid: [u32; 2],
    tile: f64,
    seed: u64,
) {
    let missing = if settings.roulette { 0.0 } else { 0.5_f64.powi(settings.max_bounces as i32) };
    let shines = json["lights"].as_array().is_none_or(Vec::is_empty);
    // A point light's series starts with the first bounce, a shining wall's with none.
    let expected = 1.0 - if shines { 0.5 * missing } else { missing };
    let tiles = (grid[0] * grid[1]) as usize;
    let images = images(&scene(json), settings, Budget::new(samples, seed));
    let bounds = Bounds::new(grid, tile, tile.min(0.004));
    assert_closed(what, &images, &expect_colored(&vec![expected; tiles], [1.0; 3]), bounds);
}

/// The point light at the centre lights all of the wall alike, so that every bounce of the path tracer adds exactly its
/// share, and no bounce less than all 64 can hide.
#[test]
fn the_integrating_sphere_without_variance() {
    let view = inside([8, 8]);
    let path = Settings { roulette: false, ..settings(Integrator::Path, 64) };
    is_one("integrating sphere, path, 64 bounces", &integrating_sphere(&view), path, 4, [8, 8], 0.0001, 310);
}

#[test]
fn the_integrating_sphere_is_one_in_every_tile() {
    let view = inside([2, 2]);
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        // The light tracer's noise is that of where its splats fall: roulette saves it the paths that carry little.
        let light = integrator == Integrator::Light;
        let settings = Settings { roulette: light, ..settings(integrator, if light { 64 } else { 10 }) };
        // And what 0.2 % in a tile costs it is left to the deep test below.
        let (samples, tile) = if light { (1 << 14, 0.01) } else { (1 << 11, 0.002) };
        let what = format!("integrating sphere, {integrator:?}");
        is_one(&what, &integrating_sphere(&view), settings, samples, [2, 2], tile, 320 + n as u64);
        let what = format!("shining sphere, {integrator:?}");
        is_one(&what, &shining_sphere(&view), settings, samples, [2, 2], tile, 330 + n as u64);
    }
}

/// A quarter of the light has been scattered three times and more: what roulette took and did not give back would show.
#[test]
fn roulette_keeps_the_integrating_sphere_at_one() {
    let view = inside([2, 2]);
    for (n, (integrator, samples)) in [(Integrator::Path, 1 << 14), (Integrator::Bdpt, 1 << 11)].into_iter().enumerate()
    {
        let what = format!("integrating sphere with roulette, {integrator:?}");
        is_one(&what, &integrating_sphere(&view), settings(integrator, 64), samples, [2, 2], 0.008, 360 + n as u64);
    }
}

#[test]
#[ignore = "deep"]
fn the_integrating_sphere_is_one_within_a_fifth_of_a_percent() {
    let view = inside([4, 4]);
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        let settings = settings(integrator, 64);
        let samples = match integrator {
            Integrator::Path => 1 << 16,
            Integrator::Light => 1 << 16,
            Integrator::Bdpt | Integrator::Auto => 1 << 13,
        };
        let what = format!("integrating sphere with roulette, {integrator:?}");
        is_one(&what, &integrating_sphere(&view), settings, samples, [2, 2], 0.002, 340 + n as u64);
        let what = format!("shining sphere with roulette, {integrator:?}");
        is_one(&what, &shining_sphere(&view), settings, samples, [2, 2], 0.002, 350 + n as u64);
    }
}

/// A box is a furnace, too, and its walls are six lights of unequal power: E/(1 − ρ) for each way of choosing among them,
/// as long as all techniques count it alike.
#[test]
fn a_furnace_of_six_lights() {
    let view = inside([2, 2]);
    let half = DVec3::new(0.6, 0.8, 1.0);
    let wall = |axis: DVec3, side: f64, size: f64| {
        // Larger than the room: walls cross at its edges.
        quad(&facing(-axis * side * half, axis * side), [size; 2], shining_diffuse(vec![1.0, 0.5, 2.0], 0.5))
    };
    let walls = [(DVec3::X, 2.2), (DVec3::Y, 2.4), (DVec3::Z, 1.8)];
    let walls = walls.iter().flat_map(|&(axis, size)| [1.0, -1.0].map(|side| wall(axis, side, size))).collect();
    let scene = scene(&scene_json(view.json(), walls, vec![]));
    assert_eq!(scene.lights.len(), 6);
    for (n, (integrator, samples)) in [(Integrator::Path, 1 << 9), (Integrator::Bdpt, 1 << 8)].into_iter().enumerate() {
        let images = images(&scene, settings(integrator, 64), Budget::new(samples, 370 + n as u64));
        let expected = expect_colored(&[2.0; 4], [1.0, 0.5, 2.0]);
        let what = format!("furnace of six lights, {integrator:?}");
        assert_closed(&what, &images, &expected, Bounds::new([2, 2], 0.03, 0.01));
    }
}

//! Glass and mirrors: what they may not change, and by how much they must.

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::{DAffine3, DVec3};

use crate::common::{
    Bounds, Budget, View, assert_closed, diffuse, expect_colored, facing, images, quad, scene, scene_json, settings,
    shining, shining_diffuse, sphere,
};

fn glass(ior: f64) -> Value {
    json!({ "type": "dielectric", "ior": ior })
}

/// From inside the sphere of radius 2, at the unit ball around the origin.
fn at_ball() -> View {
    View { from: DVec3::new(0.2, 0.1, 1.7), at: DVec3::ZERO, up: DVec3::Y, vfov: 80.0, resolution: [8, 8] }
}

/// A lossless glass ball in a furnace cannot be seen: what it keeps away it sends from elsewhere, and the radiance that
/// refraction compresses on the way in expands on the way out.
#[test]
fn a_glass_ball_in_a_furnace_is_invisible() {
    let (emitted, albedo) = ([1.0, 0.5, 2.0], [0.5, 0.3, 0.0]);
    let view = at_ball();
    for (n, ior) in [1.5, 1.1, 2.4, 1.0 / 1.5].into_iter().enumerate() {
        for (m, reflecting) in [false, n % 3 == 0].into_iter().enumerate() {
            let walls =
                if reflecting { shining_diffuse(emitted.to_vec(), albedo.to_vec()) } else { shining(emitted.to_vec()) };
            let surfaces = vec![sphere(DVec3::ZERO, 2.0, true, walls), sphere(DVec3::ZERO, 1.0, false, glass(ior))];
            let scene = scene(&scene_json(view.json(), surfaces, vec![]));
            let color = [0, 1, 2].map(|c| if reflecting { emitted[c] / (1.0 - albedo[c]) } else { emitted[c] });
            for integrator in [Integrator::Path, Integrator::Bdpt] {
                // Many bounces and no roulette: within black walls nothing is then left to chance.
                let settings = Settings { roulette: reflecting, ..settings(integrator, 200) };
                let samples = if reflecting { 256 } else { 16 };
                let images = images(&scene, settings, Budget::new(samples, 400 + 2 * n as u64 + m as u64));
                let (tile, mean) = if reflecting { (0.02, 0.005) } else { (1e-4, 1e-4) };
                let bounds = Bounds::new([2, 2], tile, mean);
                let what = format!("ball of ior {ior:.3}, walls reflect: {reflecting}, {integrator:?}");
                assert_closed(&what, &images, &expect_colored(&[1.0; 4], color), bounds);
            }
        }
    }
}

/// Within glass the radiance is n² times that outside. The camera is close enough to the centre for no ray to be
/// reflected totally.
#[test]
fn within_glass_the_furnace_is_n_squared_as_bright() {
    let emitted = [1.0, 0.5, 2.0];
    let view = View { from: DVec3::new(0.1, 0.2, 0.2), at: DVec3::new(0.0, -0.3, 1.0), ..at_ball() };
    for (n, ior) in [1.5, 1.1, 2.4].into_iter().enumerate() {
        for (m, reflecting) in [false, n == 0].into_iter().enumerate() {
            let walls = if reflecting { shining_diffuse(emitted.to_vec(), 0.5) } else { shining(emitted.to_vec()) };
            let surfaces = vec![sphere(DVec3::ZERO, 2.0, true, walls), sphere(DVec3::ZERO, 1.0, false, glass(ior))];
            let scene = scene(&scene_json(view.json(), surfaces, vec![]));
            let color = emitted.map(|e| ior * ior * if reflecting { 2.0 * e } else { e });
            for integrator in [Integrator::Path, Integrator::Bdpt] {
                let settings = Settings { roulette: reflecting, ..settings(integrator, 200) };
                let samples = if reflecting { 256 } else { 16 };
                let images = images(&scene, settings, Budget::new(samples, 420 + 2 * n as u64 + m as u64));
                let (tile, mean) = if reflecting { (0.02, 0.005) } else { (1e-4, 1e-4) };
                let bounds = Bounds::new([2, 2], tile, mean);
                let what = format!("inside glass of ior {ior}, walls reflect: {reflecting}, {integrator:?}");
                assert_closed(&what, &images, &expect_colored(&[1.0; 4], color), bounds);
            }
        }
    }
}

/// A flat pane of glass in a furnace, seen under all angles, transmits and reflects all there is.
#[test]
fn a_slab_transmits_and_reflects_what_fresnels_formulas_say() {
    // Before the camera a slab between two infinite-seeming faces; behind it a wall of radiance 1, before it black.
    // T = (1−F)/(1+F) with all inter-reflections; n = 1.5.
    for (n, (degrees, transmitted)) in
        [(0.0_f64, 0.923_077), (45.0, 0.904_327), (60.0, 0.836_232), (80.0, 0.441_229)].into_iter().enumerate()
    {
        let (s, c) = degrees.to_radians().sin_cos();
        let view = View { from: DVec3::new(-s, 0.0, c), at: DVec3::ZERO, up: DVec3::Y, vfov: 0.01, resolution: [1, 1] };
        // Wide enough for rays that go to and fro thirty times at 80°.
        let face = |z: f64, up: f64| quad(&facing(DVec3::new(0.0, 0.0, z), DVec3::Z * up), [20.0; 2], glass(1.5));
        let surfaces = vec![
            face(0.0, 1.0),
            face(-0.1, -1.0),
            quad(&facing(DVec3::new(0.0, 0.0, -0.2), DVec3::Z), [20.0; 2], shining(1.0)),
        ];
        let scene = scene(&scene_json(view.json(), surfaces, vec![]));
        let settings = Settings { roulette: false, ..settings(Integrator::Path, 60) };
        let images = images(&scene, settings, Budget::new(if degrees > 70.0 { 32768 } else { 8192 }, 440 + n as u64));
        let bounds = Bounds::of_mean(0.005);
        assert_closed(&format!("slab at {degrees}°"), &images, &expect_colored(&[transmitted], [1.0; 3]), bounds);
    }
}

/// Between two facing mirrors a camera ray is reflected N times before it reaches the light: L Rᴺ, without variance.
#[test]
fn n_mirrors_reflect_to_the_nth_power() {
    let (radiance, albedo) = ([1.0, 2.0, 4.0], [0.9, 0.5, 0.25]);
    let mirror = || json!({ "type": "mirror", "albedo": albedo });
    for n in 0..=12_u32 {
        // Mirrors at z = 0 and z = 1, the light at x = 6. Unfolded, the ray to z = n + ½ there crosses n mirrors.
        let from = DVec3::new(0.0, 0.0, 0.5);
        let view =
            View { from, at: DVec3::new(6.0, 0.0, f64::from(n) + 0.5), up: DVec3::Y, vfov: 0.5, resolution: [4, 4] };
        let middle = |z: f64| DVec3::new(2.5, 0.0, z);
        let surfaces = vec![
            quad(&facing(middle(0.0), DVec3::Z), [20.0; 2], mirror()),
            quad(&facing(middle(1.0), -DVec3::Z), [20.0; 2], mirror()),
            quad(&facing(DVec3::new(6.0, 0.0, 0.5), -DVec3::X), [20.0; 2], shining(radiance.to_vec())),
            // Something to connect to, out of the rays' way, so that light subpaths are traced at all.
            quad(&DAffine3::from_translation(DVec3::new(-3.0, 0.0, 0.2)), [0.5; 2], diffuse(0.5)),
        ];
        let scene = scene(&scene_json(view.json(), surfaces, vec![]));
        let color = [0, 1, 2].map(|c| radiance[c] * f64::powi(albedo[c], n as i32));
        for integrator in [Integrator::Path, Integrator::Bdpt] {
            let settings = Settings { roulette: false, ..settings(integrator, 16) };
            let images = images(&scene, settings, Budget { runs: 2, samples: 4, seed: 460 });
            let bounds = Bounds::new([4, 4], 2e-5, 2e-5);
            let expected = expect_colored(&[1.0; 16], color);
            if n == 0 && integrator == Integrator::Bdpt {
                // Seen directly, the light is also what light subpaths show: there only the sum is exact on average.
                continue;
            }
            assert_closed(&format!("{n} mirrors, {integrator:?}"), &images, &expected, bounds);
        }
    }
}

//! Light from infinity: environments and directional lights.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};
use twinlight::film::Image;
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::{DAffine3, DMat3, DVec3};
use twinlight::output::{Metadata, write_image};
use twinlight::scene::desc::{InfiniteLightDesc, InfiniteLightKind, Place};

use crate::common::{
    Bounds, Budget, DefaultAccel, View, assert_closed, diffuse, expect_colored, facing, images, matrix, quad, scene,
    scene_json, settings, sphere,
};

const INTEGRATORS: [Integrator; 3] = [Integrator::Path, Integrator::Light, Integrator::Bdpt];

/// Close before the unit ball around the origin, which fills the view.
fn at_ball() -> View {
    View { from: DVec3::new(0.6, 0.4, 1.6), at: DVec3::ZERO, up: DVec3::Y, vfov: 40.0, resolution: [2, 2] }
}

fn sky(radiance: [f64; 3]) -> Value {
    json!({ "type": "constant", "radiance": radiance })
}

fn samples(integrator: Integrator) -> u32 {
    if integrator == Integrator::Light { 1 << 15 } else { 1 << 10 }
}

/// Light tracing is not aimed at the view: most of its paths end elsewhere.
fn bounds(integrator: Integrator) -> Bounds {
    if integrator == Integrator::Light { Bounds::new([2, 2], 0.12, 0.04) } else { Bounds::new([2, 2], 0.03, 0.005) }
}

/// A convex diffuse body under the same radiance from everywhere has its albedo times it.
#[test]
fn under_a_constant_sky_a_diffuse_ball_has_its_albedo() {
    let (radiance, albedo) = ([1.0, 0.5, 2.0], [0.8, 0.5, 0.3]);
    let ball = sphere(DVec3::ZERO, 1.0, false, diffuse(albedo.to_vec()));
    let mut backgrounds = vec![scene_json(at_ball().json(), vec![ball.clone()], vec![sky(radiance)])];
    // The same, half as background and half as a light.
    let mut halves = scene_json(at_ball().json(), vec![ball], vec![sky(radiance.map(|x| 0.5 * x))]);
    halves["background"] = json!({ "type": "constant", "color": radiance.map(|x| 0.5 * x) });
    backgrounds.push(halves);
    let expected = expect_colored(&[1.0; 4], [0, 1, 2].map(|c| radiance[c] * albedo[c]));
    for (m, json) in backgrounds.iter().enumerate() {
        let scene = scene(json);
        for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
            let budget = Budget::new(samples(integrator), 500 + 3 * m as u64 + n as u64);
            let images = images(&scene, settings(integrator, 64), budget);
            let what = format!("diffuse ball under a constant sky, {integrator:?}, {m}");
            assert_closed(&what, &images, &expected, bounds(integrator));
        }
    }
}

/// Nothing is to be seen of lossless glass under a constant sky, nor of a mirror but its colour.
#[test]
fn glass_and_mirrors_under_a_constant_sky() {
    for (n, (material, factor)) in [
        (json!({ "type": "dielectric", "ior": 1.5 }), 1.0),
        (json!({ "type": "dielectric", "ior": 1.0 / 1.7 }), 1.0),
        (json!({ "type": "mirror", "albedo": 0.7 }), 0.7),
    ]
    .into_iter()
    .enumerate()
    {
        let view = View { vfov: 90.0, resolution: [8, 8], ..at_ball() };
        let ball = sphere(DVec3::ZERO, 1.0, false, material.clone());
        let scene = scene(&scene_json(view.json(), vec![ball], vec![sky([1.0; 3])]));
        // The mirror ball is not the whole view: only its colour's part of the closed form can be checked there.
        for integrator in [Integrator::Path, Integrator::Bdpt] {
            let settings = Settings { roulette: false, ..settings(integrator, 500) };
            let images = images(&scene, settings, Budget::new(16, 510 + n as u64));
            if factor == 1.0 {
                let what = format!("{material} under a constant sky, {integrator:?}");
                assert_closed(&what, &images, &expect_colored(&[1.0; 4], [1.0; 3]), Bounds::new([2, 2], 1e-4, 1e-4));
            } else {
                // Every pixel is on the ball, beside it, or on its edge.
                let center = images[0].get(4, 4)[0];
                assert!((f64::from(center) - factor).abs() < 1e-5, "{integrator:?}: {center} in the mirror");
                assert_eq!(images[0].get(0, 0), [1.0; 3], "{integrator:?}: the sky");
            }
        }
    }
}

/// A tilted plane that fills the view, around the origin.
fn plane(normal: DVec3) -> (View, Value) {
    let side = normal.any_orthonormal_vector();
    let view = View { from: 1.5 * normal + 0.5 * side, at: DVec3::ZERO, up: side, vfov: 20.0, resolution: [2, 2] };
    (view, quad(&facing(DVec3::ZERO, normal), [2.0; 2], diffuse(0.5)))
}

#[test]
fn a_directional_light_on_a_plane() {
    let toward = DVec3::new(0.3, 0.8, 0.5).normalize();
    let irradiance = [2.0, 3.0, 1.0];
    for (n, tilt) in [0.0, 0.7, 1.4].into_iter().enumerate() {
        let normal = (toward * f64::cos(tilt) + toward.any_orthonormal_vector() * f64::sin(tilt)).normalize();
        let (view, wall) = plane(normal);
        let sun = json!({ "type": "directional", "direction": (-3.0 * toward).to_array(), "irradiance": irradiance });
        let scene = scene(&scene_json(view.json(), vec![wall], vec![sun]));
        // f = ρ/π times E cosθ.
        let expected = expect_colored(&[0.5 / PI * f64::cos(tilt); 4], irradiance);
        for integrator in INTEGRATORS {
            let images = images(&scene, settings(integrator, 8), Budget::new(samples(integrator), 520 + n as u64));
            let what = format!("directional light at {tilt} rad, {integrator:?}");
            assert_closed(&what, &images, &expected, Bounds::new([2, 2], 0.05, 0.0125));
        }
    }
}

const SIZE: [usize; 2] = [8, 5];

/// Weight of texel (x, y) in the bilinear interpolation at a direction of the map's frame, written as tents.
fn tent(direction: DVec3, [x, y]: [usize; 2]) -> f64 {
    let [w, h] = SIZE.map(|n| n as f64);
    let u = (direction.x.atan2(-direction.z) / TAU + 0.5) * w - 0.5;
    let v = (direction.y.clamp(-1.0, 1.0).acos() / PI * h - 0.5).clamp(0.0, h - 1.0);
    let around = (u - x as f64).rem_euclid(w);
    (1.0 - around.min(w - around)).max(0.0) * (1.0 - (v - y as f64).abs()).max(0.0)
}

/// ∫ L cosθ dω of one texel of radiance 1 at a surface of this normal, in the map's frame, by the midpoint rule over cosθ
/// and φ.
fn irradiance(texel: [usize; 2], normal: DVec3) -> f64 {
    let (rows, columns) = (1000, 2000);
    let mut integral = 0.0;
    for i in 0..rows {
        let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(rows);
        let r = (1.0 - y * y).sqrt();
        for j in 0..columns {
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(columns);
            let d = DVec3::new(r * phi.sin(), y, -r * phi.cos());
            integral += tent(d, texel) * d.dot(normal).max(0.0);
        }
    }
    integral * 4.0 * PI / f64::from(rows * columns)
}

/// One lit texel, the poles' rows and the seam's columns included: the radiosity of a plane that faces it, by a quadrature
/// that knows nothing of the sampling.
#[test]
fn one_lit_texel_of_an_environment() {
    let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_y(-0.9);
    for (n, texel) in [[3, 2], [0, 2], [7, 1], [5, 0], [2, 4]].into_iter().enumerate() {
        let mut texels = vec![[0.0; 3]; SIZE[0] * SIZE[1]];
        texels[texel[1] * SIZE[0] + texel[0]] = [3.0, 1.0, 2.0];
        // Facing the texel, and half turned away from it: some of it lies below the horizon.
        let theta = (texel[1] as f64 + 0.5) / SIZE[1] as f64 * PI;
        let phi = ((texel[0] as f64 + 0.5) / SIZE[0] as f64 - 0.5) * TAU;
        let center = DVec3::new(theta.sin() * phi.sin(), theta.cos(), -theta.sin() * phi.cos());
        for (m, tilt) in [0.0, 1.2].into_iter().enumerate() {
            let normal = (center * f64::cos(tilt) + center.any_orthonormal_vector() * f64::sin(tilt)).normalize();
            let integral = irradiance(texel, normal);
            let (view, wall) = plane(turn * normal);
            let mut desc = twinlight::import::scene_from_str(
                &scene_json(view.json(), vec![wall], vec![]).to_string(),
                "texel.json",
                std::path::Path::new(""),
            )
            .expect("a valid scene");
            let kind = InfiniteLightKind::Image { size: SIZE, texels: texels.clone(), transform: turn };
            desc.infinite_lights.push(InfiniteLightDesc { kind, at: Place::default() });
            let prepared = twinlight::scene::prepare(&desc).expect("a scene that can be prepared");
            let scene =
                twinlight::scene::Scene::<DefaultAccel>::build(prepared, Default::default()).expect("buildable");
            let expected = expect_colored(&[0.5 / PI * integral; 4], [3.0, 1.0, 2.0]);
            for integrator in INTEGRATORS {
                let samples = if integrator == Integrator::Light { 1 << 14 } else { 1 << 12 };
                let images =
                    images(&scene, settings(integrator, 8), Budget::new(samples, 530 + 2 * n as u64 + m as u64));
                let what = format!("texel {texel:?}, tilt {tilt}, {integrator:?}");
                let (tile, mean) = if integrator == Integrator::Light { (0.1, 0.03) } else { (0.05, 0.0125) };
                let bounds = Bounds { rounding: 2e-5, ..Bounds::new([2, 2], tile, mean) };
                assert_closed(&what, &images, &expected, bounds);
            }
        }
    }
}

/// An image read from a file, half of it as a light and half as the background.
#[test]
fn an_environment_from_a_file() {
    let texel = [2, 1];
    let mut rgb = vec![[0.0; 3]; SIZE[0] * SIZE[1]];
    rgb[texel[1] * SIZE[0] + texel[0]] = [3.0, 1.0, 2.0];
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("one_texel.exr");
    let image = Image { width: SIZE[0] as u32, height: SIZE[1] as u32, rgb };
    write_image(&path, &image, &Metadata::default(), 0.0).expect("writable");
    let turn = DMat3::from_rotation_z(1.1) * DMat3::from_rotation_y(0.6);
    let normal = DVec3::new(-0.8, 0.5, 0.1).normalize();
    let (view, wall) = plane(turn * normal);
    let sky = |kind: &str, scale: f64| json!({ "type": kind, "filename": path, "scale": scale, "transform": matrix(&DAffine3::from_mat3(turn)) });
    let mut json = scene_json(view.json(), vec![wall], vec![sky("environment", 0.5)]);
    json["background"] = sky("image", 1.5);
    let scene = scene(&json);
    let expected = expect_colored(&[2.0 * 0.5 / PI * irradiance(texel, normal); 4], [3.0, 1.0, 2.0]);
    for integrator in INTEGRATORS {
        let samples = if integrator == Integrator::Light { 1 << 14 } else { 1 << 12 };
        let images = images(&scene, settings(integrator, 8), Budget::new(samples, 546));
        let (tile, mean) = if integrator == Integrator::Light { (0.1, 0.03) } else { (0.05, 0.0125) };
        let bounds = Bounds { rounding: 2e-5, ..Bounds::new([2, 2], tile, mean) };
        assert_closed(&format!("an environment from a file, {integrator:?}"), &images, &expected, bounds);
    }
}

/// An environment image that is the same everywhere is the constant sky.
#[test]
fn an_even_image_is_a_constant_sky() {
    let ball = sphere(DVec3::ZERO, 1.0, false, diffuse(0.5));
    let json = scene_json(at_ball().json(), vec![ball], vec![]);
    let mut desc =
        twinlight::import::scene_from_str(&json.to_string(), "even.json", std::path::Path::new("")).expect("valid");
    let kind = InfiniteLightKind::Image {
        size: [3, 1],
        texels: vec![[1.0, 0.5, 2.0]; 3],
        transform: DMat3::from_rotation_x(1.0),
    };
    desc.infinite_lights.push(InfiniteLightDesc { kind, at: Place::default() });
    let prepared = twinlight::scene::prepare(&desc).expect("preparable");
    let scene = twinlight::scene::Scene::<DefaultAccel>::build(prepared, Default::default()).expect("buildable");
    for integrator in INTEGRATORS {
        let images = images(&scene, settings(integrator, 64), Budget::new(samples(integrator), 545));
        let what = format!("an even image, {integrator:?}");
        assert_closed(&what, &images, &expect_colored(&[0.5; 4], [1.0, 0.5, 2.0]), bounds(integrator));
    }
}

/// A sheet that shines on both sides lights two planes alike, and its power is twice that of one side.
#[test]
fn both_sides_shine() {
    let both = json!({ "type": "diffuse light", "emit": 4.0, "two_sided": true });
    let one = json!({ "type": "diffuse light", "emit": 4.0 });
    // Between two walls, halfway; the camera is behind one of them, which shows nothing of its back, and sees the other.
    let view = View { from: DVec3::new(0.9, 0.0, 0.45), at: DVec3::new(0.2, 0.0, -0.5), ..at_ball() };
    let walls = |z: f64| quad(&facing(DVec3::new(0.0, 0.0, z), DVec3::Z * -z), [4.0; 2], diffuse(0.5));
    let sheet = |z: f64, material: &Value, side: DVec3| quad(&facing(DVec3::Z * z, side), [0.5; 2], material.clone());
    let run = |surfaces: Vec<Value>, integrator, seed| {
        let scene = scene(&scene_json(view.json(), surfaces, vec![]));
        images(&scene, settings(integrator, 4), Budget::new(samples(integrator), seed))
    };
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        let seed = 550 + 2 * n as u64;
        let two_sided = run(vec![walls(-0.5), walls(0.5), sheet(0.0, &both, DVec3::Z)], integrator, seed);
        let back_to_back = vec![sheet(2e-5, &one, DVec3::Z), sheet(-2e-5, &one, -DVec3::Z)];
        let lamps = [vec![walls(-0.5), walls(0.5)], back_to_back].concat();
        let two_lamps = run(lamps, integrator, seed + 1);
        let what = format!("one two-sided sheet against two, {integrator:?}");
        // The two stand a little closer to the walls.
        let bounds = Bounds { rounding: 2e-4, ..Bounds::new([2, 2], 0.06, 0.02) };
        crate::common::assert_same(&what, &two_sided, &two_lamps, bounds);
    }
}

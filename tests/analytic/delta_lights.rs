//! Point and spot lights over a diffuse plane, and a spot inside a sphere.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};
use twinlight::light::Light;
use twinlight::math::{DAffine3, DVec3};
use twinlight::scene::Scene;

use crate::common::{
    Bounds, Budget, DefaultAccel, Random, View, assert_closed, diffuse, expect_colored, facing, images, matrix, point,
    quad, scene, scene_json, sphere, technique,
};

const ALBEDO: [f64; 3] = [0.8, 0.5, 0.25];

/// A camera that looks down on a disk of radius about `size` around the origin of the plane z = 0.
fn over_plane(size: f64) -> View {
    View {
        from: DVec3::new(0.3, -0.8, 0.9) * size,
        at: DVec3::new(0.05, 0.1, 0.0) * size,
        up: DVec3::Z,
        vfov: 50.0,
        resolution: [8, 8],
    }
}

/// Where a ray meets the plane z = 0.
fn on_plane(from: DVec3, direction: DVec3) -> DVec3 {
    assert!(direction.z < 0.0, "the camera sees past the plane");
    from - direction * (from.z / direction.z)
}

/// `I cosθ/d²` at a point of the plane z = 0.
fn irradiance(light: DVec3, p: DVec3) -> f64 {
    let to = light - p;
    to.z / to.length().powi(3)
}

#[test]
fn a_point_light_over_a_plane_at_any_distance() {
    let intensity = [3.0, 2.0, 0.7];
    for (n, r) in [1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3].into_iter().enumerate() {
        let light = DVec3::new(0.1, 0.2, 1.0) * r;
        for (s, t) in [(1, 2), (2, 1)] {
            // Light tracing would hit a small plane under a far light too rarely: there the plane grows along.
            let size = if s == 1 { r.min(1.0) } else { r };
            let extent = 6.0 * size.max(1.0);
            // Few pixels with many samples each: a sampler's points are even within a pixel's own sequence.
            let view = View { resolution: if s == 1 { [8, 8] } else { [2, 2] }, ..over_plane(size) };
            let scene = scene(&scene_json(
                view.json(),
                vec![quad(&DAffine3::IDENTITY, [extent; 2], diffuse(ALBEDO.to_vec()))],
                vec![json!({ "type": "point", "position": point(light), "intensity": intensity })],
            ));
            let grid = if s == 1 { [8, 8] } else { [2, 2] };
            let grey =
                view.tile_means(grid, 384 / view.resolution[0], |d| irradiance(light, on_plane(view.from, d)) / PI);
            let color = [0, 1, 2].map(|c| ALBEDO[c] * intensity[c]);
            let samples = if s == 1 { 128 } else { 8192 };
            let images = images(&scene, technique(s, t), Budget::new(samples, 100 + n as u64));
            let (tile, mean) = if s == 1 { (0.002, 0.001) } else { (0.03, 0.005) };
            // f32 coordinates are good to 6e-8 of the plane's extent, however little of it is looked at.
            let rounding = 1e-5 + 6e-8 * extent / size;
            let bounds = Bounds { rounding, ..Bounds::new(grid, tile, mean) };
            assert_closed(&format!("r = {r}, ({s},{t})"), &images, &expect_colored(&grey, color), bounds);
        }
    }
}

/// Relative error of the midpoint rule across a spot's edge, which is a step or has an infinite slope.
const QUADRATURE: f64 = 1e-4;

/// A spot's angles in degrees and its exponent, as the file writes them; without one it is linear in the angle.
#[derive(Clone, Copy, Debug)]
struct Spot {
    inner: f64,
    outer: f64,
    falloff: Option<f64>,
}

const fn cosine(inner: f64, outer: f64, falloff: f64) -> Spot {
    Spot { inner, outer, falloff: Some(falloff) }
}

const fn linear(inner: f64, outer: f64) -> Spot {
    Spot { inner, outer, falloff: None }
}

const SPOTS: [Spot; 9] = [
    cosine(20.0, 40.0, 0.5),
    cosine(30.0, 30.0, 0.5),
    cosine(0.0, 60.0, 1.0),
    cosine(10.0, 50.0, 2.0),
    cosine(35.0, 55.0, 0.0),
    cosine(15.0, 70.0, 0.25),
    linear(20.0, 40.0),
    linear(0.0, 60.0),
    linear(30.0, 30.0),
];

impl Spot {
    /// The light with the keys of its cone, but for its place and direction.
    fn json(&self, mut rest: Value) -> Value {
        rest["inner_angle"] = self.inner.into();
        rest["outer_angle"] = self.outer.into();
        match self.falloff {
            Some(falloff) => rest["falloff"] = falloff.into(),
            None => rest["profile"] = "angle".into(),
        }
        rest
    }

    fn attenuation(&self, cos: f64) -> f64 {
        let (ci, co) = (self.inner.to_radians().cos(), self.outer.to_radians().cos());
        if cos >= ci {
            return 1.0;
        }
        if cos <= co {
            return 0.0;
        }
        match self.falloff {
            Some(falloff) => ((cos - co) / (ci - co)).powf(falloff),
            None => (self.outer - cos.acos().to_degrees()) / (self.outer - self.inner),
        }
    }

    /// Φ/I, [TESTING A2]: `2π[(1−cosβ) + (cosβ−cosτ)/(p+1)]`, or `2π[1 − (sinτ−sinβ)/(τ−β)]` (whose limit for a hard edge
    /// is the cone's solid angle).
    fn solid_angle(&self) -> f64 {
        let (b, t) = (self.inner.to_radians(), self.outer.to_radians());
        match self.falloff {
            Some(falloff) => TAU * ((1.0 - b.cos()) + (b.cos() - t.cos()) / (falloff + 1.0)),
            None if b == t => TAU * (1.0 - b.cos()),
            None => TAU * (1.0 - (t.sin() - b.sin()) / (t - b)),
        }
    }
}

#[test]
fn a_spot_over_a_plane_in_any_pose() {
    let intensity = [2.0, 1.0, 5.0];
    let (light, axis) = (DVec3::new(0.1, 0.2, 1.0), DVec3::new(0.1, -0.15, -1.0).normalize());
    let mut random = Random(2);
    for (n, spot) in SPOTS.into_iter().enumerate() {
        let pose = if n == 0 { DAffine3::IDENTITY } else { random.pose(2.0) };
        let view = View { resolution: [2, 2], ..over_plane(1.0) };
        let direction = pose.transform_vector3(axis);
        let scene = scene(&scene_json(
            view.moved(&pose).json(),
            vec![quad(&pose, [6.0; 2], diffuse(ALBEDO.to_vec()))],
            vec![spot.json(json!({
                "type": "spot", "position": point(pose.transform_point3(light)), "direction": point(direction),
                "intensity": intensity
            }))],
        ));
        let grid = [2, 2];
        let grey = view.tile_means(grid, 640, |d| {
            let p = on_plane(view.from, d);
            irradiance(light, p) * spot.attenuation((p - light).normalize().dot(axis)) / PI
        });
        let color = [0, 1, 2].map(|c| ALBEDO[c] * intensity[c]);
        let expected = expect_colored(&grey, color);
        for (s, t, samples) in [(1, 2, 1024), (2, 1, 8192)] {
            let images = images(&scene, technique(s, t), Budget::new(samples, 120 + n as u64));
            let mean = if s == 1 { 0.002 } else { 0.005 };
            let bounds = Bounds { rounding: QUADRATURE, ..Bounds::new(grid, 0.02, mean) };
            assert_closed(&format!("{spot:?}, ({s},{t})"), &images, &expected, bounds);
        }
    }
}

/// The spot at the centre of a sphere, the camera beside it: the wall shows the attenuation itself, and the image's
/// sum over the solid angles of its pixels is the flux.
#[test]
fn a_spots_flux_through_a_sphere_by_light_tracing() {
    let radius = 3.0;
    for (n, spot) in SPOTS.into_iter().filter(|s| s.outer < 62.0).enumerate() {
        let axis = DVec3::new(0.2, -0.3, -1.0).normalize();
        let view = View { from: DVec3::ZERO, at: axis, up: DVec3::Y, vfov: 130.0, resolution: [2, 2] };
        let scene = scene(&scene_json(
            view.json(),
            vec![sphere(DVec3::ZERO, radius, true, diffuse(0.5))],
            vec![spot.json(json!({
                "type": "spot", "position": [0, 0, 0], "direction": point(axis), "intensity": 7.0
            }))],
        ));
        let scale = 7.0 / (radius * radius) * 0.5 / PI;
        let grey = view.tile_means([2, 2], 1024, |d| scale * spot.attenuation(d.dot(axis)));
        let expected = expect_colored(&grey, [1.0; 3]);
        let bounds = Bounds { rounding: QUADRATURE, ..Bounds::new([2, 2], 0.015, 0.005) };
        for (s, t) in [(1, 2), (2, 1)] {
            let images = images(&scene, technique(s, t), Budget::new(4096, 140 + n as u64));
            assert_closed(&format!("in a sphere, {spot:?}, ({s},{t})"), &images, &expected, bounds);
        }
    }
}

/// The largest number a sampler gives.
const LARGEST_U: f32 = 1.0 - f32::EPSILON / 2.0;

/// Every path that a spot emits carries the same power, Φ: the sampled density is the attenuation itself.
#[test]
fn a_spot_emits_its_flux_with_zero_variance() {
    let mut random = Random(3);
    for spot in SPOTS.into_iter().chain([
        cosine(0.0, 0.5, 0.5),
        cosine(90.0, 90.0, 0.5),
        cosine(120.0, 170.0, 3.0),
        cosine(180.0, 180.0, 0.5),
        linear(0.0, 1.0),
        linear(90.0, 90.0),
        linear(120.0, 170.0),
        linear(0.0, 180.0),
        linear(180.0, 180.0),
    ]) {
        let axis = random.direction();
        let pose = facing(DVec3::new(0.3, -0.2, 1.0), axis);
        // A delta-point surface this time, its axis along local −z.
        let spot_material = spot.json(json!({ "type": "spot light", "emit": 7.0 }));
        let view = over_plane(1.0);
        let scene: Scene<DefaultAccel> = scene(&scene_json(
            view.json(),
            vec![
                quad(&DAffine3::IDENTITY, [4.0; 2], diffuse(0.5)),
                json!({ "type": "delta point", "transform": matrix(&pose), "material": spot_material }),
            ],
            vec![],
        ));
        let [light] = scene.lights.as_slice() else { panic!("one light") };
        let Light::Spot(prepared) = light else { panic!("a spot") };
        assert!((prepared.axis().as_dvec3() + axis).length() < 1e-6, "the axis is local −z");
        // Intensity is in render units, scaled with the square of the scene's scale: a power of two (here 1/16).
        let intensity = f64::from(prepared.intensity.x);
        let flux = intensity * spot.solid_angle();
        assert!((f64::from(light.power().x) / flux - 1.0).abs() < 2e-6, "{spot:?}: {} for {flux}", light.power().x);
        for i in 0..4000 {
            let mut u = [random.uniform() as f32, random.uniform() as f32].map(|u| u.min(LARGEST_U));
            // The axis and the rim themselves, all around.
            match i % 4 {
                0 => u[0] = 0.0,
                1 => u[0] = LARGEST_U,
                _ => {}
            }
            let Some(e) = light.sample_emission(&scene.geometry, 0.0, [0.5; 2], u) else {
                // Rounding may carry the last direction of the rim out of the cone.
                assert!(u[0] > 1.0 - 1e-6, "{spot:?}, u = {u:?}: nothing is emitted");
                continue;
            };
            let carried = f64::from(e.le.x) / e.pdf_direction.0;
            assert!((carried / flux - 1.0).abs() < 1e-5, "{spot:?}, u = {u:?}: {carried} for {flux}");
            // And the direction is where the format says light goes.
            // From the chord: in a narrow cone a cosine in f32 has few digits.
            let cos = 1.0 - 0.5 * (e.w.as_dvec3() - prepared.axis().as_dvec3()).length_squared();
            let attenuation = f64::from(e.le.x) / intensity;
            assert!(cos >= spot.outer.to_radians().cos() - 1e-6, "{spot:?}: outside the cone");
            let near_rim = (cos - spot.outer.to_radians().cos()).abs() < 1e-4;
            let want = spot.attenuation(cos);
            assert!(near_rim || (attenuation - want).abs() < 1e-4, "{spot:?}, cos {cos}: {attenuation} for {want}");
        }
    }
}

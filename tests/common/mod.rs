//! What the statistical tests share: scenes from JSON, independent renders, and assertions that can fail both ways.
//!
//! A test of "no difference" that is too noisy passes everything. So every assertion here is two-sided:
//!
//! 1. there is no evidence of a difference: a t-test per tile and channel, with Šidák's correction, at level `ALPHA`;
//! 2. there is evidence that the difference is small: its 99 % confidence interval lies inside ± the stated bound.
//!
//! All seeds are fixed: a test that passes once passes always on the same machine type.

#![allow(dead_code, unused_imports)] // Each test crate uses its own part of this module.

mod estimate;
mod everything;
mod view;

use std::path::Path;

use serde_json::{Value, json};
use twinlight::accel::{Accel, AccelOptions};
use twinlight::film::Image;
use twinlight::import::scene_from_str;
use twinlight::integrator::{Crop, Integrator, Settings, Technique};
use twinlight::math::{DAffine3, DVec3};
use twinlight::render::{RenderJob, Rendered, render};
use twinlight::scene::{Prepared, Scene, prepare};

pub use estimate::{ALPHA, Bounds, ROUNDING, assert_closed, assert_same, expect_colored, pooled_ratio, validation_row};
pub use everything::everything;
pub use view::View;

/// The accelerator that tests run on unless they say otherwise.
#[cfg(feature = "embree")]
pub type DefaultAccel = twinlight::accel::embree::EmbreeAccel;
/// The accelerator that tests run on unless they say otherwise.
#[cfg(not(feature = "embree"))]
pub type DefaultAccel = twinlight::accel::bvh::BvhAccel;

/// A scene on the default accelerator.
pub type SceneOnDefault = Scene<DefaultAccel>;

/// Reads and prepares a scene.
pub fn prepared(scene: &Value) -> Prepared {
    let desc = scene_from_str(&scene.to_string(), "test.json", Path::new(""))
        .unwrap_or_else(|e| panic!("the test's scene is wrong: {e}\n{scene:#}"));
    let prepared = prepare(&desc).unwrap_or_else(|e| panic!("the test's scene cannot be prepared: {e}"));
    assert!(prepared.warnings.is_empty(), "unexpected warnings: {:?}", prepared.warnings);
    prepared
}

/// A scene on a chosen accelerator.
pub fn scene_on<A: Accel>(scene: &Value, options: AccelOptions) -> Scene<A> {
    Scene::build(prepared(scene), options).unwrap_or_else(|e| panic!("the accelerator cannot be built: {e}"))
}

/// A scene on the default accelerator.
pub fn scene(scene: &Value) -> Scene<DefaultAccel> {
    scene_on(scene, AccelOptions::default())
}

/// A scene file of these parts.
pub fn scene_json(camera: Value, surfaces: Vec<Value>, lights: Vec<Value>) -> Value {
    json!({ "camera": camera, "surfaces": surfaces, "lights": lights })
}

/// A transform as the file writes it.
pub fn matrix(m: &DAffine3) -> Value {
    let rows: Vec<f64> = (0..3)
        .flat_map(|r| {
            let row = m.matrix3.row(r);
            [row.x, row.y, row.z, m.translation[r]]
        })
        .chain([0.0, 0.0, 0.0, 1.0])
        .collect();
    json!({ "matrix": rows })
}

/// A point or direction as the file writes it.
pub fn point(p: DVec3) -> Value {
    json!([p.x, p.y, p.z])
}

/// The frame at `o` whose local z is `z`.
pub fn facing(o: DVec3, z: DVec3) -> DAffine3 {
    let z = z.normalize();
    let (x, y) = z.any_orthonormal_pair();
    DAffine3 { matrix3: twinlight::math::DMat3::from_cols(x, y, z), translation: o }
}

/// A rectangle of full extents `size` in the xy plane of `frame`, facing its z.
pub fn quad(frame: &DAffine3, size: [f64; 2], material: Value) -> Value {
    json!({ "type": "quad", "size": size, "transform": matrix(frame), "material": material })
}

/// A sphere, facing outwards or, with `inward`, inwards.
pub fn sphere(center: DVec3, radius: f64, inward: bool, material: Value) -> Value {
    json!({
        "type": "sphere", "radius": radius, "transform": { "translate": point(center) }, "material": material,
        "flip_normals": inward
    })
}

/// A diffuse material.
pub fn diffuse(albedo: impl Into<Value>) -> Value {
    json!({ "type": "lambertian", "albedo": albedo.into() })
}

/// A material that shines and reflects nothing.
pub fn shining(radiance: impl Into<Value>) -> Value {
    json!({ "type": "diffuse light", "emit": radiance.into() })
}

/// A material that shines and reflects diffusely.
pub fn shining_diffuse(radiance: impl Into<Value>, albedo: impl Into<Value>) -> Value {
    json!({ "type": "lambertian", "albedo": albedo.into(), "emit": radiance.into() })
}

/// Default settings of an integrator with a limit on bounces.
pub fn settings(integrator: Integrator, max_bounces: u32) -> Settings {
    Settings { integrator, max_bounces, ..Settings::default() }
}

/// One technique of the bidirectional integrator alone, unweighted.
pub fn technique(s: u32, t: u32) -> Settings {
    Settings {
        only: Some(Technique { s, t }),
        weighted: false,
        max_bounces: s + t - 2,
        roulette: false,
        ..settings(Integrator::Bdpt, 0)
    }
}

/// How much to render: `runs` independent images of `samples` per pixel.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Independent images; the degrees of freedom of every test.
    pub runs: u32,
    /// Samples per pixel of each.
    pub samples: u32,
    /// Seed of the first; the others follow.
    pub seed: u64,
}

impl Budget {
    /// Sixteen images: enough degrees of freedom for the far quantiles that Šidák's correction asks for.
    pub fn new(samples: u32, seed: u64) -> Self {
        // Seeds of different budgets must not meet.
        Self { runs: 16, samples, seed: seed * 1000 }
    }
}

/// One render of the whole image by one thread. Nothing may be rejected at the gate before the film.
pub fn render_once<A: Accel>(scene: &Scene<A>, settings: Settings, samples: u32, pyramid: Option<u32>) -> Rendered {
    let crop = Crop::full(scene.camera.resolution());
    render_job(scene, &RenderJob { settings, samples, crop, threads: 1, pyramid })
}

/// Renders a job to its end. Nothing may be rejected at the gate before the film.
pub fn render_job<A: Accel>(scene: &Scene<A>, job: &RenderJob) -> Rendered {
    let rendered = render(scene, job, &|_| true).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(rendered.rejected, 0, "non-finite contributions: {:?}", rendered.rejected_first);
    assert_eq!(rendered.overflows, 0, "contributions too large for the film");
    rendered
}

/// Independent images.
pub fn images<A: Accel>(scene: &Scene<A>, settings: Settings, budget: Budget) -> Vec<Image> {
    (0..u64::from(budget.runs))
        .map(|run| {
            let settings = Settings { seed: budget.seed + run, ..settings };
            render_once(scene, settings, budget.samples, None).image
        })
        .collect()
}

/// Independent images by number of edges of the path, 1 to `edges`: the first index is the number of edges − 1.
pub fn images_by_edges<A: Accel>(scene: &Scene<A>, settings: Settings, budget: Budget, edges: u32) -> Vec<Vec<Image>> {
    let [width, height] = scene.camera.resolution();
    let mut by_edges = vec![Vec::new(); edges as usize];
    for run in 0..u64::from(budget.runs) {
        let settings = Settings { seed: budget.seed + run, ..settings };
        let rendered = render_once(scene, settings, budget.samples, Some(edges));
        for (n, list) in by_edges.iter_mut().enumerate() {
            let mut sum = Image::new(width, height);
            for (t, image) in &rendered.techniques {
                if (t.s + t.t) as usize == n + 2 {
                    sum = combined(&sum, image, 1.0);
                }
            }
            list.push(sum);
        }
    }
    by_edges
}

/// `a + factor · b`.
pub fn combined(a: &Image, b: &Image, factor: f32) -> Image {
    let mut sum = a.clone();
    for (p, q) in sum.rgb.iter_mut().zip(&b.rgb) {
        for (x, y) in p.iter_mut().zip(q) {
            *x += factor * y;
        }
    }
    sum
}

/// Random numbers for test scenes: SplitMix64 (Steele, Lea, Flood 2014, "Fast Splittable Pseudorandom Number
/// Generators", figure 17).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * (0.5_f64).powi(53)
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// A uniform unit vector.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (s, c) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * c, r * s, z)
    }

    /// A rigid motion: a rotation about a random axis by a random angle, then a shift of up to `shift` per axis.
    pub fn pose(&mut self, shift: f64) -> DAffine3 {
        let (axis, angle) = (self.direction(), self.between(0.5, 3.0));
        let translation =
            DVec3::new(self.between(-shift, shift), self.between(-shift, shift), self.between(-shift, shift));
        DAffine3::from_translation(translation) * DAffine3::from_axis_angle(axis, angle)
    }
}

//! The Cornell scenes against reference images by another renderer, where those are at hand.
//!
//! The references lie outside the project (`../shared/scenes/cornell/*.exr`); without them the tests say that they are
//! skipped. The mean of every channel must agree to 0.5 %, and the difference image must hold no structure: no block
//! differs by more than the noise of both images explains, and neighbouring blocks do not differ alike.

mod common;

use std::path::{Path, PathBuf};

use common::{Budget, DefaultAccel, images, settings, validation_row};
use twinlight::compare::stats::{Interval, Moments, normal_quantile, sidak, student_t_two_sided};
use twinlight::film::Image;
use twinlight::import::load_scene;
use twinlight::integrator::Integrator::{self, Bdpt, Light, Path as PathTracer};
use twinlight::output::read_image;
use twinlight::scene::{Scene, prepare};

/// Side of a block in pixels.
const BLOCK: u32 = 16;

/// Chance of a false alarm per scene and integrator.
const ALPHA: f64 = 1e-3;

fn reference(name: &str) -> Option<Image> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../shared/scenes/cornell/cornell_{name}.exr"));
    if !path.exists() {
        println!("skipped: there is no reference {}", path.display());
        return None;
    }
    Some(read_image(&path).unwrap_or_else(|e| panic!("{e}")))
}

fn scene(name: &str) -> Scene<DefaultAccel> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/reference/cornell_{name}.json"));
    let desc = load_scene(&path).unwrap_or_else(|e| panic!("{e}"));
    let prepared = prepare(&desc).unwrap_or_else(|e| panic!("{e}"));
    Scene::build(prepared, Default::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Grey means of blocks, row-major.
fn blocks(image: &Image) -> Vec<f64> {
    let mut sums = Vec::new();
    for y0 in (0..image.height).step_by(BLOCK as usize) {
        for x0 in (0..image.width).step_by(BLOCK as usize) {
            let mut sum = 0.0;
            for y in y0..y0 + BLOCK {
                for x in x0..x0 + BLOCK {
                    sum += image.get(x, y).iter().map(|c| f64::from(*c)).sum::<f64>();
                }
            }
            sums.push(sum / f64::from(3 * BLOCK * BLOCK));
        }
    }
    sums
}

/// `rel_mse` is the reference's own noise, as its makers measured it; each integrator comes with the samples per pixel
/// that its noise asks for.
fn check(name: &str, rel_mse: f64, integrators: &[(Integrator, u32)]) {
    let Some(reference) = reference(name) else { return };
    let scene = scene(name);
    for &(integrator, samples) in integrators {
        let budget = Budget { runs: 8, ..Budget::new(samples, 1) };
        let renders = images(&scene, settings(integrator, 64), budget);
        let what = format!("cornell_{name}, {integrator:?}");

        for (channel, want) in reference.mean().into_iter().enumerate() {
            let mut moments = Moments::default();
            for image in &renders {
                moments.push(image.mean()[channel] / want - 1.0);
            }
            let interval = moments.confidence_interval(0.99);
            let case = format!("{what}, channel {channel}");
            let measured = (1.0 + moments.mean()) * want;
            validation_row(file!(), &case, measured, want, [interval.low, interval.high], 5e-3, f64::NAN);
            assert!(interval.within(5e-3), "{what}, channel {channel}: {interval:?}");
        }

        let of_reference = blocks(&reference);
        let of_renders: Vec<Vec<f64>> = renders.iter().map(blocks).collect();
        let moments: Vec<Moments> = (0..of_reference.len())
            .map(|i| {
                let mut moments = Moments::default();
                of_renders.iter().for_each(|b| moments.push(b[i]));
                moments
            })
            .collect();
        let n = (reference.width / BLOCK) as usize;
        // Few renders know a block's variance badly; a neighbourhood of blocks, whose noise is alike, knows it well.
        let pooled = |i: usize| -> (f64, f64) {
            let near = |a: usize, b: usize| a.abs_diff(b) <= 1;
            let around = || (0..moments.len()).filter(|&j| near(i % n, j % n) && near(i / n, j / n));
            let count = around().count() as f64;
            let mean = around().map(|j| moments[j].variance()).sum::<f64>() / count;
            // The block's own variance where it is the larger: a caustic's edge is not like its neighbours.
            (mean.max(moments[i].variance()), count * (moments[i].count() - 1) as f64)
        };
        let alpha = sidak(ALPHA, of_reference.len() as u64);
        let mut z = Vec::new();
        for (i, r) in of_reference.iter().enumerate() {
            // relMSE is over pixels and channels; a block averages 3·BLOCK² of them, the channels of a pixel alike.
            let reference_variance = rel_mse * (r * r + 1e-2) / f64::from(BLOCK * BLOCK);
            let (variance, dof) = pooled(i);
            let t = (moments[i].mean() - r) / (variance / moments[i].count() as f64 + reference_variance).sqrt();
            let p = student_t_two_sided(t, dof);
            assert!(p > alpha, "{what}: block {i} is {} instead of {r}, t = {t:.2}, p = {p:.1e}", moments[i].mean());
            z.push(t);
        }
        // And no quarter of the image may be off by more than a noisy test could miss.
        for quarter in 0..4 {
            let inside = |i: usize| i / n / (n / 2) == quarter / 2 && i % n / (n / 2) == quarter % 2;
            let sum = |b: &[f64]| (0..b.len()).filter(|&i| inside(i)).map(|i| b[i]).sum::<f64>();
            let mut ratio = Moments::default();
            of_renders.iter().for_each(|b| ratio.push(sum(b) / sum(&of_reference) - 1.0));
            let interval = ratio.confidence_interval(0.99);
            let case = format!("{what}, quarter {quarter}, relative");
            let Interval { low, high } = interval;
            validation_row(file!(), &case, 1.0 + ratio.mean(), 1.0, [low, high], 2e-2, f64::NAN);
            assert!(interval.within(2e-2), "{what}: quarter {quarter} of the image is off by {interval:?}");
        }
        // Correlation of neighbours along rows and columns; without structure it is about normal, of variance 1/pairs.
        let energy = z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64;
        let (mut sum, mut pairs) = (0.0, 0.0);
        for i in 0..z.len() {
            if i % n + 1 < n {
                sum += z[i] * z[i + 1];
                pairs += 1.0;
            }
            if i + n < z.len() {
                sum += z[i] * z[i + n];
                pairs += 1.0;
            }
        }
        let correlation: f64 = sum / pairs / energy;
        let bound = normal_quantile(1.0 - ALPHA / 2.0) / f64::sqrt(pairs);
        println!("{what}: correlation of neighbouring differences {correlation:+.3}, bound ±{bound:.3}");
        assert!(correlation.abs() < bound, "{what}: the difference has structure: {correlation}");
    }
}

#[test]
fn area_light() {
    check("area", 2.6e-5, &[(PathTracer, 4), (Bdpt, 4), (Light, 4)]);
}

#[test]
fn point_light() {
    check("point", 1.4e-4, &[(PathTracer, 8), (Bdpt, 4), (Light, 6)]);
}

#[test]
fn spot_light() {
    check("spot", 1.3e-4, &[(PathTracer, 16), (Bdpt, 4), (Light, 6)]);
}

/// Light tracing never sees the spheres: no light path can be connected to a delta surface.
#[test]
fn glass_and_mirror() {
    check("glass", 1.5e-4, &[(PathTracer, 24), (Bdpt, 4)]);
}

#[test]
fn glossy_blocks() {
    check("glossy", 1.5e-4, &[(PathTracer, 16), (Bdpt, 4), (Light, 32)]);
}

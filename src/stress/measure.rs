//! Renders without a film, for what happens before it; walks that watch rays.

use rayon::prelude::*;

use crate::accel::Accel;
use crate::bsdf::{Bsdf, Transport};
use crate::compare::stats::Moments;
use crate::geometry::GeometryKind;
use crate::integrator::bdpt::oracle::{Judge, Seen};
use crate::integrator::path::camera_ray;
use crate::integrator::{Crop, PixelSample, Recorder, SampleLoop, Settings};
use crate::math::Ray;
use crate::sampling::{Sampler, SamplerKind, Stream};
use crate::scene::{Reached, Scene};

/// One render.
#[derive(Clone, Debug)]
pub struct Run {
    /// Mean radiance over pixels and channels.
    pub mean: f64,
    /// Sums of the contributions to each pixel, per channel.
    pixels: Vec<[f64; 3]>,
}

/// Renders with different seeds.
#[derive(Clone, Debug)]
pub struct Measured {
    /// By seed.
    pub runs: Vec<Run>,
    /// Contributions that were not finite.
    pub rejected: u64,
    /// The first of them.
    pub first: String,
}

impl Measured {
    /// Of the renders' means.
    pub fn moments(&self) -> Moments {
        self.runs.iter().map(|run| run.mean).collect()
    }

    /// Whether every pixel of every render is so many times another's, to the last bit.
    pub fn is_times(&self, o: &Self, times: f64) -> bool {
        let pixels = |m: &Self| m.runs.iter().flat_map(|run| &run.pixels).flatten().copied().collect::<Vec<f64>>();
        let (a, b) = (pixels(self), pixels(o));
        a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| *a == times * b)
    }
}

/// Renders a scene with `samples` samples per pixel and seeds from 0 to `seeds`, each render by one thread.
pub fn measure<A: Accel>(scene: &Scene<A>, settings: Settings, samples: u32, seeds: u64) -> Measured {
    let resolution = scene.camera.resolution();
    let crop = Crop::full(resolution);
    let render = |seed: u64| {
        let mut samplers = SampleLoop::new(scene, Settings { seed, ..settings });
        let mut recorder = Recorder::new(crop, false);
        let mut pixels = vec![[0.0; 3]; crop.pixels() as usize];
        let add = |sum: &mut [f64; 3], value: [f32; 3]| {
            sum.iter_mut().zip(value).for_each(|(sum, x)| *sum += f64::from(x));
        };
        for y in 0..resolution[1] {
            for x in 0..resolution[0] {
                for index in 0..samples {
                    samplers.sample(PixelSample { pixel: [x, y], index }, &mut recorder);
                    add(&mut pixels[(y * resolution[0] + x) as usize], recorder.radiance().to_array());
                    for splat in recorder.splats() {
                        add(&mut pixels[splat.pixel as usize], splat.value.to_array());
                    }
                    recorder.clear();
                }
            }
        }
        let count = 3.0 * pixels.len() as f64 * f64::from(samples);
        let mean = pixels.iter().flatten().sum::<f64>() / count;
        let (rejected, first) = recorder.rejected();
        let first = first.first().map(|r| {
            format!(
                "pixel {},{}, sample {}, technique ({},{}), seed {seed}",
                r.pixel[0], r.pixel[1], r.sample, r.technique.s, r.technique.t
            )
        });
        (Run { mean, pixels }, rejected, first)
    };
    let all: Vec<_> = (0..seeds).into_par_iter().map(render).collect();
    Measured {
        rejected: all.iter().map(|(_, rejected, _)| rejected).sum(),
        first: all.iter().find_map(|(_, _, first)| first.clone()).unwrap_or_default(),
        runs: all.into_iter().map(|(run, ..)| run).collect(),
    }
}

/// How far from 1 the weights of a path may sum.
pub const WEIGHTS: f64 = 1e-4;

/// How far a weight may be off by itself, where that is more than 10⁻⁴: over what rounding the path's points does to its
/// densities, which the power heuristic squares.
const WEIGHT: f64 = 2.0;

/// However badly conditioned a path is.
const WEIGHT_AT_MOST: f64 = 0.1;

/// How far a contribution with the weight 1 may be off, where that is more than 10⁻⁵, and what techniques measure of one path,
/// where that is more than 10⁻⁴: over the same.
const CONTRIBUTION: f64 = 1.0;

/// Characters of a fault's text: the path itself is longer than a table's row.
const FAULT: usize = 160;

/// Judges the weights of `bdpt` on `paths` random paths by their densities multiplied out.
pub fn weights<A: Accel>(scene: &Scene<A>, settings: Settings, paths: u32) -> Seen {
    let judge = Judge::new(scene, settings);
    (0..paths).into_par_iter().map(|index| Seen::path(&judge, index)).reduce(Seen::default, Seen::merge)
}

/// What is wrong with paths' weights, whose sums may be `sum` from 1, with their contributions and with what their techniques
/// measure; empty when nothing is.
pub fn faults_of_weights(seen: &Seen, sum: f64) -> Vec<String> {
    let mut faults = Vec::new();
    // A NaN is a fault.
    let (off, weight, over) = (seen.worst_sum, seen.worst_weight, seen.worst_weight_over_condition);
    if !(off <= sum && over <= WEIGHT && weight <= WEIGHT_AT_MOST) {
        faults.push(format!(
            "Σw − 1 up to {off:.1e}, a weight off by {weight:.1e}, {over:.1} times what rounding explains"
        ));
    }
    let (worst, over) = (seen.worst_contribution, seen.worst_contribution_over_condition);
    if over.is_nan() || over > CONTRIBUTION {
        faults.push(format!("a contribution off by {worst:.1e}, {over:.1} times what rounding explains"));
    }
    let over = seen.worst_identity_over_condition;
    if over.is_nan() || over > CONTRIBUTION {
        faults.push(format!("techniques measure differently, by {over:.1} times what rounding explains"));
    }
    if let Some(first) = &seen.structural.first {
        let first: String = first.to_string().chars().take(FAULT).collect();
        faults
            .push(format!("{} paths have faults that no rounding explains, the first: {first}", seen.structural.count));
    }
    faults
}

/// What the walks saw.
#[derive(Clone, Copy, Debug, Default)]
pub struct Audit {
    /// Rays traced.
    pub rays: u64,
    /// Rays that met the flat primitive they left, or the ball they left to the outside.
    pub self_hits: u64,
    /// Rays that left a closed room.
    pub escapes: u64,
}

/// Scatterings of each walk.
const STEPS: u32 = 12;

/// Takes `walks` walks from the camera by the BSDFs.
pub fn audit<A: Accel>(scene: &Scene<A>, closed: bool, walks: u32) -> Audit {
    let [width, height] = scene.camera.resolution();
    let walk = |index: u32| {
        let mut audit = Audit::default();
        let pixel = [index % width, index / width % height];
        let mut sampler =
            Sampler::new(SamplerKind::Independent, 77, pixel[1] * width + pixel[0], Stream::Camera, index);
        let mut coins = sampler.coins();
        let mut ray = camera_ray(&scene.camera, pixel, &mut sampler).ray;
        let mut varying = Bsdf::Black;
        let mut left: Option<(GeometryKind, u32)> = None;
        for _ in 0..STEPS {
            audit.rays += 1;
            let mut parts = 0;
            let arrival = match scene.follow(ray, &mut coins, &mut parts, &mut varying) {
                Reached::Surface(arrival) => arrival,
                Reached::Infinity { .. } => {
                    audit.escapes += u64::from(closed);
                    break;
                }
            };
            let at = &arrival.at;
            let here = (arrival.geometry, at.primitive());
            // What passes a window or a hole starts anew there: from a place that is known as well as that surface is large.
            audit.self_hits += u64::from(left == Some(here) && parts == 1);
            let (u, lobe) = (sampler.next_2d(), sampler.next_1d());
            let Some(next) = arrival.bsdf.sample(at, -ray.d, lobe, u, Transport::Radiance) else { break };
            // A ball can be met again from inside.
            let convex = match arrival.geometry {
                GeometryKind::Triangle => true,
                GeometryKind::Quadric => {
                    let outward = scene.geometry.quadrics[at.primitive() as usize].orientation;
                    f64::from(next.wi.dot(at.ng)) * outward > 0.0
                }
            };
            left = convex.then_some(here);
            ray = Ray::new(at.origin(next.wi), next.wi);
        }
        audit
    };
    (0..walks).into_par_iter().map(walk).reduce(Audit::default, |a, b| Audit {
        rays: a.rays + b.rays,
        self_hits: a.self_hits + b.self_hits,
        escapes: a.escapes + b.escapes,
    })
}

//! `auto`: which techniques a scene is rendered with, learnt from its first samples.
//!
//! The first `PILOT` samples of each pixel are those of `bdpt`, whatever comes after them, and stay in the image. The first
//! `SCOUT` of them say how bright the image is about where; over the others a survey carries the sums of weights that other
//! numbers of light subpaths and connections would have (`LANES`), and so learns from one and the same samples what the
//! variance would have been with each of them, those of paths included that a lane can hardly make: the pilot finds them
//! with another technique (after [Grittmann22]). Cost is counted work: rays by kind, with fixed weights. The lane of
//! the least variance × cost renders the rest, with visibility rays traced by what they are worth (`worth`).
//!
//! The plan depends on scene, settings and seed alone: no clock and no thread is asked, and every image of the pilot is the
//! full one, so that any number of samples, threads, or any crop has the same.

mod cost;
mod scout;
mod survey;

pub use scout::{Scattering, Scout};
pub use survey::{Survey, Tally};

use std::sync::Arc;

use super::bdpt::CANDIDATES;
use super::{Integrator, PathClass, Rays, Settings, SplatConfidence, Thresholds};
use crate::film::Image;
use crate::math::Rgb;
use crate::sampling::SamplerKind;
use crate::scene::SceneNeeds;
use crate::scene::desc::Heuristic;

/// Samples of each pixel that tell how bright it is about.
pub const SCOUT: u32 = 2;
/// Samples of each pixel after which the plan is made.
pub const PILOT: u32 = 4;

const _: () = assert!(SCOUT == 2 && PILOT >= SCOUT + 2);

/// How light subpaths are spent: one in `one_in` camera samples has `light_paths` of them and is connected to
/// `connections` of these.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lane {
    /// Light subpaths of a sample that has any.
    pub light_paths: u32,
    /// How many of them its camera vertices are connected to.
    pub connections: u32,
    /// One in this many samples has any.
    pub one_in: u32,
}

impl Lane {
    const fn new(light_paths: u32, connections: u32, one_in: u32) -> Self {
        Self { light_paths, connections, one_in }
    }

    /// Light subpaths and connections per camera sample.
    pub fn counts(&self) -> [f64; 2] {
        [self.light_paths, self.connections].map(|n| f64::from(n) / f64::from(self.one_in))
    }
}

/// What `auto` chooses among; the pilot's own is the first.
pub const LANES: [Lane; CANDIDATES] = [
    Lane::new(1, 1, 1),
    Lane::new(0, 0, 1),
    Lane::new(1, 0, 4),
    Lane::new(1, 0, 1),
    Lane::new(1, 1, 4),
    Lane::new(1, 1, 2),
    Lane::new(2, 1, 1),
    Lane::new(4, 1, 1),
];

/// Pixels on a side of the blocks that brightness is known of.
pub(super) const BLOCK: u32 = 8;

/// What of the variance of a sample's direct light (paths of up to 2 edges) is left where many samples are taken: points
/// of a net integrate it, smooth as it is and of few dimensions, far better than independent ones do. (Direct light of the
/// Cornell box by `path`, 64 samples, Sobol's points against independent ones: docs/PERFORMANCE.md.)
const LEFT_OF_DIRECT: f64 = 0.1;
/// The same of longer paths.
const LEFT_OF_REST: f64 = 0.5;

/// Keeps relative errors finite in the dark: this part of the image's mean, so that no unit of radiance matters.
const DARK: f64 = 0.5;

/// A block is no brighter than this many times its median pixel: lamps that are seen in it, and samples that stand out, say
/// nothing of its other pixels.
const ABOVE_MEDIAN: f64 = 3.0;

/// Images of fewer pixels have too few samples to learn from.
const LEAST_PIXELS: u64 = 256;

/// No visibility ray that could add more than this part of a pixel's brightness is left to roulette.
const MOST_DELTA: f64 = 0.2;

/// How bright the image is about where, as the scale that makes errors relative.
#[derive(Clone, Debug)]
pub struct Brightness {
    columns: u32,
    /// 1/√(μ² + ε) per block and channel.
    scale: Vec<Rgb>,
}

impl Brightness {
    /// Of an image, however noisy.
    pub fn of(image: &Image) -> Self {
        let (columns, rows) = ((image.width / BLOCK).max(1), (image.height / BLOCK).max(1));
        let mut blocks = vec![[const { Vec::new() }; 3]; (columns * rows) as usize];
        for (i, pixel) in image.rgb.iter().enumerate() {
            let (x, y) = (i as u32 % image.width, i as u32 / image.width);
            let block = (y / BLOCK).min(rows - 1) * columns + (x / BLOCK).min(columns - 1);
            for (values, c) in blocks[block as usize].iter_mut().zip(pixel) {
                values.push(f64::from(*c));
            }
        }
        let levels: Vec<[f64; 3]> = blocks.into_iter().map(|block| block.map(level)).collect();
        let dark = DARK * levels.iter().flatten().sum::<f64>() / (3 * levels.len()) as f64;
        // Of a black image nothing is relative.
        let relative = |level: f64| if dark > 0.0 { (1.0 / (level * level + dark * dark).sqrt()) as f32 } else { 0.0 };
        Self { columns, scale: levels.iter().map(|l| Rgb::from_array(l.map(relative))).collect() }
    }

    /// What makes an error of this pixel relative.
    #[inline]
    fn at(&self, pixel: [u32; 2]) -> Rgb {
        self.scale[block(pixel, self.columns, self.scale.len())]
    }
}

/// The index of a pixel's block among so many, of which `columns` stand in a row; the last of a row or column reach to the
/// image's edge.
#[inline]
pub(super) fn block([x, y]: [u32; 2], columns: u32, blocks: usize) -> usize {
    let row = ((y / BLOCK) as usize).min(blocks / columns as usize - 1);
    row * columns as usize + (x / BLOCK).min(columns - 1) as usize
}

/// The mean of a channel, but for what stands out.
fn level(mut values: Vec<f64>) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.sort_by(f64::total_cmp);
    match values[values.len() / 2] {
        median if median > 0.0 => mean.min(ABOVE_MEDIAN * median),
        // More than half of it is black, or seems so yet.
        _ => mean,
    }
}

/// Whether there is anything to learn from samples: else `Err` tells what is done, and why.
///
/// # Errors
/// The lane that the scene or the settings leave, and the reason in words.
pub fn undecided(settings: &Settings, needs: &SceneNeeds, pixels: u64) -> Result<(), (Lane, &'static str)> {
    let bdpt = LANES[0];
    let path = LANES[1];
    if !needs.light {
        return Err((path, "nothing in the scene shines"));
    }
    if !needs.connections {
        return Err((path, "no surface can be connected to: light subpaths would be of no use"));
    }
    if settings.only.is_some() || !settings.weighted || settings.class != PathClass::default() {
        return Err((bdpt, "single techniques are asked for"));
    }
    if pixels < LEAST_PIXELS {
        return Err((bdpt, "the image has too few pixels to learn from"));
    }
    if settings.heuristic == Heuristic::Uniform {
        return Err((bdpt, "the uniform heuristic weighs all techniques the same, however many samples they take"));
    }
    if settings.max_bounces == 0 {
        return Err((path, "emitted light alone is asked for"));
    }
    Ok(())
}

/// What the pilot found of a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// The lane.
    pub lane: Lane,
    /// Mean over pixels of a sample's variance over μ² + ε; infinite where paths would be missing.
    pub variance: f64,
    /// Work per sample, in visibility rays.
    pub cost: f64,
}

/// What is rendered after the pilot, and why.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Settings of the survey's samples, those from `SCOUT` on.
    pub survey: Settings,
    /// Settings of the samples from `PILOT` on.
    pub settings: Settings,
    /// What their visibility rays must be worth.
    pub thresholds: Option<Arc<Thresholds>>,
    /// How `light_paths` and `connections` are spent.
    pub lane: Lane,
    /// What was found of each lane, if samples were asked.
    pub findings: Vec<Finding>,
    /// δ relative to a pixel's brightness.
    pub delta: f64,
    /// Why, where the scene or the settings left no choice.
    pub exact: Option<&'static str>,
}

impl Plan {
    /// The plan that is left where nothing needs learning.
    pub fn exact(settings: &Settings, lane: Lane, why: &'static str) -> Self {
        Self {
            survey: *settings,
            settings: along(settings, lane),
            thresholds: None,
            lane,
            findings: Vec::new(),
            delta: 0.0,
            exact: Some(why),
        }
    }

    /// The plan of a pilot whose last samples had these settings.
    pub fn learnt(survey: Settings, needs: &SceneNeeds, brightness: &Brightness, tally: &Tally, rays: &Rays) -> Self {
        let variances = tally.variances(left(survey.sampler));
        // What only light subpaths find well may have been missed by the few of a pilot.
        let light_alone = needs.delta_surfaces || needs.delta_lights && needs.windows;
        let findings: Vec<Finding> = LANES
            .iter()
            .zip(variances)
            .map(|(lane, variance)| Finding {
                lane: *lane,
                variance: if light_alone && lane.light_paths == 0 { f64::INFINITY } else { variance },
                cost: cost::of(lane, rays),
            })
            .collect();
        let work = |f: &Finding| f.variance * f.cost;
        let known = findings.iter().filter(|f| work(f).is_finite());
        let best = known.min_by(|a, b| work(a).total_cmp(&work(b))).copied().unwrap_or(findings[0]);
        let delta = (best.variance * cost::RAY / best.cost).sqrt().min(MOST_DELTA);
        let thresholds = (delta > 0.0 && delta.is_finite() && survey.roulette)
            .then(|| Arc::new(Thresholds::new(brightness.columns, &brightness.scale, delta as f32)));
        Self { survey, settings: along(&survey, best.lane), thresholds, lane: best.lane, findings, delta, exact: None }
    }
}

impl Plan {
    /// By what sample number `index` of a pixel is made.
    pub fn of_sample(&self, settings: &Settings, index: u32) -> (Settings, Option<Arc<Thresholds>>) {
        match index {
            _ if self.exact.is_some() => (self.settings, None),
            index if index < SCOUT => (scout(settings), None),
            index if index < PILOT => (self.survey, None),
            _ => (self.settings, self.thresholds.clone()),
        }
    }
}

/// The settings of the scout's samples.
pub fn scout(settings: &Settings) -> Settings {
    // Direct light is smooth nearly everywhere: what splats add to it is noise.
    Settings { splat_confidence: SplatConfidence::new([0.01, 0.01, 1.0, 1.0, 1.0, 1.0]), ..along(settings, LANES[0]) }
}

/// What is left of the variance of direct light and of longer paths by this sampler's points.
fn left(sampler: SamplerKind) -> [f64; 2] {
    match sampler {
        SamplerKind::Sobol => [LEFT_OF_DIRECT, LEFT_OF_REST],
        SamplerKind::Independent => [1.0; 2],
    }
}

/// The settings of the survey's samples, by what the scout has seen.
pub fn survey(settings: &Settings, scattering: &Scattering) -> Settings {
    Settings { splat_confidence: scattering.confidence(left(settings.sampler)[0]), ..along(settings, LANES[0]) }
}

/// Settings with the light subpaths of a lane.
fn along(settings: &Settings, lane: Lane) -> Settings {
    Settings {
        integrator: if lane.light_paths == 0 { Integrator::Path } else { Integrator::Bdpt },
        light_paths: lane.light_paths,
        connections: lane.connections,
        light_one_in: lane.one_in,
        ..*settings
    }
}

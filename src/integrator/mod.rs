//! Integrators: one sample of one pixel in, contributions out. They never open a file, read a clock or see a thread.

pub mod bdpt;
pub mod light;
pub mod path;
mod recorder;
mod roulette;

pub use recorder::{Contribution, Rays, Recorder, Rejected, Technique};
pub use roulette::Roulette;

use crate::accel::Accel;
use crate::sampling::SamplerKind;
use crate::scene::Scene;
use crate::scene::desc::Heuristic;

/// Which estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Path tracing: techniques s ≤ 1.
    Path,
    /// Light tracing: techniques t = 1.
    Light,
    /// Bidirectional path tracing: all techniques s ≥ 0, t ≥ 1.
    Bdpt,
}

/// What an integrator needs to know besides the scene.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Which estimator.
    pub integrator: Integrator,
    /// Largest number of scattering events on a path; 0 is emitted light only.
    pub max_bounces: u32,
    /// Whether subpaths are ended at random, without bias.
    pub roulette: bool,
    /// How techniques share a path.
    pub heuristic: Heuristic,
    /// Light subpaths per camera sample (`bdpt`); 0 leaves path tracing.
    pub light_paths: u32,
    /// How many of them each camera vertex connects to, at most `light_paths` (`bdpt`).
    pub connections: u32,
    /// Point set.
    pub sampler: SamplerKind,
    /// Seed of everything random.
    pub seed: u64,
    /// Whether contributions are weighted by the heuristic; unweighted techniques are for study.
    pub weighted: bool,
    /// Record this technique alone.
    pub only: Option<Technique>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            integrator: Integrator::Bdpt,
            max_bounces: 64,
            roulette: true,
            heuristic: Heuristic::Power,
            light_paths: 1,
            connections: 1,
            sampler: SamplerKind::Sobol,
            seed: 0,
            weighted: true,
            only: None,
        }
    }
}

impl Settings {
    /// Whether a technique is to be computed.
    #[inline]
    pub fn wants(&self, s: u32, t: u32) -> bool {
        self.only.is_none_or(|only| only == Technique { s, t })
    }
}

/// The pixels that are rendered: column and row ranges of the full image, ends exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Crop {
    /// The whole image.
    pub fn full([width, height]: [u32; 2]) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.x1 - self.x0
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.y1 - self.y0
    }

    /// Number of pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// Whether a pixel of the full image is among them.
    #[inline]
    pub fn contains(&self, [x, y]: [u32; 2]) -> bool {
        (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y)
    }
}

/// One sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct PixelSample {
    /// Column and row in the full image.
    pub pixel: [u32; 2],
    /// Number of the sample in the pixel, counted from 0 whatever the pass.
    pub index: u32,
}

/// Computes samples of one scene under one set of settings; owns its scratch memory, one per thread.
#[derive(Debug)]
pub struct SampleLoop<'a, A> {
    scene: &'a Scene<A>,
    settings: Settings,
    bdpt: bdpt::Bdpt,
    /// Light paths that the whole pass traces: each of them may land on any pixel.
    light_paths_per_pass: f64,
}

impl<'a, A: Accel> SampleLoop<'a, A> {
    /// For samples of the pixels in `crop`.
    pub fn new(scene: &'a Scene<A>, settings: Settings, crop: Crop) -> Self {
        let per_sample = match settings.integrator {
            Integrator::Path => 0,
            Integrator::Light => settings.light_paths.max(1),
            Integrator::Bdpt => settings.light_paths,
        };
        let light_paths_per_pass = f64::from(per_sample) * crop.pixels() as f64;
        Self { scene, settings, bdpt: bdpt::Bdpt::new(scene, settings, light_paths_per_pass), light_paths_per_pass }
    }

    /// Computes one sample; its contributions go to `recorder`.
    #[inline]
    pub fn sample(&mut self, sample: PixelSample, recorder: &mut Recorder) {
        match self.settings.integrator {
            Integrator::Path => path::sample(self.scene, &self.settings, sample, recorder),
            Integrator::Light => {
                light::sample(self.scene, &self.settings, self.light_paths_per_pass, sample, recorder);
            }
            Integrator::Bdpt => self.bdpt.sample(self.scene, sample, recorder),
        }
    }
}

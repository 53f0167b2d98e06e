//! Integrators: one sample of one pixel in, contributions out. They never open a file, read a clock or see a thread.

pub mod bdpt;
mod class;
pub mod light;
pub mod path;
mod recorder;
mod roulette;
pub mod trace;

pub use class::PathClass;
pub use recorder::{Contribution, Rays, Reason, Recorder, Rejected, Technique};
pub use roulette::Roulette;

use crate::accel::Accel;
use crate::math::Rgb;
use crate::planted::{Bug, planted};
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
    /// Scatterings at the start of a subpath that are free of roulette; `None` for the integrator's own choice.
    pub roulette_after: Option<u32>,
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
    /// Make the paths of this class alone.
    pub class: PathClass,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            integrator: Integrator::Bdpt,
            max_bounces: 64,
            roulette: true,
            roulette_after: None,
            heuristic: Heuristic::Power,
            light_paths: 1,
            connections: 1,
            sampler: SamplerKind::Sobol,
            seed: 0,
            weighted: true,
            only: None,
            class: PathClass::default(),
        }
    }
}

impl Settings {
    /// The roulette of a subpath that starts with throughput `beta`.
    #[inline]
    fn roulette(&self, beta: Rgb) -> Roulette {
        Roulette::new(self.roulette, beta, self.free_of_roulette())
    }

    /// How many scatterings at the start of a subpath are free of roulette, where there is any.
    #[inline]
    pub fn free_of_roulette(&self) -> u32 {
        self.roulette_after.unwrap_or(match self.integrator {
            Integrator::Path => Roulette::FREE_PATH,
            Integrator::Light | Integrator::Bdpt => Roulette::FREE_SUBPATH,
        })
    }

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

impl PixelSample {
    /// A number that is the pixel's alone: its row-major index in the full image.
    #[inline]
    fn key(&self, [width, _]: [u32; 2]) -> u32 {
        self.pixel[1] * width + self.pixel[0]
    }
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
    /// For samples of a scene's image. Light paths are counted over the full image, whatever is cropped out of it.
    pub fn new(scene: &'a Scene<A>, mut settings: Settings) -> Self {
        settings.max_bounces += u32::from(planted(Bug::DepthOfAll));
        let per_sample = match settings.integrator {
            Integrator::Path => 0,
            Integrator::Light => settings.light_paths.max(1),
            Integrator::Bdpt => settings.light_paths,
        };
        let pixels = Crop::full(scene.camera.resolution()).pixels();
        let per_sample = if planted(Bug::SplatCount) { per_sample.min(1) } else { per_sample };
        let light_paths_per_pass = f64::from(per_sample) * pixels as f64;
        Self { scene, settings, bdpt: bdpt::Bdpt::new(scene, settings, light_paths_per_pass), light_paths_per_pass }
    }

    /// Whether samples contribute to pixels other than their own: then the samples of every pixel of the full image
    /// have to be computed (`sample`, or `sample_splats` for those cropped away), or splats are missing.
    pub fn splats(&self) -> bool {
        let wanted = self.settings.only.is_none_or(|only| only.t == 1);
        wanted
            && match self.settings.integrator {
                Integrator::Path => false,
                Integrator::Light => self.scene.needs.light,
                Integrator::Bdpt => self.bdpt.traces_light(),
            }
    }

    /// Computes one sample; its contributions go to `recorder`.
    #[inline]
    pub fn sample<const T: bool>(&mut self, sample: PixelSample, recorder: &mut Recorder<T>) {
        match self.settings.integrator {
            Integrator::Path => path::sample(self.scene, &self.settings, sample, recorder),
            Integrator::Light => {
                light::sample(self.scene, &self.settings, self.light_paths_per_pass, sample, recorder);
            }
            Integrator::Bdpt => self.bdpt.sample(self.scene, sample, recorder),
        }
    }

    /// Computes only what one sample contributes to other pixels than its own.
    pub fn sample_splats<const T: bool>(&mut self, sample: PixelSample, recorder: &mut Recorder<T>) {
        match self.settings.integrator {
            Integrator::Path => {}
            Integrator::Light => self.sample(sample, recorder),
            Integrator::Bdpt => self.bdpt.sample_light(self.scene, sample, recorder),
        }
    }
}

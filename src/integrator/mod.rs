//! Integrators: one sample of one pixel in, contributions out. They never open a file, read a clock or see a thread.

pub mod auto;
pub mod bdpt;
mod class;
pub mod light;
pub mod path;
mod recorder;
mod roulette;
pub mod trace;
mod worth;

pub use class::PathClass;
pub use recorder::{Contribution, Rays, Reason, Recorder, Rejected, Technique};
pub use roulette::Roulette;
pub use worth::Thresholds;

use std::sync::Arc;

use crate::accel::Accel;
use crate::math::Rgb;
use crate::planted::{Bug, planted};
use crate::sampling::SamplerKind;
use crate::scene::Scene;
use crate::scene::desc::Heuristic;
use bdpt::{Candidates, Sums};

/// Which estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Path tracing: techniques s ≤ 1.
    Path,
    /// Light tracing: techniques t = 1.
    Light,
    /// Bidirectional path tracing: all techniques s ≥ 0, t ≥ 1.
    Bdpt,
    /// Either, with as many light subpaths and connections as the first samples say are worth it (`auto`). That is for
    /// the driver to find out; a sample by itself is `bdpt`'s.
    Auto,
}

/// Lengths of paths that are told apart, in edges; the last stands for all longer ones.
pub const LENGTHS: usize = 6;

/// How far splats are trusted on paths of 1, 2, … edges, the last for all longer ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplatConfidence([f32; LENGTHS]);

impl Default for SplatConfidence {
    fn default() -> Self {
        Self([1.0; LENGTHS])
    }
}

impl SplatConfidence {
    /// By length of path.
    pub fn new(by_edges: [f32; LENGTHS]) -> Self {
        Self(by_edges)
    }

    /// On paths of so many edges, at least one.
    #[inline(always)]
    pub fn on(&self, edges: u32) -> f64 {
        f64::from(self.0[(edges as usize - 1).min(LENGTHS - 1)])
    }
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
    /// One in this many of a pixel's samples has light subpaths and connections, the others have none (`bdpt`).
    pub light_one_in: u32,
    /// How far splats (t = 1) are trusted on paths of 1, 2, … edges, the last for all longer ones (`bdpt`): they count in the
    /// weights for so many times as many samples as there are. Above 0; 1 where other techniques' samples scatter as much.
    pub splat_confidence: SplatConfidence,
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
            light_one_in: 1,
            splat_confidence: SplatConfidence::default(),
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
            Integrator::Light | Integrator::Bdpt | Integrator::Auto => Roulette::FREE_SUBPATH,
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
pub struct SampleLoop<'a, A, S = f64> {
    scene: &'a Scene<A>,
    settings: Settings,
    bdpt: bdpt::Bdpt<S>,
    /// Light paths that the whole pass traces: each of them may land on any pixel.
    light_paths_per_pass: f64,
    /// What visibility rays must be worth.
    thresholds: Option<Arc<Thresholds>>,
}

impl<'a, A: Accel> SampleLoop<'a, A> {
    /// For samples of a scene's image. Light paths are counted over the full image, whatever is cropped out of it.
    pub fn new(scene: &'a Scene<A>, settings: Settings) -> Self {
        Self::thrifty(scene, settings, None)
    }

    /// The same with visibility rays traced by what they are worth (`path`, `bdpt`).
    pub fn thrifty(scene: &'a Scene<A>, mut settings: Settings, thresholds: Option<Arc<Thresholds>>) -> Self {
        settings.max_bounces += u32::from(planted(Bug::DepthOfAll));
        let light_paths_per_pass = light_paths_per_pass(scene, &settings);
        let bdpt = bdpt::Bdpt::new(scene, settings, light_paths_per_pass).thrifty(thresholds.clone());
        Self { scene, settings, bdpt, light_paths_per_pass, thresholds }
    }
}

impl<'a, A: Accel> SampleLoop<'a, A, Candidates> {
    /// `bdpt`, and for each contribution what other lanes of `auto` would have made of it (`Recorder::take_notes`).
    pub fn survey(scene: &'a Scene<A>, settings: Settings) -> Self {
        let light_paths_per_pass = light_paths_per_pass(scene, &settings);
        let others = std::array::from_fn(|i| auto::LANES[i + 1].counts());
        let bdpt = bdpt::Bdpt::survey(scene, settings, light_paths_per_pass, others);
        Self { scene, settings, bdpt, light_paths_per_pass, thresholds: None }
    }
}

/// How many light subpaths a pass of one sample per pixel of the full image traces.
fn light_paths_per_pass<A: Accel>(scene: &Scene<A>, settings: &Settings) -> f64 {
    let per_sample = match settings.integrator {
        Integrator::Path => 0,
        Integrator::Light => settings.light_paths.max(1),
        Integrator::Bdpt | Integrator::Auto => settings.light_paths,
    };
    let pixels = Crop::full(scene.camera.resolution()).pixels();
    let per_sample = if planted(Bug::SplatCount) { per_sample.min(1) } else { per_sample };
    f64::from(per_sample) * pixels as f64 / f64::from(settings.light_one_in)
}

impl<A: Accel, S: Sums> SampleLoop<'_, A, S> {
    /// Whether samples contribute to pixels other than their own: then the samples of every pixel of the full image
    /// have to be computed (`sample`, or `sample_splats` for those cropped away), or splats are missing.
    pub fn splats(&self) -> bool {
        let wanted = self.settings.only.is_none_or(|only| only.t == 1);
        wanted
            && match self.settings.integrator {
                Integrator::Path => false,
                Integrator::Light => self.scene.needs.light,
                Integrator::Bdpt | Integrator::Auto => self.bdpt.traces_light(),
            }
    }

    /// Computes one sample; its contributions go to `recorder`.
    #[inline]
    pub fn sample<const T: bool>(&mut self, sample: PixelSample, recorder: &mut Recorder<T>) {
        match self.settings.integrator {
            Integrator::Path => {
                path::sample(self.scene, &self.settings, self.thresholds.as_deref(), sample, recorder);
            }
            Integrator::Light => {
                light::sample(self.scene, &self.settings, self.light_paths_per_pass, sample, recorder);
            }
            Integrator::Bdpt | Integrator::Auto => self.bdpt.sample(self.scene, sample, recorder),
        }
    }

    /// Computes only what one sample contributes to other pixels than its own.
    pub fn sample_splats<const T: bool>(&mut self, sample: PixelSample, recorder: &mut Recorder<T>) {
        match self.settings.integrator {
            Integrator::Path => {}
            Integrator::Light => self.sample(sample, recorder),
            Integrator::Bdpt | Integrator::Auto => self.bdpt.sample_light(self.scene, sample, recorder),
        }
    }
}

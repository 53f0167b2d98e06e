//! The driver: passes, tiles, threads, time and progress. What is computed is the integrators' business; that the
//! result does not depend on how it was scheduled is the film's.

mod aov;

pub use aov::{Aov, AovJob};

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use crate::accel::Accel;
use crate::film::{Accumulator, Image, Quanta};
use crate::integrator::{Crop, PixelSample, Rays, Recorder, Rejected, SampleLoop, Settings, Technique};
use crate::light::Light;
use crate::math::Rgb;
use crate::planted::{Bug, planted};
use crate::scene::Scene;

/// What to render.
#[derive(Clone, Copy, Debug)]
pub struct RenderJob {
    /// The estimator and its settings.
    pub settings: Settings,
    /// Samples per pixel.
    pub samples: u32,
    /// Which pixels.
    pub crop: Crop,
    /// Worker threads; 0 for one per logical processor.
    pub threads: usize,
    /// Keep an image per technique, for paths of up to this many edges.
    pub pyramid: Option<u32>,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The image, of the crop's size.
    pub image: Image,
    /// Weighted image of each technique that contributed, when asked for.
    pub techniques: BTreeMap<Technique, Image>,
    /// Estimated variance of each pixel, were its samples independent, when asked for.
    pub variance: Option<Image>,
    /// Counted work.
    pub rays: Rays,
    /// How many contributions were not finite.
    pub rejected: u64,
    /// The first of them in order of pixel and sample.
    pub rejected_first: Vec<Rejected>,
    /// Contributions too large for the film.
    pub overflows: u64,
    /// Whether the render was stopped before its last sample; the image is then not the job's.
    pub stopped: bool,
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Pixel samples done.
    pub done: u64,
    /// Pixel samples to do.
    pub total: u64,
    /// Rays traced so far.
    pub rays: u64,
    /// Seconds since the start.
    pub seconds: f64,
}

/// Why a render could not start.
#[derive(Debug)]
pub struct RenderError {
    message: String,
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for RenderError {}

/// Side of a tile in pixels.
const TILE: u32 = 16;

/// Pixel samples of a tile that one task computes: small enough to share out, large enough to pay for the task.
const TASK_SAMPLES: u32 = 64;

/// Renders a job. `progress` is called from worker threads, now and then, and answers whether to go on.
///
/// # Errors
/// When the threads cannot be started.
pub fn render<A: Accel>(
    scene: &Scene<A>,
    job: &RenderJob,
    progress: &(dyn Fn(Progress) -> bool + Sync),
) -> Result<Rendered, RenderError> {
    render_with(scene, job, Extras::default(), progress)
}

/// What is collected beside the image.
#[derive(Clone, Copy, Debug, Default)]
pub struct Extras {
    /// The variance of each pixel.
    pub variance: bool,
}

/// `render`, with more than the image.
///
/// # Errors
/// As there.
pub fn render_with<A: Accel>(
    scene: &Scene<A>,
    job: &RenderJob,
    extras: Extras,
    progress: &(dyn Fn(Progress) -> bool + Sync),
) -> Result<Rendered, RenderError> {
    let pool = pool(job.threads)?;
    let mut run = Run::new(scene, job, progress);
    run.spread = extras.variance.then(|| Spread::new(job.crop, run.emission));
    pool.install(|| run.all());
    Ok(run.finish())
}

/// Worker threads.
fn pool(threads: usize) -> Result<rayon::ThreadPool, RenderError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| RenderError { message: format!("cannot start {threads} render threads: {e}") })
}

/// Sums from which pixels' variances follow. A pixel is the mean of what n camera samples found, plus 1/n times the sum
/// of splats, of which each light subpath makes one with a small probability: a compound Poisson sum, whose variance is
/// estimated by the sum of squares.
struct Spread {
    /// Of what the pixel's own samples found.
    own: Accumulator,
    /// Of the squares of that and of splats.
    squares: Accumulator,
}

impl Spread {
    fn new(crop: Crop, emission: f32) -> Self {
        let film = |emission| Accumulator::new(crop.width(), crop.height(), emission);
        Self { own: film(emission), squares: film((emission * emission).min(f32::MAX)) }
    }

    fn square(&self, value: Rgb) -> Quanta {
        self.squares.quantize(value * value)
    }

    fn variance(&self, samples: u64) -> Image {
        let (own, mut variance) = (self.own.resolve(samples), self.squares.resolve(samples));
        let n = samples.saturating_sub(1).max(1) as f32;
        for (square, mean) in variance.rgb.iter_mut().flatten().zip(own.rgb.iter().flatten()) {
            // Rounding alone could make it negative.
            *square = (*square - mean * mean).max(0.0) / n;
        }
        variance
    }
}

/// A rectangle of pixels and a range of samples: the unit of work.
#[derive(Clone, Copy, Debug)]
struct Task {
    pixels: Crop,
    first: u32,
    count: u32,
}

struct Run<'a, A> {
    scene: &'a Scene<A>,
    job: &'a RenderJob,
    progress: &'a (dyn Fn(Progress) -> bool + Sync),
    /// Pixels whose samples are computed: the crop, or all where splats may come from anywhere.
    region: Crop,
    film: Accumulator,
    emission: f32,
    spread: Option<Spread>,
    techniques: Mutex<BTreeMap<Technique, std::sync::Arc<Accumulator>>>,
    totals: Mutex<Totals>,
    done: AtomicU64,
    rays: AtomicU64,
    stopped: AtomicBool,
    start: Instant,
}

#[derive(Default)]
struct Totals {
    rays: Rays,
    rejected: u64,
    rejected_first: Vec<Rejected>,
}

impl Totals {
    /// Keeps the first few of all rejected contributions, in order of pixel and sample.
    fn keep(&mut self, more: &[Rejected]) {
        if !more.is_empty() {
            self.rejected_first.extend_from_slice(more);
            self.rejected_first.sort_by_key(|r| ([r.pixel[1], r.pixel[0]], r.sample, r.technique));
            self.rejected_first.truncate(16);
        }
    }
}

impl<'a, A: Accel> Run<'a, A> {
    fn new(scene: &'a Scene<A>, job: &'a RenderJob, progress: &'a (dyn Fn(Progress) -> bool + Sync)) -> Self {
        let emission = scene.lights.iter().map(Light::brightness).fold(0.0, f32::max);
        let splats = SampleLoop::new(scene, job.settings).splats();
        Self {
            scene,
            job,
            progress,
            region: if splats { Crop::full(scene.camera.resolution()) } else { job.crop },
            film: Accumulator::new(job.crop.width(), job.crop.height(), emission),
            emission,
            spread: None,
            techniques: Mutex::default(),
            totals: Mutex::default(),
            done: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
            start: Instant::now(),
        }
    }

    fn all(&self) {
        let region = self.region;
        let columns = u64::from(region.width().div_ceil(TILE));
        let tiles = columns * u64::from(region.height().div_ceil(TILE));
        let ranges = u64::from(self.job.samples.div_ceil(TASK_SAMPLES));
        // Tasks are made from their number when they are run: a list of them could outgrow the image.
        let task = |number: u64| {
            let (range, tile) = (number / tiles, number % tiles);
            let first = range as u32 * TASK_SAMPLES;
            let (x, y) = (region.x0 + (tile % columns) as u32 * TILE, region.y0 + (tile / columns) as u32 * TILE);
            let pixels = Crop { x0: x, y0: y, x1: region.x1.min(x + TILE), y1: region.y1.min(y + TILE) };
            Task { pixels, first, count: TASK_SAMPLES.min(self.job.samples - first) }
        };
        (0..tiles * ranges).into_par_iter().for_each_init(
            || {
                let recorder = Recorder::new(self.job.crop, self.job.pyramid.is_some());
                (SampleLoop::new(self.scene, self.job.settings), recorder)
            },
            |(integrator, recorder), number| {
                if !self.stopped.load(Ordering::Relaxed) {
                    self.run(&task(number), integrator, recorder);
                }
            },
        );
    }

    fn run(&self, task: &Task, integrator: &mut SampleLoop<'_, A>, recorder: &mut Recorder) {
        let crop = self.job.crop;
        recorder.reset();
        for y in task.pixels.y0..task.pixels.y1 {
            for x in task.pixels.x0..task.pixels.x1 {
                let samples = (task.first..task.first + task.count).map(|index| PixelSample { pixel: [x, y], index });
                if crop.contains([x, y]) {
                    let mut sum = Quanta::default();
                    let mut squares = Quanta::default();
                    for sample in samples {
                        integrator.sample(sample, recorder);
                        sum += self.film.quantize(recorder.radiance());
                        if let Some(spread) = &self.spread {
                            squares += spread.square(recorder.radiance());
                        }
                    }
                    let pixel = (y - crop.y0) as usize * crop.width() as usize + (x - crop.x0) as usize;
                    self.film.add(pixel, sum);
                    if let Some(spread) = &self.spread {
                        spread.own.add(pixel, sum);
                        spread.squares.add(pixel, squares);
                    }
                } else {
                    samples.for_each(|sample| integrator.sample_splats(sample, recorder));
                }
                let share = || crop.pixels() as f32 / self.region.pixels() as f32;
                let count = if planted(Bug::SplatCountOfCrop) { share() } else { 1.0 };
                for splat in recorder.splats() {
                    self.film.add(splat.pixel as usize, self.film.quantize(splat.value / count));
                    if let Some(spread) = &self.spread {
                        spread.squares.add(splat.pixel as usize, spread.square(splat.value));
                    }
                }
                self.keep_apart(recorder);
                recorder.clear();
            }
        }
        let samples = task.pixels.pixels() * u64::from(task.count);
        let done = self.done.fetch_add(samples, Ordering::Relaxed) + samples;
        let rays = self.rays.fetch_add(recorder.rays.total(), Ordering::Relaxed) + recorder.rays.total();
        if let Ok(mut totals) = self.totals.lock() {
            totals.rays += recorder.rays;
            let (count, first) = recorder.rejected();
            totals.rejected += count;
            totals.keep(first);
        }
        let total = self.region.pixels() * u64::from(self.job.samples);
        let seconds = self.start.elapsed().as_secs_f64();
        if !(self.progress)(Progress { done, total, rays, seconds }) {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    /// Adds what the recorder kept apart to the techniques' own films.
    fn keep_apart(&self, recorder: &Recorder) {
        let Some(edges) = self.job.pyramid else { return };
        for c in recorder.by_technique() {
            if c.technique.s + c.technique.t > edges + 1 {
                continue;
            }
            let film = match self.techniques.lock() {
                Ok(mut films) => std::sync::Arc::clone(films.entry(c.technique).or_insert_with(|| {
                    let crop = self.job.crop;
                    std::sync::Arc::new(Accumulator::new(crop.width(), crop.height(), self.emission))
                })),
                Err(_) => return,
            };
            film.add(c.pixel as usize, film.quantize(c.value));
        }
    }

    fn finish(self) -> Rendered {
        let samples = u64::from(self.job.samples);
        let totals = self.totals.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        let films = self.techniques.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Rendered {
            image: self.film.resolve(samples),
            techniques: films.into_iter().map(|(t, film)| (t, film.resolve(samples))).collect(),
            variance: self.spread.as_ref().map(|spread| spread.variance(samples)),
            rays: totals.rays,
            rejected: totals.rejected,
            rejected_first: totals.rejected_first,
            overflows: self.film.overflows(),
            stopped: self.stopped.load(Ordering::Relaxed),
        }
    }
}

//! The driver: passes, tiles, threads, time and progress. What is computed is the integrators' business; that the
//! result does not depend on how it was scheduled is the film's.

mod aov;
mod auto;

pub use aov::{Aov, AovJob, FIRST_SURFACE_BYTES};
pub use auto::made_by;

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

use rayon::prelude::*;

use crate::accel::Accel;
use crate::film::{Accumulator, Image, Quanta, Squares, VarianceFilm};
use crate::integrator::auto::Plan;
use crate::integrator::bdpt::Sums;
use crate::integrator::{
    Contribution, Crop, Integrator, PixelSample, Rays, Recorder, Rejected, SampleLoop, Settings, Technique,
};
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
    /// Contributions too large for the film.
    pub overflows: u64,
    /// The first of those that were not finite, in order of pixel and sample, then the first of those that were too large.
    pub rejected_first: Vec<Rejected>,
    /// Whether the render was stopped before its last sample; the image is then not the job's.
    pub stopped: bool,
    /// What `auto` went by after its pilot.
    pub plan: Option<Plan>,
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

/// Splats whose pixels are brought into the cache together.
const SPLATS_TOUCHED: usize = 32;

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
    run.spread = extras.variance.then(|| VarianceFilm::new(job.crop.width(), job.crop.height(), run.emission));
    let plan = pool.install(|| run.all());
    Ok(Rendered { plan, ..run.finish() })
}

/// Worker threads.
fn pool(threads: usize) -> Result<rayon::ThreadPool, RenderError> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| RenderError { message: format!("cannot start {threads} render threads: {e}") })
}

/// The films of techniques kept apart, each made when the first contribution comes; adding to them takes no lock.
#[derive(Debug)]
struct TechniqueFilms {
    /// Number of edges of the longest paths; 0 for none.
    edges: u32,
    crop: Crop,
    emission: f32,
    /// By `slot`.
    films: Vec<OnceLock<Accumulator>>,
}

impl TechniqueFilms {
    fn new(job: &RenderJob, emission: f32) -> Self {
        let edges = job.pyramid.unwrap_or(0);
        // Paths of n edges are made by n + 1 techniques (t = 0 is not built).
        let films = (0..=edges).flat_map(|n| 0..if n == 0 { 0 } else { n + 1 }).map(|_| OnceLock::new()).collect();
        Self { edges, crop: job.crop, emission, films }
    }

    /// The place of a technique among them: by number of edges, then by s.
    fn slot(&self, t: Technique) -> Option<usize> {
        let edges = (t.s + t.t).checked_sub(1).filter(|edges| t.t > 0 && (1..=self.edges).contains(edges))?;
        // Shorter paths have 2, 3, …, edges techniques.
        Some((edges as usize + 2) * (edges as usize - 1) / 2 + t.s as usize)
    }

    fn add(&self, contributions: &[Contribution]) {
        for c in contributions {
            let Some(film) = self.slot(c.technique).and_then(|i| self.films.get(i)) else { continue };
            let film = film.get_or_init(|| Accumulator::new(self.crop.width(), self.crop.height(), self.emission));
            film.add(c.pixel as usize, film.quantize(c.value));
        }
    }

    fn resolve(&self, samples: u64) -> BTreeMap<Technique, Image> {
        let all = (1..=self.edges).flat_map(|edges| (0..=edges).map(move |s| Technique { s, t: edges + 1 - s }));
        let made = all.zip(&self.films).filter_map(|(t, film)| Some((t, film.get()?)));
        made.map(|(t, film)| (t, film.resolve(samples))).collect()
    }
}

/// A rectangle of pixels and a range of samples: the unit of work.
#[derive(Clone, Copy, Debug)]
struct Task {
    pixels: Crop,
    first: u32,
    count: u32,
    /// Pixels of the pass.
    region: Crop,
    /// Samples of all pixels once the render is done, as far as is known in this pass.
    total: u64,
}

/// Looks at samples of the crop's pixels as they are made.
trait Observe {
    /// What it has to say of a task.
    type Seen: Send;
    /// A sample has been made, and its contributions are still with the recorder.
    fn sample(&mut self, sample: PixelSample, recorder: &mut Recorder);
    /// A task is done.
    fn take(&mut self) -> Self::Seen;
    /// Runs all tasks; what was seen, in their order.
    fn collect(tasks: impl IndexedParallelIterator<Item = Self::Seen>) -> Vec<Self::Seen>;
}

/// Nobody looks.
impl Observe for () {
    type Seen = ();
    #[inline(always)]
    fn sample(&mut self, _: PixelSample, _: &mut Recorder) {}
    #[inline(always)]
    fn take(&mut self) {}
    fn collect(tasks: impl IndexedParallelIterator<Item = ()>) -> Vec<()> {
        tasks.for_each(|()| {});
        Vec::new()
    }
}

struct Run<'a, A> {
    scene: &'a Scene<A>,
    job: &'a RenderJob,
    progress: &'a (dyn Fn(Progress) -> bool + Sync),
    film: Accumulator,
    emission: f32,
    spread: Option<VarianceFilm>,
    techniques: TechniqueFilms,
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
    overflows: u64,
    rejected_first: Vec<Rejected>,
}

/// How many rejected contributions are named, for each reason.
const NAMED: usize = 16;

impl Totals {
    /// Keeps the first few of all rejected contributions, by reason, in order of pixel and sample.
    fn keep(&mut self, more: &[Rejected]) {
        if !more.is_empty() {
            self.rejected_first.extend_from_slice(more);
            self.rejected_first.sort_by_key(|r| (r.reason, [r.pixel[1], r.pixel[0]], r.sample, r.technique));
            let mut kept = [0; 2];
            self.rejected_first.retain(|r| {
                kept[r.reason as usize] += 1;
                kept[r.reason as usize] <= NAMED
            });
        }
    }
}

impl<'a, A: Accel> Run<'a, A> {
    fn new(scene: &'a Scene<A>, job: &'a RenderJob, progress: &'a (dyn Fn(Progress) -> bool + Sync)) -> Self {
        let emission = scene.brightness;
        Self {
            scene,
            job,
            progress,
            film: Accumulator::new(job.crop.width(), job.crop.height(), emission),
            emission,
            spread: None,
            techniques: TechniqueFilms::new(job, emission),
            totals: Mutex::default(),
            done: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            stopped: AtomicBool::new(false),
            start: Instant::now(),
        }
    }

    /// All samples; the plan, if one was made on the way.
    fn all(&self) -> Option<Plan> {
        let job = self.job;
        if job.settings.integrator == Integrator::Auto {
            return self.auto();
        }
        self.pass(0..job.samples, || SampleLoop::new(self.scene, job.settings), || ());
        None
    }

    /// Pixels whose samples are computed: the crop, or all where splats may come from anywhere.
    fn region<S: Sums>(&self, loops: &SampleLoop<'_, A, S>) -> Crop {
        if loops.splats() { Crop::full(self.scene.camera.resolution()) } else { self.job.crop }
    }

    /// A range of each pixel's samples; what `observe`d them, once per task, in the tasks' order.
    fn pass<S: Sums, O: Observe>(
        &self,
        samples: Range<u32>,
        loops: impl Fn() -> SampleLoop<'a, A, S> + Sync,
        observer: impl Fn() -> O + Sync,
    ) -> Vec<O::Seen> {
        let region = self.region(&loops());
        let columns = u64::from(region.width().div_ceil(TILE));
        let tiles = columns * u64::from(region.height().div_ceil(TILE));
        let ranges = u64::from((samples.end - samples.start).div_ceil(TASK_SAMPLES));
        let total = region.pixels() * u64::from(self.job.samples - samples.start);
        let total = self.done.load(Ordering::Relaxed) + total;
        // Tasks are made from their number when they are run: a list of them could outgrow the image.
        let task = |number: u64| {
            let (range, tile) = (number / tiles, number % tiles);
            let first = samples.start + range as u32 * TASK_SAMPLES;
            let (x, y) = (region.x0 + (tile % columns) as u32 * TILE, region.y0 + (tile / columns) as u32 * TILE);
            let pixels = Crop { x0: x, y0: y, x1: region.x1.min(x + TILE), y1: region.y1.min(y + TILE) };
            Task { pixels, first, count: TASK_SAMPLES.min(samples.end - first), region, total }
        };
        // Of 2³² tasks the image alone would be larger than memory.
        let tasks = (0..(tiles * ranges) as usize).into_par_iter().map_init(
            || {
                let largest = Accumulator::largest(self.emission);
                (loops(), Recorder::new(self.job.crop, self.job.pyramid.is_some()).within(largest), observer())
            },
            |(integrator, recorder, observer), number| {
                if !self.stopped.load(Ordering::Relaxed) {
                    self.run(&task(number as u64), integrator, recorder, observer);
                }
                observer.take()
            },
        );
        O::collect(tasks)
    }

    fn run<S: Sums, O: Observe>(
        &self,
        task: &Task,
        integrator: &mut SampleLoop<'_, A, S>,
        recorder: &mut Recorder,
        observer: &mut O,
    ) {
        let crop = self.job.crop;
        recorder.reset();
        for y in task.pixels.y0..task.pixels.y1 {
            for x in task.pixels.x0..task.pixels.x1 {
                let samples = (task.first..task.first + task.count).map(|index| PixelSample { pixel: [x, y], index });
                if crop.contains([x, y]) {
                    let mut sum = Quanta::default();
                    let mut squares = Squares::default();
                    for sample in samples {
                        integrator.sample(sample, recorder);
                        observer.sample(sample, recorder);
                        let quanta = self.film.quantize(recorder.radiance());
                        sum += quanta;
                        if self.spread.is_some() {
                            squares += Squares::of(quanta);
                        }
                    }
                    let pixel = (y - crop.y0) as usize * crop.width() as usize + (x - crop.x0) as usize;
                    self.film.add(pixel, sum);
                    if let Some(spread) = &self.spread {
                        spread.add_samples(pixel, sum, squares);
                    }
                } else {
                    samples.for_each(|sample| integrator.sample_splats(sample, recorder));
                }
                let share = || crop.pixels() as f32 / task.region.pixels() as f32;
                let count = if planted(Bug::SplatCountOfCrop) { share() } else { 1.0 };
                for splats in recorder.splats().chunks(SPLATS_TOUCHED) {
                    self.film.touch(splats.iter().map(|splat| splat.pixel as usize));
                    for splat in splats {
                        let quanta = self.film.quantize(splat.value / count);
                        self.film.add(splat.pixel as usize, quanta);
                        if let Some(spread) = &self.spread {
                            spread.add_splat(splat.pixel as usize, quanta);
                        }
                    }
                }
                self.techniques.add(recorder.by_technique());
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
            totals.overflows += recorder.overflows();
            totals.keep(first);
        }
        let seconds = self.start.elapsed().as_secs_f64();
        if !(self.progress)(Progress { done, total: task.total, rays, seconds }) {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn finish(self) -> Rendered {
        let samples = u64::from(self.job.samples);
        let totals = self.totals.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Rendered {
            image: self.film.resolve(samples),
            techniques: self.techniques.resolve(samples),
            variance: self.spread.as_ref().map(|spread| spread.resolve(samples)),
            rays: totals.rays,
            rejected: totals.rejected,
            rejected_first: totals.rejected_first,
            overflows: totals.overflows + self.film.overflows(),
            stopped: self.stopped.load(Ordering::Relaxed),
            plan: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    /// Each technique has a film of its own, longer ones have none, and what comes from several threads at once sums.
    #[test]
    fn techniques_are_kept_apart() {
        let crop = Crop::full([2, 1]);
        let settings = Settings::default();
        let films = TechniqueFilms::new(&RenderJob { settings, samples: 1, crop, threads: 1, pyramid: Some(5) }, 1.0);
        let all: Vec<Technique> =
            (1..=7).flat_map(|edges| (0..=edges).map(move |s| Technique { s, t: edges + 1 - s })).collect();
        let kept: Vec<Technique> = all.iter().copied().filter(|t| t.s + t.t <= 6).collect();
        let slots: Vec<usize> = kept.iter().filter_map(|t| films.slot(*t)).collect();
        assert_eq!(slots, (0..films.films.len()).collect::<Vec<_>>());
        let value = |t: Technique| Rgb::new(t.s as f32, t.t as f32, 0.25);
        let contributions: Vec<Contribution> =
            all.iter().map(|t| Contribution { pixel: 1, value: value(*t), technique: *t }).collect();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| films.add(&contributions));
            }
        });
        let images = films.resolve(4);
        assert_eq!(images.keys().copied().collect::<std::collections::BTreeSet<_>>(), kept.into_iter().collect());
        for (t, image) in images {
            assert_eq!(image.rgb, [[0.0; 3], value(t).to_array()], "{t:?}");
        }
        let none = TechniqueFilms::new(&RenderJob { settings, samples: 1, crop, threads: 1, pyramid: None }, 1.0);
        none.add(&contributions);
        assert!(none.films.is_empty() && none.resolve(4).is_empty());
    }
}

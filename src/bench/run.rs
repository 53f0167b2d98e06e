//! The runs of one scene.

use std::time::Instant;

use super::plan::{Backend, Configuration, Effort, IDLE_SEED, Plan, Turn};
use super::reference::{Measure, ReferenceJob};
use super::report::{ConfigurationReport, Pilot, RunReport, SceneReport};
use super::{BenchError, Summary, machine};
use crate::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use crate::accel::embree::EmbreeAccel;
use crate::accel::{Accel, AccelOptions};
use crate::compare::{Figure, metrics};
use crate::film::Image;
use crate::integrator::{Crop, Rays, Settings};
use crate::render::{RenderJob, Rendered, render};
use crate::scene::desc::SceneDesc;
use crate::scene::{Scene, prepare};

/// Processor seconds that a pilot takes at least, where the budget is not shorter still.
const PILOT_SECONDS: f64 = 0.25;

/// What a pilot may take of the shortest budget.
const PILOT_SHARE: f64 = 0.1;

/// A scene and what to do with it.
#[derive(Clone, Debug)]
pub struct SceneJob<'a> {
    /// A name for tables and files.
    pub name: String,
    /// Its file, as named on the command line.
    pub file: String,
    /// What is rendered.
    pub desc: &'a SceneDesc,
    /// How.
    pub plan: &'a Plan,
    /// Against what.
    pub reference: ReferenceJob,
    /// What whoever reads the report should know of the scene.
    pub notes: Vec<String>,
}

/// The processor's clock, without which nothing here has a meaning.
pub(super) fn cpu_seconds() -> Result<f64, BenchError> {
    machine::cpu_seconds()
        .ok_or_else(|| BenchError::new("this system does not tell processor time, by which bench measures"))
}

/// A scene on the accelerator that was asked for.
pub(super) enum Built {
    #[cfg(feature = "embree")]
    Embree(Box<Scene<EmbreeAccel>>),
    Bvh(Box<Scene<BvhAccel>>),
}

impl Built {
    pub(super) fn new(desc: &SceneDesc, backend: Backend, threads: usize) -> Result<Self, BenchError> {
        let prepared = prepare(desc).map_err(BenchError::new)?;
        let options = AccelOptions { threads: threads as u32, ..AccelOptions::default() };
        Ok(match backend {
            #[cfg(feature = "embree")]
            Backend::Embree => Self::Embree(Box::new(Scene::build(prepared, options).map_err(BenchError::new)?)),
            Backend::Bvh => Self::Bvh(Box::new(Scene::build(prepared, options).map_err(BenchError::new)?)),
        })
    }

    pub(super) fn render(&self, settings: Settings, samples: u32, threads: usize) -> Result<Rendered, BenchError> {
        fn of<A: Accel>(scene: &Scene<A>, job: RenderJob) -> Result<Rendered, BenchError> {
            let job = RenderJob { crop: Crop::full(scene.camera.resolution()), ..job };
            render(scene, &job, &|_| true).map_err(BenchError::new)
        }
        let job = RenderJob { settings, samples, crop: Crop::full([1, 1]), threads, pyramid: None };
        match self {
            #[cfg(feature = "embree")]
            Self::Embree(scene) => of(scene, job),
            Self::Bvh(scene) => of(scene, job),
        }
    }

    /// The accelerator with its version.
    fn describe(&self) -> String {
        match self {
            #[cfg(feature = "embree")]
            Self::Embree(scene) => scene.accel.describe(),
            Self::Bvh(scene) => scene.accel.describe(),
        }
    }
}

/// The scene on the accelerator that is in turn; the one before is gone by then.
struct Stage<'a> {
    job: &'a SceneJob<'a>,
    now: Option<(Backend, Built)>,
}

impl Stage<'_> {
    fn on(&mut self, backend: Backend, settings: Settings) -> Result<&Built, BenchError> {
        if self.now.as_ref().is_none_or(|(there, _)| *there != backend) {
            self.now = None;
            let threads = self.job.plan.threads;
            let built = Built::new(self.job.desc, backend, threads)?;
            // What touches memory for the first time pays for it, and that is no run's business.
            built.render(Settings { seed: IDLE_SEED, ..settings }, 1, threads)?;
            self.now = Some((backend, built));
        }
        match &self.now {
            Some((_, built)) => Ok(built),
            None => Err(BenchError::new("no scene was built")),
        }
    }
}

/// A render that was watched.
struct Watched {
    rendered: Rendered,
    cpu_seconds: f64,
    wall_seconds: f64,
    peak_memory: Option<u64>,
}

fn watch(scene: &Built, settings: Settings, samples: u32, threads: usize) -> Result<Watched, BenchError> {
    let counted = machine::reset_peak_memory();
    let (cpu, wall) = (cpu_seconds()?, Instant::now());
    let rendered = scene.render(settings, samples, threads)?;
    let (cpu_seconds, wall_seconds) = (cpu_seconds()? - cpu, wall.elapsed().as_secs_f64());
    let peak_memory = machine::peak_memory().filter(|_| counted);
    Ok(Watched { rendered, cpu_seconds, wall_seconds, peak_memory })
}

/// Runs the plan on a scene: pilots where there are budgets, the reference, then all turns. `tell` hears, now and then, how far
/// it is.
///
/// # Errors
/// When the scene cannot be built, a render cannot start, the reference has another size, or the system does not tell
/// processor time.
pub fn bench_scene(job: &SceneJob<'_>, tell: &mut dyn FnMut(&str)) -> Result<SceneReport, BenchError> {
    let SceneJob { desc, plan, .. } = *job;
    cpu_seconds()?;
    let mut stage = Stage { job, now: None };
    let mut configurations = fix_samples(&mut stage, tell)?;
    // The reference builds the scene for itself; two of them need not be in memory.
    stage.now = None;
    let longest = configurations.iter().map(|c| c.samples).max().unwrap_or(1);
    let backend = plan.configurations.first().map_or(Backend::Bvh, |c| c.backend);
    let measure = Measure::new(&job.reference, desc, backend, longest, tell)?;
    let turns = plan.turns();
    for (number, turn) in turns.iter().enumerate() {
        if number % configurations.len() == 0 {
            tell(&format!("repetition {} of {}", turn.repetition + 1, plan.repetitions));
        }
        let Configuration { settings, backend, .. } = plan.configurations[turn.configuration];
        let to = &mut configurations[turn.configuration];
        let built = stage.on(backend, settings)?;
        let watched = watch(built, Settings { seed: turn.seed, ..settings }, to.samples, plan.threads)?;
        to.accelerator = built.describe();
        to.runs.push(run_report(&watched, *turn, number, &measure)?);
        // One image of each is shown, of its first run.
        to.image.get_or_insert(watched.rendered.image);
    }
    // The first configuration's own runs are what the others' are compared with.
    let first: Vec<Option<f64>> = configurations.first().map_or(Vec::new(), ConfigurationReport::efficiencies);
    for (index, configuration) in configurations.iter_mut().enumerate() {
        configuration.summary = Summary::of(&configuration.runs, configuration.samples, (index > 0).then_some(&first));
    }
    keep_largest(&mut configurations);
    Ok(SceneReport {
        name: job.name.clone(),
        file: job.file.clone(),
        fingerprint: desc.fingerprint,
        resolution: desc.camera.resolution,
        max_bounces: desc.integrator.max_bounces,
        notes: job.notes.clone(),
        measure,
        configurations,
    })
}

/// Numbers of samples for all configurations: those that were asked for, or by a pilot of each integrator on each accelerator
/// those that take the time that was.
fn fix_samples(stage: &mut Stage<'_>, tell: &mut dyn FnMut(&str)) -> Result<Vec<ConfigurationReport>, BenchError> {
    let plan = stage.job.plan;
    let seconds = plan.configurations.iter().filter_map(|c| match c.effort {
        Effort::Seconds(seconds) => Some(seconds),
        Effort::Samples(_) => None,
    });
    let shortest = seconds.fold(f64::INFINITY, f64::min);
    if shortest.is_finite() {
        tell("pilots");
    }
    let mut pilots: Vec<(&'static str, Backend, Pilot)> = Vec::new();
    let mut out = Vec::new();
    for configuration in &plan.configurations {
        let Configuration { integrator, settings, backend, effort } = *configuration;
        let (samples, budget) = match effort {
            Effort::Samples(samples) => (samples, None),
            Effort::Seconds(seconds) => {
                let known = pilots.iter().find(|(i, b, _)| (*i, *b) == (integrator, backend));
                let pilot = match known {
                    Some((.., pilot)) => *pilot,
                    None => {
                        let built = stage.on(backend, settings)?;
                        let enough = PILOT_SECONDS.min(PILOT_SHARE * shortest);
                        let pilot = pilot(built, settings, plan.threads, enough)?;
                        pilots.push((integrator, backend, pilot));
                        pilot
                    }
                };
                (pilot.samples_for(seconds), Some((seconds, pilot)))
            }
        };
        out.push(ConfigurationReport::new(configuration, samples, budget));
    }
    Ok(out)
}

/// Doubles the samples until a render takes enough processor time to tell their rate.
fn pilot(scene: &Built, settings: Settings, threads: usize, enough: f64) -> Result<Pilot, BenchError> {
    let mut samples = 1;
    loop {
        let watched = watch(scene, Settings { seed: IDLE_SEED, ..settings }, samples, threads)?;
        if watched.cpu_seconds >= enough || samples > u32::MAX / 2 {
            return Ok(Pilot { samples, cpu_seconds: watched.cpu_seconds });
        }
        samples *= 2;
    }
}

fn run_report(watched: &Watched, turn: Turn, order: usize, measure: &Measure) -> Result<RunReport, BenchError> {
    let Watched { rendered, cpu_seconds, wall_seconds, peak_memory } = watched;
    let image: &Image = &rendered.image;
    let m = metrics(image, &measure.reference.image).map_err(BenchError::new)?;
    let noise = measure.reference.share(image).map_err(BenchError::new)?;
    let rel_mse = Figure { measured: m.rel_mse, noise: noise.rel_mse };
    let pixels = u64::from(image.width) * u64::from(image.height);
    let rays: Rays = rendered.rays;
    Ok(RunReport {
        repetition: turn.repetition,
        seed: turn.seed,
        order,
        cpu_seconds: *cpu_seconds,
        wall_seconds: *wall_seconds,
        mse: Figure { measured: m.mse, noise: noise.mse },
        rel_mse,
        rel_mse_trimmed: Figure { measured: m.rel_mse_trimmed, noise: noise.rel_mse_trimmed },
        energy: m.mean_a.iter().sum::<f64>() / m.mean_ref.iter().sum::<f64>(),
        pixels,
        rays,
        peak_memory: *peak_memory,
        non_finite: rendered.rejected,
        overflows: rendered.overflows,
    })
}

/// Keeps the image of each integrator on each accelerator with the most samples.
fn keep_largest(configurations: &mut [ConfigurationReport]) {
    let largest: Vec<bool> = configurations
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let same = |o: &ConfigurationReport| (o.integrator, o.backend) == (c.integrator, c.backend);
            // Of equal ones (two short budgets), the first.
            !configurations
                .iter()
                .enumerate()
                .any(|(j, o)| same(o) && (o.samples > c.samples || o.samples == c.samples && j < i))
        })
        .collect();
    for (configuration, keep) in configurations.iter_mut().zip(largest) {
        configuration.image = configuration.image.take().filter(|_| keep);
    }
}

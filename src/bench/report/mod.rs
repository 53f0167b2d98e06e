//! What came of a benchmark: a table to read, and the same as JSON, CSV and HTML.

mod base64;
mod csv;
mod html;
mod json;
mod plot;
mod table;

pub use table::{HEADING, table};

use super::machine::Machine;
use super::plan::{Backend, Configuration};
use super::reference::Measure;
use super::summary::Summary;
use crate::compare::Figure;
use crate::compare::stats::median_order;
use crate::film::Image;
use crate::integrator::{Integrator, Rays, Settings};

/// What all runs have in common, and the scenes that are done.
#[derive(Clone, Debug)]
pub struct Report {
    /// Version of the program.
    pub version: &'static str,
    /// The commit it was built of.
    pub git: &'static str,
    /// Where it ran.
    pub machine: Machine,
    /// Threads of each run.
    pub threads: usize,
    /// Runs of each configuration.
    pub repetitions: u32,
    /// In the order in which they were made.
    pub scenes: Vec<SceneReport>,
}

/// A scene's runs.
#[derive(Clone, Debug)]
pub struct SceneReport {
    /// Its name in tables.
    pub name: String,
    /// Its file, as named on the command line.
    pub file: String,
    /// Of the scene and all its files.
    pub fingerprint: u128,
    /// Width and height of the image in pixels.
    pub resolution: [u32; 2],
    /// Largest number of scattering events on a path.
    pub max_bounces: u32,
    /// What the reader should know.
    pub notes: Vec<String>,
    /// What the runs are measured by.
    pub measure: Measure,
    /// In the order in which they were asked for; others are compared with the first.
    pub configurations: Vec<ConfigurationReport>,
}

/// A render that finds how many samples a second of processor time gives.
#[derive(Clone, Copy, Debug)]
pub struct Pilot {
    /// Samples per pixel.
    pub samples: u32,
    /// What they took.
    pub cpu_seconds: f64,
}

impl Pilot {
    /// The samples per pixel that come nearest to a budget of processor seconds, at least one.
    pub fn samples_for(&self, seconds: f64) -> u32 {
        // The cast saturates.
        (seconds * f64::from(self.samples) / self.cpu_seconds).round().max(1.0) as u32
    }
}

/// One integrator on one accelerator with one number of samples.
#[derive(Clone, Debug)]
pub struct ConfigurationReport {
    /// The integrator as it was asked for.
    pub integrator: &'static str,
    /// What it rendered by, but for the seed.
    pub settings: Settings,
    /// The accelerator.
    pub backend: Backend,
    /// The same with its version.
    pub accelerator: String,
    /// Samples per pixel.
    pub samples: u32,
    /// The budget of processor seconds that these were chosen for, and the pilot by which.
    pub budget: Option<(f64, Pilot)>,
    /// In the order of their seeds.
    pub runs: Vec<RunReport>,
    /// What they say together.
    pub summary: Summary,
    /// The first run's image, of the most samples by an integrator on an accelerator.
    pub image: Option<Image>,
}

impl ConfigurationReport {
    pub(super) fn new(of: &Configuration, samples: u32, budget: Option<(f64, Pilot)>) -> Self {
        Self {
            integrator: of.integrator,
            settings: of.settings,
            backend: of.backend,
            accelerator: String::new(),
            samples,
            budget,
            runs: Vec::new(),
            summary: Summary::default(),
            image: None,
        }
    }

    /// By run.
    pub(super) fn efficiencies(&self) -> Vec<Option<f64>> {
        self.runs.iter().map(RunReport::efficiency).collect()
    }

    /// What it renders by.
    pub fn renders_by(&self) -> &'static str {
        name(self.settings.integrator)
    }

    /// Whether the error is below the reference's noise, by the median run.
    pub fn below_noise(&self) -> bool {
        self.summary.rel_mse.is_some_and(|m| m.median == f64::NEG_INFINITY)
    }
}

/// An integrator's name on the command line.
fn name(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::Path => "path",
        Integrator::Light => "light",
        Integrator::Bdpt => "bdpt",
        Integrator::Auto => "auto",
    }
}

/// One run.
#[derive(Clone, Copy, Debug)]
pub struct RunReport {
    /// Counted from 0.
    pub repetition: u32,
    /// Its seed.
    pub seed: u64,
    /// Its place among all runs of the scene, from 0.
    pub order: usize,
    /// Processor time of the render, all threads, seconds.
    pub cpu_seconds: f64,
    /// Wall time of the render, seconds.
    pub wall_seconds: f64,
    /// Mean squared error.
    pub mse: Figure,
    /// Mean of (x − r)² / (r² + 1e-2) over pixels and channels.
    pub rel_mse: Figure,
    /// The same without the worst thousandth of the pixels.
    pub rel_mse_trimmed: Figure,
    /// Mean over the reference's, all channels together.
    pub energy: f64,
    /// Number of pixels.
    pub pixels: u64,
    /// Rays by kind, and paths.
    pub rays: Rays,
    /// Largest resident memory of the process during the run, bytes.
    pub peak_memory: Option<u64>,
    /// Contributions that were not finite and left out.
    pub non_finite: u64,
    /// Contributions too large for the film and left out.
    pub overflows: u64,
}

impl RunReport {
    /// 1 / (relMSE × processor seconds), in 1/s; `None` where the error is below the reference's noise.
    pub fn efficiency(&self) -> Option<f64> {
        self.rel_mse.value().map(|error| 1.0 / (error * self.cpu_seconds))
    }

    /// Rays of all kinds per processor second.
    pub fn rays_per_cpu_second(&self) -> f64 {
        self.rays.total() as f64 / self.cpu_seconds
    }

    /// Samples of all pixels per processor second, for so many per pixel.
    pub fn samples_per_cpu_second(&self, samples: u32) -> f64 {
        (self.pixels * u64::from(samples)) as f64 / self.cpu_seconds
    }
}

impl Report {
    /// Nothing yet, of these many runs by these many threads each.
    pub fn new(threads: usize, repetitions: u32) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            git: env!("TWINLIGHT_GIT_HASH"),
            machine: Machine::this(),
            threads,
            repetitions,
            scenes: Vec::new(),
        }
    }

    /// The coverage of the intervals of medians.
    pub fn coverage(&self) -> f64 {
        median_order(self.repetitions as usize).1
    }

    /// What the intervals are, in words.
    pub fn intervals(&self) -> String {
        let n = self.repetitions as usize;
        let (k, coverage) = median_order(n);
        let percent = text::percent(coverage);
        match (n, k) {
            (..=1, _) => "One run of each: no intervals.".to_owned(),
            (_, 1) => {
                format!("Medians of {n} runs; [least … greatest of them] covers the true median with {percent} %.")
            }
            _ => format!(
                "Medians of {n} runs; [{0} least … {0} greatest of them] covers the true median with {percent} %.",
                text::ordinal(k)
            ),
        }
    }

    /// Contributions that were left out of all runs: those that were not finite, and those too large.
    pub fn left_out(&self) -> [u64; 2] {
        let runs = self.scenes.iter().flat_map(|s| &s.configurations).flat_map(|c| &c.runs);
        runs.fold([0, 0], |[a, b], run| [a + run.non_finite, b + run.overflows])
    }
}

impl SceneReport {
    /// How the runs' errors were corrected, in words.
    pub fn about_reference(&self) -> String {
        use super::reference::Origin;
        use crate::compare::ReferenceNoise;
        let noise = |x: Option<f64>| x.map_or("not a number".to_owned(), text::figures);
        match (&self.measure.origin, &self.measure.reference.noise) {
            (Origin::Halves { integrator, samples, cpu_seconds }, _) => format!(
                "reference: mean of two independent halves of {samples} spp by {} ({} CPU s); its noise, relMSE {}, is \
                 subtracted from all errors, and none below it is told",
                name(*integrator),
                text::figures(*cpu_seconds),
                noise(self.measure.rel_mse)
            ),
            (Origin::File(file), ReferenceNoise::RelMse(x)) => format!(
                "reference: {file}; its noise, said to be relMSE {}, is subtracted from each relMSE, and none below it is told; \
                 MSE as measured",
                text::figures(*x)
            ),
            (Origin::File(file), _) => format!(
                "reference: {file}; its noise is not known and is part of all errors (--reference-noise tells it)"
            ),
        }
    }
}

/// Numbers in words.
mod text {
    /// Three significant digits; a power of ten where the size is unusual.
    pub fn figures(x: f64) -> String {
        if x == 0.0 || !x.is_finite() {
            return format!("{x}");
        }
        // Of what is printed: 999.9 has the size of 1000.
        let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
        match rounded.abs().log10().floor() as i32 {
            power @ -3..=5 => format!("{rounded:.*}", (2 - power).max(0) as usize),
            _ => format!("{x:.2e}"),
        }
    }

    /// 2nd, 3rd, 4th.
    pub fn ordinal(n: usize) -> String {
        let ending = match (n % 10, n % 100) {
            (_, 11..=13) => "th",
            (1, _) => "st",
            (2, _) => "nd",
            (3, _) => "rd",
            _ => "th",
        };
        format!("{n}{ending}")
    }

    /// A share in percent, as exact as it is.
    pub fn percent(share: f64) -> String {
        let text = format!("{:.2}", 100.0 * share);
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

#[cfg(test)]
mod tests;

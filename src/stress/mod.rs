//! Stress: scenes at the edge of what numbers can hold, rendered by each integrator on both accelerators.
//!
//! A case is a scene with what it must look like: another scene's image, its very bits, a closed form, nothing at all. Beside
//! the image's energy are counted: contributions that were not finite before the film's gate, rays that met the primitive they
//! left, rays that left a closed room; and for `bdpt` how far the weights of a path are from summing to one.

mod case;
mod cases;
mod measure;
mod precision;
mod quantiles;
mod report;

pub use case::{Case, Expected};
pub use cases::cases;
pub use measure::{Audit, Measured, Run, WEIGHTS, audit, faults_of_weights, measure, weights};
pub use precision::{Precision, bytes_of_steps, precision};
pub use report::{HEADING, LEGEND, Report, Row};

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use serde_json::Value;

use crate::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use crate::accel::embree::EmbreeAccel;
use crate::accel::{Accel, AccelOptions};
use crate::compare::stats::{Interval, Moments, student_t_two_sided};
use crate::import::scene_from_str;
use crate::integrator::bdpt::oracle::Seen;
use crate::integrator::{Integrator, Settings};
use crate::scene::{Scene, prepare};

/// Independent renders of each side of a comparison.
const SEEDS: u64 = 16;

/// Confidence of the intervals of energies.
const CONFIDENCE: f64 = 0.99;

/// p-values below this are evidence of a difference: a report makes some hundreds of comparisons, with fixed seeds.
const ALPHA: f64 = 1e-5;

/// Camera paths for the audit.
const WALKS: u32 = 4096;

/// Paths that the weights of are judged.
const JUDGED: u32 = 20_000;

/// Relative differences of energies that rounding makes.
const ROUNDING: f64 = 2e-5;

/// What a scene's renders with one integrator on one accelerator gave.
type Renders = HashMap<(String, String), Result<Measured, String>>;

/// Runs the cases; `done` hears of each row when it is there.
pub fn run(cases: &[Case], effort: u32, done: &mut dyn FnMut(&Row)) -> Report {
    let mut rows = Vec::new();
    #[cfg(feature = "embree")]
    run_on::<EmbreeAccel>(cases, effort, &mut rows, done);
    run_on::<BvhAccel>(cases, effort, &mut rows, done);
    Report { rows }
}

fn run_on<A: Accel>(cases: &[Case], effort: u32, rows: &mut Vec<Row>, done: &mut dyn FnMut(&Row)) {
    // Many cases are compared with one undisturbed scene.
    let mut renders = Renders::new();
    for case in cases {
        let walked = build::<A>(&case.scene).and_then(|scene| guarded(|| audit(&scene, case.closed, WALKS)));
        for &integrator in case.integrators {
            let mut row = Row::new(case, integrator, A::NAME);
            match &walked {
                Ok(audit) => row.walked(audit),
                Err(message) => row.faults.push(message.clone()),
            }
            if walked.is_ok() {
                compare::<A>(case, integrator, effort, &mut renders, &mut row);
                if integrator == Integrator::Bdpt {
                    row.weigh(
                        build::<A>(&case.scene)
                            .and_then(|scene| guarded(|| weights(&scene, settings(case, integrator), JUDGED))),
                    );
                }
            }
            done(&row);
            rows.push(row);
        }
    }
}

/// What a case is rendered with.
fn settings(case: &Case, integrator: Integrator) -> Settings {
    Settings { integrator, max_bounces: case.bounces, roulette: case.roulette, ..Settings::default() }
}

/// Compares a case's image with what is expected.
fn compare<A: Accel>(case: &Case, integrator: Integrator, effort: u32, renders: &mut Renders, row: &mut Row) {
    let mut side = |scene: &Value| -> Result<Measured, String> {
        let settings = settings(case, integrator);
        let key = (scene.to_string(), format!("{settings:?} {}", case.effort));
        if let Some(known) = renders.get(&key) {
            return known.clone();
        }
        let samples = effort * case.effort;
        let result = build::<A>(scene).and_then(|scene| guarded(|| measure(&scene, settings, samples, SEEDS)));
        renders.insert(key, result.clone());
        result
    };
    let measured = match side(&case.scene) {
        Ok(measured) => measured,
        Err(message) => return row.faults.push(message),
    };
    row.rejected = measured.rejected;
    row.mean = measured.moments().mean();
    if measured.rejected > 0 {
        row.faults.push(format!("{} contributions were not finite: {}", measured.rejected, measured.first));
    }
    match &case.expected {
        Expected::Nothing => {
            if measured.runs.iter().any(|run| run.mean != 0.0) {
                row.faults.push("light where there is none".to_owned());
            }
        }
        Expected::Mean(expected) => {
            let differences = measured.runs.iter().map(|run| run.mean - expected).collect();
            row.judge(*expected, &differences, case);
        }
        Expected::SameAs { scene, times } | Expected::SameBits { scene, times } => match side(scene) {
            Err(message) => row.faults.push(format!("the undisturbed scene: {message}")),
            Ok(plain) => {
                let pairs = measured.runs.iter().zip(&plain.runs);
                let differences = pairs.map(|(a, b)| a.mean - times * b.mean).collect();
                row.judge(times * plain.moments().mean(), &differences, case);
                let exact = matches!(case.expected, Expected::SameBits { .. });
                if exact && !measured.is_times(&plain, *times) {
                    row.faults.push("not the same bits".to_owned());
                }
            }
        },
    }
}

impl Row {
    /// Takes over what was seen of the weights.
    fn weigh(&mut self, seen: Result<Seen, String>) {
        let seen = match seen {
            Ok(seen) => seen,
            Err(message) => return self.faults.push(format!("weights: {message}")),
        };
        if seen.paths > 0 {
            self.weights = Some(seen.worst_sum);
        }
        self.faults.extend(faults_of_weights(&seen, WEIGHTS));
    }

    /// Judges the differences of renders with equal seeds from what is expected.
    fn judge(&mut self, expected: f64, differences: &Moments, case: &Case) {
        self.expected = Some(expected);
        if expected == 0.0 {
            self.faults.push("nothing is seen of the undisturbed scene".to_owned());
            return;
        }
        let (mean, error) =
            (differences.mean() / expected, (differences.variance() / differences.count() as f64).sqrt() / expected);
        let interval = if error > 0.0 {
            differences.confidence_interval(CONFIDENCE).scaled(1.0 / expected)
        } else {
            Interval { low: mean, high: mean }
        };
        self.energy = Some(interval);
        if !interval.within(case.bound) {
            self.faults.push(format!("energy is not proven within ±{} %", 100.0 * case.bound));
        }
        let allowed = case.apart.map_or(ROUNDING, |(by, _)| by);
        let excess = (mean.abs() - allowed).max(0.0);
        let dof = differences.count() as f64 - 1.0;
        let p = if error > 0.0 { student_t_two_sided(excess / error, dof) } else { f64::from(u8::from(excess == 0.0)) };
        if p.is_nan() || p < ALPHA {
            self.faults.push(format!("energy differs by {mean:+.1e}, p = {p:.1e}"));
        }
    }
}

/// A scene on an accelerator, or why there is none.
fn build<A: Accel>(scene: &Value) -> Result<Scene<A>, String> {
    guarded(|| {
        let desc = scene_from_str(&scene.to_string(), "stress.json", Path::new("")).map_err(|e| e.to_string())?;
        let prepared = prepare(&desc).map_err(|e| e.to_string())?;
        Scene::build(prepared, AccelOptions::default()).map_err(|e| e.to_string())
    })
    .and_then(|built| built)
}

/// How much of such work is going on.
static GUARDED: AtomicU32 = AtomicU32::new(0);

/// Whether a case is being worked on, on whatever thread: a panic is a row's verdict then, and a panic hook has nothing to say.
pub fn is_guarded() -> bool {
    GUARDED.load(Ordering::SeqCst) > 0
}

/// A panic is a finding like others.
fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    GUARDED.fetch_add(1, Ordering::SeqCst);
    let result = catch_unwind(AssertUnwindSafe(work));
    GUARDED.fetch_sub(1, Ordering::SeqCst);
    result.map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        format!("panics: {}", text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("without a word"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_verdict_and_nothing_else_is_silent() {
        assert_eq!(guarded(is_guarded), Ok(true));
        let verdict = guarded(|| -> u32 { std::panic::panic_any("planted") });
        assert_eq!(verdict, Err("panics: planted".to_owned()));
    }
}

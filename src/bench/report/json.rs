//! The report for programs.

use serde_json::{Value, json};

use super::{ConfigurationReport, Report, RunReport, SceneReport};
use crate::bench::reference::Origin;
use crate::bench::summary::Summary;
use crate::compare::stats::Median;
use crate::compare::{Figure, ReferenceNoise};

/// A number, or null: JSON has no others.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// A median and its interval. Infinite is what is below the reference's noise, or would be divided by it: null.
fn median(m: Option<Median>) -> Value {
    match m {
        None => Value::Null,
        Some(m) if m.coverage > 0.0 => {
            json!({"median": finite(m.median), "low": finite(m.interval.low), "high": finite(m.interval.high)})
        }
        Some(m) => json!({"median": finite(m.median), "low": null, "high": null}),
    }
}

/// An error: what is left without the noise, what was measured, and the noise.
fn figure(f: &Figure) -> Value {
    json!({
        "value": f.value().and_then(finite),
        "measured": finite(f.measured),
        "noise": f.noise.and_then(finite),
        "below_reference_noise": f.below_noise(),
    })
}

fn summary(s: &Summary) -> Value {
    json!({
        "cpu_seconds": median(s.cpu_seconds),
        "wall_seconds": median(s.wall_seconds),
        "mse": median(s.mse),
        "rel_mse": median(s.rel_mse),
        "rel_mse_trimmed": median(s.rel_mse_trimmed),
        "efficiency": median(s.efficiency),
        "efficiency_ratio": median(s.ratio),
        "energy": median(s.energy),
        "rays_per_cpu_second": median(s.rays_per_cpu_second),
        "samples_per_cpu_second": median(s.samples_per_cpu_second),
        "peak_memory_bytes": median(s.peak_memory),
    })
}

fn run(r: &RunReport, samples: u32) -> Value {
    let rays = &r.rays;
    json!({
        "repetition": r.repetition,
        "seed": r.seed,
        "order": r.order,
        "cpu_seconds": r.cpu_seconds,
        "wall_seconds": r.wall_seconds,
        "mse": figure(&r.mse),
        "rel_mse": figure(&r.rel_mse),
        "rel_mse_trimmed": figure(&r.rel_mse_trimmed),
        "efficiency": r.efficiency().and_then(finite),
        "energy": finite(r.energy),
        "rays": {
            "camera": rays.camera,
            "light": rays.light,
            "shadow": rays.shadow,
            "connection": rays.connection,
            "lens": rays.lens,
            "total": rays.total(),
        },
        "paths": {"camera": rays.camera_paths, "light": rays.light_paths},
        "rays_per_cpu_second": finite(r.rays_per_cpu_second()),
        "samples_per_cpu_second": finite(r.samples_per_cpu_second(samples)),
        "peak_memory_bytes": r.peak_memory,
        "non_finite": r.non_finite,
        "overflows": r.overflows,
    })
}

fn configuration(c: &ConfigurationReport) -> Value {
    let s = &c.settings;
    let lower = |x: &dyn std::fmt::Debug| format!("{x:?}").to_lowercase();
    json!({
        "integrator": c.integrator,
        "renders_by": c.renders_by(),
        "light_paths": s.light_paths,
        "connections": s.connections,
        "heuristic": lower(&s.heuristic),
        "sampler": lower(&s.sampler),
        "roulette": s.roulette,
        "accel": c.backend.name(),
        "accel_version": c.accelerator,
        "spp": c.samples,
        "budget": c.budget.map(|(seconds, pilot)| json!({
            "cpu_seconds": seconds,
            "pilot": {"spp": pilot.samples, "cpu_seconds": pilot.cpu_seconds},
        })),
        "below_reference_noise": c.below_noise(),
        "medians": summary(&c.summary),
        "runs": c.runs.iter().map(|r| run(r, c.samples)).collect::<Vec<Value>>(),
    })
}

fn reference(scene: &SceneReport) -> Value {
    let measure = &scene.measure;
    let noise = json!({"mse": measure.mse.and_then(finite), "rel_mse": measure.rel_mse.and_then(finite)});
    let subtracted = !matches!(measure.reference.noise, ReferenceNoise::Unknown);
    match &measure.origin {
        Origin::File(file) => json!({"file": file, "noise": noise, "noise_is_subtracted": subtracted}),
        Origin::Halves { integrator, samples, cpu_seconds } => json!({
            "halves": {
                "integrator": super::name(*integrator),
                "spp": samples,
                "seeds": crate::bench::REFERENCE_SEEDS,
                "cpu_seconds": cpu_seconds,
            },
            "noise": noise,
            "noise_is_subtracted": subtracted,
        }),
    }
}

fn scene(s: &SceneReport) -> Value {
    json!({
        "name": s.name,
        "file": s.file,
        "scene": format!("{:032x}", s.fingerprint),
        "resolution": s.resolution,
        "max_bounces": s.max_bounces,
        "notes": s.notes,
        "reference": reference(s),
        "configurations": s.configurations.iter().map(configuration).collect::<Vec<Value>>(),
    })
}

impl Report {
    /// The report for programs; all there is but for the images.
    pub fn json(&self) -> Value {
        json!({
            "version": self.version,
            "git": self.git,
            "machine": {
                "cpu": self.machine.cpu,
                "processors": self.machine.processors,
                "system": self.machine.system,
            },
            "threads": self.threads,
            "repetitions": self.repetitions,
            "intervals": {"coverage": self.coverage(), "are": self.intervals()},
            "scenes": self.scenes.iter().map(scene).collect::<Vec<Value>>(),
        })
    }
}

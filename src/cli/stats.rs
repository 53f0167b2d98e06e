//! What a render cost, as JSON. Whatever varies from run to run is told here and nowhere else.

use std::time::Duration;

use serde_json::{Value, json};

use crate::bench::machine::{cpu_seconds, peak_memory};
use crate::integrator::Reason;
use crate::render::{RenderJob, Rendered};
use crate::scene::desc::SceneDesc;

/// Wall time by phase.
#[derive(Clone, Copy, Debug, Default)]
pub struct Phases {
    pub parse: Duration,
    pub build: Duration,
    pub render: Duration,
    pub write: Duration,
}

pub fn json(job: &RenderJob, desc: &SceneDesc, accel: &str, rendered: &Rendered, phases: &Phases) -> Value {
    let s = &job.settings;
    let rays = &rendered.rays;
    let seconds = phases.render.as_secs_f64();
    let first = |reason: Reason| -> Vec<Value> {
        let told = rendered.rejected_first.iter().filter(|r| r.reason == reason);
        told.map(|r| json!({"pixel": r.pixel, "sample": r.sample, "technique": [r.technique.s, r.technique.t]}))
            .collect()
    };
    json!({
        "scene": format!("{:032x}", desc.fingerprint),
        "version": env!("CARGO_PKG_VERSION"),
        "git": env!("TWINLIGHT_GIT_HASH"),
        "accel": accel,
        "integrator": format!("{:?}", s.integrator).to_lowercase(),
        "heuristic": format!("{:?}", s.heuristic).to_lowercase(),
        "sampler": format!("{:?}", s.sampler).to_lowercase(),
        "seed": s.seed,
        "spp": job.samples,
        "max_bounces": s.max_bounces,
        "roulette": s.roulette,
        "roulette_after": s.roulette.then(|| s.free_of_roulette()),
        "technique": s.only.map(|t| json!({"s": t.s, "t": t.t, "weighted": s.weighted})),
        "light_paths": s.light_paths,
        "connections": s.connections,
        "resolution": desc.camera.resolution,
        "crop": [job.crop.x0, job.crop.y0, job.crop.x1, job.crop.y1],
        "threads": job.threads,
        "seconds": {
            "parse": phases.parse.as_secs_f64(),
            "build": phases.build.as_secs_f64(),
            "render": seconds,
            "write": phases.write.as_secs_f64(),
            "cpu": cpu_seconds(),
        },
        "peak_memory_bytes": peak_memory(),
        "paths": {"camera": rays.camera_paths, "light": rays.light_paths},
        "rays": {
            "camera": rays.camera,
            "light": rays.light,
            "shadow": rays.shadow,
            "connection": rays.connection,
            "lens": rays.lens,
            "total": rays.total(),
            "per_second": rays.total() as f64 / seconds.max(1e-9),
        },
        "non_finite": {"count": rendered.rejected, "first": first(Reason::NotFinite)},
        "overflows": rendered.overflows,
        "overflows_first": first(Reason::TooLarge),
        "plan": rendered.plan.as_ref().map(super::explain::json),
    })
}

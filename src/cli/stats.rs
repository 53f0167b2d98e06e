//! What a render cost, as JSON. Whatever varies from run to run is told here and nowhere else.

use std::time::Duration;

use serde_json::{Value, json};

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

/// Seconds of processor time this process has used, all threads, or `None` where the system does not tell.
fn cpu_seconds() -> Option<f64> {
    // Fields 14 and 15 (utime, stime) of proc(5), counted after the parenthesised command name, in ticks of 1/100 s.
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = stat.rsplit_once(')')?.1.split_ascii_whitespace().skip(11);
    let ticks = fields.next()?.parse::<f64>().ok()? + fields.next()?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}

/// Largest resident memory of this process in bytes, or `None` where the system does not tell.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
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
    })
}

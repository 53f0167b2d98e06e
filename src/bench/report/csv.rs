//! The report for spreadsheets: one row per run (RFC 4180; lines end as on Unix).

use std::fmt::Write;

use super::{ConfigurationReport, Report, RunReport, SceneReport};
use crate::compare::Figure;

/// The columns. An error without a suffix is without the reference's noise, and empty where it is below that.
const COLUMNS: &str = "scene,integrator,accel,spp,budget_cpu_seconds,repetition,seed,order,cpu_seconds,wall_seconds,\
     mse,mse_measured,mse_noise,rel_mse,rel_mse_measured,rel_mse_noise,rel_mse_trimmed,rel_mse_trimmed_measured,\
     rel_mse_trimmed_noise,below_reference_noise,efficiency,energy,rays_camera,rays_light,rays_shadow,rays_connection,\
     rays_lens,rays_total,paths_camera,paths_light,rays_per_cpu_second,samples_per_cpu_second,peak_memory_bytes,\
     non_finite,overflows";

/// A number with all its digits; nothing for none.
fn number(x: Option<f64>) -> String {
    x.filter(|x| x.is_finite()).map_or(String::new(), |x| format!("{x:e}"))
}

/// A text, quoted where a reader would take it apart.
fn field(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

fn figure(f: &Figure) -> String {
    [f.value(), Some(f.measured), f.noise].map(number).join(",")
}

fn row(out: &mut String, scene: &SceneReport, c: &ConfigurationReport, r: &RunReport) {
    let rays = &r.rays;
    let counts = [rays.camera, rays.light, rays.shadow, rays.connection, rays.lens, rays.total()];
    let counts = counts.into_iter().chain([rays.camera_paths, rays.light_paths]);
    let cells = [
        field(&scene.name),
        c.integrator.to_owned(),
        c.backend.name().to_owned(),
        c.samples.to_string(),
        number(c.budget.map(|(seconds, _)| seconds)),
        r.repetition.to_string(),
        r.seed.to_string(),
        r.order.to_string(),
        number(Some(r.cpu_seconds)),
        number(Some(r.wall_seconds)),
        figure(&r.mse),
        figure(&r.rel_mse),
        figure(&r.rel_mse_trimmed),
        r.rel_mse.below_noise().to_string(),
        number(r.efficiency()),
        number(Some(r.energy)),
        counts.map(|n| n.to_string()).collect::<Vec<String>>().join(","),
        number(Some(r.rays_per_cpu_second())),
        number(Some(r.samples_per_cpu_second(c.samples))),
        r.peak_memory.map_or(String::new(), |bytes| bytes.to_string()),
        r.non_finite.to_string(),
        r.overflows.to_string(),
    ];
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{}", cells.join(","));
}

impl Report {
    /// The report for spreadsheets.
    pub fn csv(&self) -> String {
        let mut out = format!("{COLUMNS}\n");
        for scene in &self.scenes {
            for c in &scene.configurations {
                c.runs.iter().for_each(|r| row(&mut out, scene, c, r));
            }
        }
        out
    }
}

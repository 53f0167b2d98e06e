//! The table for a terminal.

use std::fmt::Write;

use super::{ConfigurationReport, SceneReport, text};
use crate::compare::stats::Median;

/// The heading of the table.
pub const HEADING: &str = "scene            integrator accel     spp    CPU s    relMSE  efficiency [interval]             \
                           × first [interval]     energy  Mrays/s     MiB";

/// The columns of a configuration that pages and tables share, but for the scene's name.
pub(super) struct Cells {
    /// Seconds.
    pub cpu: String,
    pub rel_mse: String,
    pub efficiency: [String; 2],
    pub ratio: [String; 2],
    pub energy: String,
    pub mega_rays: String,
    pub memory: String,
}

/// A median, and its interval in brackets if there is one.
fn pair(median: Option<Median>, none: &str, hidden: &str) -> [String; 2] {
    let Some(m) = median else { return [none.to_owned(), String::new()] };
    let number = |x: f64| if x.is_infinite() { hidden.to_owned() } else { text::figures(x) };
    let interval = if m.coverage > 0.0 {
        format!("[{} … {}]", number(m.interval.low), number(m.interval.high))
    } else {
        String::new()
    };
    [number(m.median), interval]
}

impl Cells {
    pub fn of(c: &ConfigurationReport, first: bool) -> Self {
        let s = &c.summary;
        let plain = |m: Option<Median>, scale: f64| m.map_or("-".to_owned(), |m| text::figures(m.median * scale));
        Self {
            cpu: plain(s.cpu_seconds, 1.0),
            rel_mse: pair(s.rel_mse, "-", "< noise")[0].clone(),
            efficiency: pair(s.efficiency, "-", "-"),
            ratio: if first { ["1".to_owned(), String::new()] } else { pair(s.ratio, "-", "-") },
            energy: s.energy.map_or("-".to_owned(), |m| format!("{:.4}", m.median)),
            mega_rays: plain(s.rays_per_cpu_second, 1e-6),
            memory: plain(s.peak_memory, 1.0 / f64::from(1 << 20)),
        }
    }
}

/// The lines of a scene: its configurations, then how they were measured and what to know of them.
pub fn table(scene: &SceneReport) -> String {
    let mut out = String::new();
    for (index, c) in scene.configurations.iter().enumerate() {
        let cells = Cells::of(c, index == 0);
        let [efficiency, ratio] = [&cells.efficiency, &cells.ratio].map(|[median, interval]| {
            if interval.is_empty() { median.clone() } else { format!("{median} {interval}") }
        });
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "{:<16} {:<10} {:<6} {:>6} {:>8} {:>9}  {:<33} {:<22} {:>6} {:>8} {:>7}",
            scene.name,
            c.integrator,
            c.backend.name(),
            c.samples,
            cells.cpu,
            cells.rel_mse,
            efficiency,
            ratio,
            cells.energy,
            cells.mega_rays,
            cells.memory
        );
    }
    let _ = writeln!(out, "  {}", scene.about_reference());
    for note in &scene.notes {
        let _ = writeln!(out, "  note: {note}");
    }
    out
}

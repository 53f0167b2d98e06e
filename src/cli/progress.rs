//! Progress on standard error: a bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::sync::Mutex;

use crate::render::Progress;

/// Prints how far a render is.
#[derive(Debug)]
pub struct Reporter {
    mode: Mode,
    spp: u32,
    last: Mutex<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Quiet,
    Terminal,
    Lines,
}

/// Seconds between two updates.
const BAR_EVERY: f64 = 0.1;
const LINE_EVERY: f64 = 10.0;

impl Reporter {
    pub fn new(quiet: bool, spp: u32) -> Self {
        let mode = match (quiet, std::io::stderr().is_terminal()) {
            (true, _) => Mode::Quiet,
            (false, true) => Mode::Terminal,
            (false, false) => Mode::Lines,
        };
        Self { mode, spp, last: Mutex::new(0.0) }
    }

    /// To be called from any thread, as often as one likes.
    pub fn update(&self, p: Progress) {
        let every = match self.mode {
            Mode::Quiet => return,
            Mode::Terminal => BAR_EVERY,
            Mode::Lines => LINE_EVERY,
        };
        // A busy lock means that another thread is printing: nothing is lost by leaving it to that.
        let Ok(mut last) = self.last.try_lock() else { return };
        if p.seconds - *last < every {
            return;
        }
        *last = p.seconds;
        let text = describe(p, self.spp);
        if self.mode == Mode::Terminal {
            let filled = ((30.0 * p.done as f64 / p.total as f64) as usize).min(30);
            super::draw(&format!("\r\x1b[K[{}{}] {text}", "#".repeat(filled), ".".repeat(30 - filled)));
        } else {
            super::tell(&format!("{text}\n"));
        }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        if self.mode == Mode::Terminal {
            super::draw("\r\x1b[K");
        }
    }
}

fn describe(p: Progress, spp: u32) -> String {
    let share = p.done as f64 / p.total as f64;
    let left = if share > 0.0 { p.seconds * (1.0 - share) / share } else { 0.0 };
    format!(
        "{:5.1} %  {:.1}/{spp} spp  {:.2} Mrays/s  {} left",
        100.0 * share,
        share * f64::from(spp),
        p.rays as f64 / p.seconds.max(1e-9) * 1e-6,
        duration(left)
    )
}

/// Seconds in words that fit a line.
pub fn duration(seconds: f64) -> String {
    let s = seconds.round() as u64;
    match s {
        0..60 if seconds < 9.95 => format!("{seconds:.1} s"),
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min {:02} s", s / 60, s % 60),
        _ => format!("{} h {:02} min", s / 3600, s / 60 % 60),
    }
}

//! Benchmarks: how much error is left of a scene after how much processor time, by integrator, accelerator and number of
//! samples.
//!
//! Each configuration is rendered with several independent seeds and measured against a reference whose own noise is
//! subtracted, or at least named (`compare::Reference`). What is told of several runs are medians with distribution-free
//! intervals: a handful of values, some of them with fireflies, are not normal. Times are the processor's, not the wall's, and
//! configurations take turns, so that a machine's drift meets all of them alike; their efficiencies are compared repetition by
//! repetition.

pub mod machine;
mod plan;
mod reference;
pub mod report;
mod run;
mod summary;

pub use plan::{Backend, Configuration, Effort, Plan, REFERENCE_SEEDS, Turn};
pub use reference::{Given, ReferenceJob};
pub use run::{SceneJob, bench_scene};
pub use summary::Summary;

use std::fmt;

/// Why a benchmark could not go on.
#[derive(Debug)]
pub struct BenchError {
    message: String,
}

impl BenchError {
    fn new(message: impl fmt::Display) -> Self {
        Self { message: message.to_string() }
    }
}

impl fmt::Display for BenchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for BenchError {}

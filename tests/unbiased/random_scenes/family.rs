//! Families of tests.

use twinlight::compare::stats::{Moments, Welch, sidak, student_t_two_sided};

use crate::common::{ALPHA, ROUNDING};

/// Welch's p-value of two means, where differences that rounding makes of means of the size `unit` are none; `None` where
/// there is nothing to compare.
pub fn p_value(a: &Moments, b: &Moments, unit: f64) -> Option<f64> {
    let welch = Welch::new(a, b);
    let excess = (welch.difference.abs() - ROUNDING * unit).max(0.0);
    if welch.error == 0.0 {
        return (excess > 0.0).then_some(0.0);
    }
    Some(student_t_two_sided(excess / welch.error, welch.dof))
}

/// Tests of which the smallest p-value must not be smaller than so many make it.
#[derive(Default)]
pub struct Family {
    tests: u64,
    smallest: Option<(f64, String)>,
}

impl Family {
    /// Adds a test.
    pub fn add(&mut self, p: f64, label: impl Fn() -> String) {
        self.tests += 1;
        // A NaN is the smallest.
        if self.smallest.as_ref().is_none_or(|(least, _)| p.is_nan() || p < *least) {
            self.smallest = Some((p, label()));
        }
    }

    /// Judges them all at once.
    pub fn conclude(self, what: &str) {
        let Some((p, label)) = self.smallest else {
            eprintln!("{what}: none");
            return;
        };
        let level = sidak(ALPHA, self.tests);
        eprintln!("{what}: {} tests, smallest p {p:.1e} where {level:.1e} is too small: {label}", self.tests);
        assert!(p >= level, "{what}: {label}: p = {p:.1e}");
    }
}

/// How many values lie in each tenth of the unit interval.
pub fn histogram(p: &[f64]) -> String {
    let mut counts = [0; 10];
    p.iter().for_each(|p| counts[((p * 10.0) as usize).min(9)] += 1);
    format!("{counts:?}")
}

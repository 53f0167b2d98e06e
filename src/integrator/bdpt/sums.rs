//! The sums that weights are made of: by one set of sample counts, or by several side by side.
//!
//! Densities do not depend on how many samples each technique takes, and the heuristics' sums over techniques are linear in
//! the counts' `h`. So the sums for several sets of counts can be carried along one and the same walk: a survey
//! (`integrator::auto`) learns from samples of one estimator what others would have made of them.

use std::fmt::Debug;
use std::ops::{Add, Mul};

/// Sums stay below this, so that a product with a zero density is zero and not NaN.
const SATURATION: f64 = 1e280;

/// Sums over techniques, by one set of counts or by several.
pub trait Sums: Copy + Debug + Default + PartialEq + Add<Output = Self> + Mul<f64, Output = Self> {
    /// The same number for each set.
    fn splat(x: f64) -> Self;
    /// Each set's number by itself.
    fn map(self, f: impl Fn(f64) -> f64) -> Self;
    /// The number of the set that samples are taken with.
    fn taken(self) -> f64;
    /// All of them, if there are others than the one samples are taken with.
    fn candidates(self) -> Option<Candidates>;

    /// Keeps a sum finite; a NaN passes, for the gate before the film to see.
    #[inline(always)]
    fn saturated(self) -> Self {
        // Not `f64::min`, which would turn a NaN into the bound.
        self.map(|x| if x > SATURATION { SATURATION } else { x })
    }
}

impl Sums for f64 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        f(self)
    }

    #[inline(always)]
    fn taken(self) -> f64 {
        self
    }

    #[inline(always)]
    fn candidates(self) -> Option<Candidates> {
        None
    }
}

/// How many sets of counts are looked at side by side.
pub const CANDIDATES: usize = 8;

/// A number for each set; samples are taken with the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Candidates(pub [f64; CANDIDATES]);

impl Add for Candidates {
    type Output = Self;

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + o.0[i]))
    }
}

impl Mul<f64> for Candidates {
    type Output = Self;

    #[inline(always)]
    fn mul(self, x: f64) -> Self {
        Self(self.0.map(|a| a * x))
    }
}

impl Sums for Candidates {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; CANDIDATES])
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    #[inline(always)]
    fn taken(self) -> f64 {
        self.0[0]
    }

    #[inline(always)]
    fn candidates(self) -> Option<Candidates> {
        Some(self)
    }
}

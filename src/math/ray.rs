//! A ray segment.

use super::Vec3;
use crate::planted::{Bug, planted};

/// The points `o + t·d` with `tmin ≤ t ≤ tmax`. `d` need not be normalised: `t` counts in lengths of `d`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub o: Vec3,
    /// Direction, of any non-zero length.
    pub d: Vec3,
    /// Start of the segment, in lengths of `d`; below zero counts as zero.
    pub tmin: f32,
    /// End of the segment, in lengths of `d`; infinity for a half-line.
    pub tmax: f32,
}

impl Ray {
    /// The half-line from `o` along `d`.
    #[inline]
    pub fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, d, tmin: 0.0, tmax: f32::INFINITY }
    }

    /// The segment from `a` to `b`, `t` running from 0 to 1. Both ends must already be offset off their surfaces.
    #[inline]
    pub fn segment(a: Vec3, b: Vec3) -> Self {
        Self { o: a, d: b - a, tmin: 0.0, tmax: if planted(Bug::ShadowEndsEarly) { 0.999 } else { 1.0 } }
    }

    /// The point at parameter `t`. Carries the rounding of `o + t·d`: hit points come from the primitive instead.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }
}

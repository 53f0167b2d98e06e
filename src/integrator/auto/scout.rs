//! How far splats are to be trusted.
//!
//! MIS weighs techniques by their densities, as if each one's variance were its second moment. For splats that is so: those
//! of a pixel come from ever other samples, however alike they are. What a camera subpath gathers in one sample is nearly
//! the same in the next where light is smooth (direct light most of all): its variance is a small part of its second
//! moment, and its techniques deserve a weight larger by that part's reciprocal; or splats a smaller one, which is the same
//! ([Grittmann19], with one factor per length of path). Whatever the factors, the weights of a path sum to one.

use super::LEFT_OF_DIRECT;
use crate::integrator::recorder::Noted;
use crate::integrator::{LENGTHS, SplatConfidence};
use crate::math::Rgb;

/// Splats are never trusted less: they may be all there is.
const LEAST: f64 = 1e-3;

/// Per length of path, Σ over pixels of what camera subpaths gather: their variance and its second moment.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scattering {
    variance: [f64; LENGTHS],
    moment: [f64; LENGTHS],
}

impl std::ops::AddAssign for Scattering {
    fn add_assign(&mut self, o: Self) {
        for i in 0..LENGTHS {
            self.variance[i] += o.variance[i];
            self.moment[i] += o.moment[i];
        }
    }
}

impl Scattering {
    /// Variance over second moment for paths of 1, 2, … edges.
    pub fn confidence(&self) -> SplatConfidence {
        SplatConfidence::new(std::array::from_fn(|i| {
            // Where camera subpaths have found nothing, nothing is known against splats.
            let part = if self.moment[i] > 0.0 { self.variance[i] / self.moment[i] } else { 1.0 };
            let part = if i < 2 { LEFT_OF_DIRECT * part } else { part };
            part.clamp(LEAST, 1.0) as f32
        }))
    }
}

/// Takes in the two samples of each pixel, one thread's.
#[derive(Debug, Default)]
pub struct Scout {
    first: Option<[Rgb; LENGTHS]>,
    seen: Scattering,
}

impl Scout {
    /// Takes in what a sample of a pixel was noted to have made.
    pub fn sample(&mut self, notes: impl Iterator<Item = Noted>) {
        let mut sum = [Rgb::ZERO; LENGTHS];
        for note in notes.filter(|note| note.splat.is_none()) {
            let edges = (note.technique.s + note.technique.t - 1) as usize;
            sum[(edges - 1).min(LENGTHS - 1)] += note.value;
        }
        let Some(first) = self.first.take() else {
            self.first = Some(sum);
            return;
        };
        // Relative to what the pixel's two samples are, so that no bright one speaks for all.
        let pixel = (first.iter().sum::<Rgb>() + sum.iter().sum::<Rgb>()) / 2.0;
        let scale = 1.0 / (pixel * pixel + 1e-2);
        for i in 0..LENGTHS {
            let (a, b) = (first[i], sum[i]);
            let relative = |x: Rgb| f64::from((x * scale).element_sum());
            self.seen.variance[i] += relative((a - b) * (a - b)) / 2.0;
            self.seen.moment[i] += relative(a * a + b * b) / 2.0;
        }
    }

    /// What came of all pixels since it was last asked.
    pub fn take(&mut self) -> Scattering {
        std::mem::take(&mut self.seen)
    }
}

//! How far splats are to be trusted.
//!
//! MIS weighs techniques by their densities, as if each one's variance were its second moment. For splats that is so: those
//! of a pixel come from ever other samples, however alike they are. What a camera subpath gathers in one sample is nearly
//! the same in the next where light is smooth (direct light most of all): its variance is a small part of its second
//! moment, and its techniques deserve a weight larger by that part's reciprocal; or splats a smaller one, which is the same
//! ([Grittmann19], with one factor per length of path). Whatever the factors, the weights of a path sum to one.

use crate::integrator::recorder::Noted;
use crate::integrator::{LENGTHS, SplatConfidence};
use crate::math::{DVec3, Rgb};

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
    /// Variance over second moment for paths of 1, 2, … edges, of direct light's variance so much being left.
    pub fn confidence(&self, left_of_direct: f64) -> SplatConfidence {
        SplatConfidence::new(std::array::from_fn(|i| {
            // Where camera subpaths have found nothing, or what no f64 holds, nothing is known against splats.
            let part = self.variance[i] / self.moment[i];
            let part = if part.is_finite() { part } else { 1.0 };
            let part = if i < 2 { left_of_direct * part } else { part };
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
        for note in notes.filter(|note| note.splat.is_none() && note.value.is_finite()) {
            let edges = (note.technique.s + note.technique.t - 1) as usize;
            sum[(edges - 1).min(LENGTHS - 1)] += note.value;
        }
        let Some(first) = self.first.take() else {
            self.first = Some(sum);
            return;
        };
        // Relative to what the pixel's two samples are, so that no bright one speaks for all.
        let all = |samples: &[Rgb; LENGTHS]| samples.iter().map(|x| x.as_dvec3()).sum::<DVec3>();
        let pixel = all(&first) + all(&sum);
        let scale = (1.0 / pixel).map(|x| if x.is_finite() { x } else { 0.0 });
        for i in 0..LENGTHS {
            let (a, b) = (first[i].as_dvec3() * scale, sum[i].as_dvec3() * scale);
            self.seen.variance[i] += (a - b).length_squared() / 2.0;
            self.seen.moment[i] += (a.length_squared() + b.length_squared()) / 2.0;
        }
    }

    /// What came of all pixels since it was last asked.
    pub fn take(&mut self) -> Scattering {
        std::mem::take(&mut self.seen)
    }
}

//! What one estimator's samples say of the variance of others.
//!
//! Of a path that technique s has made with the contribution c = w_s f/(n_s p_s), a lane with other counts n' makes
//! c · (w'_s/w_s)(n_s/n'_s), at the same place of the same walk: the sum of these over a sample is the lane's sample, and
//! its variance over a pixel's samples is the lane's. That fails for paths which the lane makes far more seldom than the
//! pilot: their weight is in few samples, or in none. They are left out of that variance, and found in the pilot's
//! samples of *any* technique instead: with P = (Σ_j h(n_j p_j))^(1/β), the density with which all techniques together
//! make a path, about,
//!
//! ```text
//! ∫ f²/P' = E[ Σ c · f/P' ] = E[ Σ c² P/P' ] ,
//! ```
//!
//! their second moment. What light subpaths splat onto a pixel comes from ever other samples; its variance is its second
//! moment. Where one in m samples has light subpaths, their connections' Y adds (m − 1) Var Y to the variance, Y being what a
//! sample would have if each had one m-th of them: which samples have them is systematic.

use super::{Brightness, LANES};
use crate::integrator::bdpt::CANDIDATES;
use crate::integrator::recorder::Noted;
use crate::math::Rgb;
use crate::scene::desc::Heuristic;

/// Paths that a lane makes this many times as seldom as the pilot are none of its samples'. Above what a lane of one sample
/// in 4 does to the paths that light subpaths alone make.
const SELDOM: f64 = 6.0;

/// Samples of a pixel in a survey.
const SAMPLES: usize = (super::PILOT - super::SCOUT) as usize;

/// Direct light, longer paths, and of these the connections of lanes that thin them.
const PARTS: usize = 3;

/// Sums over a survey's pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Pixels.
    pixels: f64,
    /// Σ over pixels of the variance of a camera sample's parts, the second one's with the third in it.
    camera: [[f64; PARTS]; CANDIDATES],
    /// Σ over samples of squares: splats, and what a lane makes seldom.
    moments: [f64; CANDIDATES],
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, o: Self) {
        self.pixels += o.pixels;
        for i in 0..CANDIDATES {
            self.moments[i] += o.moments[i];
            for part in 0..PARTS {
                self.camera[i][part] += o.camera[i][part];
            }
        }
    }
}

impl Tally {
    /// Of each lane, the mean over pixels of one sample's relative variance, so much of the variance of direct light and of
    /// longer paths being left by the sampler.
    pub fn variances(&self, [direct, rest]: [f64; 2]) -> [f64; CANDIDATES] {
        std::array::from_fn(|i| {
            let [near, far, thinned] = self.camera[i];
            // Which samples have light subpaths is systematic: only what differs between them counts (m − 1 times).
            let more = f64::from(LANES[i].one_in - 1) * thinned;
            (direct * near + rest * (far + more) + self.moments[i] / SAMPLES as f64) / self.pixels
        })
    }
}

/// Takes in the samples of pixels, one thread's.
#[derive(Debug)]
pub struct Survey<'a> {
    brightness: &'a Brightness,
    heuristic: Heuristic,
    /// The lanes' samples of the pixel under way by parts, relative to its brightness.
    samples: [[[Rgb; PARTS]; CANDIDATES]; SAMPLES],
    /// How many of them are done.
    done: usize,
    tally: Tally,
}

/// Square of a relative contribution, mean over channels.
#[inline]
fn square(x: Rgb) -> f64 {
    x.as_dvec3().length_squared() / 3.0
}

impl<'a> Survey<'a> {
    /// By this brightness, with the weights of this heuristic.
    pub fn new(brightness: &'a Brightness, heuristic: Heuristic) -> Self {
        Self { brightness, heuristic, samples: Default::default(), done: 0, tally: Tally::default() }
    }

    /// x^(1/β).
    #[inline]
    fn root(&self, x: f64) -> f64 {
        if self.heuristic == Heuristic::Power { x.sqrt() } else { x }
    }

    /// Takes in what a sample of `pixel` was noted to have made.
    pub fn sample(&mut self, pixel: [u32; 2], notes: impl Iterator<Item = Noted>) {
        let own_scale = self.brightness.at(pixel);
        // What the gate before the film has kept out says nothing, nor does what is nothing.
        for note in notes.filter(|note| note.value.is_finite() && note.value != Rgb::ZERO) {
            let value = note.value * note.splat.map_or(own_scale, |pixel| self.brightness.at(pixel));
            let total = note.own[0] + note.others[0];
            let part = usize::from(note.technique.s + note.technique.t > 3);
            let (splat, connection) = (note.technique.t == 1, note.technique.s >= 2 && note.technique.t >= 2);
            for (i, lane) in LANES.iter().enumerate() {
                let ratio = total / (note.own[i] + note.others[i]);
                let seldom = self.root(ratio);
                // Written so that what overflows is seldom.
                if seldom.is_nan() || seldom > SELDOM {
                    // c is f/P · (P/n_s p_s)^(1 − β) under the power heuristic.
                    let density = if self.heuristic == Heuristic::Power { self.root(total / note.own[0]) } else { 1.0 };
                    let moment = square(value) * density * seldom;
                    self.tally.moments[i] += if moment.is_nan() { f64::INFINITY } else { moment };
                    continue;
                }
                // n'/n, and (w'/w)(n/n').
                let more = self.root(note.own[i] / note.own[0]);
                if more == 0.0 {
                    continue;
                }
                let made = value * (note.own[i] / note.own[0] * ratio / more) as f32;
                let sample = &mut self.samples[self.done][i];
                if splat {
                    self.tally.moments[i] += more * square(made);
                } else if connection && lane.one_in > 1 {
                    sample[1] += made * more as f32;
                    sample[2] += made * more as f32;
                } else {
                    sample[part] += made;
                }
            }
        }
        self.done += 1;
        if self.done == SAMPLES {
            self.pixel();
        }
    }

    /// All samples of a pixel are in.
    fn pixel(&mut self) {
        for i in 0..CANDIDATES {
            for part in 0..PARTS {
                let mean = self.samples.iter().map(|s| s[i][part]).sum::<Rgb>() / SAMPLES as f32;
                let squares: f64 = self.samples.iter().map(|s| square(s[i][part] - mean)).sum();
                self.tally.camera[i][part] += squares / (SAMPLES - 1) as f64;
            }
        }
        self.tally.pixels += 1.0;
        self.samples = Default::default();
        self.done = 0;
    }

    /// What came of all pixels since it was last asked.
    pub fn take(&mut self) -> Tally {
        std::mem::take(&mut self.tally)
    }
}

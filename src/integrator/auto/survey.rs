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
//! moment. Where one in m samples has light subpaths, their connections' Y adds (m − 1) E[Y²] to the variance, Y being what a
//! sample would have if each had one m-th of them.

use super::{Brightness, LANES, LEFT_OF_DIRECT, LEFT_OF_REST};
use crate::integrator::bdpt::CANDIDATES;
use crate::integrator::recorder::Noted;
use crate::math::Rgb;
use crate::scene::desc::Heuristic;

/// Paths that a lane makes this many times as seldom as the pilot are none of its samples'.
const SELDOM: f64 = 4.0;

/// Samples of a pixel in a survey.
const SAMPLES: usize = (super::PILOT - super::SCOUT) as usize;

/// Sums over a survey's pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Pixels.
    pixels: f64,
    /// Σ over pixels of a sample's variance, as a camera sample makes it.
    camera: [f64; CANDIDATES],
    /// Σ over samples of squares: splats, thinned connections, and what a lane makes seldom.
    moments: [f64; CANDIDATES],
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, o: Self) {
        self.pixels += o.pixels;
        for i in 0..CANDIDATES {
            self.camera[i] += o.camera[i];
            self.moments[i] += o.moments[i];
        }
    }
}

impl Tally {
    /// Of each lane, the mean over pixels of one sample's relative variance.
    pub fn variances(&self) -> [f64; CANDIDATES] {
        std::array::from_fn(|i| (self.camera[i] + self.moments[i] / SAMPLES as f64) / self.pixels)
    }
}

/// Takes in the samples of pixels, one thread's.
#[derive(Debug)]
pub struct Survey<'a> {
    brightness: &'a Brightness,
    heuristic: Heuristic,
    /// The lanes' samples of the pixel under way, relative to its brightness: direct light, and the rest.
    samples: [[[Rgb; 2]; CANDIDATES]; SAMPLES],
    /// How many of them are done.
    done: usize,
    tally: Tally,
}

/// Square of a relative contribution, mean over channels.
#[inline]
fn square(x: Rgb) -> f64 {
    f64::from(x.length_squared()) / 3.0
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
        let mut connected = [Rgb::ZERO; CANDIDATES];
        for note in notes {
            let scale = note.splat.map_or(own_scale, |pixel| self.brightness.at(pixel));
            let value = note.value * scale;
            let total = note.own[0] + note.others[0];
            let far = usize::from(note.technique.s + note.technique.t > 3);
            let (splat, connection) = (note.technique.t == 1, note.technique.s >= 2 && note.technique.t >= 2);
            for (i, lane) in LANES.iter().enumerate() {
                let ratio = total / (note.own[i] + note.others[i]);
                let seldom = self.root(ratio);
                if seldom > SELDOM {
                    self.tally.moments[i] += square(value) * seldom;
                    continue;
                }
                // n'/n, and (w'/w)(n/n').
                let more = self.root(note.own[i] / note.own[0]);
                if more == 0.0 {
                    continue;
                }
                let made = value * (note.own[i] / note.own[0] * ratio / more) as f32;
                if splat {
                    self.tally.moments[i] += more * square(made);
                } else if connection && lane.one_in > 1 {
                    connected[i] += made * more as f32;
                } else {
                    self.samples[self.done][i][far] += made;
                }
            }
        }
        for (i, lane) in LANES.iter().enumerate().filter(|(_, lane)| lane.one_in > 1) {
            self.samples[self.done][i][1] += connected[i];
            self.tally.moments[i] += f64::from(lane.one_in - 1) * square(connected[i]);
        }
        self.done += 1;
        if self.done == SAMPLES {
            self.pixel();
        }
    }

    /// All samples of a pixel are in.
    fn pixel(&mut self) {
        for i in 0..CANDIDATES {
            for (far, left) in [LEFT_OF_DIRECT, LEFT_OF_REST].into_iter().enumerate() {
                let mean = self.samples.iter().map(|s| s[i][far]).sum::<Rgb>() / SAMPLES as f32;
                let squares: f64 = self.samples.iter().map(|s| square(s[i][far] - mean)).sum();
                self.tally.camera[i] += left * squares / (SAMPLES - 1) as f64;
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

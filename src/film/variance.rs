//! Exact sums of squares: pixels' variances have the same bits for any number of threads, and follow emission × 2ᵏ
//! exactly, as the picture does.
//!
//! What the picture's film rounds to quanta 2ᵉ is squared as an integer and summed in quanta 2²ᵉ. A contribution that
//! fits the film is below 2¹⁰³ quanta and a sample's sum below 2¹¹⁵, so that its square is below 2²³⁰, and the 256-bit sums
//! hold 2²⁶ of the largest: no square is lost that the picture has the contribution of.

use std::sync::atomic::{AtomicU64, Ordering};

use super::accumulator::{Accumulator, Quanta};
use super::{BYTES_PER_PIXEL, Image};

/// Memory of the sums with the image they resolve to.
pub const VARIANCE_BYTES_PER_PIXEL: u64 = BYTES_PER_PIXEL + 96;

/// A sum of squares of contributions per channel, one thread's: 256 bits, the lowest 64 first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Squares([[u64; 4]; 3]);

impl Squares {
    /// The squares of one contribution.
    #[inline]
    pub fn of(quanta: Quanta) -> Self {
        Self(quanta.0.map(square))
    }
}

impl std::ops::AddAssign for Squares {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        for (sum, square) in self.0.iter_mut().zip(o.0) {
            let mut carry = false;
            for (a, b) in sum.iter_mut().zip(square) {
                let (c, first) = a.overflowing_add(b);
                let (c, second) = c.overflowing_add(u64::from(carry));
                (*a, carry) = (c, first || second);
            }
        }
    }
}

/// `q²`: with |q| = 2⁶⁴a + b, 2¹²⁸a² + 2⁶⁵ab + b².
#[inline]
fn square(q: i128) -> [u64; 4] {
    let q = q.unsigned_abs();
    let (a, b) = (q >> 64, q & u128::from(u64::MAX));
    // |q| is at most 2¹²⁷, so that 2ab is below 2¹²⁸ − 2⁶⁴: nothing here overflows.
    let (aa, ab, bb) = (a * a, a * b, b * b);
    let middle = (ab << 1) + (bb >> 64);
    let high = aa + (middle >> 64);
    [bb as u64, middle as u64, high as u64, (high >> 64) as u64]
}

/// Sums from which pixels' variances follow, shared by all threads. A pixel is the mean of what n camera samples found,
/// plus 1/n times the sum of splats, of which each light subpath makes one with a small probability: a compound Poisson
/// sum, whose variance is estimated by the sum of squares.
#[derive(Debug)]
pub struct VarianceFilm {
    /// Of what the pixels' own samples found.
    own: Accumulator,
    /// Of the squares of that and of splats.
    squares: Vec<[[AtomicU64; 4]; 3]>,
}

impl VarianceFilm {
    /// Empty sums beside an [`Accumulator`] of the same size and `emission`.
    pub fn new(width: u32, height: u32, emission: f32) -> Self {
        let squares = (0..width as usize * height as usize).map(|_| Default::default()).collect();
        Self { own: Accumulator::new(width, height, emission), squares }
    }

    /// Adds samples of a pixel (row-major index): their sum, and the sum of their squares.
    #[inline]
    pub fn add_samples(&self, pixel: usize, sum: Quanta, squares: Squares) {
        self.own.add(pixel, sum);
        self.add(pixel, squares);
    }

    /// Adds a splat to a pixel.
    #[inline]
    pub fn add_splat(&self, pixel: usize, splat: Quanta) {
        self.add(pixel, Squares::of(splat));
    }

    fn add(&self, pixel: usize, squares: Squares) {
        for (cell, square) in self.squares[pixel].iter().zip(squares.0) {
            // As in the film: each addition sees its own carry, and carries are added in any order.
            let mut carry = 0;
            for (limb, value) in cell.iter().zip(square) {
                let (value, wrapped) = value.overflowing_add(carry);
                // 2⁶⁴ more is a carry alone.
                carry = u64::from(wrapped);
                if value != 0 {
                    let old = limb.fetch_add(value, Ordering::Relaxed);
                    carry += u64::from(old.checked_add(value).is_none());
                }
            }
        }
    }

    /// The variance of each pixel's mean over `samples` samples, were they independent. All threads must have finished
    /// adding.
    pub fn resolve(&self, samples: u64) -> Image {
        let n = samples.max(1) as f64;
        let quantum = 1.0 / self.own.scale();
        let mut image = self.own.resolve(samples);
        for (pixel, (variance, squares)) in image.rgb.iter_mut().zip(&self.squares).enumerate() {
            let own = self.own.sum(pixel);
            for ((variance, square), own) in variance.iter_mut().zip(squares).zip(own) {
                let square = square
                    .iter()
                    .rev()
                    .fold(0.0, |sum, limb| sum * 18_446_744_073_709_551_616.0 + limb.load(Ordering::Relaxed) as f64);
                let mean = own as f64 / n;
                // Rounding alone could make it negative. Quanta are multiplied in last: until there nothing but the
                // integers counts, whatever the emission.
                let spread = (square / n - mean * mean).max(0.0) / (n - 1.0).max(1.0);
                *variance = (spread * quantum * quantum) as f32;
            }
        }
        image
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    fn add(film: &VarianceFilm, picture: &Accumulator, values: &[f32]) {
        for value in values {
            let quanta = picture.quantize(Rgb::splat(*value));
            film.add_samples(0, quanta, Squares::of(quanta));
        }
        assert_eq!(picture.overflows(), 0);
    }

    fn variance(emission: f32, values: &[f32]) -> f32 {
        let (film, picture) = (VarianceFilm::new(1, 1, emission), Accumulator::new(1, 1, emission));
        add(&film, &picture, values);
        film.resolve(values.len() as u64).rgb[0][0]
    }

    /// In f64, of the mean.
    fn expected(values: &[f32]) -> f64 {
        let n = values.len() as f64;
        let mean = values.iter().map(|x| f64::from(*x)).sum::<f64>() / n;
        values.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))
    }

    fn some_values() -> Vec<f32> {
        (0..1000u32).map(|i| 0.1 + (i as f32).sin().abs() * 3.3).collect()
    }

    #[test]
    fn it_is_the_variance_of_the_mean() {
        let values = some_values();
        let (got, want) = (f64::from(variance(2.0, &values)), expected(&values));
        assert!((got / want - 1.0).abs() < 1e-6, "{got}, not {want}");
        assert_eq!(variance(2.0, &[0.3; 7]), 0.0);
        // Little noise on a bright pixel: the difference of two numbers that agree in ten digits.
        let values: Vec<f32> = values.iter().map(|x| 1e3 + 0.01 * x).collect();
        let (got, want) = (f64::from(variance(2.0, &values)), expected(&values));
        assert!((got / want - 1.0).abs() < 1e-4, "{got}, not {want}");
    }

    #[test]
    fn emission_times_a_power_of_two_scales_it_by_the_square_exactly() {
        let values = some_values();
        let one = variance(12.5, &values);
        for k in [-50, -21, -1, 1, 20, 60] {
            let factor = f32::exp2(k as f32);
            let scaled: Vec<f32> = values.iter().map(|x| x * factor).collect();
            assert_eq!(variance(12.5 * factor, &scaled), one * factor * factor, "2^{k}");
        }
    }

    /// As bright as the film holds: 2⁴⁷ times the emission, whose square is 2⁹⁴ times the emission's.
    #[test]
    fn a_fireflys_square_is_not_lost() {
        for firefly in [1e5, 1e8, 1.2e14] {
            let mut values = vec![0.5; 100];
            values[17] = firefly;
            let (got, want) = (f64::from(variance(1.0, &values)), expected(&values));
            assert!((got / want - 1.0).abs() < 1e-6, "{firefly}: {got}, not {want}");
        }
    }

    #[test]
    fn sums_do_not_depend_on_order_or_threads() {
        let values: Vec<f32> = (0..3000u32).map(|i| f32::exp2((i % 83) as f32 - 50.0) * (1.0 + i as f32)).collect();
        let picture = Accumulator::new(1, 1, 1.0);
        let forward = VarianceFilm::new(1, 1, 1.0);
        add(&forward, &picture, &values);
        let shared = VarianceFilm::new(1, 1, 1.0);
        std::thread::scope(|scope| {
            for part in 0..5 {
                let (shared, values, picture) = (&shared, &values, &picture);
                scope.spawn(move || {
                    let (mut sum, mut squares) = (Quanta::default(), Squares::default());
                    for (i, v) in values.iter().rev().enumerate().filter(|(i, _)| i % 5 == part) {
                        let quanta = picture.quantize(Rgb::splat(*v));
                        if i % 2 == 0 {
                            shared.add_samples(0, quanta, Squares::of(quanta));
                        } else {
                            sum += quanta;
                            squares += Squares::of(quanta);
                        }
                    }
                    shared.add_samples(0, sum, squares);
                });
            }
        });
        assert_eq!(forward.resolve(3000), shared.resolve(3000));
    }

    #[test]
    fn squares_are_exact_to_the_last_bit() {
        for q in [0, 1, -1, i128::from(u64::MAX), -(1 << 64), (1 << 103) - 1, i128::MAX, i128::MIN] {
            // Schoolbook, in halves of 32 bits.
            let mut digits = [0_u128; 9];
            let halves: Vec<u128> = (0..4).map(|i| (q.unsigned_abs() >> (32 * i)) & 0xffff_ffff).collect();
            for (i, a) in halves.iter().enumerate() {
                for (j, b) in halves.iter().enumerate() {
                    let product = a * b;
                    digits[i + j] += product & 0xffff_ffff;
                    digits[i + j + 1] += product >> 32;
                }
            }
            for i in 0..8 {
                digits[i + 1] += digits[i] >> 32;
                digits[i] &= 0xffff_ffff;
            }
            let want = [0, 1, 2, 3].map(|i| (digits[2 * i] | (digits[2 * i + 1] << 32)) as u64);
            assert_eq!(square(q), want, "{q}");
        }
    }
}

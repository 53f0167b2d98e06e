//! Exact sums: the image has the same bits for any number of threads and any order of tiles.
//!
//! Floating-point addition is not associative, integer addition is. What a sample adds to its own pixel (summed in the
//! sample's fixed order) and every splat is rounded once to a multiple of a quantum 2ᵉ, and sums are 128-bit integers.
//!
//! The quantum is 2⁻⁵⁶ of the light that the scene's lights may be expected to throw on a surface (`Light::brightness`),
//! and follows nothing else, so that emission × 2ᵏ shifts every sum exactly. A contribution may exceed it 2⁴⁷ times: that
//! much brighter may a lamp be than what it lights, and a point light of intensity I makes a surface at distance r shine
//! with ρI/πr². What is larger is an overflow: `largest` tells, so that it is kept from the film where its pixel, sample and
//! technique are known (`integrator::Recorder`). The sum holds 2²⁴ contributions of that largest size in one pixel, and as many
//! more as they are smaller.

use std::sync::atomic::{AtomicU64, Ordering};

use super::Image;
use crate::math::Rgb;

/// The light to be expected is this many powers of two above the quantum.
const BITS_BELOW_EMISSION: i32 = 56;

/// Contributions beyond this many quanta are overflows: 2²⁴ of them, all on one pixel, still fit.
const LARGEST: f64 = 1.014_120_480_182_583_5e31; // 2¹⁰³

/// A sample's sum, of contributions that are each below `LARGEST`, may be larger by this.
const SUMMED: f64 = 4096.0;

/// Memory of a film with the image it resolves to.
pub const BYTES_PER_PIXEL: u64 = 48 + 12;

/// Sums of contributions, shared by all threads.
#[derive(Debug)]
pub struct Accumulator {
    width: u32,
    height: u32,
    /// 2⁻ᵉ.
    scale: f64,
    /// Low and high half of a two's complement 128-bit sum per channel.
    cells: Vec<[[AtomicU64; 2]; 3]>,
    overflows: AtomicU64,
}

/// A sum of contributions in quanta, one thread's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quanta(pub [i128; 3]);

impl std::ops::AddAssign for Quanta {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        for (a, b) in self.0.iter_mut().zip(o.0) {
            *a += b;
        }
    }
}

impl Accumulator {
    /// The smallest contribution (any channel) that is too large for a film of this `emission`; infinite where all fit.
    pub fn largest(emission: f32) -> f32 {
        (LARGEST / scale(emission)) as f32
    }

    /// An empty sum for an image of a scene whose lights throw light of about `emission` (any channel).
    pub fn new(width: u32, height: u32, emission: f32) -> Self {
        let cells = (0..width as usize * height as usize).map(|_| Default::default()).collect();
        Self { width, height, scale: scale(emission), cells, overflows: AtomicU64::new(0) }
    }

    /// Rounds a finite contribution, or a sample's sum, to quanta. One that no gate should have let through becomes zero and is
    /// counted.
    #[inline]
    pub fn quantize(&self, value: Rgb) -> Quanta {
        let x = value.as_dvec3() * self.scale;
        if x.abs().max_element() < LARGEST * SUMMED {
            Quanta([round(x.x), round(x.y), round(x.z)])
        } else {
            self.overflows.fetch_add(1, Ordering::Relaxed);
            Quanta::default()
        }
    }

    /// Brings pixels (row-major indices) into the cache together, before they are added to one by one: an atomic addition
    /// that has to wait for its cell holds up all that follow it.
    #[inline]
    pub fn touch(&self, pixels: impl Iterator<Item = usize>) {
        let touched = pixels.fold(0, |sum: u64, pixel| {
            let [first, _, last] = &self.cells[pixel];
            sum ^ first[0].load(Ordering::Relaxed) ^ last[1].load(Ordering::Relaxed)
        });
        std::hint::black_box(touched);
    }

    /// Adds to a pixel (row-major index).
    #[inline]
    pub fn add(&self, pixel: usize, quanta: Quanta) {
        for (cell, value) in self.cells[pixel].iter().zip(quanta.0) {
            let (low, high) = (value as u64, (value >> 64) as u64);
            // Each addition sees its own carry out of the low half, whatever other threads do in between, and the
            // high half takes carries in any order: the pair ends at the true sum mod 2¹²⁸.
            let old = cell[0].fetch_add(low, Ordering::Relaxed);
            let carry = u64::from(old.checked_add(low).is_none());
            let high = high.wrapping_add(carry);
            if high != 0 {
                cell[1].fetch_add(high, Ordering::Relaxed);
            }
        }
    }

    /// How many values were too large to be summed.
    pub fn overflows(&self) -> u64 {
        self.overflows.load(Ordering::Relaxed)
    }

    /// 2⁻ᵉ, quanta per unit.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// A pixel's sum in quanta. All threads must have finished adding.
    pub(super) fn sum(&self, pixel: usize) -> [i128; 3] {
        self.cells[pixel].each_ref().map(|[low, high]| {
            let (low, high) = (low.load(Ordering::Relaxed), high.load(Ordering::Relaxed));
            ((u128::from(high) << 64) | u128::from(low)) as i128
        })
    }

    /// The mean over `samples` samples per pixel. All threads must have finished adding.
    pub fn resolve(&self, samples: u64) -> Image {
        let factor = 1.0 / (self.scale * samples.max(1) as f64);
        let mut image = Image::new(self.width, self.height);
        for (i, pixel) in image.rgb.iter_mut().enumerate() {
            *pixel = self.sum(i).map(|sum| (sum as f64 * factor) as f32);
        }
        image
    }
}

/// 2⁻ᵉ, quanta per unit, of a film of this emission.
fn scale(emission: f32) -> f64 {
    // The exponent field of the f64, in which every positive f32 is normal: exact, as a logarithm is not.
    let exponent =
        if emission > 0.0 && emission.is_finite() { (f64::from(emission).to_bits() >> 52) as i32 - 1023 } else { 0 };
    f64::from(BITS_BELOW_EMISSION - exponent).exp2()
}

/// To the nearest integer, ties to even.
#[inline]
fn round(x: f64) -> i128 {
    // 64-bit conversion is one instruction; the 128-bit one is a call.
    let x = x.round_ties_even();
    if x.abs() < 9.2e18 { i128::from(x as i64) } else { x as i128 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_order_or_threads() {
        let values: Vec<Rgb> = (0..10_000u32)
            .map(|i| {
                let x = (f64::from(i) * 0.754_877_666).fract() as f32;
                Rgb::new(x, x * x * 1e-9, -x * 1e7)
            })
            .collect();
        let forward = Accumulator::new(1, 1, 17.0);
        for v in &values {
            forward.add(0, forward.quantize(*v));
        }
        let shared = Accumulator::new(1, 1, 17.0);
        std::thread::scope(|scope| {
            for part in 0..5 {
                let (shared, values) = (&shared, &values);
                scope.spawn(move || {
                    let mut local = Quanta::default();
                    for (i, v) in values.iter().rev().enumerate().filter(|(i, _)| i % 5 == part) {
                        if i % 2 == 0 {
                            shared.add(0, shared.quantize(*v));
                        } else {
                            local += shared.quantize(*v);
                        }
                    }
                    shared.add(0, local);
                });
            }
        });
        assert_eq!(forward.resolve(10_000).rgb, shared.resolve(10_000).rgb);
        let exact: f64 = values.iter().map(|v| f64::from(v.z)).sum::<f64>() / 10_000.0;
        assert!((f64::from(forward.resolve(10_000).rgb[0][2]) / exact - 1.0).abs() < 1e-6);
    }

    #[test]
    fn emission_times_a_power_of_two_shifts_the_image_exactly() {
        for k in [-60, -20, 1, 40] {
            let factor = f32::exp2(k as f32);
            let (a, b) = (Accumulator::new(1, 1, 12.5), Accumulator::new(1, 1, 12.5 * factor));
            for i in 0..1000u32 {
                let v = Rgb::splat(0.1 + (i as f32).sin().abs() * 3.3);
                a.add(0, a.quantize(v));
                b.add(0, b.quantize(v * factor));
            }
            assert_eq!(a.resolve(1000).rgb[0].map(|x| x * factor), b.resolve(1000).rgb[0]);
        }
    }

    #[test]
    fn ten_million_samples_lose_nothing_and_too_large_ones_are_counted() {
        let film = Accumulator::new(1, 1, 1.0);
        let one = film.quantize(Rgb::splat(0.1));
        let mut local = Quanta::default();
        for _ in 0..10_000_000 {
            local += one;
        }
        film.add(0, local);
        let got = film.resolve(10_000_000).rgb[0][0];
        assert_eq!(got, 0.1);
        assert_eq!(film.overflows(), 0);
        let largest = Accumulator::largest(1.0);
        assert_eq!(largest, 47.0_f32.exp2());
        assert_ne!(film.quantize(Rgb::splat(largest)), Quanta::default());
        film.add(0, film.quantize(Rgb::splat(1e37)));
        assert_eq!(film.overflows(), 1);
        assert_eq!(film.resolve(10_000_000).rgb[0][0], got);
    }
}

//! Point sets keyed by (seed, pixel or light path, sample, dimension): never by thread or time, so that any sample
//! can be made again on its own.

use crate::planted::{Bug, planted};

/// Which point set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerKind {
    /// Each pair of dimensions is an Owen-scrambled (0,2)-sequence with its own shuffle
    /// (Burley 2020, "Practical Hash-based Owen Scrambling", JCGT 9(4)).
    Sobol,
    /// Independent uniform numbers.
    Independent,
}

/// Which subpath the numbers are for: streams of one pixel are independent of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    /// The camera subpath with its next-event samples.
    Camera,
    /// The light subpath of this number among those of the pixel's sample.
    Light(u32),
}

/// One sample point, read dimension by dimension.
#[derive(Clone, Debug)]
pub struct Sampler {
    kind: SamplerKind,
    /// Hash of seed, pixel and stream.
    key: u64,
    /// Index of the sample in its pixel's sequence, bits reversed.
    reversed_index: u32,
    index: u32,
    dimension: u32,
}

impl Sampler {
    /// The sample `index` of `pixel` (any number unique to it) in `stream`, at dimension 0.
    #[inline]
    pub fn new(kind: SamplerKind, seed: u64, pixel: u32, stream: Stream, index: u32) -> Self {
        let stream = match stream {
            Stream::Camera => 0,
            Stream::Light(_) if planted(Bug::OneStream) => 0,
            Stream::Light(n) => u64::from(n) + 1,
        };
        let key = mix(mix(seed ^ 0x9e37_79b9_7f4a_7c15) ^ u64::from(pixel) ^ stream << 32);
        Self { kind, key, reversed_index: index.reverse_bits(), index, dimension: 0 }
    }

    /// The sample's coins: numbers beside its dimensions, independent of all of them.
    #[inline]
    pub fn coins(&self) -> Coins {
        Coins { state: self.key ^ u64::from(self.index).wrapping_mul(0xda94_2042_e4dd_58b5) }
    }

    /// Other coins than those: for decisions that must leave what `coins` decides where it is.
    #[inline]
    pub fn more_coins(&self) -> Coins {
        Coins { state: !self.coins().state }
    }

    /// Moves to a dimension: a bounce always starts at the same one, whatever the bounces before it consumed.
    #[inline]
    pub fn set_dimension(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    /// The next number, uniform in [0, 1).
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        let h = self.next_hash();
        match self.kind {
            SamplerKind::Independent => unit(h as u32),
            SamplerKind::Sobol => {
                let shuffled = self.shuffled_index(h as u32);
                unit(scramble(shuffled, (h >> 32) as u32).reverse_bits())
            }
        }
    }

    /// The next number, uniform in [0, 1), with all the bits of an f64: for choices among many.
    #[inline]
    pub fn next_f64(&mut self) -> f64 {
        let h = self.next_hash();
        let bits = match self.kind {
            SamplerKind::Independent => h,
            SamplerKind::Sobol => {
                let shuffled = self.shuffled_index(h as u32);
                let high = scramble(shuffled, (h >> 32) as u32).reverse_bits();
                // Below the 32 bits of the sequence the scramble's are independent per sample.
                u64::from(high) << 32 | mix(h ^ u64::from(self.index)) >> 32
            }
        };
        (bits >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }

    /// The next pair, uniform in [0, 1)².
    #[inline]
    pub fn next_2d(&mut self) -> [f32; 2] {
        let h = self.next_hash();
        match self.kind {
            SamplerKind::Independent => [unit(h as u32), unit((h >> 32) as u32)],
            SamplerKind::Sobol => {
                let shuffled = self.shuffled_index(h as u32);
                let second = (h >> 32) as u32;
                let x = scramble(shuffled, second);
                let y = scramble(sobol_second(shuffled), second ^ 0x5bd1_e995);
                // Both reversed at once, which changes their places.
                let reversed = (u64::from(y) << 32 | u64::from(x)).reverse_bits();
                [unit((reversed >> 32) as u32), unit(reversed as u32)]
            }
        }
    }

    /// The hash that makes this dimension its own; for independent numbers of this sample, too.
    #[inline]
    fn next_hash(&mut self) -> u64 {
        let dimension = u64::from(self.dimension);
        self.dimension += 1;
        match self.kind {
            SamplerKind::Sobol => mix(self.key ^ dimension.wrapping_mul(0xd6e8_feb8_6659_fd93)),
            SamplerKind::Independent => {
                mix(mix(self.key ^ u64::from(self.index)) ^ dimension.wrapping_mul(0xd6e8_feb8_6659_fd93))
            }
        }
    }

    /// The sample's index after an Owen shuffle of the sequence: a nested uniform permutation of the index's bits
    /// keeps every aligned block of 2ᵏ indices together, and with it the net property.
    #[inline]
    fn shuffled_index(&self, seed: u32) -> u32 {
        scramble(self.reversed_index, seed).reverse_bits()
    }
}

/// Independent uniform numbers for decisions that few samples have to make (whether a cut-out surface is there, which
/// part of a blend): their count varies from path to path, and dimensions would be spent on all.
///
/// SplitMix64, seeded by the sample's key alone: the same for any number of threads. Nothing is hashed before a number is
/// asked for.
#[derive(Clone, Debug)]
pub struct Coins {
    state: u64,
}

impl Coins {
    /// The coins of a seed.
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The next number, uniform in [0, 1).
    #[inline]
    pub fn flip(&mut self) -> f32 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        // Twice: states of one pixel's samples differ by multiples of one constant.
        unit((mix(mix(self.state)) >> 32) as u32)
    }
}

/// Finaliser of SplitMix64 (Steele, Lea, Flood 2014; Stafford's variant 13).
#[inline]
pub(crate) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A nested uniform scramble of bit-reversed values: each bit is flipped by a hash of the bits below it
/// (Laine, Karras 2011, with the constants of Vegdahl 2021, "Building a Better LK Hash").
#[inline]
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

/// The second dimension of Sobol's sequence, bits reversed: the product of the index with Pascal's matrix mod 2.
/// By Lucas' theorem C(c, r) is odd exactly when r's bits are among c's, so the product is a sum over supersets on
/// the 5-cube of bit positions, one step per axis (Ahmed 2024, "An Implementation Algorithm of 2D Sobol Sequence").
#[inline]
fn sobol_second(mut x: u32) -> u32 {
    x ^= (x >> 1) & 0x5555_5555;
    x ^= (x >> 2) & 0x3333_3333;
    x ^= (x >> 4) & 0x0f0f_0f0f;
    x ^= (x >> 8) & 0x00ff_00ff;
    x ^= (x >> 16) & 0x0000_ffff;
    x
}

/// The upper 24 bits as a number in [0, 1): never 1.
#[inline]
fn unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Direction numbers of Sobol's second dimension by their recurrence v_k = v_{k−1} ⊕ v_{k−1}/2.
    fn sobol_second_by_recurrence(index: u32) -> u32 {
        let (mut v, mut x) = (1u32 << 31, 0);
        for bit in 0..32 {
            if index >> bit & 1 == 1 {
                x ^= v;
            }
            v ^= v >> 1;
        }
        x
    }

    #[test]
    fn second_dimension_is_sobols() {
        for i in (0..1000).chain([0xdead_beef, u32::MAX, 1 << 31]) {
            assert_eq!(sobol_second(i).reverse_bits(), sobol_second_by_recurrence(i), "index {i}");
        }
    }

    #[test]
    fn every_prefix_of_a_power_of_two_is_a_net() {
        for dimension in [0, 7, 31] {
            for m in [4u32, 6, 10] {
                let n = 1u32 << m;
                let points: Vec<[f32; 2]> = (0..n)
                    .map(|i| {
                        let mut s = Sampler::new(SamplerKind::Sobol, 3, 12345, Stream::Camera, i);
                        s.set_dimension(dimension);
                        s.next_2d()
                    })
                    .collect();
                // Each of the 2ᵃ × 2ᵐ⁻ᵃ boxes holds exactly one point.
                for a in 0..=m {
                    let (w, h) = (1u32 << a, 1u32 << (m - a));
                    let mut seen = vec![false; n as usize];
                    for p in &points {
                        let cell = (p[0] * w as f32) as u32 + (p[1] * h as f32) as u32 * w;
                        assert!(!seen[cell as usize], "two points in one box: dim {dimension}, 2^{m}, a {a}");
                        seen[cell as usize] = true;
                    }
                }
            }
        }
    }

    #[test]
    fn dimensions_streams_pixels_and_seeds_are_uncorrelated() {
        let column = |kind, seed, pixel, stream, dimension| -> Vec<f64> {
            (0..4096)
                .map(|i| {
                    let mut s = Sampler::new(kind, seed, pixel, stream, i);
                    s.set_dimension(dimension);
                    f64::from(s.next_1d()) - 0.5
                })
                .collect()
        };
        for kind in [SamplerKind::Sobol, SamplerKind::Independent] {
            let columns = [
                column(kind, 0, 0, Stream::Camera, 0),
                column(kind, 0, 0, Stream::Camera, 1),
                column(kind, 0, 0, Stream::Light(0), 0),
                column(kind, 0, 0, Stream::Light(1), 0),
                column(kind, 0, 1, Stream::Camera, 0),
                column(kind, 1, 0, Stream::Camera, 0),
            ];
            for (i, a) in columns.iter().enumerate() {
                let mean = a.iter().sum::<f64>() / 4096.0;
                assert!(mean.abs() < 5.0 / (12.0f64 * 4096.0).sqrt(), "{kind:?} {i}: mean {mean}");
                for b in &columns[..i] {
                    let r = a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() * 12.0 / 4096.0;
                    assert!(r.abs() < 5.0 / 64.0, "{kind:?}: correlation {r}");
                }
            }
        }
    }
}

//! Russian roulette of visibility rays: what a ray may add decides, before it is traced, how likely it is to be traced.
//!
//! A contribution c that needs a ray is kept with the probability q = min(1, c/δ) and divided by it [Veach97, §10.4]. That
//! adds the variance c²(1/q − 1) and saves the ray with the probability 1 − q. With variance V and cost C of a whole sample
//! and cost r of a ray, V · C is least where c²/q² · C = V · r, that is at
//!
//! ```text
//! δ = √(V r / C)
//! ```
//!
//! Errors are relative to a pixel's brightness μ, V = mean of Var/(μ² + ε), so that δ of a pixel is √(μ² + ε) times that.
//! The brightness is that of blocks of pixels in a pilot (`integrator::auto`): a number that knows nothing of the samples
//! it decides about.

use super::auto::block;
use crate::math::Rgb;
use crate::planted::{Bug, planted};
use crate::sampling::{Coins, Sampler};

/// What a visibility ray must be able to add to a pixel to be traced for certain.
#[derive(Clone, Debug, PartialEq)]
pub struct Thresholds {
    /// Blocks in a row.
    columns: u32,
    /// 1/δ per block and channel.
    reciprocal: Vec<Rgb>,
}

impl Thresholds {
    /// By what brings √(μ² + ε) of each block (row-major, `columns` to a row) to 1, and δ of pixels of that brightness 1.
    pub fn new(columns: u32, scale: &[Rgb], delta: f32) -> Self {
        Self { columns, reciprocal: scale.iter().map(|s| *s / delta).collect() }
    }

    #[inline]
    fn at(&self, pixel: [u32; 2]) -> Rgb {
        self.reciprocal[block(pixel, self.columns, self.reciprocal.len())]
    }
}

/// The roulette of one subpath's visibility rays.
#[derive(Clone, Debug)]
pub struct RayRoulette {
    /// 1/δ of the pixel that contributions go to; `None` where all rays are traced.
    reciprocal: Option<Rgb>,
    coins: Coins,
}

impl RayRoulette {
    /// For a subpath with this sampler; all rays are traced until a pixel is turned to.
    #[inline]
    pub fn new(sampler: &Sampler) -> Self {
        Self { reciprocal: None, coins: sampler.more_coins() }
    }

    /// From here on contributions go to this pixel.
    #[inline]
    pub fn turn_to(&mut self, thresholds: Option<&Thresholds>, pixel: [u32; 2]) {
        self.reciprocal = thresholds.map(|t| t.at(pixel));
    }

    /// What to multiply `value` by: what `trace` finds over the probability of asking it, or 0 if it is not asked.
    #[inline]
    pub fn visible(&mut self, value: Rgb, trace: impl FnOnce() -> f32) -> f32 {
        let Some(reciprocal) = self.reciprocal else { return trace() };
        let worth = value * reciprocal;
        // Written so that a NaN in any channel is traced: the gate before the film has to see it.
        if worth.cmplt(Rgb::ONE).all() {
            let q = worth.max_element();
            let divisor = if planted(Bug::RayRouletteUncompensated) { 1.0 } else { q };
            return if self.coins.flip() < q { trace() / divisor } else { 0.0 };
        }
        trace()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{SamplerKind, Stream};

    /// What is kept makes up for what is not: below the threshold, at it and above, in every channel's own units.
    #[test]
    fn the_mean_stays() {
        // Two blocks, the second in a second row.
        let thresholds = Thresholds::new(1, &[Rgb::new(1.0, 2.0, 4.0), Rgb::splat(0.5)], 0.1);
        for (pixel, value, q) in [
            ([3, 3], Rgb::new(0.05, 0.0, 0.0), 0.5),
            ([0, 0], Rgb::new(0.001, 0.001, 0.005), 0.2),
            ([2, 1], Rgb::splat(3.0), 1.0),
            ([1, 9], Rgb::new(0.02, 0.06, 0.0), 0.3),
        ] {
            let (n, mut asked, mut sum) = (100_000_u32, 0, 0.0);
            for i in 0..n {
                let sampler = Sampler::new(SamplerKind::Sobol, 5, 7, Stream::Camera, i);
                let mut roulette = RayRoulette::new(&sampler);
                roulette.turn_to(Some(&thresholds), pixel);
                let visible = roulette.visible(value, || {
                    asked += 1;
                    0.75
                });
                sum += f64::from(visible);
            }
            let (asked, mean) = (f64::from(asked) / f64::from(n), sum / f64::from(n));
            // Five standard deviations of the share, and of the mean of what is 0.75/q with the probability q.
            let deviation = 5.0 * (q * (1.0 - q) / f64::from(n)).sqrt() + 1e-6;
            assert!((asked - q).abs() <= deviation, "{pixel:?} {value}: {asked} of the rays instead of {q}");
            assert!((mean - 0.75).abs() <= 0.75 / q * deviation, "{pixel:?} {value}: mean {mean}");
        }
    }

    #[test]
    fn without_thresholds_every_ray_is_traced_and_nan_always() {
        let mut roulette = RayRoulette::new(&Sampler::new(SamplerKind::Sobol, 5, 7, Stream::Camera, 0));
        assert_eq!(roulette.visible(Rgb::splat(1e-30), || 1.0), 1.0);
        let thresholds = Thresholds::new(1, &[Rgb::ONE], 1e30);
        roulette.turn_to(Some(&thresholds), [0, 0]);
        for channel in 0..3 {
            let mut value = Rgb::ZERO;
            value[channel] = f32::NAN;
            assert_eq!(roulette.visible(value, || 1.0), 1.0, "channel {channel}");
        }
        assert_eq!(roulette.visible(Rgb::ZERO, || 1.0), 0.0);
    }
}

//! Russian roulette.

use crate::math::Rgb;
use crate::planted::{Bug, planted};

/// Ends subpaths at random so that the survivors' throughput keeps the size it started with.
///
/// The probabilities stay out of every density: the MIS weights are functions of the path alone, whatever roulette it
/// went through, and still sum to one (`docs/MIS.md` §8). Radiance scaling by refraction is left out of the decision,
/// for it is undone on the way out of the medium.
///
/// The first few scatterings are free of it: ending paths at once costs more variance than it saves rays. On the
/// Cornell scenes efficiency per ray peaks near the values below (sweep 0…6, 16 spp: docs/PERFORMANCE.md).
#[derive(Clone, Copy, Debug)]
pub struct Roulette {
    enabled: bool,
    /// 1 / (initial throughput × accumulated η scale).
    reference: f32,
    /// Scatterings still free of roulette.
    free: u32,
}

impl Roulette {
    /// Scatterings free of roulette on a path tracer's paths.
    pub const FREE_PATH: u32 = 3;
    /// The same on either subpath of a bidirectional sample, which has other ways to make long paths.
    pub const FREE_SUBPATH: u32 = 2;

    /// For a subpath that starts with the throughput `beta`; its first `free` scatterings are survived for certain.
    #[inline]
    pub fn new(enabled: bool, beta: Rgb, free: u32) -> Self {
        let size = beta.max_element();
        Self { enabled: enabled && size > 0.0, reference: 1.0 / size, free }
    }

    /// Decides by one uniform number (drawn only when needed) whether the subpath goes on with throughput `beta`,
    /// after a scattering that scaled radiance by `eta_scale`; returns what to divide it by, or `None` at its end.
    #[inline]
    pub fn survive(&mut self, beta: Rgb, eta_scale: f32, u: impl FnOnce() -> f32) -> Option<f32> {
        if !self.enabled {
            return Some(1.0);
        }
        self.reference /= eta_scale;
        if self.free > 0 {
            self.free -= 1;
            return Some(1.0);
        }
        let q = beta.max_element() * self.reference;
        // Written so that a NaN survives: the gate before the film has to see it.
        if q >= 1.0 || q.is_nan() {
            return Some(if planted(Bug::RouletteAboveOne) { q } else { 1.0 });
        }
        (u() < q).then_some(if planted(Bug::RouletteUncompensated) { 1.0 } else { q })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P(survival) × 1/(what is divided by) is 1, whatever the throughput: also where it has grown, as by the adjoint
    /// factor of shading normals, and survival is certain.
    #[test]
    fn survivors_make_up_for_the_others() {
        let n = 1000;
        for (start, beta) in [(1.0, 0.1), (1.0, 0.5), (1.0, 1.0), (1.0, 3.0), (4.0, 1.0), (0.25, 1.0)] {
            let sum: f64 = (0..n)
                .filter_map(|i| {
                    let u = (i as f32 + 0.5) / n as f32;
                    Roulette::new(true, Rgb::splat(start), 0).survive(Rgb::splat(beta), 1.0, || u)
                })
                .map(|q| 1.0 / f64::from(q))
                .sum();
            assert!((sum / f64::from(n) - 1.0).abs() < 1e-6, "from {start} to {beta}: {}", sum / f64::from(n));
        }
    }

    /// What refraction does to radiance decides nothing.
    #[test]
    fn the_change_of_medium_is_left_out() {
        let mut roulette = Roulette::new(true, Rgb::ONE, 0);
        let q = roulette.survive(Rgb::splat(0.5 * 0.4), 0.4, || 0.0);
        assert!(q.is_some_and(|q| (q - 0.5).abs() < 1e-6), "{q:?}");
    }
}

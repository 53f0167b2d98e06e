//! Russian roulette.

use crate::math::Rgb;

/// Ends subpaths at random so that the survivors' throughput keeps the size it started with.
///
/// The probabilities stay out of every density: they cancel in the MIS weights of all techniques that share a
/// prefix, and weights without them still sum to one. Radiance scaling by refraction is left out of the decision,
/// for it is undone on the way out of the medium.
#[derive(Clone, Copy, Debug)]
pub struct Roulette {
    enabled: bool,
    /// 1 / (initial throughput × accumulated η scale).
    reference: f32,
}

impl Roulette {
    /// For a subpath that starts with the throughput `beta`.
    #[inline]
    pub fn new(enabled: bool, beta: Rgb) -> Self {
        let size = beta.max_element();
        Self { enabled: enabled && size > 0.0, reference: 1.0 / size }
    }

    /// Decides by one uniform number (drawn only when needed) whether the subpath goes on with throughput `beta`,
    /// after a scattering that scaled radiance by `eta_scale`; returns what to divide it by, or `None` at its end.
    #[inline]
    pub fn survive(&mut self, beta: Rgb, eta_scale: f32, u: impl FnOnce() -> f32) -> Option<f32> {
        if !self.enabled {
            return Some(1.0);
        }
        self.reference /= eta_scale;
        let q = beta.max_element() * self.reference;
        // Written so that a NaN survives: the gate before the film has to see it.
        if q >= 1.0 || q.is_nan() {
            return Some(1.0);
        }
        (u() < q).then_some(q)
    }
}

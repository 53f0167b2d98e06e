//! The rim of a spot that falls linearly in the angle.
//!
//! With τ the outer and β the inner half-angle, δ = τ − β, the light beyond the angle θ = τ − h is, per 2π and peak
//! intensity,
//!
//! ```text
//! R(h) = ∫_{τ−h}^τ (τ − x)/δ sin x dx = h/δ [cos(τ − h) − cos m sinc(h/2)],      m = τ − h/2
//!      = h/δ [sin m sin(h/2) − cos m (sinc(h/2) − cos(h/2))]
//! ```
//!
//! (by parts; the second form has no difference of nearly equal numbers: its first term is at least three times the
//! other). The whole rim is R(δ), and the flux is 2πI[(1 − cosβ) + R(δ)] = 2πI[1 − (sinτ − sinβ)/δ].

use std::f64::consts::PI;

use crate::math::Vec3;

/// Angles in radians, in f64: the solver's differences then vanish in the rounding of its f32 directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct AngleRim {
    /// τ.
    outer: f64,
    /// δ.
    width: f64,
    /// R(δ).
    share: f64,
}

/// Steps of the solver at the most: bisection alone would be down to the last bits then.
const MOST_STEPS: u32 = 48;

impl AngleRim {
    /// The rim between two half-angles in radians, `0 ≤ inner ≤ outer ≤ π`.
    pub fn new(inner: f64, outer: f64) -> Self {
        let rim = Self { outer, width: outer - inner, share: 0.0 };
        Self { share: if rim.width > 0.0 { rim.beyond(rim.width) } else { 0.0 }, ..rim }
    }

    /// R(δ), the rim's flux over 2π and the peak intensity.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// (τ − θ)/δ, held to [0, 1], for the angle θ between the unit vectors `w` and `axis`.
    pub fn attenuation(&self, w: Vec3, axis: Vec3) -> f32 {
        let left = self.outer - angle(w, axis);
        if left >= self.width { 1.0 } else { (left / self.width).max(0.0) as f32 }
    }

    /// `1 − cosθ` of the angle θ beyond which lies the fraction `q` of the rim's light: the inverse of R.
    pub fn versine_at(&self, q: f32) -> f32 {
        let s = (0.5 * (self.outer - self.left_at(f64::from(q) * self.share))).sin();
        (2.0 * s * s) as f32
    }

    fn beyond(&self, h: f64) -> f64 {
        let y = 0.5 * h;
        let (sin_m, cos_m) = (self.outer - y).sin_cos();
        h / self.width * (sin_m * y.sin() - cos_m * sinc_less_cos(y))
    }

    /// The h at which R(h) = `r`, by Newton's method held within a bracket: R grows all along, but its slope
    /// h/δ sin(τ − h) is zero at the outer edge and on the axis.
    fn left_at(&self, r: f64) -> f64 {
        if r <= 0.0 || r.is_nan() {
            return 0.0;
        }
        if r >= self.share {
            return self.width;
        }
        let (mut low, mut high) = (0.0, self.width);
        // As if sin were the same all over the rim.
        let mut h = self.width * (r / self.share).sqrt();
        for _ in 0..MOST_STEPS {
            let excess = self.beyond(h) - r;
            if excess > 0.0 {
                high = h
            } else {
                low = h
            }
            let newton = h - excess * self.width / (h * (self.outer - h).sin());
            // NaN is in no bracket; a step onto the bracket's end is a step onto the root, all but rounding.
            let next = if (low..=high).contains(&newton) { newton } else { 0.5 * (low + high) };
            let step = (next - h).abs();
            h = next;
            // Steps are squared from one to the next: what is left is far below f32's rounding.
            if step <= 1e-11 * self.width {
                break;
            }
        }
        h
    }
}

/// The angle between unit vectors, from the chord between them: good to its last digits near 0 and π, too.
fn angle(w: Vec3, axis: Vec3) -> f64 {
    let half = |chord: Vec3| (0.5 * f64::from(chord.length_squared()).sqrt()).min(1.0).asin();
    if w.dot(axis) >= 0.0 { 2.0 * half(w - axis) } else { PI - 2.0 * half(w + axis) }
}

/// `sin y / y − cos y` for y in [0, π/2].
fn sinc_less_cos(y: f64) -> f64 {
    if y > 0.5 {
        return y.sin() / y - y.cos();
    }
    // Σ (−1)^{k+1} 2k y^{2k}/(2k + 1)!, to 1e-11 of the first term.
    let z = y * y;
    z * (1.0 / 3.0 - z * (1.0 / 30.0 - z * (1.0 / 840.0 - z * (1.0 / 45_360.0 - z / 3_991_680.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cones in degrees: usual, full, narrow, nearly hard edges, wide.
    const CONES: [(f64, f64); 9] = [
        (20.0, 40.0),
        (0.0, 90.0),
        (0.0, 180.0),
        (90.0, 180.0),
        (1e-4, 2e-4),
        (0.0, 1e-5),
        (29.999, 30.0),
        (179.9, 180.0),
        (120.0, 170.0),
    ];

    fn rim((inner, outer): (f64, f64)) -> AngleRim {
        AngleRim::new(inner.to_radians(), outer.to_radians())
    }

    /// By composite Gauss-Legendre quadrature with two points, in which nothing cancels.
    fn integral(rim: &AngleRim, h: f64) -> f64 {
        let n = 2000;
        let step = h / f64::from(n);
        let at = |x: f64| x / rim.width * (rim.outer - x).sin();
        let middle = |i| (f64::from(i) + 0.5) * step;
        let offset = 0.5 * step / 3.0_f64.sqrt();
        (0..n).map(|i| at(middle(i) - offset) + at(middle(i) + offset)).sum::<f64>() * 0.5 * step
    }

    #[test]
    fn the_distribution_is_the_integral_of_the_attenuation() {
        for cone in CONES {
            let rim = rim(cone);
            for fraction in [1e-3, 0.1, 0.5, 0.9, 1.0] {
                let h = fraction * rim.width;
                let (got, want) = (rim.beyond(h), integral(&rim, h));
                assert!((got / want - 1.0).abs() < 1e-10, "{cone:?}, {fraction}: {got}, not {want}");
            }
        }
    }

    #[test]
    fn sampling_inverts_it_to_far_below_f32s_rounding() {
        for cone in CONES {
            let rim = rim(cone);
            for i in 0..=1000 {
                // Also the ends, closer than an f32 of the unit interval comes to 1.
                let q = [f64::from(i) / 1000.0, 2.0_f64.powi(-i / 30), 1.0 - 2.0_f64.powi(-i / 30)][i as usize % 3];
                let h = rim.left_at(q * rim.share);
                let (got, want) = (rim.beyond(h), q * rim.share);
                assert!((got - want).abs() <= 1e-11 * rim.share, "{cone:?}, {q}: {got}, not {want}");
            }
            assert_eq!((rim.left_at(0.0), rim.left_at(rim.share)), (0.0, rim.width));
        }
    }

    #[test]
    fn a_hard_edge_has_no_rim() {
        for degrees in [0.0, 30.0, 180.0] {
            let rim = rim((degrees, degrees));
            assert_eq!((rim.share(), rim.versine_at(0.5)), (0.0, rim.versine_at(0.0)));
        }
    }
}

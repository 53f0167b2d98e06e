//! Fresnel's formulas for dielectrics and conductors, and their hemispherical means.

use crate::math::Rgb;

/// Unpolarised Fresnel reflectance of a smooth interface and the cosine of the refracted direction (0 under total
/// reflection). `cos_o` is the cosine on the incident side, `eta` the index on the far side over the near one.
///
/// Exact at `eta = 1` (no reflection) and at grazing angles (all): the refracted cosine comes from
/// `η² − 1 + cos²` rather than from `1 − sin²/η²`, which cancels.
#[inline]
pub fn fresnel_dielectric(cos_o: f32, eta: f32) -> (f32, f32) {
    let cos_o = cos_o.clamp(0.0, 1.0);
    // g = η cosθt; g² = η² − 1 + cos²θo.
    let g2 = (eta - 1.0) * (eta + 1.0) + cos_o * cos_o;
    if g2 <= 0.0 {
        return (1.0, 0.0);
    }
    let g = g2.sqrt();
    let perpendicular = ((cos_o - g) / (cos_o + g)).powi(2);
    let e2 = eta * eta;
    let parallel = ((e2 * cos_o - g) / (e2 * cos_o + g)).powi(2);
    (0.5 * (perpendicular + parallel), g / eta)
}

/// Unpolarised Fresnel transmittance of a smooth interface, 1 less the reflectance, to the last digits also where that is
/// nearly 1: at high indices and at grazing angles. From the rarer side, `eta` ≥ 1; both sides let through the same.
#[inline]
pub fn fresnel_transmittance(cos_o: f32, eta: f32) -> f32 {
    let cos_o = cos_o.clamp(0.0, 1.0);
    debug_assert!(eta >= 1.0, "from the denser side, of index 1/{eta}, the root cancels");
    let g2 = (eta - 1.0) * (eta + 1.0) + cos_o * cos_o;
    if g2 <= 0.0 {
        return 0.0;
    }
    // 1 − ((a − b)/(a + b))² = 4ab/(a + b)².
    let (g, e2) = (g2.sqrt(), eta * eta);
    let (perpendicular, parallel) = (cos_o + g, e2 * cos_o + g);
    2.0 * cos_o * g * (1.0 / (perpendicular * perpendicular) + e2 / (parallel * parallel))
}

/// Unpolarised Fresnel reflectance of a conductor with the relative index `eta − i k` per channel
/// [PBRT4, §9.3.6], written with real numbers.
pub fn fresnel_conductor(cos_o: f32, eta: Rgb, k: Rgb) -> Rgb {
    let cos = cos_o.clamp(1e-6, 1.0);
    let (cc, ss) = (cos * cos, (1.0 - cos) * (1.0 + cos));
    // η² − k² − sin², without the cancellation at η = 1.
    let t0 = (eta - Rgb::ONE) * (eta + Rgb::ONE) - k * k + Rgb::splat(cc);
    // a² + b² and a of the complex refracted cosine a + ib, times the index.
    let a2_b2 = lanes(t0 * t0 + 4.0 * eta * eta * k * k, f32::sqrt);
    let a = lanes((0.5 * (a2_b2 + t0)).max(Rgb::ZERO), f32::sqrt);
    let (t1, t2) = (a2_b2 + Rgb::splat(cc), 2.0 * cos * a);
    let perpendicular = (t1 - t2) / (t1 + t2);
    let (t3, t4) = (cc * a2_b2 + Rgb::splat(ss * ss), ss * t2);
    let parallel = perpendicular * (t3 - t4) / (t3 + t4);
    0.5 * (perpendicular + parallel)
}

#[inline]
fn lanes(c: Rgb, f: impl Fn(f32) -> f32) -> Rgb {
    Rgb::new(f(c.x), f(c.y), f(c.z))
}

/// Schlick's approximation from the reflectance at normal incidence [Schlick94].
#[inline]
pub fn fresnel_schlick(cos_o: f32, normal: Rgb) -> Rgb {
    let c = (1.0 - cos_o).clamp(0.0, 1.0);
    let c2 = c * c;
    normal + (Rgb::ONE - normal) * (c2 * c2 * c)
}

/// Hemispherical reflectance `∫ F(θ) 2 cosθ sinθ dθ` of a dielectric for diffuse light from outside, `eta` ≥ 1 the
/// index inside over that outside, in closed form [Duntley42].
///
/// From inside it is `1 − (1 − F̄)/η²`, since what passes is the same from both sides [Veach97 (5.13)].
pub fn hemispherical_dielectric(eta: f64) -> f64 {
    // Near 1 the terms cancel to the cube of η − 1 and more; F̄ itself goes to zero as (η − 1)² ln(η − 1).
    if eta < 1.0 + 1e-3 {
        return simpson(eta);
    }
    let n = eta;
    let n2 = n * n;
    let n4 = n2 * n2;
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

/// The same by quadrature, for indices near 1. In x with cosθ = x⁴ the steep end at grazing angles is spread out.
fn simpson(eta: f64) -> f64 {
    let f = |x: f64| {
        let cos = x.powi(4);
        let g = ((eta - 1.0) * (eta + 1.0) + cos * cos).sqrt();
        if cos + g == 0.0 {
            return 0.0;
        }
        let s = ((cos - g) / (cos + g)).powi(2);
        let p = ((eta * eta * cos - g) / (eta * eta * cos + g)).powi(2);
        0.5 * (s + p) * 8.0 * x.powi(7)
    };
    let n = 256;
    let weight = |i: i32| if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    (0..=n).map(|i| weight(i) * f(f64::from(i) / f64::from(n))).sum::<f64>() / (3.0 * f64::from(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hemispherical reflectance ∫F(θ) 2 cosθ sinθ dθ by the midpoint rule in cos²θ.
    fn hemispherical(eta: f32) -> f64 {
        let n = 400_000;
        (0..n).map(|i| f64::from(fresnel_dielectric(((i as f32 + 0.5) / n as f32).sqrt(), eta).0)).sum::<f64>()
            / f64::from(n)
    }

    #[test]
    fn hemispherical_reflectance_of_glass() {
        assert!((hemispherical(1.5) - 0.09178).abs() < 1e-5, "{}", hemispherical(1.5));
        assert!((hemispherical(1.0 / 1.5) - 0.59635).abs() < 2e-5, "{}", hemispherical(1.0 / 1.5));
    }

    #[test]
    fn hemispherical_reflectance_in_closed_form() {
        for eta in [1.0005_f32, 1.01, 1.1, 1.33, 1.5, 2.4, 10.0] {
            let (closed, sum) = (hemispherical_dielectric(f64::from(eta)), hemispherical(eta));
            assert!((closed - sum).abs() < 2e-6 + 1e-4 * sum, "{eta}: {closed} {sum}");
        }
        assert_eq!(hemispherical_dielectric(1.0), 0.0);
        // Quadrature and closed form meet where the one takes over from the other.
        let (below, above) = (hemispherical_dielectric(1.000_999_999), hemispherical_dielectric(1.001_000_001));
        assert!((below / above - 1.0).abs() < 1e-4, "{below} {above}");
        // From inside: 1 − (1 − F̄)/η².
        assert!((1.0 - (1.0 - hemispherical_dielectric(1.5)) / 2.25 - 0.59635).abs() < 1e-5);
    }

    /// The same numbers by complex arithmetic: the textbook's r = (cosθ − η cosθt)/(cosθ + η cosθt) and its like.
    #[test]
    fn conductors_agree_with_complex_fresnel() {
        type C = [f64; 2];
        let mul = |a: C, b: C| [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
        let abs2 = |a: C| a[0] * a[0] + a[1] * a[1];
        let sqrt = |a: C| {
            let r = abs2(a).sqrt();
            [((r + a[0]) / 2.0).sqrt(), ((r - a[0]) / 2.0).max(0.0).sqrt().copysign(a[1])]
        };
        for (eta, k) in [(0.2, 3.9), (1.5, 0.0), (1.0, 0.0), (1.0, 2.0), (0.04, 5.0), (2.9, 3.1), (30.0, 90.0)] {
            for cos in [1.0_f64, 0.9, 0.5, 0.1, 0.01] {
                let n: C = [eta, -k];
                let n2 = mul(n, n);
                // n cosθt = √(n² − sin²).
                let g = sqrt([n2[0] - 1.0 + cos * cos, n2[1]]);
                let s = abs2([cos - g[0], -g[1]]) / abs2([cos + g[0], g[1]]);
                let c = [n2[0] * cos, n2[1] * cos];
                let p = abs2([c[0] - g[0], c[1] - g[1]]) / abs2([c[0] + g[0], c[1] + g[1]]);
                let f = fresnel_conductor(cos as f32, Rgb::splat(eta as f32), Rgb::splat(k as f32)).x;
                assert!((f64::from(f) - 0.5 * (s + p)).abs() < 3e-5, "{eta} {k} {cos}: {f} {}", 0.5 * (s + p));
            }
        }
    }

    #[test]
    fn schlick_meets_its_ends() {
        let f0 = Rgb::new(0.04, 0.5, 1.0);
        assert_eq!(fresnel_schlick(1.0, f0), f0);
        assert_eq!(fresnel_schlick(0.0, f0), Rgb::ONE);
    }

    #[test]
    fn a_pane_transmits_what_the_slab_formula_says() {
        for (degrees, want) in [(0.0f32, 0.923_077), (45.0, 0.904_327), (60.0, 0.836_232), (80.0, 0.441_229)] {
            let (f, _) = fresnel_dielectric(degrees.to_radians().cos(), 1.5);
            assert!(((1.0 - f) / (1.0 + f) - want).abs() < 2e-6, "{degrees}°");
        }
    }

    #[test]
    fn limits_are_exact() {
        assert_eq!(fresnel_dielectric(0.3, 1.0), (0.0, 0.3));
        assert_eq!(fresnel_dielectric(0.0, 1.5).0, 1.0);
        assert_eq!(fresnel_dielectric(0.5, 1.0 / 1.5), (1.0, 0.0));
        // Reciprocity: the same interface seen along the refracted ray.
        let (f, cos_t) = fresnel_dielectric(0.4, 1.7);
        let (back, cos_o) = fresnel_dielectric(cos_t, 1.0 / 1.7);
        assert!((f - back).abs() < 1e-6 && (cos_o - 0.4).abs() < 1e-6);
    }

    /// What is let through has all its digits, at grazing angles and up to indices at which next to nothing is.
    #[test]
    fn transmittance_does_not_cancel() {
        for eta in [1.0_f32, 1.0001, 1.5, 10.0, 1000.0] {
            for cos in [1e-6_f32, 1e-3, 0.05, 0.5, 0.9, 1.0] {
                let (c, e) = (f64::from(cos), f64::from(eta));
                let g = ((e - 1.0) * (e + 1.0) + c * c).max(0.0).sqrt();
                let share = |a: f64| 4.0 * a * g / (a + g).powi(2);
                let exact = if g > 0.0 { 0.5 * (share(c) + share(e * e * c)) } else { 0.0 };
                let t = f64::from(fresnel_transmittance(cos, eta));
                assert!((t - exact).abs() <= 2e-6 * exact, "η {eta}, cos {cos}: {t:e} instead of {exact:e}");
                let (r, _) = fresnel_dielectric(cos, eta);
                assert!((f64::from(r) + t - 1.0).abs() < 1e-5, "η {eta}, cos {cos}: {r} + {t}");
            }
        }
    }
}

//! Maps from the unit square to directions and points, with their densities.

use std::f32::consts::{FRAC_PI_4, PI};

use crate::math::Vec3;

/// The unit disk, area-preserving and continuous (Shirley, Chiu 1997).
#[inline]
pub fn concentric_disk(u: [f32; 2]) -> [f32; 2] {
    let (x, y) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    let wide = x.abs() > y.abs();
    let (long, short) = if wide { (x, y) } else { (y, x) };
    if long == 0.0 {
        return [0.0; 2];
    }
    let (sin, cos) = sin_cos_eighth(short / long);
    let (along, across) = (long * cos, long * sin);
    if wide { [along, across] } else { [across, along] }
}

/// Sine and cosine of π/4·t for |t| ≤ 1, to 1.2e-7: their Taylor series, of which the first terms left out are 1.8e-9 and
/// 1.2e-10. In plain arithmetic the result is the same whatever the machine's mathematical library, and takes half its time.
#[inline]
fn sin_cos_eighth(t: f32) -> (f32, f32) {
    let t2 = t * t;
    let sin = 3.133_616_7e-7_f32;
    let sin = sin * t2 - 3.657_620_4e-5;
    let sin = sin * t2 + 2.490_394_6e-3;
    let sin = sin * t2 - 8.074_551e-2;
    let sin = (sin * t2 + FRAC_PI_4) * t;
    let cos = -2.461_137e-8_f32;
    let cos = cos * t2 + 3.590_860_6e-6;
    let cos = cos * t2 - 3.259_919e-4;
    let cos = cos * t2 + 1.585_434_4e-2;
    let cos = cos * t2 - 3.084_251_4e-1;
    (sin, cos * t2 + 1.0)
}

/// A direction around +z with density `cosθ/π` per solid angle (Malley's method).
#[inline]
pub fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let [x, y] = concentric_disk(u);
    // 1 − x² − y² may round below zero at the rim; a direction of cosine zero carries nothing.
    Vec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// The density of `cosine_hemisphere` per solid angle.
#[inline]
pub fn cosine_hemisphere_pdf(cos: f32) -> f32 {
    cos.max(0.0) / PI
}

/// The unit sphere, uniformly: density 1/(4π) per solid angle, 1/(4π) per area.
#[inline]
pub fn uniform_sphere(u: [f32; 2]) -> Vec3 {
    direction_from_versine(2.0 * u[0], 2.0 * PI * u[1])
}

/// The direction at azimuth `phi` whose angle θ to +z has the versine `1 − cosθ`; near the pole the versine keeps
/// the digits that a cosine loses.
#[inline]
pub fn direction_from_versine(versine: f32, phi: f32) -> Vec3 {
    let sin = (versine * (2.0 - versine)).max(0.0).sqrt();
    let (s, c) = phi.sin_cos();
    Vec3::new(sin * c, sin * s, 1.0 - versine)
}

/// A visible normal of the microfacets of a GGX surface with the roughness `alpha` along x and y, seen from the unit
/// direction `wo` with `wo.z > 0`: density `D_wo(m) = G1(wo) max(0, wo·m) D(m) / wo.z` per solid angle of the normal.
///
/// Stretching the microsurface to a hemisphere, the visible normals are the half vectors of `wo` and a direction
/// uniform in a spherical cap (Dupuy, Benyoub 2023, listing 3). `None` where rounding leaves no normal.
#[inline]
pub fn ggx_visible_normal(alpha: [f32; 2], wo: Vec3, u: [f32; 2]) -> Option<Vec3> {
    let stretch = Vec3::new(alpha[0], alpha[1], 1.0);
    let seen = (wo * stretch).try_normalize()?;
    // The cap z > −seen.z, by its versine: near the pole the digits of small roughness are there.
    let cap = direction_from_versine(u[1] * (1.0 + seen.z), 2.0 * PI * u[0]);
    let m = (cap + seen) * stretch;
    Vec3::new(m.x, m.y, m.z.max(0.0)).try_normalize()
}

/// A microfacet normal of a Beckmann surface with the roughness `alpha` along x and y: density `D(m) m.z` per solid
/// angle (Walter et al. 2007, (28), (29)).
#[inline]
pub fn beckmann_normal(alpha: [f32; 2], u: [f32; 2]) -> Vec3 {
    // Slopes are normal deviates with the variance α²/2 along each axis.
    let radius = (-(-u[1]).ln_1p()).sqrt();
    let (sin, cos) = (2.0 * PI * u[0]).sin_cos();
    Vec3::new(alpha[0] * radius * cos, alpha[1] * radius * sin, 1.0).normalize()
}

/// A direction around +z with density `(n+1)/(2π) cosⁿθ` per solid angle of the hemisphere.
#[inline]
pub fn cosine_power(exponent: f32, u: [f32; 2]) -> Vec3 {
    // cosθ = (1 − u)^{1/(n+1)}, as its versine.
    direction_from_versine(-((-u[1]).ln_1p() / (exponent + 1.0)).exp_m1(), 2.0 * PI * u[0])
}

/// Barycentric weights of the second and third corner of a triangle, uniform in area
/// (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
#[inline]
pub fn uniform_triangle(u: [f32; 2]) -> [f32; 2] {
    if u[1] > u[0] {
        let x = 0.5 * u[0];
        [x, u[1] - x]
    } else {
        let y = 0.5 * u[1];
        [u[0] - y, y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: u32) -> impl Iterator<Item = [f32; 2]> {
        (0..n * n).map(move |i| [((i % n) as f32 + 0.5) / n as f32, ((i / n) as f32 + 0.5) / n as f32])
    }

    #[test]
    fn the_eighth_turn_is_sine_and_cosine() {
        let mut worst = 0.0_f64;
        for i in -100_000..=100_000 {
            let t = i as f32 / 100_000.0;
            let (sin, cos) = sin_cos_eighth(t);
            let (s, c) = (std::f64::consts::FRAC_PI_4 * f64::from(t)).sin_cos();
            worst = worst.max((f64::from(sin) - s).abs()).max((f64::from(cos) - c).abs());
        }
        assert!(worst < 1.2e-7, "{worst:e}");
    }

    #[test]
    fn moments_of_every_map_are_those_of_its_density() {
        let n = 512;
        let count = f64::from(n * n);
        let mean = |f: &dyn Fn([f32; 2]) -> f32| grid(n).map(|u| f64::from(f(u))).sum::<f64>() / count;
        // ∫cosθ·cosθ/π dω = 2/3; a uniform disk's r² averages 1/2; a uniform sphere's z² 1/3; a triangle's weights 1/3.
        assert!((mean(&|u| cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < 1e-4);
        assert!(
            (mean(&|u| {
                let [x, y] = concentric_disk(u);
                x * x + y * y
            }) - 0.5)
                .abs()
                < 1e-4
        );
        assert!(
            (mean(&|u| {
                let z = uniform_sphere(u).z;
                z * z
            }) - 1.0 / 3.0)
                .abs()
                < 1e-4
        );
        assert!(mean(&|u| uniform_sphere(u).x).abs() < 1e-4);
        assert!((mean(&|u| uniform_triangle(u)[0]) - 1.0 / 3.0).abs() < 1e-3);
        assert!((mean(&|u| uniform_triangle(u)[1]) - 1.0 / 3.0).abs() < 1e-3);
        // Second moment ∫b² = 1/6, which a map that is not uniform misses.
        assert!((mean(&|u| uniform_triangle(u)[0].powi(2)) - 1.0 / 6.0).abs() < 1e-3);
    }

    #[test]
    fn the_ends_of_the_unit_interval_are_harmless() {
        let last = 1.0 - f32::EPSILON / 2.0;
        for a in [0.0, last] {
            for b in [0.0, last] {
                let d = cosine_hemisphere([a, b]);
                assert!(d.is_finite() && (d.length() - 1.0).abs() < 1e-3 && d.z >= 0.0, "{d:?}");
                assert!((uniform_sphere([a, b]).length() - 1.0).abs() < 1e-5);
                for m in [beckmann_normal([1e-4, 0.5], [a, b]), cosine_power(0.0, [a, b]), cosine_power(1e6, [a, b])] {
                    assert!((m.length() - 1.0).abs() < 1e-5 && m.z >= 0.0, "{m:?}");
                }
                for wo in [Vec3::Z, Vec3::new(1.0, 0.0, 1.745e-5), Vec3::new(0.6, 0.0, 0.8)] {
                    for alpha in [[1e-4, 1e-4], [1e-4, 0.5], [1.0, 1.0]] {
                        // No normal is left where the cap's rim is exactly opposite to the view.
                        if let Some(m) = ggx_visible_normal(alpha, wo, [a, b]) {
                            assert!((m.length() - 1.0).abs() < 1e-5 && m.z >= 0.0, "{m:?}");
                        }
                    }
                }
                let [u, v] = uniform_triangle([a, b]);
                assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0);
            }
        }
    }
}

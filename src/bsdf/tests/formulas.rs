//! Values against the textbook's formulas in f64, written without the transformations that keep the code stable.

use std::f64::consts::PI;

use super::{conductor, direction, flat};
use crate::bsdf::microfacet::beckmann_lambda;
use crate::bsdf::{Bsdf, Distribution, Masking, Transport, fresnel_dielectric};
use crate::compare::stats::normal_cdf;
use crate::math::{DVec3, Rgb, Vec3};

/// D(m) [Walter07 (25), (33)], with two roughnesses.
fn d(distribution: Distribution, [ax, ay]: [f64; 2], m: DVec3) -> f64 {
    let tan2 = (m.x / ax).powi(2) / m.z.powi(2) + (m.y / ay).powi(2) / m.z.powi(2);
    let norm = 1.0 / (PI * ax * ay * m.z.powi(4));
    match distribution {
        Distribution::Ggx => norm / (1.0 + tan2).powi(2),
        Distribution::Beckmann => norm * (-tan2).exp(),
    }
}

/// Λ(w) [Heitz14].
fn lambda(distribution: Distribution, [ax, ay]: [f64; 2], w: DVec3) -> f64 {
    let tan = ((ax * w.x).powi(2) + (ay * w.y).powi(2)).sqrt() / w.z.abs();
    match distribution {
        Distribution::Ggx => 0.5 * ((1.0 + tan * tan).sqrt() - 1.0),
        Distribution::Beckmann => {
            let a = 1.0 / tan;
            let erfc = 2.0 * normal_cdf(-a * std::f64::consts::SQRT_2);
            0.5 * ((-a * a).exp() / (a * PI.sqrt()) - erfc)
        }
    }
}

fn close(a: f32, b: f64, what: &str) {
    assert!((f64::from(a) / b - 1.0).abs() < 5e-4, "{what}: {a}, not {b}");
}

const PAIRS: [(f32, f32, f32); 6] =
    [(0.1, 5.0, 1.0), (20.0, 40.0, 2.5), (60.0, 60.0, 3.0), (70.0, 20.0, 0.2), (85.0, 80.0, 3.1), (45.0, 10.0, 5.0)];

#[test]
fn conductors_are_d_g_over_four_cosines() {
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for masking in [Masking::HeightCorrelated, Masking::Separable] {
            for alpha in [[0.3_f32, 0.3], [0.2, 0.9], [1.0, 0.4]] {
                let bsdf = conductor(alpha, distribution, masking, false);
                let wide = alpha.map(f64::from);
                for (a, b, phi) in PAIRS {
                    let (wo, wi) = (direction(a, 0.4), direction(b, 0.4 + phi));
                    let v = bsdf.eval(&flat(), wo, wi, Transport::Radiance).expect("reflects");
                    let (o, i) = (wo.as_dvec3().normalize(), wi.as_dvec3().normalize());
                    let m = (o + i).normalize();
                    let (lo, li) = (lambda(distribution, wide, o), lambda(distribution, wide, i));
                    let g = match masking {
                        Masking::HeightCorrelated => 1.0 / (1.0 + lo + li),
                        Masking::Separable => 1.0 / (1.0 + lo) / (1.0 + li),
                    };
                    let d = d(distribution, wide, m);
                    close(v.f.x, d * g / (4.0 * o.z), "value");
                    let pdf = match distribution {
                        Distribution::Ggx => d / (1.0 + lo) / (4.0 * o.z),
                        Distribution::Beckmann => d * m.z / (4.0 * o.dot(m)),
                    };
                    close(v.pdf_fwd.0, pdf, "density");
                }
            }
        }
    }
}

/// [Walter07 (21)], radiance scaled by the square of the indices.
#[test]
fn rough_glass_refracts_by_the_formula() {
    for ior in [1.5_f32, 2.4, 0.8] {
        for alpha in [0.2_f32, 0.7] {
            let bsdf = Bsdf::dielectric(ior, Rgb::ONE, [alpha; 2]);
            for front in [true, false] {
                let eta = if front { f64::from(ior) } else { 1.0 / f64::from(ior) };
                let mut seen = 0;
                for (a, b, phi) in [(10.0, 175.0, 0.5), (50.0, 150.0, 3.0), (30.0, 160.0, 2.8), (75.0, 140.0, 3.2)] {
                    let side = |w: Vec3| if front { w } else { Vec3::new(w.x, w.y, -w.z) };
                    let (wo, wi) = (side(direction(a, 0.0)), side(direction(b, phi)));
                    let (o, i) = (side(wo).as_dvec3().normalize(), side(wi).as_dvec3().normalize());
                    let h = -(o + i * eta);
                    let m = (h * h.z.signum()).normalize();
                    let value = bsdf.eval(&flat(), wo, wi, Transport::Radiance);
                    if !(o.dot(m) > 0.0 && i.dot(m) < 0.0) {
                        assert!(value.is_none());
                        continue;
                    }
                    let wide = [f64::from(alpha); 2];
                    let g = |w: DVec3| 1.0 / (1.0 + lambda(Distribution::Ggx, wide, w));
                    let f = f64::from(fresnel_dielectric(o.dot(m) as f32, eta as f32).0);
                    if f > 0.999 {
                        continue;
                    }
                    let v = value.expect("refracts");
                    let below = (o.dot(m) + eta * i.dot(m)).powi(2);
                    let jacobian = eta * eta * i.dot(m).abs() / below;
                    let d = d(Distribution::Ggx, wide, m);
                    close(v.f.x, (1.0 - f) * d * g(o) * g(i) * o.dot(m) / o.z * jacobian / (eta * eta), "value");
                    close(v.pdf_fwd.0, (1.0 - f) * g(o) * d * o.dot(m) / o.z * jacobian, "density");
                    seen += 1;
                }
                assert!(seen >= 1, "{ior} {front}");
            }
        }
    }
}

#[test]
fn beckmann_masking_is_the_error_function() {
    for tan in [0.01_f32, 0.2, 0.3, 0.5, 1.0, 3.0, 20.0, 1e4] {
        let w = Vec3::new(tan, 0.0, 1.0).normalize();
        let (found, want) = (beckmann_lambda([1.0; 2], w), lambda(Distribution::Beckmann, [1.0; 2], w.as_dvec3()));
        assert!((f64::from(found) - want).abs() < 1e-4 * want + 1e-7, "{tan}: {found}, not {want}");
    }
}

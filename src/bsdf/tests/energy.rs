//! What models reflect in all: never more than arrives, and what is known in closed form.

use super::{LAST, conductor, direction, empirical, flat, plastic};
use crate::bsdf::{Bsdf, Distribution, Masking, Shape, Transport, fresnel_dielectric};
use crate::math::Rgb;

/// Mean weight over a grid of numbers, each with a lobe of its own. Importance, which η² leaves alone.
fn albedo_on(bsdf: &Bsdf, degrees: f32, [width, height]: [u32; 2]) -> f64 {
    let wo = direction(degrees, 0.7);
    let mut sum = 0.0;
    for k in 0..width * height {
        let u = [((k % width) as f32 + 0.5) / width as f32, ((k / width) as f32 + 0.5) / height as f32];
        // The golden ratio's multiples fill the interval evenly.
        let lobe = (f64::from(k) * 0.618_033_988_749_895).fract() as f32;
        if let Some(s) = bsdf.sample(&flat(), wo, lobe.min(LAST), u, Transport::Importance) {
            sum += f64::from(s.weight.x);
        }
    }
    sum / f64::from(width * height)
}

fn albedo(bsdf: &Bsdf, degrees: f32, n: u32) -> f64 {
    albedo_on(bsdf, degrees, [n, n])
}

/// A13: GGX with F = 1.
#[test]
fn ggx_albedos_are_those_of_the_table() {
    let (hc, sep) = (Masking::HeightCorrelated, Masking::Separable);
    for (alpha, degrees, masking, want) in [
        (1.0, 0.0, hc, 1.0 - std::f64::consts::LN_2),
        (1.0, 0.0, sep, 1.0 - std::f64::consts::LN_2),
        (0.5, 0.0, hc, 0.687_849),
        (0.5, 0.0, sep, 0.687_849),
        (0.25, 0.0, hc, 0.915_812),
        (0.1, 0.0, sep, 0.988_304),
        (1.0, 60.0, hc, 0.4507),
        (1.0, 60.0, sep, 0.4091),
        (0.5, 60.0, hc, 0.6983),
        (0.5, 60.0, sep, 0.6860),
        (0.25, 60.0, hc, 0.8573),
        (0.25, 60.0, sep, 0.8551),
        (1.0, 80.0, hc, 0.6682),
        (1.0, 80.0, sep, 0.5229),
        (0.5, 80.0, hc, 0.8053),
        (0.5, 80.0, sep, 0.7469),
    ] {
        // Narrow facets lose light within a thin slice of the second number.
        let found = albedo_on(&conductor([alpha; 2], Distribution::Ggx, masking, false), degrees, [100, 2500]);
        assert!((found - want).abs() < 1e-4, "α {alpha}, {degrees}°, {masking:?}: {found}, not {want}");
    }
}

/// White surfaces reflect at most what arrives.
#[test]
fn white_furnaces_never_gain() {
    let mut white = vec![];
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for masking in [Masking::HeightCorrelated, Masking::Separable] {
            for alpha in [[0.01; 2], [0.1; 2], [0.1, 0.7], [0.5; 2], [1.0; 2]] {
                white.push((conductor(alpha, distribution, masking, true), 1e-5));
            }
        }
    }
    for ior in [1.1, 1.5, 2.4, 1.0 / 1.5] {
        for alpha in [0.05, 0.3, 1.0] {
            white.push((Bsdf::dielectric(ior, Rgb::ONE, [alpha; 2]), 1e-5));
        }
    }
    for n in [0.0, 1.0, 10.0, 1000.0] {
        white.push((empirical(Shape::Phong { exponent: n }), 2e-3));
        white.push((empirical(Shape::BlinnPhong { exponent: n }), 2e-3));
    }
    for sigma in [0.0, 0.1, 0.22, 0.5, 1.5] {
        white.push((empirical(Shape::oren_nayar(sigma)), 1e-5));
    }
    for (bsdf, rounding) in white {
        for degrees in [0.0, 20.0, 45.0, 70.0, 85.0, 89.9, 120.0, 179.0] {
            let found = albedo(&bsdf, degrees, 64);
            assert!(found > 0.0 && found <= 1.0 + rounding, "{bsdf:?} at {degrees}°: {found}");
        }
    }
}

/// Coat and base together: E + ρ'(1 − E), so that a white plastic loses nothing, whatever the coat.
#[test]
fn plastics_conserve_energy() {
    for nonlinear in [false, true] {
        for (alpha, tolerance) in [(0.0, 1e-3), (0.05, 4e-3), (0.13, 4e-3), (0.3, 4e-3), (0.62, 4e-3), (1.0, 4e-3)] {
            for degrees in [0.0, 30.0, 60.0, 75.0, 85.0, 89.0] {
                let found = albedo(&plastic(Rgb::ONE, alpha, nonlinear), degrees, 300);
                assert!((found - 1.0).abs() < tolerance, "α {alpha} at {degrees}°: {found}");
            }
        }
    }
    // A smooth coat over grey: F + ρ'(1 − F), with ρ' = ρ(1 − F̄i)/(1 − ρ F̄i) when nonlinear, F̄i = 0.59635.
    for degrees in [0.0_f32, 60.0, 80.0] {
        let f = f64::from(fresnel_dielectric(degrees.to_radians().cos(), 1.5).0);
        for (nonlinear, base) in [(false, 0.5), (true, 0.5 * (1.0 - 0.596_35) / (1.0 - 0.5 * 0.596_35))] {
            let found = albedo(&plastic(Rgb::splat(0.5), 0.0, nonlinear), degrees, 300);
            assert!((found - (f + base * (1.0 - f))).abs() < 1e-3, "{degrees}° {nonlinear}: {found}");
        }
    }
}

/// A10: T = (1 − F)/(1 + F) and R = 1 − T, exactly, and nothing is bent.
#[test]
fn panes_are_slabs() {
    for (degrees, want) in [(0.0_f32, 0.923_077), (45.0, 0.904_327), (60.0, 0.836_232), (80.0, 0.441_229)] {
        for wo in [direction(degrees, 1.0), direction(180.0 - degrees, 1.0)] {
            let bsdf = Bsdf::ThinDielectric { ior: 1.5 };
            let through = bsdf.sample(&flat(), wo, LAST, [0.5; 2], Transport::Radiance).expect("transmits");
            assert!((through.pdf_fwd.0 - want).abs() < 2e-6 && through.wi == -wo && through.weight == Rgb::ONE);
            let mirrored = bsdf.sample(&flat(), wo, 0.0, [0.5; 2], Transport::Radiance).expect("reflects");
            assert!((mirrored.pdf_fwd.0 - (1.0 - want)).abs() < 2e-6 && mirrored.wi.z * wo.z > 0.0);
        }
    }
}

/// Albedos of the phenomenological models: Phong and Blinn–Phong reflect all at normal incidence, Oren–Nayar A + B G(θ)
/// with G = (sinθ(θ − sinθ cosθ) + ⅔ tanθ (1 − sin³θ))/π.
#[test]
fn phenomenological_models_reflect_what_their_formulas_integrate_to() {
    for n in [0.0, 3.0, 50.0] {
        for shape in [Shape::Phong { exponent: n }, Shape::BlinnPhong { exponent: n }] {
            let found = albedo(&empirical(shape), 0.0, 500);
            assert!((found - 1.0).abs() < 1e-3, "{shape:?}: {found}");
        }
    }
    for sigma in [0.2_f64, 0.5, 1.0] {
        let (a, b) =
            (1.0 - 0.5 * sigma.powi(2) / (sigma.powi(2) + 0.33), 0.45 * sigma.powi(2) / (sigma.powi(2) + 0.09));
        for degrees in [0.0_f64, 30.0, 60.0, 80.0] {
            let (t, s, c) = (degrees.to_radians(), degrees.to_radians().sin(), degrees.to_radians().cos());
            let g = (s * (t - s * c) + 2.0 / 3.0 * s / c * (1.0 - s.powi(3))) / std::f64::consts::PI;
            let want = (a + b * g) / (a + 0.5 * b).max(1.0);
            let found = albedo(&empirical(Shape::oren_nayar(sigma as f32)), degrees as f32, 300);
            assert!((found - want).abs() < 1e-4, "σ {sigma}, {degrees}°: {found}, not {want}");
        }
    }
}

/// A rough interface as it becomes smooth reflects what Fresnel says, from both sides.
#[test]
fn narrow_rough_glass_is_glass() {
    let bsdf = Bsdf::dielectric(1.5, Rgb::ONE, [2e-3; 2]);
    assert!(matches!(bsdf, Bsdf::RoughDielectric(_)));
    for degrees in [10.0_f32, 55.0, 75.0, 150.0, 130.0] {
        let cos = degrees.to_radians().cos();
        let (f, _) = fresnel_dielectric(cos.abs(), if cos > 0.0 { 1.5 } else { 1.0 / 1.5 });
        let (mut reflected, n) = (0.0, 40_000);
        for k in 0..n {
            let u = [(k as f64 * 0.754_877_666).fract() as f32, (k as f64 * 0.569_840_29).fract() as f32];
            let lobe = ((k as f64 + 0.5) * 0.618_033_988_749_895).fract() as f32;
            let s = bsdf.sample(&flat(), direction(degrees, 0.0), lobe, u, Transport::Radiance);
            if let Some(s) = s.filter(|s| (s.wi.z > 0.0) == (cos > 0.0)) {
                reflected += f64::from(s.weight.x);
            }
        }
        assert!((reflected / f64::from(n) - f64::from(f)).abs() < 2e-3, "{degrees}°: {}", reflected / f64::from(n));
    }
}

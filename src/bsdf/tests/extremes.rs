//! The ends of every range: sample numbers, roughness, angles, indices.

use super::{LAST, conductor, direction, empirical, flat, models, plastic, point, turned};
use crate::bsdf::{Bsdf, Distribution, Masking, Plastic, Reflectance, Shape, Transport};
use crate::math::{Rgb, Vec3};

fn extreme() -> Vec<(&'static str, Bsdf)> {
    use Distribution::{Beckmann, Ggx};
    use Masking::{HeightCorrelated, Separable};
    let mut all = models();
    all.extend([
        ("ggx 1e-4", conductor([1e-4; 2], Ggx, HeightCorrelated, true)),
        ("ggx 1e-4/.5", turned([1e-4, 0.5], 1.0)),
        ("ggx 1/1e-4", turned([1.0, 1e-4], 0.0)),
        ("ggx 0/1", turned([0.0, 1.0], 0.0)),
        ("beckmann 1e-4", conductor([1e-4; 2], Beckmann, Separable, true)),
        ("beckmann 1e-4/1", conductor([1e-4, 1.0], Beckmann, HeightCorrelated, true)),
        ("beckmann 1", conductor([1.0; 2], Beckmann, HeightCorrelated, true)),
        (
            "metal of no index",
            Bsdf::conductor(Reflectance::Index { eta: [1.0; 3], k: [0.0; 3] }, [0.1; 2], Ggx, Separable, true),
        ),
        (
            "dense metal",
            Bsdf::conductor(Reflectance::Index { eta: [1e-3; 3], k: [1e3; 3] }, [0.1; 2], Ggx, Separable, true),
        ),
        ("glass 2e-4", Bsdf::dielectric(1.5, Rgb::ONE, [2e-4; 2])),
        ("glass 2e-4/1", Bsdf::dielectric(1.5, Rgb::ONE, [2e-4, 1.0])),
        ("glass 1 of ior 1.0001", Bsdf::dielectric(1.0001, Rgb::ONE, [1.0; 2])),
        ("ior 1000", Bsdf::dielectric(1000.0, Rgb::ONE, [0.5; 2])),
        ("ior 1/1000", Bsdf::dielectric(1e-3, Rgb::ONE, [0.5; 2])),
        ("plastic 1e-4", plastic(Rgb::ONE, 1e-4, true)),
        ("plastic of ior 1", Bsdf::Plastic(Plastic::new(Rgb::ONE, 1.0, 0.5, true, true))),
        ("plastic of ior 1000", Bsdf::Plastic(Plastic::new(Rgb::ONE, 1000.0, 0.5, false, true))),
        ("black smooth plastic", plastic(Rgb::ZERO, 0.0, false)),
        ("pane of ior 1", Bsdf::ThinDielectric { ior: 1.0 }),
        ("phong 1e6", empirical(Shape::Phong { exponent: 1e6 })),
        ("blinn-phong 1e6", empirical(Shape::BlinnPhong { exponent: 1e6 })),
        ("oren-nayar π/2", empirical(Shape::oren_nayar(std::f32::consts::FRAC_PI_2))),
    ]);
    all
}

/// Samples at the ends of the unit interval, under grazing views and edge-on shading normals: finite, with densities
/// above zero, or none at all.
#[test]
fn every_sample_is_finite() {
    let ends = [0.0, f32::MIN_POSITIVE, 1e-7, 0.25, 0.5, 0.999_999, LAST];
    let points = [
        flat(),
        point(Vec3::Z, Vec3::new(1.0, 0.0, 1e-3).normalize()),
        point(Vec3::X, Vec3::new(1.0, 0.5, 0.0).normalize()),
    ];
    for (name, bsdf) in extreme() {
        let mut seen = 0;
        for at in &points {
            for degrees in [0.0, 30.0, 89.0, 89.999, 90.0, 90.001, 150.0, 180.0] {
                for phi in [0.0, 1.0, 4.0] {
                    let wo = direction(degrees, phi);
                    for (a, b, lobe) in ends.iter().flat_map(|a| ends.iter().flat_map(move |b| ends.map(|l| (a, b, l))))
                    {
                        for transport in [Transport::Radiance, Transport::Importance] {
                            let Some(s) = bsdf.sample(at, wo, lobe, [*a, *b], transport) else { continue };
                            assert!(s.weight.is_finite() && s.weight.min_element() >= 0.0, "{name} {wo}: {s:?}");
                            assert!((s.wi.length() - 1.0).abs() < 1e-5, "{name} {wo}: {s:?}");
                            assert!(s.pdf_fwd.0.is_finite() && s.pdf_fwd.0 > 0.0, "{name} {wo}: {s:?}");
                            assert!(s.pdf_rev.0.is_finite() && s.pdf_rev.0 >= 0.0, "{name} {wo}: {s:?}");
                            assert!(s.eta_scale.is_finite() && s.eta_scale > 0.0, "{name} {wo}: {s:?}");
                            seen += 1;
                        }
                    }
                }
            }
        }
        assert!(seen > 1000, "{name}: {seen}");
    }
}

/// Values between directions that graze the surface, coincide or oppose each other.
#[test]
fn every_value_is_finite() {
    for (name, bsdf) in extreme() {
        for a in [0.0, 45.0, 89.999, 90.0, 90.001, 135.0, 180.0] {
            for b in [0.0, 45.0, 89.999, 90.0, 90.001, 135.0, 180.0] {
                for phi in [0.0, 1e-4, 1.0, std::f32::consts::PI] {
                    let (wo, wi) = (direction(a, 0.0), direction(b, phi));
                    for transport in [Transport::Radiance, Transport::Importance] {
                        let Some(v) = bsdf.eval(&flat(), wo, wi, transport) else { continue };
                        let pdfs = [v.pdf_fwd.0, v.pdf_rev.0];
                        assert!(v.f.is_finite() && v.f.min_element() >= 0.0, "{name} {wo} {wi}: {v:?}");
                        assert!(pdfs.iter().all(|p| p.is_finite() && *p >= 0.0), "{name} {wo} {wi}: {v:?}");
                    }
                }
            }
        }
    }
}

/// At α = 1e-4 the weights are those of a mirror, from wherever it is seen, and the density still agrees with itself.
#[test]
fn narrow_lobes_are_mirrors() {
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        let bsdf = conductor([1e-4; 2], distribution, Masking::HeightCorrelated, false);
        for degrees in [0.0, 30.0, 60.0, 85.0] {
            let wo = direction(degrees, 0.3);
            for k in 0..100 {
                let u = [(k as f32 * 0.618).fract(), (k as f32 + 0.5) / 101.0];
                let s = bsdf.sample(&flat(), wo, 0.5, u, Transport::Radiance).expect("reflects");
                let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
                assert!((s.weight.x - 1.0).abs() < 5e-3 && (s.wi - mirror).length() < 5e-3, "{s:?}");
                let v = bsdf.eval(&flat(), wo, s.wi, Transport::Radiance).expect("reflects");
                assert!((v.pdf_fwd.0 / s.pdf_fwd.0 - 1.0).abs() < 0.02, "{degrees}°: {s:?} {v:?}");
            }
        }
    }
}

#[test]
fn what_cannot_be_told_from_smooth_is_smooth() {
    let metal = |alpha| conductor(alpha, Distribution::Ggx, Masking::Separable, true);
    assert!(matches!(metal([0.0; 2]), Bsdf::SmoothConductor { .. }));
    assert!(matches!(metal([9e-5; 2]), Bsdf::SmoothConductor { .. }));
    assert!(matches!(metal([1e-4; 2]), Bsdf::Conductor(_)));
    let glass = |ior, alpha| Bsdf::dielectric(ior, Rgb::ONE, [alpha; 2]);
    assert!(matches!(glass(1.5, 0.0), Bsdf::Dielectric { .. }));
    assert!(matches!(glass(1.5, 1e-4), Bsdf::RoughDielectric(_)));
    for ior in [1.0, 1.0 + 1e-6, 1.0 - 1e-6] {
        assert!(matches!(glass(ior, 0.5), Bsdf::Dielectric { .. }));
    }
    assert!(plastic(Rgb::ONE, 0.0, false).has_delta_lobe() && plastic(Rgb::ONE, 0.0, false).is_connectible());
    assert!(!plastic(Rgb::ONE, 0.1, false).has_delta_lobe());
}

/// Vertices hold a `Bsdf` each.
#[test]
fn a_bsdf_stays_small() {
    assert!(size_of::<Bsdf>() <= 48, "{}", size_of::<Bsdf>());
}

/// Where `chooses_lobe` says no, the integrators draw no number: `sample` must not look at it. Where it says yes, it does.
#[test]
fn lobes_are_chosen_where_it_is_said() {
    let mut choosing = 0;
    for (name, bsdf) in extreme().into_iter().chain(models()) {
        let mut differs = false;
        for degrees in [0.0, 20.0, 60.0, 80.0] {
            for u in [[0.2, 0.3], [0.7, 0.1], [0.5, 0.9]] {
                let sample = |lobe| {
                    let s = bsdf.sample(&flat(), direction(degrees, 0.4), lobe, u, Transport::Radiance);
                    s.map(|s| (s.wi.to_array().map(f32::to_bits), s.weight.to_array().map(f32::to_bits), s.delta))
                };
                differs |= sample(0.0) != sample(LAST);
            }
        }
        assert!(bsdf.chooses_lobe() || !differs, "{name}: a lobe is chosen by a number that is not drawn");
        choosing += u32::from(differs);
    }
    assert!(choosing > 10, "only {choosing} models choose");
}

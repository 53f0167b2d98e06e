//! Reciprocity, the two quantities carried, sides and delta lobes.

use super::{conductor, direction, flat, models, numbers, plastic, point, turned};
use crate::bsdf::{Bsdf, Distribution, Masking, Reflectance, Transport};
use crate::math::{Rgb, Vec3};
use crate::sampling::warp::uniform_sphere;

/// The index on the side of a direction.
fn index(bsdf: &Bsdf, at_ng: Vec3, w: Vec3) -> f32 {
    match bsdf {
        Bsdf::RoughDielectric(b) if w.dot(at_ng) < 0.0 => b.ior,
        _ => 1.0,
    }
}

/// B4: f(wo, wi) n_i² = f(wi, wo) n_o², zero for zero; importance is radiance the other way round, the cosines of
/// adjoint BSDFs included; the reverse density is the forward one of the reversed pair.
#[test]
fn reciprocity_of_values_densities_and_transports() {
    let normals = [
        (Vec3::Z, Vec3::Z),
        (Vec3::Z, Vec3::new(0.4, 0.1, 1.0).normalize()),
        (direction(70.0, 2.0), direction(50.0, 1.6)),
    ];
    for (name, bsdf) in models() {
        let mut seen = [0; 2];
        for i in 0..6000 {
            let (ng, ns) = normals[i as usize % normals.len()];
            let at = point(ng, ns);
            let mut u = numbers(9, i);
            let (wo, wi) = (uniform_sphere(u.next_2d()), uniform_sphere(u.next_2d()));
            if [wo, wi].iter().any(|w| w.dot(ng).abs() < 1e-3 || w.dot(ns).abs() < 1e-3) {
                continue;
            }
            let eval = |a, b, transport| bsdf.eval(&at, a, b, transport);
            let there = eval(wo, wi, Transport::Radiance);
            let back = eval(wi, wo, Transport::Radiance);
            let importance = eval(wo, wi, Transport::Importance);
            assert_eq!((there.is_some(), importance.is_some()), (back.is_some(), back.is_some()), "{name} {wo} {wi}");
            let (Some(there), Some(back), Some(importance)) = (there, back, importance) else { continue };
            let side = usize::from(wo.dot(ng) * wi.dot(ng) < 0.0);
            let close = |a: Rgb, b: Rgb, what: &str| {
                let off = (a - b).abs().max_element();
                assert!(off <= 1e-3 * b.max_element() + 1e-30, "{name} {what}: {a} {b} at {wo} {wi}");
            };
            let (no, ni) = (index(&bsdf, ng, wo), index(&bsdf, ng, wi));
            close(there.f / wi.dot(ns).abs() * (ni * ni), back.f / wo.dot(ns).abs() * (no * no), "is not reciprocal");
            close(importance.f * wo.dot(ng).abs(), back.f * wi.dot(ng).abs(), "differs between transports");
            for (a, b) in [
                (there.pdf_rev.0, back.pdf_fwd.0),
                (there.pdf_fwd.0, back.pdf_rev.0),
                (importance.pdf_fwd.0, there.pdf_fwd.0),
                (importance.pdf_rev.0, there.pdf_rev.0),
            ] {
                close(Rgb::splat(a), Rgb::splat(b), "densities");
            }
            seen[side] += 1;
        }
        let transmits = matches!(bsdf, Bsdf::RoughDielectric(_));
        assert!(seen[0] > 300 && (seen[1] > 100) == transmits, "{name}: {seen:?}");
    }
}

/// Delta lobes lead back where they came from, with the same weight and probability.
#[test]
fn delta_lobes_are_reversible() {
    let metal = Reflectance::Index { eta: [0.2, 0.9, 1.4], k: [3.9, 2.4, 1.6] };
    for (name, bsdf) in [
        ("smooth metal", Bsdf::SmoothConductor { reflectance: metal, two_sided: true }),
        ("pane", Bsdf::ThinDielectric { ior: 1.5 }),
        ("smooth plastic", plastic(Rgb::splat(0.5), 0.0, false)),
    ] {
        let mut seen = 0;
        for i in 0..500 {
            let at = if i % 2 == 0 { flat() } else { point(Vec3::Z, Vec3::new(0.2, 0.1, 1.0).normalize()) };
            let mut u = numbers(3, i);
            let wo = uniform_sphere(u.next_2d());
            let (uv, lobe) = (u.next_2d(), u.next_1d());
            let Some(s) = bsdf.sample(&at, wo, lobe, uv, Transport::Radiance) else { continue };
            if !s.delta || wo.dot(at.ns).abs() < 0.01 {
                continue;
            }
            let importance = bsdf.sample(&at, wo, lobe, uv, Transport::Importance).expect("the same lobe");
            // The lobe's probability is the same from the other end, but for rounding.
            let lobe = if s.wi.dot(at.ng) * wo.dot(at.ng) > 0.0 { 0.0 } else { super::LAST };
            let back = bsdf.sample(&at, s.wi, lobe, uv, Transport::Radiance).expect("a way back");
            assert!((back.wi - wo).length() < 1e-5 && back.delta, "{name}: {wo} → {} → {}", s.wi, back.wi);
            assert!((s.pdf_rev.0 / back.pdf_fwd.0 - 1.0).abs() < 1e-3, "{name}");
            assert!((s.pdf_fwd.0 / back.pdf_rev.0 - 1.0).abs() < 1e-3, "{name}");
            assert!((s.weight - back.weight).abs().max_element() < 1e-3, "{name}");
            let adjoint = back.weight * (s.wi.dot(at.ng) / wo.dot(at.ng)).abs();
            assert!((importance.weight - adjoint).abs().max_element() < 1e-3, "{name}: {importance:?} {adjoint}");
            seen += 1;
        }
        assert!(seen > 30, "{name}: {seen}");
    }
}

#[test]
fn one_sided_models_have_one_side() {
    let (front, back) = (direction(30.0, 1.0), direction(150.0, 2.0));
    for two_sided in [false, true] {
        let smooth = Bsdf::SmoothConductor { reflectance: Reflectance::Constant([1.0; 3]), two_sided };
        let rough = conductor([0.5; 2], Distribution::Ggx, Masking::Separable, two_sided);
        for bsdf in [smooth, rough] {
            for (wo, scatters) in [(front, true), (back, two_sided)] {
                let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
                let s = bsdf.sample(&flat(), wo, 0.5, [0.1, 0.2], Transport::Radiance);
                assert_eq!(s.is_some(), scatters, "{bsdf:?} {wo}");
                if bsdf.is_connectible() {
                    let v = bsdf.eval(&flat(), wo, mirror, Transport::Radiance);
                    assert_eq!(v.is_some(), scatters, "{bsdf:?} {wo}");
                }
            }
        }
    }
}

/// The tangent turns the lobes: a quarter turn exchanges the two roughnesses.
#[test]
fn the_tangent_turns_anisotropy() {
    let (wo, wi) = (direction(40.0, 0.4), direction(30.0, 2.5));
    let f = |bsdf: Bsdf| bsdf.eval(&flat(), wo, wi, Transport::Radiance).map(|v| v.f.x).unwrap_or_default();
    let quarter = f(turned([0.2, 0.5], std::f32::consts::FRAC_PI_2));
    assert!((f(turned([0.5, 0.2], 0.0)) / quarter - 1.0).abs() < 1e-4);
    assert!((f(turned([0.2, 0.5], 0.0)) / quarter - 1.0).abs() > 0.1);
    // The back has the same tangent: the mirror image of both directions gives the same value.
    let down = |w: Vec3| Vec3::new(w.x, w.y, -w.z);
    let behind = turned([0.2, 0.5], 0.3).eval(&flat(), down(wo), down(wi), Transport::Radiance).expect("two-sided").f.x;
    assert!((f(turned([0.2, 0.5], 0.3)) / behind - 1.0).abs() < 1e-5);
}

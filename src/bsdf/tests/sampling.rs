//! Samples follow the densities, and the densities that come with samples are those of evaluation.

use std::f32::consts::PI;

use super::{direction, flat, models, numbers, point};
use crate::bsdf::{Bsdf, Transport};
use crate::compare::stats::{chi_squared_p, sidak};
use crate::geometry::SurfacePoint;
use crate::math::Vec3;

/// Bins of θ over the whole sphere and of φ.
const ROWS: usize = 24;
const COLUMNS: usize = 16;
/// Points along each side of a bin.
const POINTS: usize = 20;

/// The probability of each bin, by the midpoint rule.
fn expected(bsdf: &Bsdf, at: &SurfacePoint, wo: Vec3) -> Vec<f64> {
    let (rows, columns) = (ROWS * POINTS, COLUMNS * POINTS);
    let cell = f64::from(PI) / rows as f64 * 2.0 * f64::from(PI) / columns as f64;
    let mut bins = vec![0.0; ROWS * COLUMNS];
    for i in 0..rows {
        let (r, z) = (PI * (i as f32 + 0.5) / rows as f32).sin_cos();
        for j in 0..columns {
            let (s, c) = (2.0 * PI * (j as f32 + 0.5) / columns as f32).sin_cos();
            if let Some(value) = bsdf.eval(at, wo, Vec3::new(r * c, r * s, z), Transport::Radiance) {
                bins[i / POINTS * COLUMNS + j / POINTS] += f64::from(value.pdf_fwd.0) * cell * f64::from(r);
            }
        }
    }
    bins
}

fn bin(w: Vec3) -> usize {
    let row = ((w.x.hypot(w.y).atan2(w.z) / PI * ROWS as f32) as usize).min(ROWS - 1);
    let turn = (w.y.atan2(w.x) / (2.0 * PI)).rem_euclid(1.0);
    row * COLUMNS + ((turn * COLUMNS as f32) as usize).min(COLUMNS - 1)
}

/// B1, B3: counts follow the integrals of `eval`'s density over the bins, and what was not sampled (absorbed, or a
/// delta lobe) is what the density lacks to 1.
#[test]
fn samples_follow_the_density() {
    let models = models();
    let angles = [direction(8.0, 0.3), direction(50.0, 2.0), direction(78.0, -1.0), direction(130.0, 0.5)];
    let level = sidak(0.01, (models.len() * angles.len()) as u64);
    let n = 60_000;
    let mut tested = 0;
    for (seed, (name, bsdf)) in models.iter().enumerate() {
        for wo in angles {
            let at = flat();
            let mut expected = expected(bsdf, &at, wo);
            let total: f64 = expected.iter().sum();
            assert!(total < 1.0 + 2e-3, "{name} {wo}: the density integrates to {total}");
            expected.push((1.0 - total).max(0.0));
            let mut counts = vec![0.0; ROWS * COLUMNS + 1];
            for i in 0..n {
                let mut u = numbers(seed as u64, i);
                let (uv, lobe) = (u.next_2d(), u.next_1d());
                match bsdf.sample(&at, wo, lobe, uv, Transport::Radiance) {
                    Some(s) if !s.delta => counts[bin(s.wi)] += 1.0,
                    _ => counts[ROWS * COLUMNS] += 1.0,
                }
            }
            // Bins of small expectation are pooled.
            let (mut statistic, mut used, mut pool) = (0.0, 0, (0.0, 0.0));
            for (count, p) in counts.iter().zip(&expected) {
                let e = p * f64::from(n);
                if e < 8.0 {
                    pool = (pool.0 + count, pool.1 + e);
                } else {
                    statistic += (count - e) * (count - e) / e;
                    used += 1;
                }
            }
            if pool.1 > 8.0 {
                statistic += (pool.0 - pool.1) * (pool.0 - pool.1) / pool.1;
                used += 1;
            } else {
                assert!(pool.0 < pool.1 + 20.0, "{name} {wo}: {} samples where {} are expected", pool.0, pool.1);
            }
            if used < 2 {
                // Nothing scatters: the back of a one-sided model.
                assert_eq!(counts[ROWS * COLUMNS], f64::from(n), "{name} {wo}");
                continue;
            }
            let p = chi_squared_p(statistic, f64::from(used - 1));
            assert!(p > level, "{name} seen from {wo}: χ² {statistic:.1} of {} bins, p = {p:.1e}", used);
            tested += 1;
        }
    }
    assert!(tested > 80, "{tested}");
}

/// Where nothing is lost below the horizon, the density integrates to 1.
#[test]
fn densities_without_loss_integrate_to_one() {
    for (name, bsdf) in models() {
        if !["lambertian", "oren-nayar"].contains(&name) {
            continue;
        }
        for degrees in [0.0, 60.0, 89.0, 120.0] {
            let total: f64 = expected(&bsdf, &flat(), direction(degrees, 1.0)).iter().sum();
            assert!((total - 1.0).abs() < 1e-3, "{name} at {degrees}°: {total}");
        }
    }
}

/// B2: density, reverse density and weight of a sample are those that `eval` finds for its direction; with shading
/// normals, for both quantities carried.
#[test]
fn samples_agree_with_evaluation() {
    let tilted = point(Vec3::Z, Vec3::new(0.3, -0.2, 1.0).normalize());
    for (name, bsdf) in models() {
        let mut seen = 0;
        for i in 0..4000 {
            let mut u = numbers(5, i);
            let at = if i % 2 == 0 { flat() } else { tilted };
            let transport = if i % 4 < 2 { Transport::Radiance } else { Transport::Importance };
            let wo = crate::sampling::warp::uniform_sphere(u.next_2d());
            // Grazing views lose digits with the cosine.
            if wo.z.abs() < 0.02 || wo.dot(at.ns).abs() < 0.02 {
                continue;
            }
            let (uv, lobe) = (u.next_2d(), u.next_1d());
            let Some(s) = bsdf.sample(&at, wo, lobe, uv, transport).filter(|s| !s.delta) else { continue };
            assert!((s.wi.length() - 1.0).abs() < 1e-5, "{name}");
            if s.wi.dot(at.ns).abs() < 0.02 {
                continue;
            }
            let v = bsdf.eval(&at, wo, s.wi, transport).unwrap_or_else(|| panic!("{name}: sampled, but zero: {s:?}"));
            for (sampled, evaluated) in [(s.pdf_fwd.0, v.pdf_fwd.0), (s.pdf_rev.0, v.pdf_rev.0)] {
                assert!((sampled / evaluated - 1.0).abs() < 5e-4, "{name} {wo}: {sampled} {evaluated}: {s:?}");
            }
            let off = (s.weight * v.pdf_fwd.0 - v.f).abs().max_element();
            assert!(off < 5e-4 * v.f.max_element(), "{name}: {} {:?}", s.weight * v.pdf_fwd.0, v.f);
            seen += 1;
        }
        assert!(seen > 600, "{name}: {seen}");
    }
}

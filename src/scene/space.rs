//! Render space: where its origin lies in the world, and how large its unit is.
//!
//! f32 knows a place to 2⁻²⁴ of its distance from the origin. In the middle of the scene's bounds one small object far away
//! would take the digits of all the others. So the surfaces vote. Each draws the origin toward the box that it fills, along
//! each axis alone, with the angle that its rounding would be off by as the camera sees it: to minimise
//! Σ w · (distance of the origin from the box), with w = (solid angle, about) / (distance from the camera), is to take the
//! weighted median of the boxes' ends. A lone far object has a weight that falls with the cube of its distance, and a huge one
//! around the others, whose box holds them, draws nowhere. The origin is the middle of the bounds, brought to within two
//! spreads of that median: scenes without far objects keep the middle.

use super::desc::{Diagnostic, SceneDesc, ShapeDesc, SurfaceDesc};
use crate::math::DVec3;

/// Where render space lies in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Space {
    /// Its origin, world units.
    pub center: DVec3,
    /// Its units per world unit: the power of two that brings the largest coordinate into [½, 1).
    pub scale: f64,
    /// The spread of what the camera is among, render units: of order 1, but where there is something far away.
    pub near: f64,
}

/// Most triangles that vote: of more, each of so many votes for as many.
const VOTERS: usize = 1 << 16;

/// How many spreads the origin may be off the median.
const SPREADS: f64 = 2.0;

/// The box of a surface or of one of its triangles, with its weight.
struct Vote {
    lo: DVec3,
    hi: DVec3,
    weight: f64,
}

impl Vote {
    /// The vote of what has these points, seen from `eye`.
    fn new(points: impl Iterator<Item = DVec3>, eye: DVec3, times: f64) -> Self {
        let (lo, hi) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
        let half = 0.5 * (hi - lo).length();
        let distance = (0.5 * (lo + hi) - eye).length() + half;
        let weight = if half > 0.0 { times * (half / distance) * (half / distance) / distance } else { 0.0 };
        Self { lo, hi, weight }
    }
}

/// The value below which `share` of the weight lies; between two, their middle.
fn quantile(values: &mut [(f64, f64)], share: f64) -> f64 {
    values.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let wanted = share * values.iter().map(|v| v.1).sum::<f64>();
    let mut below = 0.0;
    for (i, (value, weight)) in values.iter().enumerate() {
        below += weight;
        if below == wanted {
            return 0.5 * (value + values.get(i + 1).map_or(*value, |next| next.0));
        }
        if below > wanted {
            return *value;
        }
    }
    values.last().map_or(0.0, |v| v.0)
}

/// The median of the votes, and how far they spread about it along the axis along which they spread most.
fn median(votes: &[Vote]) -> Option<(DVec3, f64)> {
    let votes: Vec<&Vote> = votes.iter().filter(|v| v.weight > 0.0 && v.weight.is_finite()).collect();
    if votes.is_empty() {
        return None;
    }
    let (mut at, mut spread) = (DVec3::ZERO, 0.0_f64);
    for axis in 0..3 {
        let mut ends: Vec<(f64, f64)> =
            votes.iter().flat_map(|v| [(v.lo[axis], v.weight), (v.hi[axis], v.weight)]).collect();
        let middle = quantile(&mut ends, 0.5);
        ends.iter_mut().for_each(|end| end.0 = (end.0 - middle).abs());
        at[axis] = middle;
        // Not half of them: the ends of a single box are both at hand.
        spread = spread.max(quantile(&mut ends, 0.75));
    }
    Some((at, spread))
}

/// The points that a surface reaches to, world space.
fn points(surface: &SurfaceDesc) -> Vec<DVec3> {
    let local = match &surface.shape {
        ShapeDesc::Quad { size: [w, h] } => {
            let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
            corners.map(|(x, y)| DVec3::new(x * w, y * h, 0.0)).to_vec()
        }
        ShapeDesc::Sphere { radius } | ShapeDesc::Disk { radius } => {
            DVec3::AXES.iter().flat_map(|axis| [*axis * *radius, *axis * -*radius]).collect()
        }
        ShapeDesc::DeltaPoint => vec![DVec3::ZERO],
        // Not to be copied.
        ShapeDesc::Mesh(_) => Vec::new(),
    };
    local.into_iter().map(|p| surface.transform.transform_point3(p)).collect()
}

/// What render space is to be; coordinates out of range become errors.
pub(super) fn space(desc: &SceneDesc, errors: &mut Vec<Diagnostic>) -> Space {
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut grow = |surface: &SurfaceDesc, p: DVec3| {
        // Beyond this, squares of distances leave f32 even after scaling.
        if !p.is_finite() || p.abs().max_element() >= 1e30 {
            if errors.last().is_none_or(|e: &Diagnostic| e.at != surface.at) {
                errors.push(Diagnostic {
                    at: surface.at.clone(),
                    message: format!("the transform carries a point to {p}: coordinates must stay below 1e30"),
                });
            }
            return;
        }
        lo = lo.min(p);
        hi = hi.max(p);
    };
    let eye = desc.camera.transform.translation;
    let triangles = |s: &SurfaceDesc| if let ShapeDesc::Mesh(mesh) = &s.shape { mesh.triangles.len() } else { 0 };
    let step = desc.surfaces.iter().map(triangles).sum::<usize>().div_ceil(VOTERS).max(1);
    let mut votes = Vec::new();
    for surface in &desc.surfaces {
        if let ShapeDesc::Mesh(mesh) = &surface.shape {
            let world = |p: &[f32; 3]| surface.transform.transform_point3(DVec3::from(p.map(f64::from)));
            for p in &mesh.positions {
                grow(surface, world(p));
            }
            for triangle in mesh.triangles.iter().step_by(step) {
                let corners = triangle.iter().filter_map(|i| mesh.positions.get(*i as usize)).map(world);
                votes.push(Vote::new(corners, eye, step as f64));
            }
        } else {
            let points = points(surface);
            points.iter().for_each(|p| grow(surface, *p));
            votes.push(Vote::new(points.into_iter(), eye, 1.0));
        }
    }
    if lo.x > hi.x {
        return Space { center: eye, scale: 1.0, near: 1.0 };
    }
    let middle = 0.5 * (lo + hi);
    let seen = if errors.is_empty() { median(&votes) } else { None };
    let center = seen.map_or(middle, |(at, spread)| {
        let reach = DVec3::splat(SPREADS * spread);
        middle.clamp(at - reach, at + reach)
    });
    let half = (hi - center).max(center - lo).max_element();
    // A scene of one point takes its scale from the camera's distance to it.
    let half = if half > 0.0 { half } else { (eye - lo).length() };
    let power = if half > 0.0 { (-(half.log2().floor() as i32) - 1) as f64 } else { 0.0 };
    let scale = power.exp2();
    Space { center, scale, near: seen.map_or(1.0, |(_, spread)| (spread * scale).min(1.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vote(at: DVec3, radius: f64) -> Vote {
        Vote::new([at - radius, at + radius].into_iter(), DVec3::new(0.0, 1.0, 4.0), 1.0)
    }

    #[test]
    fn a_far_thing_moves_the_median_nowhere_and_a_huge_one_neither() {
        let near = || vec![vote(DVec3::ZERO, 4.0), vote(DVec3::new(0.6, 0.4, 0.3), 0.4), vote(DVec3::Y, 0.1)];
        let (plain, spread) = median(&near()).expect("votes");
        assert!(plain.length() < 4.0 && (0.4..8.0).contains(&spread), "{plain} {spread}");
        for far in [vote(DVec3::Z * -1e7, 1.0), vote(DVec3::Z * -1e7, 1e6), vote(DVec3::ONE * 2e6, 1e7)] {
            let mut votes = near();
            votes.push(far);
            let (at, wide) = median(&votes).expect("votes");
            assert!((at - plain).length() < spread && wide < 2.0 * spread, "{at} {wide}");
        }
        assert!(median(&[vote(DVec3::ONE, 0.0)]).is_none());
    }

    #[test]
    fn quantiles_are_by_weight() {
        let mut values = [(3.0, 1.0), (1.0, 1.0), (2.0, 2.0)];
        assert_eq!(quantile(&mut values, 0.5), 2.0);
        assert_eq!(quantile(&mut values, 0.25), 1.5);
        assert_eq!(quantile(&mut values, 1.0), 3.0);
    }
}

//! How far the rounding of a path's points may take its densities.
//!
//! A walk's ray starts off its surface by the error bound of its point, beyond which it cannot meet that again, and what it
//! finds is a point known to some digits: the direction between the points of an edge of length d is not that of the ray,
//! by these errors over d. Off the surface it arrives at, the point is out by a rounding of its coordinates. Within that
//! surface it is out by more: the traversal's own numbers grow with the triangle's corners as seen from the ray's origin, and a
//! ray that arrives at a cosine c meets the plane 1/c times as far off.
//!
//! A cosine c to the surface at an end changes by 1/c of what a direction turns, relatively; but by what a point is out within
//! that very surface only by 1, foreshortened as it is. The density of a lobe changes by its steepness (`Bsdf::steepness`),
//! that of a spot's directions and of the pixel filter by their slopes. At a delta vertex Snell's law, cosθt² = 1 − (1 −
//! cosθo²)/η², hands a change of one cosine on to the other: d cosθt/cosθt = cosθo d cosθo/(η² cosθt²).
//!
//! Edges that no walk has gone along are joined by their points, the same for all: they add nothing.

use super::paths::FullPath;
use super::{Judge, worse};
use crate::accel::Accel;
use crate::bsdf::Bsdf;
use crate::geometry::{SurfacePoint, triangle_area};
use crate::light::LightPoint;
use crate::math::{DVec3, Vec3, distance_squared, gamma};

/// What the arithmetic in f32 at a scattering vertex, or at the light, may do: some four products and quotients, half an ulp each.
const ARITHMETIC: f64 = 4.0 * 0.5 * f32::EPSILON as f64;

/// Roundings, relative to the corners as seen from the ray's origin, of the traversal's barycentrics: of the corners taken
/// relative to it, the edges' products, their quotients. (Without them a weight was off by 3 times the condition, with half as
/// many by 1.5 times.)
const BARYCENTRIC_ROUNDINGS: u32 = 4;

/// How far the rounding of its points may take the densities of a path, relatively.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Condition {
    /// All of them.
    pub all: f64,
    /// What of it is due to delta vertices, whose other edge Snell's law ties to the one.
    pub deltas: f64,
}

/// What a turn of an edge does at one of its ends.
#[derive(Clone, Copy, Debug)]
struct End {
    /// The cosine there.
    cos: f64,
    /// By how much densities change per relative change of that cosine.
    by_cos: f64,
    /// By how much per radian beside it.
    by_turn: f64,
    delta: bool,
}

impl End {
    /// By how much densities change where points off the surface turn the edge by an angle.
    fn turned(&self, angle: f64) -> f64 {
        angle * (self.by_cos / self.cos + self.by_turn)
    }

    /// By how much where a point within this end's surface does.
    fn turned_within(&self, angle: f64) -> f64 {
        angle * (self.by_cos + self.by_turn)
    }
}

impl Condition {
    /// Of a path whose edges were walked along, but for the joined one.
    pub fn of<A: Accel>(judge: &Judge<'_, A>, path: &FullPath) -> Self {
        let k = path.inner.len() + 1;
        let mut sum = Self { all: ARITHMETIC * k as f64, deltas: 0.0 };
        for i in (0..k).filter(|&i| path.joined != Some(i)) {
            // The direction of light from infinity is the same for all.
            if i == 0 && matches!(path.start, LightPoint::Infinite(_)) {
                continue;
            }
            // The light's walk went along what comes before the joined edge.
            let from_light = path.joined.is_some_and(|joined| i < joined);
            let (from, to) = if from_light { (i, i + 1) } else { (i + 1, i) };
            let (off, within) = errors(judge, path, from, to);
            // The points' own distance: that of parallel rays' edges is 1 in the densities.
            let length = distance_squared(path.point(from), path.point(to)).sqrt();
            let [start, arrived] = [(from, to), (to, from)].map(|(v, other)| end(judge, path, v, other));
            let changes = [
                (start, start.turned((off + within) / length)),
                (arrived, arrived.turned(off / length) + arrived.turned_within(within / length)),
            ];
            for (end, change) in changes {
                sum.all += change;
                sum.deltas += if end.delta { change } else { 0.0 };
            }
        }
        sum
    }
}

/// Vertex `v`, as a turn of its edge to `other` changes it.
fn end<A: Accel>(judge: &Judge<'_, A>, path: &FullPath, v: usize, other: usize) -> End {
    let k = path.inner.len() + 1;
    let w = path.direction(v, other);
    if v == 0 {
        return End { cos: path.start.cos(w), by_cos: 1.0, by_turn: light_slope(judge, path), delta: false };
    }
    if v == k {
        return End { cos: 1.0, by_cos: 1.0, by_turn: camera_slope(judge, path), delta: false };
    }
    let inner = &path.inner[v - 1];
    // The vertex's other edge.
    let beyond = path.direction(v, 2 * v - other);
    let cos_to = |w: Vec3| f64::from(inner.at.ng.dot(w).abs());
    let cos = cos_to(w);
    if !inner.delta {
        return End { cos, by_cos: 1.0, by_turn: inner.bsdf.steepness(&inner.at, w, beyond), delta: false };
    }
    let side = inner.at.ng.dot(w);
    let eta = match inner.bsdf {
        Bsdf::Dielectric { ior, .. } if side * inner.at.ng.dot(beyond) < 0.0 => {
            f64::from(if side > 0.0 { ior } else { 1.0 / ior })
        }
        _ => 1.0,
    };
    End { cos, by_cos: 1.0 + (cos / (eta * cos_to(beyond))).powi(2), by_turn: 0.0, delta: true }
}

/// How far a walk's ray from vertex `from` to vertex `to` may run beside their points: in any direction, and what of the
/// arrival lies within its surface, as seen along the ray from the side.
fn errors<A: Accel>(judge: &Judge<'_, A>, path: &FullPath, from: usize, to: usize) -> (f64, f64) {
    let surface = |v: usize| match (v, &path.start) {
        (0, LightPoint::Surface(at)) => Some(at),
        (0, _) => None,
        (v, _) => path.inner.get(v - 1).map(|inner| &inner.at),
    };
    let (a, b) = (path.point(from), path.point(to));
    let rounding = f64::from(f32::EPSILON) * f64::from(a.abs().max(b.abs()).max_element());
    let start = surface(from).map_or(0.0, |at| f64::from((at.origin(path.direction(from, to)) - at.p()).length()));
    let within = surface(to).map_or(0.0, |at| error_within(judge, at, a));
    (rounding + start, within)
}

/// How far a point that a ray from `origin` has found may lie from that ray within its surface.
fn error_within<A: Accel>(judge: &Judge<'_, A>, at: &SurfacePoint, origin: Vec3) -> f64 {
    let geometry = &judge.scene.geometry;
    let primitive = at.primitive();
    // A quadric's point is found in f64, and rounded.
    if geometry.triangle_surface.get(primitive as usize) != Some(&at.surface()) {
        return f64::from(at.point.error.length());
    }
    let corners = geometry.corners(primitive);
    let [p, q, r]: [DVec3; 3] = corners.map(|v| v.as_dvec3());
    let longest2 = (q - p).length_squared().max((r - q).length_squared()).max((p - r).length_squared());
    let farthest = corners.into_iter().map(|v| distance_squared(v, origin)).fold(0.0, f64::max).sqrt();
    let cos = f64::from(at.ng.dot((origin - at.p()).normalize()).abs());
    f64::from(gamma(BARYCENTRIC_ROUNDINGS)) * farthest * longest2 / (2.0 * triangle_area(corners)) / cos
}

/// The step of differences, in radians.
const STEP: f32 = 1e-4;

/// The largest change of a density's logarithm per radian as a direction is turned by `STEP`; `None` counts for nothing.
fn slope(w: Vec3, density: f64, turned: impl Fn(Vec3) -> Option<f64>) -> f64 {
    let (a, b) = w.any_orthonormal_pair();
    let changes = [a, -a, b, -b].into_iter().filter_map(|t| Some((turned(t * STEP)? / density).ln().abs()));
    changes.fold(0.0, worse) / f64::from(STEP)
}

/// How fast the density of a delta light's directions changes about the first edge; without bound at a spot's rim.
fn light_slope<A: Accel>(judge: &Judge<'_, A>, path: &FullPath) -> f64 {
    if !matches!(path.start, LightPoint::Delta(_)) {
        return 0.0;
    }
    let light = &judge.scene.lights[path.light as usize];
    let w = path.direction(0, 1);
    let density = |w: Vec3| light.pdf_emission_direction(&path.start, w).0;
    slope(w, density(w), |t| Some(density((w + t).normalize())))
}

/// How fast the camera's density changes about the last edge: with a filter that reaches over the image's edge, it falls there.
fn camera_slope<A: Accel>(judge: &Judge<'_, A>, path: &FullPath) -> f64 {
    let k = path.inner.len() + 1;
    let (p, distance) = (path.point(k - 1), (path.point(k - 1) - path.camera).length());
    let density = |p: Vec3| judge.scene.camera.sample_lens(p, &path.numbers).map(|lens| lens.pdf.0);
    density(p).map_or(0.0, |here| slope(path.direction(k, k - 1), here, |t| density(p + t * distance)))
}

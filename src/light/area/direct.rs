//! Points of emitting surfaces for next-event estimation: uniform in the solid angle that the receiver sees where that pays,
//! else uniform in area.

use std::f32::consts::{FRAC_PI_2, PI};

use crate::geometry::{Geometry, QuadricKind, SurfacePoint, triangle_area};
use crate::light::LightPoint;
use crate::light::tree::EmitterBound;
use crate::math::{DVec3, Vec3, distance_squared, gamma, luminance};
use crate::pdf::AreaPdf;
use crate::sampling::{SphereCone, SphericalRectangle, SphericalTriangle, warp};

use super::{AreaLight, Emitter};

/// Triangles whose middle is nearer than this, in lengths of their longest edge, are sampled by solid angle; rectangles where
/// their nearest point is nearer than their diagonal. Farther away the solid angle of an element hardly varies over the
/// polygon, and the maps' arithmetic buys nothing (docs/PERFORMANCE.md).
const NEAR: f64 = 1.25;

/// Whether all of a rectangle is farther away than its diagonal, told from its middle at little cost: no point is farther
/// from the middle than half a diagonal.
#[inline(always)]
fn is_far([a, b]: &[Vec3; 2], middle: Vec3, from: Vec3) -> bool {
    let diagonal2 = f64::from(a.length_squared() + b.length_squared());
    distance_squared(from, middle) > 1.5 * 1.5 * diagonal2
}

/// The density per area at a point chosen uniformly in a solid angle: `cosθ/(d² Ω)`.
#[inline]
fn pdf_in(solid_angle: f64, from: Vec3, at: &SurfacePoint) -> AreaPdf {
    // The cosine and distance that the estimators use, so that they cancel from what a sample contributes.
    let edge = LightPoint::Surface(*at).edge_from(from);
    AreaPdf(edge.map_or(0.0, |e| e.cos / (e.d2 * solid_angle)))
}

/// Barycentric weights of the second and third corner where the direction `w` from the origin meets a triangle's plane,
/// brought into the triangle (Möller, Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection").
fn barycentrics([a, b, c]: [DVec3; 3], w: DVec3) -> Option<[f32; 2]> {
    let (e1, e2) = (b - a, c - a);
    let p = w.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return None;
    }
    let q = (-a).cross(e1);
    let u = ((-a).dot(p) / det).clamp(0.0, 1.0);
    let v = (w.dot(q) / det).clamp(0.0, 1.0 - u);
    Some([u as f32, v as f32])
}

impl AreaLight {
    /// The rectangle as a near receiver sees it.
    #[inline]
    fn rectangle_from(&self, from: Vec3) -> Option<SphericalRectangle> {
        let Emitter::Parallelogram { corner, edges, rectangle: Some((axes, size)), .. } = &self.emitter else {
            return None;
        };
        if is_far(edges, *corner + 0.5 * (edges[0] + edges[1]), from) {
            return None;
        }
        // How far beside the rectangle the receiver is, and how far from its plane.
        let to = from.as_dvec3() - corner.as_dvec3();
        let beside = |k: usize| {
            let along = to.dot(axes[k]);
            along - along.clamp(0.0, size[k])
        };
        let (x, y, z) = (beside(0), beside(1), to.dot(axes[0].cross(axes[1])));
        if x * x + y * y + z * z > size[0] * size[0] + size[1] * size[1] {
            return None;
        }
        SphericalRectangle::new(corner.as_dvec3() - from.as_dvec3(), *axes, *size)
    }

    /// The sphere as a receiver outside sees it. A receiver on the sphere itself, from which it is seen from inside, may
    /// have been rounded to the outside: it is not taken for one.
    #[inline]
    fn cone_from(&self, from: Vec3) -> Option<SphereCone> {
        let Emitter::Quadric { ball: Some((center, radius)), .. } = &self.emitter else { return None };
        let to = *center - from.as_dvec3();
        let rounding = f64::from(gamma(16)) * (f64::from(from.abs().max_element()) + center.abs().max_element());
        let outside = radius * (1.0 + 1e-4) + rounding;
        if to.length_squared() <= outside * outside {
            return None;
        }
        SphereCone::new(to, *radius)
    }

    /// Whether there is no light to be sampled from this place, behind a parallelogram: what `sample_direct` refuses, and
    /// `pdf_direct` calls impossible.
    #[inline(always)]
    fn is_behind(&self, from: Vec3) -> bool {
        match &self.emitter {
            Emitter::Parallelogram { corner, normals: [one, other], .. } => {
                let to = from - *corner;
                !self.two_sided && to.dot(*one) < 0.0 && to.dot(*other) < 0.0
            }
            Emitter::Triangles { .. } | Emitter::Quadric { .. } => false,
        }
    }

    /// A point of part `part` for next-event estimation at `from`, with its density per area given the part; `None` where
    /// the receiver sees the surface edge-on.
    #[inline(always)]
    pub fn sample_direct(
        &self,
        geometry: &Geometry,
        from: Vec3,
        part: u32,
        u: [f32; 2],
    ) -> Option<(SurfacePoint, AreaPdf)> {
        if let Emitter::Parallelogram { corner, edges, .. } = &self.emitter {
            if self.is_behind(from) {
                return None;
            }
            // The everyday lamp, at an everyday distance.
            if is_far(edges, *corner + 0.5 * (edges[0] + edges[1]), from) {
                return Some((self.parallelogram_point(u)?, AreaPdf(1.0 / self.area)));
            }
        }
        self.sample_seen(geometry, from, part, u)
    }

    /// `sample_direct` for what is near, or is no parallelogram.
    #[inline(never)]
    fn sample_seen(&self, geometry: &Geometry, from: Vec3, part: u32, u: [f32; 2]) -> Option<(SurfacePoint, AreaPdf)> {
        let (at, solid_angle) = match &self.emitter {
            Emitter::Parallelogram { .. } => {
                let Some(rectangle) = self.rectangle_from(from) else {
                    return self.sample_point(geometry, 0.0, u);
                };
                let u = rectangle.sample(u).map(|x| x as f32);
                (self.parallelogram_point(u)?, rectangle.solid_angle())
            }
            Emitter::Triangles { triangles, .. } => {
                let triangle = triangles.start + part;
                let Some((seen, corners)) = triangle_from(geometry, from, triangle) else {
                    let [b, c] = warp::uniform_triangle(u);
                    let area = triangle_area(geometry.corners(triangle));
                    return Some((geometry.triangle_point(triangle, b, c), AreaPdf(1.0 / area)));
                };
                let [b, c] = barycentrics(corners, seen.sample(u))?;
                (geometry.triangle_point(triangle, b, c), seen.solid_angle())
            }
            Emitter::Quadric { index, ball } => {
                let (Some(cone), Some((center, radius))) = (self.cone_from(from), ball) else {
                    return self.sample_point(geometry, 0.0, u);
                };
                let n = cone.sample(u);
                let p = (*center + n * *radius).as_vec3a();
                let n = (n * geometry.quadrics[*index as usize].orientation).as_vec3a();
                (geometry.quadric_point(*index, p, n), cone.solid_angle())
            }
        };
        let pdf = pdf_in(solid_angle, from, &at);
        (pdf.0 > 0.0).then_some((at, pdf))
    }

    /// Density per area with which `sample_direct` at `from` chooses the point `at` of this light, given its part.
    #[inline]
    pub fn pdf_direct(&self, geometry: &Geometry, from: Vec3, at: &SurfacePoint) -> AreaPdf {
        if self.is_behind(from) {
            return AreaPdf(0.0);
        }
        let solid_angle = match &self.emitter {
            Emitter::Parallelogram { .. } => self.rectangle_from(from).map(|r| r.solid_angle()),
            Emitter::Triangles { .. } => match triangle_from(geometry, from, at.primitive()) {
                Some((seen, _)) => Some(seen.solid_angle()),
                None => return AreaPdf(1.0 / triangle_area(geometry.corners(at.primitive()))),
            },
            Emitter::Quadric { .. } => self.cone_from(from).map(|c| c.solid_angle()),
        };
        solid_angle.map_or_else(|| self.pdf_point(geometry, at.p()), |solid_angle| pdf_in(solid_angle, from, at))
    }

    /// How many parts next-event estimation chooses among.
    pub fn parts(&self) -> u32 {
        match &self.emitter {
            Emitter::Triangles { triangles, .. } => triangles.len() as u32,
            Emitter::Parallelogram { .. } | Emitter::Quadric { .. } => 1,
        }
    }

    /// The part that a point of this light belongs to.
    #[inline]
    pub fn part_of(&self, at: &SurfacePoint) -> u32 {
        match &self.emitter {
            Emitter::Triangles { triangles, .. } => at.primitive() - triangles.start,
            Emitter::Parallelogram { .. } | Emitter::Quadric { .. } => 0,
        }
    }

    /// What the choice of a part goes by.
    pub fn bound(&self, geometry: &Geometry, part: u32) -> EmitterBound {
        let flat = |corners: &[Vec3], normal: Vec3, area: f64| {
            let lo = corners.iter().fold(Vec3::INFINITY, |m, c| m.min(*c));
            let hi = corners.iter().fold(Vec3::NEG_INFINITY, |m, c| m.max(*c));
            (lo, hi, normal, 0.0, area)
        };
        // The area that it shows at most.
        let (lo, hi, axis, theta_normals, shown) = match &self.emitter {
            Emitter::Parallelogram { corner, edges: [a, b], normals: [normal, _], .. } => {
                flat(&[*corner, *corner + *a, *corner + *b, *corner + *a + *b], *normal, self.area)
            }
            Emitter::Triangles { triangles, .. } => {
                let triangle = triangles.start + part;
                let corners = geometry.corners(triangle);
                flat(&corners, geometry.triangle_point(triangle, 0.0, 0.0).ng, triangle_area(corners))
            }
            Emitter::Quadric { index, .. } => {
                let q = &geometry.quadrics[*index as usize];
                let (lo, hi) = q.bounds();
                match q.kind {
                    // A quarter of its surface is what a convex body shows on average.
                    QuadricKind::Sphere => (lo, hi, Vec3::Z, PI, 0.25 * self.area),
                    QuadricKind::Disk => (lo, hi, q.normal_to_world(DVec3::Z).as_vec3a(), 0.0, self.area),
                }
            }
        };
        let intensity = f64::from(luminance(self.radiance)) * shown;
        EmitterBound { lo, hi, axis, theta_normals, theta_reach: FRAC_PI_2, two_sided: self.two_sided, intensity }
    }
}

/// A triangle as a near receiver sees it, and its corners relative to the receiver.
#[inline]
fn triangle_from(geometry: &Geometry, from: Vec3, triangle: u32) -> Option<(SphericalTriangle, [DVec3; 3])> {
    let corners = geometry.corners(triangle);
    let [a, b, c] = corners;
    let longest2 = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    if distance_squared(from, (a + b + c) * (1.0 / 3.0)) > NEAR * NEAR * f64::from(longest2) {
        return None;
    }
    let corners = corners.map(|p| p.as_dvec3() - from.as_dvec3());
    Some((SphericalTriangle::new(corners)?, corners))
}

#[cfg(test)]
mod tests;

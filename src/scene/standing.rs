//! Point and spot lights on surfaces, and so close to them that rays cannot tell.

use super::desc::Diagnostic;
use crate::accel::Accel;
use crate::geometry::{Geometry, GeometryKind};
use crate::light::{DeltaPlace, Light};
use crate::math::{DVec3, Ray, Vec3, gamma, next_up, normal_error};

/// Surfaces that a probing ray looks at in each direction.
const LOOKED_AT: usize = 64;

/// Where the nearest surface of `place` lies, as far as it matters: within what rays may be off anywhere in the scene.
pub(super) fn settle<A: Accel>(accel: &A, geometry: &Geometry, place: &mut DeltaPlace) {
    let p = place.p;
    let largest = p.abs().max_element();
    let (reach, back) = (4.0 * gamma(16) * (1.0 + largest), gamma(16) * largest);
    let mut best: Option<DeltaPlace> = None;
    // No plane is missed by all: one of the axes comes to within a factor of √3 of its normal.
    for axis in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]) {
        let mut ray = Ray::segment(p - axis * back, p + axis * reach);
        for _ in 0..LOOKED_AT {
            let Some(hit) = accel.intersect(&ray) else { break };
            let found = beside(geometry, hit.geometry, hit.primitive, p);
            // What it stands on comes first, then what its rays are most in doubt about.
            let rank = |place: &DeltaPlace| (!place.stands(), place.height - place.error);
            if best.is_none_or(|best| rank(&found) < rank(&best)) {
                best = Some(found);
            }
            ray.tmin = next_up(hit.t);
        }
    }
    *place = best.unwrap_or(*place);
}

/// A place as a primitive's plane (or its foot on a quadric) sees it, in f64: on which side, how high, and to what error.
fn beside(geometry: &Geometry, kind: GeometryKind, primitive: u32, p: Vec3) -> DeltaPlace {
    let exact = p.as_dvec3();
    let (foot, normal, size, at) = match kind {
        GeometryKind::Triangle => {
            let corners = geometry.corners(primitive);
            let [a, b, c] = corners.map(|c| c.as_dvec3());
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let size = corners[0].abs().max(corners[1].abs()).max(corners[2].abs());
            (a, normal, size, geometry.triangle_point(primitive, 0.25, 0.25))
        }
        GeometryKind::Quadric => {
            // Known in f64: the light's own rounding is all.
            let (foot, normal) = geometry.quadrics[primitive as usize].project(exact);
            (foot, normal, Vec3::ZERO, geometry.quadric_point(primitive, foot.as_vec3a(), normal.as_vec3a()))
        }
    };
    let height = (exact - foot).dot(normal);
    let on = if height < 0.0 { -normal } else { normal }.as_vec3a();
    DeltaPlace {
        p,
        on,
        height: height.abs() as f32,
        rounding: gamma(4) * on.abs().dot(p.abs() + size),
        error: normal_error(at.point, on),
    }
}

/// The share of a light's distance from the camera from which on a doubt about where it is can be seen.
const VISIBLE: f32 = 1e-3;

/// Lights that are closer to a surface than rays know it, where that is so large that it can be seen from `eye`: `told` makes a
/// warning of the light's index, the surface's, the height above it and what rays know of it, in render units.
pub(super) fn doubts(
    geometry: &Geometry,
    lights: &[Light],
    eye: Vec3,
    told: impl Fn(usize, u32, f32, f32) -> Option<Diagnostic>,
) -> Vec<Diagnostic> {
    let places: Vec<(usize, Vec3)> =
        lights.iter().enumerate().filter_map(|(i, light)| Some((i, light.place()?.p))).collect();
    let visible = |p: Vec3| VISIBLE * p.distance(eye);
    let least = places.iter().map(|(_, p)| visible(*p)).fold(f32::INFINITY, f32::min);
    // Coordinates are below 1, and no sum of three errors that a normal takes is larger: mostly nothing is to be looked at.
    let large = |p: Vec3| 2.0 * gamma(16) * p.abs().max_element() > least;
    if !large(Vec3::ONE) {
        return Vec::new();
    }
    let triangles = (0..geometry.triangles.len() as u32)
        .filter(|&i| geometry.corners(i).into_iter().any(large))
        .map(|i| (GeometryKind::Triangle, i));
    let quadrics =
        geometry.quadrics.iter().zip(0..).filter(|(q, _)| <[Vec3; 2]>::from(q.bounds()).into_iter().any(large));
    let huge: Vec<_> = triangles.chain(quadrics.map(|(_, i)| (GeometryKind::Quadric, i))).collect();
    let doubt = |(light, p): (usize, Vec3)| {
        huge.iter().find_map(|&(kind, primitive)| {
            let place = beside(geometry, kind, primitive, p);
            let above = kind == GeometryKind::Quadric || is_above(geometry.corners(primitive), p);
            let surface = match kind {
                GeometryKind::Triangle => geometry.triangle_surface[primitive as usize],
                GeometryKind::Quadric => geometry.quadric_surface[primitive as usize],
            };
            if !above || place.height >= place.error || place.error <= visible(p) {
                return None;
            }
            told(light, surface, place.height, place.error)
        })
    };
    places.into_iter().filter_map(doubt).collect()
}

/// Whether a point lies over a triangle, along the triangle's normal.
fn is_above(corners: [Vec3; 3], p: Vec3) -> bool {
    let [a, b, c] = corners.map(|c| c.as_dvec3());
    let (normal, p) = ((b - a).cross(c - a), p.as_dvec3());
    let side = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal) >= -1e-6 * normal.length_squared();
    side(a, b) && side(b, c) && side(c, a)
}

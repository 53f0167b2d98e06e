//! Triangles too thin for Embree, intersected by code of our own.
//!
//! Embree computes a triangle's plane from its edges in f32. Of a thin triangle they are nearly parallel, the cross product loses
//! its digits, and the plane is tilted by ε · length/height: rays that leave such a triangle meet it again (measured over random
//! ones: 2 % of the rays where the height is 1/300 of the length, a quarter where it is 1/10⁴), so that it is too dark. Here
//! everything is f64, in which differences of f32 coordinates are exact.

use std::sync::Arc;

use super::user::{UserGeometry, UserHit};
use crate::geometry::Geometry;
use crate::math::{DVec3, Ray, Vec3};

/// By how much of its distance a ray may miss an edge and still meet the triangle. A neighbour across the edge is Embree's to
/// test, in f32: where both round the ray out of their triangle, it would go through between them.
const GENEROSITY: f64 = 1.0 / (1 << 22) as f64;

/// Some of `Geometry::triangles`.
pub(super) struct Slivers {
    pub(super) geometry: Arc<Geometry>,
    pub(super) some: Vec<u32>,
}

impl UserGeometry for Slivers {
    fn len(&self) -> usize {
        self.some.len()
    }

    fn bounds(&self, primitive: u32) -> (Vec3, Vec3) {
        let [a, b, c] = self.geometry.corners(self.some[primitive as usize]);
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        // With room for what is met beside the edges from anywhere within four units: render space is two large.
        let room = Vec3::splat((1.0 + lo.abs().max(hi.abs()).max_element()) * (1.0 / (1 << 20) as f32));
        (lo - room, hi + room)
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<UserHit> {
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let corners = self.geometry.corners(self.some[primitive as usize]).map(|p| p.as_dvec3() - o);
        meet(corners, d, [ray.tmin, ray.tmax].map(f64::from))
    }
}

/// Where a ray along `d` from the origin meets a triangle, for parameters within `range`.
fn meet([a, b, c]: [DVec3; 3], d: DVec3, [tmin, tmax]: [f64; 2]) -> Option<UserHit> {
    // Edge functions: six times the volumes of the tetrahedra over the sides opposite to the corners.
    let weights = [d.dot(c.cross(b)), d.dot(a.cross(c)), d.dot(b.cross(a))];
    let det: f64 = weights.iter().sum();
    let sides = [(c - b).length(), (a - c).length(), (b - a).length()];
    let reach = a.length_squared().max(b.length_squared()).max(c.length_squared()).sqrt();
    let allowed = -GENEROSITY * reach * d.length();
    // Seen edge-on as a whole it is not met; its neighbours are.
    if det == 0.0 || weights.iter().zip(sides).any(|(w, side)| w * det.signum() < allowed * side) {
        return None;
    }
    let normal = (b - a).cross(c - a);
    let t = normal.dot(a) / normal.dot(d);
    // Of a ray almost within the plane the edges tell little: where it meets the plane beyond all corners, it passes beside.
    let heights = [a, b, c].map(|p| p.dot(d) / d.length_squared());
    let [first, last] =
        [heights.into_iter().fold(f64::INFINITY, f64::min), heights.into_iter().fold(-f64::INFINITY, f64::max)];
    let slack = GENEROSITY * reach / d.length();
    if t < first - slack || t > last + slack {
        return None;
    }
    // `+ 0.0` turns −0 into 0. A NaN fails.
    let t = t as f32 + 0.0;
    if !(f64::from(t) >= tmin && f64::from(t) <= tmax) {
        return None;
    }
    let [_, v, w] = weights.map(|w| (w / det).clamp(0.0, 1.0));
    // Beside an edge the nearest point of it, more or less.
    let over = (v + w).max(1.0);
    Some(UserHit { t, u: (v / over) as f32, v: (w / over) as f32 })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [DVec3; 3] = [DVec3::new(0.0, 0.0, 2.0), DVec3::new(1.0, 0.0, 2.0), DVec3::new(1.0, 0.01, 2.0)];
    const ALL: [f64; 2] = [0.0, f64::INFINITY];

    #[test]
    fn hits_are_where_they_are() {
        for (u, v) in [(0.2, 0.3), (0.5, 0.4), (0.01, 0.98)] {
            let [a, b, c] = TRIANGLE;
            let at = a * (1.0 - u - v) + b * u + c * v;
            for scale in [0.5, 3.0] {
                let hit = meet(TRIANGLE, at * scale, ALL).expect("a hit");
                assert!((f64::from(hit.t) * scale - 1.0).abs() < 1e-6);
                assert!((f64::from(hit.u) - u).abs() < 1e-6 && (f64::from(hit.v) - v).abs() < 1e-6, "{hit:?}");
            }
            assert!(meet(TRIANGLE, -at, ALL).is_none());
            assert!(meet(TRIANGLE, at, [0.0, 0.9]).is_none() && meet(TRIANGLE, at, [1.1, 5.0]).is_none());
            // From the other side it is met as well.
            assert!(
                meet(TRIANGLE.map(|p| p * DVec3::new(1.0, 1.0, -1.0)), at * DVec3::new(1.0, 1.0, -1.0), ALL).is_some()
            );
        }
    }

    #[test]
    fn it_is_met_a_hair_beside_its_edges_and_no_further() {
        for (beside, met) in [(1e-7, true), (1e-5, false)] {
            for at in [DVec3::new(0.5, -beside, 2.0), DVec3::new(1.0 + beside, 0.005, 2.0)] {
                let hit = meet(TRIANGLE, at, ALL);
                assert_eq!(hit.is_some(), met, "{at}: {hit:?}");
                if let Some(UserHit { u, v, .. }) = hit {
                    assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-6, "{u} {v}");
                }
            }
        }
    }
}

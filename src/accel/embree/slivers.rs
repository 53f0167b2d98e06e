//! Triangles too thin for Embree, intersected by code of our own.
//!
//! Embree computes a triangle's plane from its edges in f32. Of a thin triangle they are nearly parallel, the cross product loses
//! its digits, and the plane is tilted by ε · length/height: rays that leave such a triangle meet it again (`geometry::is_sliver`
//! has the numbers), so that it is too dark. Here everything is f64, in which differences of f32 coordinates are exact.
//!
//! Between two slivers no ray gets through: of the edge that they share both compute the same number, but for its sign. Across
//! an edge to another triangle Embree tests in f32, and a sliver is generous there.

use std::collections::HashSet;
use std::sync::Arc;

use super::user::{UserGeometry, UserHit};
use crate::geometry::Geometry;
use crate::math::{DVec3, Ray, Vec3};

/// By how much of its distance a ray may miss an edge and still meet the triangle, where a neighbour across the edge is Embree's
/// to test, in f32: where both round the ray out of their triangle, it would go through between them. Elsewhere not at all: a
/// lamp 10⁻⁵ wide would be hit from one unit away by a twentieth more rays than its area says.
const GENEROSITY: f64 = 1.0 / (1 << 22) as f64;

/// Beyond so many units (the scene is less than two large) it grows no more, so that what is met lies in a box.
const GENEROUS_WITHIN: f64 = 16.0;

/// A part of a sliver, from one end of its longest side to the other: what has a box of its own. The box of a whole one that
/// lies across the axes is large and empty, and rays would ask it in vain (Embree splits such triangles of its own; of user
/// geometry it knows boxes alone).
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Its triangle, an index into `Geometry::triangles`.
    sliver: u32,
    /// Which piece, and of how many.
    part: [u8; 2],
    /// By corner, whether Embree has a triangle across the side opposite to it.
    generous: [bool; 3],
}

/// More pieces than this gain no more (docs/PERFORMANCE.md).
const MOST_PIECES: f32 = 8.0;

/// Some of `Geometry::triangles`, in pieces.
#[derive(Clone)]
pub(super) struct Slivers {
    geometry: Arc<Geometry>,
    pieces: Vec<Piece>,
}

/// A side by its ends, whichever way round: neighbours need not share vertices, only places.
type Side = [[u32; 3]; 2];

/// The sides of a triangle, each opposite to its corner.
fn sides([a, b, c]: [Vec3; 3]) -> [Side; 3] {
    [[b, c], [c, a], [a, b]].map(|ends| {
        // The zeros are one place.
        let [p, q] = ends.map(|p| (p + 0.0).to_array().map(f32::to_bits));
        if p < q { [p, q] } else { [q, p] }
    })
}

/// Those sides of slivers that other triangles have as well. `slivers` are all of the geometry's, in order.
fn sides_of_others(geometry: &Geometry, slivers: &[u32]) -> HashSet<Side> {
    let thin: HashSet<Side> = slivers.iter().flat_map(|&i| sides(geometry.corners(i))).collect();
    let others = (0..geometry.triangles.len() as u32).filter(|i| slivers.binary_search(i).is_err());
    // Of an index out of range `attach_triangles` tells.
    let there = |i: &u32| geometry.triangles[*i as usize].iter().all(|&v| (v as usize) < geometry.positions.len());
    others.filter(there).flat_map(|i| sides(geometry.corners(i))).filter(|side| thin.contains(side)).collect()
}

impl Slivers {
    /// Some of the geometry's slivers: those among `all` that are `wanted`. Both are in order.
    pub(super) fn new(geometry: &Arc<Geometry>, wanted: &[u32], all: &[u32]) -> Self {
        let generous = if wanted.is_empty() { HashSet::new() } else { sides_of_others(geometry, all) };
        let pieces = wanted.iter().flat_map(|&sliver| {
            let corners = geometry.corners(sliver);
            let [a, b, c] = corners;
            let generous = sides(corners).map(|side| generous.contains(&side));
            let size = a.max(b).max(c) - a.min(b).min(c);
            let faces = size.x * size.y + size.y * size.z + size.z * size.x;
            // The boxes of n pieces have 1/n of the faces of the whole one's, until they are as thin as the sliver.
            let of = (faces / (b - a).cross(c - a).length()).sqrt().clamp(1.0, MOST_PIECES) as u8;
            (0..of).map(move |part| Piece { sliver, part: [part, of], generous })
        });
        Self { geometry: Arc::clone(geometry), pieces: pieces.collect() }
    }

    /// The triangle of each primitive.
    pub(super) fn numbers(&self) -> Vec<u32> {
        self.pieces.iter().map(|piece| piece.sliver).collect()
    }
}

/// Corners of a box around what of a triangle lies between two fractions of its longest side, across which it is cut.
fn bounds_between(corners: [Vec3; 3], [from, to]: [f64; 2]) -> (Vec3, Vec3) {
    let corners = corners.map(|p| p.as_dvec3());
    let sides = [0, 1, 2].map(|i| [corners[i], corners[(i + 1) % 3]]);
    let long = |[a, b]: &[DVec3; 2]| (*b - *a).length_squared();
    let longest = sides.iter().copied().reduce(|a, b| if long(&b) > long(&a) { b } else { a }).unwrap_or(sides[0]);
    let axis = longest[1] - longest[0];
    let along = |p: DVec3| (p - longest[0]).dot(axis) / axis.length_squared();
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for [a, b] in sides {
        // Where between its ends a side enters and leaves; one across the axis is within as a whole, or not at all.
        let (s, t) = (along(a), along(b));
        let cuts = [from, to].map(|x| if s == t { x - s } else { (x - s) / (t - s) });
        let (first, last) = match s == t {
            true if cuts[0] <= 0.0 && cuts[1] >= 0.0 => (0.0, 1.0),
            true => continue,
            false => (cuts[0].min(cuts[1]).max(0.0), cuts[0].max(cuts[1]).min(1.0)),
        };
        if first <= last {
            for p in [a + (b - a) * first, a + (b - a) * last] {
                (lo, hi) = (lo.min(p), hi.max(p));
            }
        }
    }
    (lo.as_vec3a(), hi.as_vec3a())
}

impl UserGeometry for Slivers {
    fn len(&self) -> usize {
        self.pieces.len()
    }

    fn bounds(&self, primitive: u32) -> (Vec3, Vec3) {
        let Piece { sliver, part: [part, of], generous } = self.pieces[primitive as usize];
        let ends = [part, part + 1].map(|i| f64::from(i) / f64::from(of));
        let (lo, hi) = bounds_between(self.geometry.corners(sliver), ends);
        // With room for the corners' roundings, and for what is met beside edges.
        let beside = if generous.contains(&true) { (GENEROSITY * GENEROUS_WITHIN) as f32 } else { 0.0 };
        let room = Vec3::splat((1.0 + lo.abs().max(hi.abs()).max_element()) * (1.0 / (1 << 22) as f32) + 2.0 * beside);
        (lo - room, hi + room)
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<UserHit> {
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let Piece { sliver, generous, .. } = self.pieces[primitive as usize];
        let corners = self.geometry.corners(sliver).map(|p| p.as_dvec3() - o);
        meet(corners, generous, d, [ray.tmin, ray.tmax].map(f64::from))
    }
}

/// Where a ray along `d` from the origin meets a triangle, for parameters within `range`; `generous` at the sides opposite to
/// these corners.
fn meet([a, b, c]: [DVec3; 3], generous: [bool; 3], d: DVec3, [tmin, tmax]: [f64; 2]) -> Option<UserHit> {
    // Edge functions: six times the volumes of the tetrahedra over the sides opposite to the corners. The neighbour's number
    // for a side, its ends in the other order, is minus this one, exactly.
    let weights = [d.dot(c.cross(b)), d.dot(a.cross(c)), d.dot(b.cross(a))];
    let det: f64 = weights.iter().sum();
    let sides = [c - b, a - c, b - a];
    let reach2 = a.length_squared().max(b.length_squared()).max(c.length_squared());
    let allowed2 = GENEROSITY * GENEROSITY * reach2.min(GENEROUS_WITHIN * GENEROUS_WITHIN) * d.length_squared();
    // Most rays that get here pass beside: that takes no root.
    let beside = |i: usize| {
        let w = weights[i];
        w * det.signum() < 0.0 && !(generous[i] && w * w <= allowed2 * sides[i].length_squared())
    };
    // Seen edge-on as a whole it is not met; its neighbours are.
    if det == 0.0 || (0..3).any(beside) {
        return None;
    }
    let reach = reach2.sqrt();
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
                let hit = meet(TRIANGLE, [true; 3], at * scale, ALL).expect("a hit");
                assert!((f64::from(hit.t) * scale - 1.0).abs() < 1e-6);
                assert!((f64::from(hit.u) - u).abs() < 1e-6 && (f64::from(hit.v) - v).abs() < 1e-6, "{hit:?}");
            }
            assert!(meet(TRIANGLE, [true; 3], -at, ALL).is_none());
            assert!(
                meet(TRIANGLE, [true; 3], at, [0.0, 0.9]).is_none()
                    && meet(TRIANGLE, [true; 3], at, [1.1, 5.0]).is_none()
            );
            // From the other side it is met as well.
            assert!(
                meet(TRIANGLE.map(|p| p * DVec3::new(1.0, 1.0, -1.0)), [true; 3], at * DVec3::new(1.0, 1.0, -1.0), ALL)
                    .is_some()
            );
        }
    }

    #[test]
    fn it_is_met_a_hair_beside_its_generous_edges_and_no_further() {
        for (beside, met) in [(1e-7, true), (1e-5, false)] {
            for (at, opposite) in [(DVec3::new(0.5, -beside, 2.0), 2), (DVec3::new(1.0 + beside, 0.005, 2.0), 0)] {
                let generous = [0, 1, 2].map(|i| i == opposite);
                let hit = meet(TRIANGLE, generous, at, ALL);
                assert_eq!(hit.is_some(), met, "{at}: {hit:?}");
                assert!(meet(TRIANGLE, generous.map(|g| !g), at, ALL).is_none(), "{at}");
                if let Some(UserHit { u, v, .. }) = hit {
                    assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-6, "{u} {v}");
                }
            }
        }
    }

    /// A long thin quad, and a square that shares one of its long edges.
    fn strip() -> Arc<Geometry> {
        let turn = crate::math::DMat3::from_axis_angle(DVec3::new(0.3, -0.5, 0.9).normalize(), 0.8);
        let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1e-3], [0.0, 1e-3], [0.0, -0.7], [1.0, -0.7]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 1], [4, 1, 0]];
        let positions = at.map(|[x, y]| (turn * DVec3::new(x - 0.4, y, 0.1)).as_vec3a()).to_vec();
        Arc::new(Geometry { positions, triangle_surface: vec![0; 4], triangles, slivers: true, ..Geometry::default() })
    }

    #[test]
    fn edges_to_what_embree_tests_are_generous_and_no_others() {
        let slivers = Slivers::new(&strip(), &[0, 1], &[0, 1]);
        for piece in &slivers.pieces {
            let expected = if piece.sliver == 0 { [false, false, true] } else { [false; 3] };
            assert_eq!(piece.generous, expected, "{piece:?}");
        }
    }

    #[test]
    fn pieces_cover_their_triangle() {
        let geometry = strip();
        let slivers = Slivers::new(&geometry, &[0, 1], &[0, 1]);
        assert_eq!(slivers.numbers(), (0..2).flat_map(|i| [i; 8]).collect::<Vec<u32>>());
        let volume = |(lo, hi): (Vec3, Vec3)| (hi - lo).element_product();
        let boxes: Vec<_> = (0..16).map(|i| slivers.bounds(i)).collect();
        let whole = bounds_between(geometry.corners(0), [0.0, 1.0]);
        assert!(boxes.iter().all(|b| volume(*b) < 0.01 * volume(whole)), "{boxes:?} {whole:?}");
        for (i, k) in (0..2).flat_map(|i| (0..10_000).map(move |k| (i, k))) {
            let (mut u, mut v) = ((k % 100) as f32 / 99.0, (k / 100) as f32 / 99.0);
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let p = geometry.triangle_point(i, u, v).p();
            let own = &boxes[8 * i as usize..][..8];
            assert!(own.iter().any(|(lo, hi)| lo.cmple(p).all() && hi.cmpge(p).all()), "{i} {u} {v}");
        }
    }
}

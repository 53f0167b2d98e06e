//! Points of lights, and the edges that lead to them.

use crate::geometry::SurfacePoint;
use crate::math::{Ray, Vec3, distance_squared, gamma};

/// Where a delta light stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeltaPlace {
    /// The point, render space.
    pub p: Vec3,
    /// The unit normal, on the side of the point, of the surface beside it, if there is one within what any ray in the scene may
    /// be off; else zero.
    pub on: Vec3,
    /// How high above that surface the point is, along the normal, as both were rounded.
    pub height: f32,
    /// How high the rounding of the point's and the surface's coordinates alone may have put it.
    pub rounding: f32,
    /// What a ray that starts here may be off in meeting that surface, along the normal.
    pub error: f32,
}

/// Most that the end of a segment is moved along it, over how far it has to rise from the surface beside it.
const STEEPEST: f32 = 16.0;

impl DeltaPlace {
    /// A place off all surfaces.
    pub fn free(p: Vec3) -> Self {
        Self { p, on: Vec3::ZERO, height: 0.0, rounding: 0.0, error: 0.0 }
    }

    /// Whether it lies on the surface, within its rounding: the light shines to both sides, and on the surface not at all.
    pub fn stands(&self) -> bool {
        self.on != Vec3::ZERO && self.height <= self.rounding
    }

    /// Where a segment of this length that leaves along the unit vector `w` starts, or ends: at the point, where it is farther
    /// from the surface beside it than the traversal may be off, by the surface's error and by its own, which grows with its
    /// length. Else, beside the surface, which would hide it, at a distance that no error spans.
    #[inline]
    fn beside(&self, w: Vec3, length: f32) -> Vec3 {
        if self.on == Vec3::ZERO {
            return self.p;
        }
        let own = gamma(16) * (self.p.abs().max_element() + length);
        let by = self.error + own;
        let side = self.on.dot(w);
        if self.stands() {
            // To the side of `w`, twice: the point may itself be as far on the other side. And along `w` by the same, for another
            // surface beside that one, in a corner. (Along `w` alone, directions within 1/1000 of a surface would stay on it, and
            // be lost or seen on both sides.)
            self.p + w * by + self.on * (2.0 * by).copysign(side)
        } else if self.height < by {
            // On the side where it is: its light falls on the surface and not through it.
            // Along the line itself, as far as that leads away from the surface, so that it meets the same points.
            let rise = by - self.height;
            let along = (rise / side.abs()).min(STEEPEST * rise);
            let along = if side > 0.0 { along.max(own) } else { -along };
            self.p + w * along + self.on * (rise - along * side).max(0.0)
        } else {
            self.p
        }
    }
}

/// A point on a light, chosen for a light subpath or for next-event estimation, or hit.
#[derive(Clone, Copy, Debug)]
pub enum LightPoint {
    /// On an emitting surface.
    Surface(SurfacePoint),
    /// At a delta light.
    Delta(DeltaPlace),
    /// At infinity, in this unit direction.
    Infinite(Vec3),
}

/// The edge from a point of the scene to a point of a light.
#[derive(Clone, Copy, Debug)]
pub struct LightEdge {
    /// Unit direction toward the light.
    pub wi: Vec3,
    /// Squared length; 1 for an edge to infinity, which has no 1/d².
    pub d2: f64,
    /// What turns a solid angle at the scene's point into the measure of light points: |cosθ| (over d²) at a surface, 1
    /// at a delta point, whose "area" is its unit mass, and at infinity.
    pub cos: f64,
}

impl LightPoint {
    /// The edge that leads here from `from`; `None` from here itself, whence no direction leads.
    #[inline]
    pub fn edge_from(&self, from: Vec3) -> Option<LightEdge> {
        let (p, ng) = match self {
            Self::Surface(s) => (s.p(), Some(s.ng)),
            Self::Delta(place) => (place.p, None),
            Self::Infinite(toward) => return Some(LightEdge { wi: *toward, d2: 1.0, cos: 1.0 }),
        };
        let d2 = distance_squared(from, p);
        if d2 == 0.0 {
            return None;
        }
        let wi = (p - from).normalize();
        Some(LightEdge { wi, d2, cos: ng.map_or(1.0, |n| f64::from(n.dot(wi).abs())) })
    }

    /// Squared length of the edge from here to `to`; 1 from infinity.
    #[inline]
    pub fn distance_squared(&self, to: Vec3) -> f64 {
        match self {
            Self::Surface(s) => distance_squared(s.p(), to),
            Self::Delta(place) => distance_squared(place.p, to),
            Self::Infinite(_) => 1.0,
        }
    }

    /// The cosine that belongs to an edge that leaves along the unit vector `w`: see `LightEdge::cos`.
    #[inline]
    pub fn cos(&self, w: Vec3) -> f64 {
        match self {
            Self::Surface(s) => f64::from(s.ng.dot(w).abs()),
            Self::Delta(_) | Self::Infinite(_) => 1.0,
        }
    }

    /// Where a ray from here along the unit vector `w` starts. Not for points at infinity, whose rays start outside the
    /// scene (`EmissionSample::origin`).
    #[inline]
    pub fn origin(&self, w: Vec3) -> Vec3 {
        match self {
            Self::Surface(s) => s.origin(w),
            Self::Delta(place) => place.beside(w, 0.0),
            Self::Infinite(toward) => *toward,
        }
    }

    /// The segment between `at` and this point, which nothing may block for light to pass.
    #[inline(always)]
    pub fn shadow_ray(&self, at: &SurfacePoint) -> Ray {
        match self {
            Self::Surface(s) => Ray::segment(at.origin(s.p() - at.p()), s.segment_end(at.p())),
            Self::Delta(place) => {
                let back = at.p() - place.p;
                let length = back.length();
                let end = if length > 0.0 { place.beside(back / length, length) } else { place.p };
                Ray::segment(at.origin(-back), end)
            }
            Self::Infinite(toward) => Ray::new(at.origin(*toward), *toward),
        }
    }
}

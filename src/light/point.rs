//! Points of lights, and the edges that lead to them.

use crate::geometry::SurfacePoint;
use crate::math::{Ray, Vec3, distance_squared, gamma};

/// A point on a light, chosen for a light subpath or for next-event estimation, or hit.
#[derive(Clone, Copy, Debug)]
pub enum LightPoint {
    /// On an emitting surface.
    Surface(SurfacePoint),
    /// At a delta light.
    Delta(Vec3),
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
            Self::Delta(p) => (*p, None),
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
            Self::Delta(p) => distance_squared(*p, to),
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
            Self::Delta(p) => beside(*p, w, 0.0),
            Self::Infinite(toward) => *toward,
        }
    }

    /// The segment between `at` and this point, which nothing may block for light to pass.
    #[inline(always)]
    pub fn shadow_ray(&self, at: &SurfacePoint) -> Ray {
        match self {
            Self::Surface(s) => Ray::segment(at.origin(s.p() - at.p()), s.segment_end(at.p())),
            Self::Delta(p) => {
                let back = at.p() - *p;
                let length = back.length();
                let end = if length > 0.0 { beside(*p, back / length, length) } else { *p };
                Ray::segment(at.origin(-back), end)
            }
            Self::Infinite(toward) => Ray::new(at.origin(*toward), *toward),
        }
    }
}

/// A delta point moved towards the unit vector `w` by what the traversal of a segment of this length may be off, so that
/// a surface it stands on does not hide it. Render space is about one unit large, and so are its largest triangles.
#[inline]
fn beside(p: Vec3, w: Vec3, length: f32) -> Vec3 {
    p + w * (gamma(16) * (1.0 + p.abs().max_element() + length))
}

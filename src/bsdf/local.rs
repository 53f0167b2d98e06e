//! The frame that models with a direction of their own compute in, and the rules about sides.
//!
//! Sides are decided by the geometric normal. Where the shading normal disagrees with it about a direction, nothing is
//! scattered: every condition holds for the two directions alike, or the BSDF is not symmetric.

use crate::geometry::SurfacePoint;
use crate::math::{Frame, Vec3};

/// The shading frame, turned to the tangent and mirrored to the side of `wo`.
#[derive(Debug)]
pub struct Local {
    frame: Frame,
    /// Whether `wo` is on the side the surface faces.
    pub front: bool,
    /// `wo` in the frame, `wo.z` > 0.
    pub wo: Vec3,
}

impl Local {
    /// The frame at a point seen from `wo`, or `None` when nothing is scattered: the back of a one-sided surface, or
    /// the shading normal on the other side. `tangent` is `Roughness::tangent`.
    #[inline]
    pub fn new(at: &SurfacePoint, wo: Vec3, two_sided: bool, tangent: [f32; 2]) -> Option<Self> {
        let front = wo.dot(at.ng) > 0.0;
        if !front && !two_sided {
            return None;
        }
        let Frame { x, y, z } = Frame::from_normal(at.ns);
        let [c, s] = tangent;
        let frame = Frame { x: x * c + y * s, y: y * c - x * s, z };
        let wo = mirrored(frame.to_local(wo), front);
        (wo.z > 0.0).then_some(Self { frame, front, wo })
    }

    /// A direction in the frame, its z above 0 on the side of `wo`; `None` where the two normals disagree about the side.
    #[inline]
    pub fn to_local(&self, at: &SurfacePoint, wi: Vec3) -> Option<Vec3> {
        let local = mirrored(self.frame.to_local(wi), self.front);
        ((local.z > 0.0) == self.same_side(at, wi)).then_some(local)
    }

    /// `to_local` for what only reflects: `None` below the surface, too.
    #[inline]
    pub fn reflected(&self, at: &SurfacePoint, wi: Vec3) -> Option<Vec3> {
        self.to_local(at, wi).filter(|local| local.z > 0.0)
    }

    /// A unit direction of the frame, out of it; `None` where the two normals disagree about its side: facets may send
    /// light to where the surface as a whole would have blocked it.
    #[inline]
    pub fn to_world(&self, at: &SurfacePoint, local: Vec3) -> Option<Vec3> {
        // Roundings of the frame must not add up from bounce to bounce.
        let wi = self.frame.to_world(mirrored(local, self.front)).normalize();
        ((local.z > 0.0) == self.same_side(at, wi)).then_some(wi)
    }

    /// Whether the geometric normal puts `wi` on the side of `wo`.
    #[inline]
    fn same_side(&self, at: &SurfacePoint, wi: Vec3) -> bool {
        (wi.dot(at.ng) > 0.0) == self.front
    }
}

/// `w` mirrored about the unit vector `m`.
#[inline]
pub fn mirror(w: Vec3, m: Vec3) -> Vec3 {
    m * (2.0 * w.dot(m)) - w
}

/// On the back, the mirror image in the tangent plane: tangents stay where they are.
#[inline]
fn mirrored(w: Vec3, front: bool) -> Vec3 {
    if front { w } else { Vec3::new(w.x, w.y, -w.z) }
}

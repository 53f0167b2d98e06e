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

    /// A direction in the frame; z > 0 on the side of `wo`.
    #[inline]
    pub fn to_local(&self, w: Vec3) -> Vec3 {
        mirrored(self.frame.to_local(w), self.front)
    }

    /// A unit direction of the frame, out of it.
    #[inline]
    pub fn to_world(&self, w: Vec3) -> Vec3 {
        // Roundings of the frame must not add up from bounce to bounce.
        self.frame.to_world(mirrored(w, self.front)).normalize()
    }

    /// Whether the geometric normal puts `wi` on the side of `wo`.
    #[inline]
    pub fn same_side(&self, at: &SurfacePoint, wi: Vec3) -> bool {
        (wi.dot(at.ng) > 0.0) == self.front
    }
}

/// On the back, the mirror image in the tangent plane: tangents stay where they are.
#[inline]
fn mirrored(w: Vec3, front: bool) -> Vec3 {
    if front { w } else { Vec3::new(w.x, w.y, -w.z) }
}

//! Who asks for light.

use crate::geometry::SurfacePoint;
use crate::math::Vec3;

/// A surface point as next-event estimation sees it: what the choice of a light there may depend on.
///
/// Densities of next-event estimation are asked for from both ends of a path, by the camera subpath that samples the light
/// and by the light subpath that arrives, so that a receiver must be the same for both: it knows the surface and the side
/// the path is on, not where the path comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Where, render space.
    pub p: Vec3,
    /// Unit geometric normal on the side that light must come from; zero where it may come from either.
    pub n: Vec3,
}

impl Receiver {
    /// The point `at` of a path that has an edge along the unit vector `w` there. A surface that does not transmit has its
    /// other edge on the same side.
    #[inline]
    pub fn new(at: &SurfacePoint, w: Vec3, transmits: bool) -> Self {
        let side = if transmits { 0.0 } else { 1.0_f32.copysign(w.dot(at.ng)) };
        Self { p: at.p(), n: at.ng * side }
    }

    /// A place without a surface.
    #[inline]
    pub fn anywhere(p: Vec3) -> Self {
        Self { p, n: Vec3::ZERO }
    }
}

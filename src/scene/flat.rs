//! Surfaces that lie in a plane across an axis of the world, where a checker may be of one colour.

use super::desc::{ShapeDesc, SurfaceDesc};
use crate::math::DVec3;

/// The share of its distance from render space's origin to which f32 surely knows a point.
const KNOWN: f64 = 1e-7;

/// What to say of a surface in a plane in which all of its checker is "even"; `everywhere`, where that is no matter of the plane.
pub(super) fn advice(axis: usize, place: f64, everywhere: bool) -> String {
    let (axis, place) = (["x", "y", "z"][axis], place + 0.0); // −0 is 0.
    if everywhere {
        return format!(
            "the scale of its checker along {axis} is 0, where a sine is zero everywhere: all of the surface is \"even\"; give \
             the checker another scale along {axis}"
        );
    }
    format!(
        "the surface lies in the plane {axis} = {place}, where a sine of its checker is zero: all of it is \"even\"; \
         move it along {axis}, by half a cell (π/2 over the checker's scale) say"
    )
}

/// The error to which the surface's points are known, and the axes across which it lies flat to that error, each with its
/// place there; world units, as is `center`, the origin of render space.
pub(super) fn planes(surface: &SurfaceDesc, center: DVec3) -> (f64, Vec<(usize, f64)>) {
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut grow = |p: DVec3| {
        let p = surface.transform.transform_point3(p);
        (lo, hi) = (lo.min(p), hi.max(p));
    };
    match &surface.shape {
        ShapeDesc::Quad { size: [w, h] } => {
            for (x, y) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
                grow(DVec3::new(x * w, y * h, 0.0));
            }
        }
        ShapeDesc::Disk { radius } => {
            for axis in [DVec3::X, DVec3::Y] {
                grow(axis * *radius);
                grow(axis * -*radius);
            }
        }
        ShapeDesc::Mesh(mesh) => mesh.positions.iter().for_each(|p| grow(DVec3::from(p.map(f64::from)))),
        ShapeDesc::Sphere { .. } | ShapeDesc::DeltaPoint => return (0.0, Vec::new()),
    }
    let error = KNOWN * (hi - center).abs().max((lo - center).abs()).max_element();
    let flat = (0..3).filter(|&axis| hi[axis] - lo[axis] <= error);
    (error, flat.map(|axis| (axis, 0.5 * (lo[axis] + hi[axis]))).collect())
}

//! What a traversal needs of a ray, computed once.

use crate::math::{Ray, Vec3};

/// A ray with its reciprocal direction and signs.
#[derive(Clone, Copy, Debug)]
pub(super) struct PreparedRay {
    /// Origin.
    pub(super) o: Vec3,
    /// `1/d` per axis, finite: a zero component gives ±`f32::MAX` with the zero's sign.
    pub(super) reciprocal: Vec3,
    /// 1 for axes along which the ray runs downwards, else 0.
    pub(super) negative: [usize; 3],
    /// The axis of the direction's largest component.
    pub(super) kz: usize,
    /// Start of the segment, at least 0.
    pub(super) tmin: f32,
}

impl PreparedRay {
    /// `None` for a ray that hits nothing: non-finite origin or direction, or a direction whose largest component is
    /// below `f32::MIN_POSITIVE`. A negative `tmin` counts as 0, as Embree demands.
    #[inline]
    pub(super) fn new(ray: &Ray) -> Option<Self> {
        let (o, d) = (ray.o, ray.d);
        let size = d.abs();
        // Written so that a NaN anywhere fails.
        if !(o.is_finite() && d.is_finite() && size.max_element() >= f32::MIN_POSITIVE && ray.tmin <= ray.tmax) {
            return None;
        }
        let kz = match (size.x >= size.y, size.x >= size.z, size.y >= size.z) {
            (true, true, _) => 0,
            (false, _, true) => 1,
            _ => 2,
        };
        // Clamped, so that (plane − origin)·reciprocal is never 0·∞; the slabs' margin around every box (see
        // `tree`) keeps the product large enough to count as parallel.
        let huge = Vec3::splat(f32::MAX);
        let reciprocal = d.recip().clamp(-huge, huge);
        let negative = [d.x, d.y, d.z].map(|c| usize::from(c.is_sign_negative()));
        Some(Self { o, reciprocal, negative, kz, tmin: ray.tmin.max(0.0) })
    }
}

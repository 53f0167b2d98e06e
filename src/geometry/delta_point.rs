//! The delta point: a surface of zero size (the source report's `DeltaPoint`).

use crate::math::{Ray, Vec3, next_down, next_up};

/// A point of zero size with the box that stands in for it in queries that ask for it.
///
/// An ideal point has measure zero: no transport ray hits it or is blocked by it. The box exists for picking, for
/// the light-position output and for the report's own intersection semantics.
#[derive(Clone, Copy, Debug)]
pub struct DeltaPoint {
    /// Position, render space.
    pub position: Vec3,
    /// How far from it a ray may pass, along each axis: covers the position's rounding and the rounding of the direction of a
    /// ray aimed at it from as far as `reach`.
    pub epsilon: f32,
}

/// How many units in the last place of its position and of the aiming ray's reach ε is. A
/// direction normalised in f32 is off by up to about 2 ulps per axis, `p − o` by half an ulp of each operand.
const ULPS: f32 = 8.0;

impl DeltaPoint {
    /// A delta point that is found by every ray aimed at it from no farther than `reach` (same units as `position`).
    pub fn new(position: Vec3, reach: f32) -> Self {
        let scale = position.abs().max_element() + reach;
        Self { position, epsilon: (ULPS * f32::EPSILON * scale).max(f32::MIN_POSITIVE) }
    }

    /// Lower and upper corner of the box of all points of rays that `intersect` accepts: a segment may end up to ε short
    /// of its closest approach, which itself lies within ±ε.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let e = Vec3::splat(2.0 * self.epsilon);
        // One further ulp outwards: `p ± ε` is itself rounded.
        let (lo, hi) = (self.position - e, self.position + e);
        (
            Vec3::new(next_down(lo.x), next_down(lo.y), next_down(lo.z)),
            Vec3::new(next_up(hi.x), next_up(hi.y), next_up(hi.z)),
        )
    }

    /// The ray parameter of closest approach, if the ray passes within ε of the point in the plane facing it.
    ///
    /// Computed in f64 from the f32 inputs, so that only the inputs' own rounding counts. The segment's ends are
    /// closed up to ε: a shadow segment that ends on the point finds it.
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let to_point = self.position.as_dvec3() - o;
        let d2 = d.length_squared();
        if d2 == 0.0 || !d2.is_finite() {
            return None;
        }
        let t = to_point.dot(d) / d2;
        let epsilon = f64::from(self.epsilon);
        let slack = epsilon / d2.sqrt();
        if t < f64::from(ray.tmin) - slack || t > f64::from(ray.tmax) + slack {
            return None;
        }
        let miss = to_point - d * t;
        (miss.abs().max_element() <= epsilon).then(|| (t as f32).max(ray.tmin).min(ray.tmax))
    }
}

//! Shapes as a point sees them, sampled uniformly in the solid angle that they subtend.
//!
//! All in f64, relative to the point that looks. Each constructor has a range in which its maps are well-conditioned and
//! returns `None` outside; since it depends on the point and the shape alone, whoever samples and whoever asks for the
//! density take the same branch.

use std::f64::consts::PI;

use crate::math::DVec3;

/// Solid angles that the maps of polygons are used for, sr: below, the polygon is edge-on or far, and uniform areas are as
/// good; above, it surrounds the point.
const SAFE: std::ops::Range<f64> = 1e-3..6.2;

/// The angle between two vectors, without the cancellation of an arc cosine near 0 and π.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// The product of two complex numbers, the second one conjugated.
#[inline(always)]
fn times_conjugate(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] + a[1] * b[1], a[1] * b[0] - a[0] * b[1]]
}

/// A rectangle (Ureña, Fajardo, King 2013, "An Area-Preserving Parametrization for Spherical Rectangles").
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    /// Its sides in its own frame, seen from the point: x and y from the first to the last, z the (negative) distance.
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    /// Cosine and sine of the angle k.
    k: [f64; 2],
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle with a corner at `corner` relative to the point that looks and edges along the unit vectors `axes`,
    /// which are at right angles, of the lengths `size`. `None` outside the safe range.
    ///
    /// A plane through the point and an edge meets the next one, at the corner (x, y), under an angle whose tangent is
    /// |z| r/(xy) up to sign, r the corner's distance. The solid angle is the sum of the four angles less 2π, and k
    /// of the paper is 2π less two of them [Urena13, (3)]. Sums of angles are products of complex numbers: one arc tangent
    /// is all that is left, and nothing cancels.
    #[inline]
    pub fn new(corner: DVec3, axes: [DVec3; 2], size: [f64; 2]) -> Option<Self> {
        let x0 = corner.dot(axes[0]);
        let y0 = corner.dot(axes[1]);
        // The side of the plane does not matter.
        let z = -corner.dot(axes[0].cross(axes[1])).abs();
        let (x, y) = ([x0, x0 + size[0]], [y0, y0 + size[1]]);
        let at = |x: f64, y: f64| [-z * (x * x + y * y + z * z).sqrt(), x * y];
        let (c00, c01, c10, c11) = (at(x[0], y[0]), at(x[0], y[1]), at(x[1], y[0]), at(x[1], y[1]));
        let (right, left) = (times_conjugate(c11, c10), times_conjugate(c01, c00));
        let [cos, sin] = times_conjugate(right, left);
        let solid_angle = sin.atan2(cos);
        // Between 0 and 2π.
        let solid_angle = if solid_angle < 0.0 { solid_angle + 2.0 * PI } else { solid_angle };
        // In its plane the rectangle is edge-on, or all around.
        if z == 0.0 || !SAFE.contains(&solid_angle) {
            return None;
        }
        let norm = -left[0].hypot(left[1]);
        Some(Self { x, y, z, k: left.map(|c| c / norm), solid_angle })
    }

    /// What it subtends, sr.
    #[inline]
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The point of the rectangle in the direction that `u` stands for, in fractions of its edges.
    pub fn sample(&self, u: [f32; 2]) -> [f64; 2] {
        let [x0, x1] = self.x;
        let [y0, y1] = self.y;
        // 1. The cut x = xu that leaves the share u₀ of the solid angle on its left.
        let (s, c) = (f64::from(u[0]) * self.solid_angle).sin_cos();
        let [ck, sk] = self.k;
        let (sin, cos) = (s * ck + c * sk, c * ck - s * sk);
        // z components of the unit normals of the planes through the edges y₀ and y₁.
        let b = [-y0 / (y0 * y0 + self.z * self.z).sqrt(), y1 / (y1 * y1 + self.z * self.z).sqrt()];
        let f = (cos * b[0] - b[1]) / sin;
        let c = (1.0 / (f * f + b[0] * b[0]).sqrt()).copysign(f).clamp(-1.0, 1.0);
        let xu = (-(c * self.z) / (1.0 - c * c).max(0.0).sqrt()).clamp(x0, x1);
        // 2. Along the cut, the height over the plane of the point.
        let d2 = xu * xu + self.z * self.z;
        let h = |y: f64| y / (d2 + y * y).sqrt();
        let (h0, h1) = (h(y0), h(y1));
        let hv = h0 + f64::from(u[1]) * (h1 - h0);
        let yv = (hv * (d2 / (1.0 - hv * hv)).sqrt()).clamp(y0, y1);
        [(xu - x0) / (x1 - x0), (yv - y0) / (y1 - y0)]
    }
}

/// A triangle (Arvo 1995, "Stratified Sampling of Spherical Triangles").
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    /// Directions to its corners, unit length.
    corners: [DVec3; 3],
    /// The angle at the first, and cosine of the arc from the first to the second.
    alpha: f64,
    cos_c: f64,
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle with these corners relative to the point that looks. `None` outside the safe range.
    pub fn new(corners: [DVec3; 3]) -> Option<Self> {
        let [a, b, c] = corners.map(DVec3::normalize_or_zero);
        // [VanOosterom83].
        let volume = a.dot(b.cross(c)).abs();
        let solid_angle = 2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        if !SAFE.contains(&solid_angle) {
            return None;
        }
        let alpha = angle(a.cross(b), a.cross(c));
        Some(Self { corners: [a, b, c], alpha, cos_c: a.dot(b), solid_angle })
    }

    /// What it subtends, sr.
    #[inline]
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// A direction into it, unit length.
    pub fn sample(&self, u: [f32; 2]) -> DVec3 {
        let [a, b, c] = self.corners;
        // 1. The corner c' on the arc from a to c that leaves the share u₀ of the area: q = cos(a, c').
        let (sin_alpha, cos_alpha) = self.alpha.sin_cos();
        let (s, t) = (f64::from(u[0]) * self.solid_angle - self.alpha).sin_cos();
        let (p, v) = (t - cos_alpha, s + sin_alpha * self.cos_c);
        let numerator = (v * t - p * s) * cos_alpha - v;
        let denominator = (v * s + p * t) * sin_alpha;
        let q = if denominator == 0.0 { 1.0 } else { (numerator / denominator).clamp(-1.0, 1.0) };
        let cut = a * q + across(c, a) * (1.0 - q * q).sqrt();
        // 2. A height on the arc from b to c', uniform in its versine.
        let z = 1.0 - f64::from(u[1]) * (1.0 - cut.dot(b));
        (b * z + across(cut, b) * (1.0 - z * z).max(0.0).sqrt()).normalize()
    }
}

/// The part of `a` across the unit vector `axis`, unit length.
fn across(a: DVec3, axis: DVec3) -> DVec3 {
    (a - axis * a.dot(axis)).normalize_or_zero()
}

/// A sphere: the cone that it fills.
#[derive(Clone, Copy, Debug)]
pub struct SphereCone {
    /// Unit direction from the sphere's centre to the point that looks.
    axis: DVec3,
    /// Sine² of the cone's half angle, and its versine 1 − cosθ.
    sin2_max: f64,
    versine_max: f64,
}

impl SphereCone {
    /// The sphere around `center`, relative to the point that looks. `None` from inside.
    pub fn new(center: DVec3, radius: f64) -> Option<Self> {
        let sin2_max = radius * radius / center.length_squared();
        if !(sin2_max > 0.0 && sin2_max < 1.0) {
            return None;
        }
        let versine_max = sin2_max / (1.0 + (1.0 - sin2_max).sqrt());
        Some(Self { axis: -center.normalize(), sin2_max, versine_max })
    }

    /// What it subtends, sr.
    #[inline]
    pub fn solid_angle(&self) -> f64 {
        2.0 * PI * self.versine_max
    }

    /// The outward normal, unit length, of the sphere's point in the direction that `u` stands for [PBRT4, 6.2.4].
    pub fn sample(&self, u: [f32; 2]) -> DVec3 {
        // Versines keep the digits of narrow cones.
        let v = f64::from(u[0]) * self.versine_max;
        let sin2 = v * (2.0 - v);
        let cos_alpha = sin2 / self.sin2_max.sqrt() + (1.0 - v) * (1.0 - sin2 / self.sin2_max).max(0.0).sqrt();
        let cos_alpha = cos_alpha.min(1.0);
        let sin_alpha = (1.0 - cos_alpha * cos_alpha).sqrt();
        let (sin, cos) = (2.0 * PI * f64::from(u[1])).sin_cos();
        let (x, y) = self.axis.any_orthonormal_pair();
        (x * (sin_alpha * cos) + y * (sin_alpha * sin) + self.axis * cos_alpha).normalize()
    }
}

#[cfg(test)]
mod tests;

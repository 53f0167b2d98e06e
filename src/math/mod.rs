//! Vectors, colours, rays, frames and error-bounded offsets.
//!
//! The vector types are glam's; this module only names them, so that the choice between glam's
//! scalar and SIMD layouts is made (and measured) in one line.

mod frame;
mod offset;
mod ray;

pub use frame::Frame;
pub use glam::{DAffine3, DMat3, DVec2, DVec3, Vec2, Vec4};
pub use offset::{PointWithError, gamma, next_down, next_up, normal_error, offset_origin, past};
pub use ray::Ray;

/// A point, direction or normal; 16-byte aligned, so that Embree may read vertex arrays of it in place.
pub type Vec3 = glam::Vec3A;

/// A linear RGB triple (Rec. 709 primaries): radiance, throughput or reflectance, as the name of the variable says.
pub type Rgb = glam::Vec3A;

/// Rec. 709 relative luminance of a linear RGB triple.
pub fn luminance(c: Rgb) -> f32 {
    c.dot(Vec3::new(0.212_639, 0.715_169, 0.072_192))
}

/// `x²`, for readable densities.
#[inline(always)]
pub fn sqr(x: f64) -> f64 {
    x * x
}

/// `a b s`, multiplied in f64: of a peaked lobe, bright light and a small weight, f32 may hold the product but no part of it.
#[inline(always)]
pub fn scaled(a: Rgb, b: Rgb, s: f64) -> Rgb {
    (a.as_dvec3() * b.as_dvec3() * s).as_vec3a()
}

/// The squared distance between two points in f64: differences of nearby f32 points are exact, their squares are not.
#[inline(always)]
pub fn distance_squared(a: Vec3, b: Vec3) -> f64 {
    let d = b - a;
    let (x, y, z) = (f64::from(d.x), f64::from(d.y), f64::from(d.z));
    x * x + y * y + z * z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_is_held_where_no_part_of_it_is() {
        let (a, b) = (Rgb::new(1e38, 1e-30, 2.0), Rgb::new(1e30, 1e-30, 3.0));
        assert_eq!(scaled(a, b, 1e-60), Rgb::new(1e8, 0.0, 6e-60));
        assert!((scaled(a, b, 1e40).y - 1e-20).abs() < 1e-26);
    }
}

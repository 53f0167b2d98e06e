//! Error-bounded ray origins: no epsilon in scene units anywhere.

use super::Vec3;

/// Unit roundoff of f32, `2⁻²⁴`.
const UNIT_ROUNDOFF: f32 = 0.5 * f32::EPSILON;

/// `γₙ = n·u / (1 − n·u)`: the bound on the relative error of `n` roundings (Higham 2002, §3.1).
#[inline]
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// A point on a surface with what bounds its distance from the true surface.
#[derive(Clone, Copy, Debug)]
pub struct PointWithError {
    /// The rounded point.
    pub p: Vec3,
    /// Bound on the absolute error of each coordinate.
    pub error: Vec3,
}

/// The share of a point's error that a surface along an axis is left by at least. A plane through the origin of the
/// coordinates along an axis is known without error, and a bound of nothing would leave the ray on it: the next float above
/// zero is subnormal, which a processor may be told to take for zero.
const LEAST_SHARE: f32 = 1.0 / (1u32 << 20) as f32;

/// The least of all, render space, for points at the origin itself: products with edges do not underflow.
const LEAST_OFFSET: f32 = 1.0 / (1u64 << 60) as f32;

/// Bound on how far from a point its surface may be along the surface's unit normal.
#[inline]
pub fn normal_error(point: PointWithError, ng: Vec3) -> f32 {
    (ng.abs() + LEAST_SHARE).dot(point.error) + LEAST_OFFSET
}

/// Moves a surface point along its geometric normal to the side of `towards`, just far enough that neither the
/// point's own error nor the traversal's lets a ray that starts there meet the surface again
/// (Pharr, Jakob, Humphreys 2023, "Physically Based Rendering", 4th ed., §6.8.6).
///
/// `ng` is a unit vector; `towards` any vector on the side to leave to.
#[inline]
pub fn offset_origin(point: PointWithError, ng: Vec3, towards: Vec3) -> Vec3 {
    let distance = normal_error(point, ng);
    let n = if ng.dot(towards) < 0.0 { -ng } else { ng };
    let moved = point.p + n * distance;
    // Round each coordinate away from the surface, so that the sum's own rounding cannot undo the offset.
    Vec3::new(round_away(moved.x, n.x), round_away(moved.y, n.y), round_away(moved.z, n.z))
}

/// The next float on the side of `direction`'s sign; `x` itself where that is zero.
///
/// Without branches, for signs of coordinates and normals are a coin's: floats in the order of their values are
/// consecutive integers once the magnitude bits of negative ones are inverted. From ±0 it may be the
/// other zero: the float beyond is subnormal.
#[inline]
fn round_away(x: f32, direction: f32) -> f32 {
    let ordered = |bits: i32| bits ^ ((bits >> 31) & i32::MAX);
    let step = i32::from(direction > 0.0) - i32::from(direction < 0.0);
    f32::from_bits(ordered(ordered(x.to_bits() as i32).wrapping_add(step)) as u32)
}

/// The next f32 above a finite `x` (`f32::next_up` is younger than the Rust this crate is kept to).
#[inline]
pub fn next_up(x: f32) -> f32 {
    if x == 0.0 {
        return f32::from_bits(1);
    }
    let bits = x.to_bits();
    f32::from_bits(if x > 0.0 { bits + 1 } else { bits - 1 })
}

/// The least ray parameter beyond a hit's: the next one, and not a subnormal one. We let the processor keep subnormals, and so
/// does Embree but while it builds; a program around us may not (flush-to-zero and denormals-are-zero, which Embree's manual
/// recommends), and then `next_up(0)` is zero, and what is met at zero is met for ever.
#[inline]
pub fn past(t: f32) -> f32 {
    next_up(t).max(f32::MIN_POSITIVE)
}

/// The next f32 below a finite `x`.
#[inline]
pub fn next_down(x: f32) -> f32 {
    -next_up(-x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_leaves_to_the_side_asked_for() {
        let point = PointWithError { p: Vec3::new(1e5, -3.0, 0.0), error: Vec3::splat(1e-3) };
        let n = Vec3::new(0.6, 0.0, 0.8);
        assert!((offset_origin(point, n, n) - point.p).dot(n) > 0.0);
        assert!((offset_origin(point, n, -n) - point.p).dot(n) < 0.0);
    }

    #[test]
    fn a_plane_without_error_is_left_by_more_than_the_processor_flushes() {
        let point = PointWithError { p: Vec3::new(0.3, 0.0, 0.5), error: Vec3::new(1e-6, 0.0, 1e-6) };
        for side in [Vec3::Y, -Vec3::Y] {
            let y = offset_origin(point, Vec3::Y, side).y * side.y;
            assert!((f32::MIN_POSITIVE..1e-11).contains(&y), "{y}");
        }
    }

    #[test]
    fn rounding_away_is_the_next_float_on_that_side() {
        for direction in [0.3, -0.3] {
            assert!([0.0, -0.0].iter().all(|x| round_away(*x, direction).abs() <= f32::from_bits(1)));
        }
        for x in [0.0, 1.0, -1.0, 1e-45, -1e-45, f32::MIN_POSITIVE, 1e30, -1e30, -0.999_999_94] {
            assert_eq!(round_away(x, 0.3).to_bits(), next_up(x).to_bits());
            assert_eq!(round_away(x, 0.0).to_bits(), x.to_bits());
            assert_eq!(round_away(x, -0.3), if x == 0.0 { 0.0 } else { next_down(x) });
        }
    }

    #[test]
    fn past_a_hit_no_parameter_is_subnormal() {
        for t in [0.0, -0.0, 1e-45, 1e-40] {
            assert_eq!(past(t), f32::MIN_POSITIVE);
        }
        for t in [f32::MIN_POSITIVE, 1e-30, 1.0, 1e30] {
            assert_eq!(past(t), next_up(t));
        }
    }

    #[test]
    fn neighbours_are_the_next_floats() {
        for x in [0.0, -0.0, 1.0, -1.0, f32::MIN_POSITIVE, -f32::MIN_POSITIVE, 1e-45, -1e-45, 1e30, -0.999_999_94] {
            assert!(next_up(x) > x && next_down(x) < x);
            assert_eq!(next_down(next_up(x)), x);
        }
        assert_eq!(next_up(1.0), 1.0 + f32::EPSILON);
    }
}

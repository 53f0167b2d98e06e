//! Rough surfaces as random facets: distributions of their normals, masking and shadowing, sampling.
//!
//! Everything is in the local frame whose z axis is the normal on the side of `wo`. Half vectors are passed unnormalised,
//! so that their length, which reflection and refraction need in their Jacobians, is not divided out and multiplied in
//! again, and quotients of the form h·h/α² stay exact down to α = 10⁻⁴.

use std::f32::consts::{FRAC_1_PI, PI};

use crate::math::Vec3;
use crate::sampling::warp::{beckmann_normal, ggx_visible_normal};

/// Below this roughness a surface is smooth: its lobe is narrower than directions in f32 can tell.
pub const SMOOTH: f32 = 1e-4;

/// The distribution of facet normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Trowbridge–Reitz: the shape of an ellipsoid [Walter07 (33)].
    Ggx,
    /// Gaussian slopes [Walter07 (25)].
    Beckmann,
}

/// Whether facets that are hidden from one direction are more likely to be hidden from the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// High facets are seen from both: `1/(1 + Λo + Λi)` [Heitz14 (99)].
    HeightCorrelated,
    /// Independent: `G1(wo) G1(wi)` [Walter07 (23)].
    Separable,
}

/// How rough along two tangents, and where these point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// α along the tangent and across it, both at least `SMOOTH`.
    pub alpha: [f32; 2],
    /// Cosine and sine of the angle that turns the x axis of `Frame::from_normal(ns)` into the tangent.
    pub tangent: [f32; 2],
}

impl Roughness {
    /// α along the frame's own axes.
    pub fn new(alpha: [f32; 2]) -> Self {
        Self { alpha, tangent: [1.0, 0.0] }
    }
}

/// The roughness to compute with, or `None` for one that cannot be told from a smooth surface. A narrow direction beside a
/// wide one is widened to what can be computed.
pub(super) fn rough(alpha: [f32; 2]) -> Option<[f32; 2]> {
    (alpha[0].max(alpha[1]) >= SMOOTH).then(|| alpha.map(|a| a.max(SMOOTH)))
}

/// What a mirror of facets (F = 1) makes of a pair of directions on one side, the common factor D left out of all.
#[derive(Clone, Copy, Debug)]
pub struct Reflection {
    /// D of the half vector: the common factor.
    pub d: f32,
    /// Cosine between either direction and the facet that reflects one into the other.
    pub cos: f32,
    /// BSDF times |wi.z|, over D.
    pub value: f32,
    /// Density of `wi` given `wo`, over D.
    pub forward: f32,
    /// Density of `wo` given `wi`, over D.
    pub reverse: f32,
}

impl Distribution {
    /// D of the direction of `h` (`h·h` = `hh` > 0), per solid angle of the normal.
    #[inline]
    pub fn d(self, alpha: [f32; 2], h: Vec3, hh: f32) -> f32 {
        let (x, y) = (h.x / alpha[0], h.y / alpha[1]);
        let slopes = x * x + y * y;
        let zz = h.z * h.z;
        match self {
            Self::Ggx => {
                let q = hh / (slopes + zz);
                q * q * (FRAC_1_PI / (alpha[0] * alpha[1]))
            }
            Self::Beckmann => {
                if zz == 0.0 {
                    return 0.0;
                }
                let q = hh / zz;
                (-slopes / zz).exp() * q * q * (FRAC_1_PI / (alpha[0] * alpha[1]))
            }
        }
    }

    /// Samples the normal of a facet seen from `wo`, `wo.z > 0`.
    #[inline]
    pub fn sample(self, alpha: [f32; 2], wo: Vec3, u: [f32; 2]) -> Option<Vec3> {
        match self {
            Self::Ggx => ggx_visible_normal(alpha, wo, u),
            Self::Beckmann => Some(beckmann_normal(alpha, u)),
        }
    }
}

/// |w| of the direction scaled by the roughness, `√(wz² + αx² wx² + αy² wy²)`: GGX's G1 is `2 wz/(wz + |w|)`
/// [Heitz14 (72)], finite at every angle.
#[inline]
pub fn stretched(alpha: [f32; 2], w: Vec3) -> f32 {
    let (x, y) = (alpha[0] * w.x, alpha[1] * w.y);
    (w.z * w.z + x * x + y * y).sqrt()
}

/// Λ of the Beckmann distribution [Heitz14], with the complementary error function after [Press07, §6.2.2]
/// (relative error 1.2e-7).
pub(super) fn beckmann_lambda(alpha: [f32; 2], w: Vec3) -> f32 {
    let (x, y) = (alpha[0] * w.x, alpha[1] * w.y);
    let across = (x * x + y * y).sqrt();
    if across == 0.0 {
        return 0.0;
    }
    let a = w.z.abs() / across;
    // exp(−a²) is below the smallest float beyond; Λ was below rounding long before.
    if a > 5.0 {
        return 0.0;
    }
    let t = 1.0 / (1.0 + 0.5 * a);
    const C: [f32; 10] = [
        -1.265_512_2,
        1.000_023_7,
        0.374_091_96,
        0.096_784_18,
        -0.186_288_06,
        0.278_868_07,
        -1.135_204,
        1.488_515_9,
        -0.822_152_23,
        0.170_872_77,
    ];
    // erfc(a) exp(a²): the common factor keeps the difference from cancelling early.
    let scaled = t * C.iter().rev().fold(0.0, |sum, c| sum * t + c).exp();
    let lambda = 0.5 * (-a * a).exp() * (1.0 / (a * PI.sqrt()) - scaled);
    lambda.max(0.0)
}

/// Reflection by facets between two directions of the upper hemisphere. `None` where they reflect nothing.
#[inline]
pub fn reflection(
    distribution: Distribution,
    masking: Masking,
    alpha: [f32; 2],
    wo: Vec3,
    wi: Vec3,
) -> Option<Reflection> {
    let h = wo + wi;
    let hh = h.dot(h);
    let d = distribution.d(alpha, h, hh);
    // NaN is nothing, too: a zero half vector of two directions that graze the surface on opposite sides.
    if d.is_nan() || d <= 0.0 {
        return None;
    }
    // |h|² = 2 + 2 wo·wi and wo·h = 1 + wo·wi.
    let cos = 0.5 * hh.sqrt();
    let (value, forward, reverse) = match distribution {
        Distribution::Ggx => {
            let (so, si) = (stretched(alpha, wo), stretched(alpha, wi));
            // G2/(4 wo.z), with G2/(4 wo.z wi.z) in the form without a quotient of small numbers.
            let value = wi.z
                * match masking {
                    Masking::HeightCorrelated => 0.5 / (wo.z * si + wi.z * so),
                    Masking::Separable => 1.0 / ((wo.z + so) * (wi.z + si)),
                };
            // Visible normals: G1(wo) D (wo·m)/wo.z · dωm/dωi, dωm/dωi = 1/(4 wo·m) [Heitz14], [Walter07 (14)].
            (value, 0.5 / (wo.z + so), 0.5 / (wi.z + si))
        }
        Distribution::Beckmann => {
            let (lo, li) = (beckmann_lambda(alpha, wo), beckmann_lambda(alpha, wi));
            let g = match masking {
                Masking::HeightCorrelated => 1.0 / (1.0 + lo + li),
                Masking::Separable => 1.0 / ((1.0 + lo) * (1.0 + li)),
            };
            // D m.z/(4 wo·m) with m.z = h.z/|h| and wo·m = |h|/2.
            let pdf = 0.5 * h.z / hh;
            (0.25 * g / wo.z, pdf, pdf)
        }
    };
    Some(Reflection { d, cos, value, forward, reverse })
}

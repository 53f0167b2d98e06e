//! Probability densities that carry their measure in their type, and the only conversions between measures.
//!
//! A value of zero means *impossible*. A delta distribution is never written as a density at all: whatever samples
//! one says so beside it (`BsdfSample::delta`, `Light::is_delta`), because a zero that stands for "delta" gives
//! weight to techniques that cannot make the path (the source report's `remap0`).

/// Density per unit solid angle, sr⁻¹.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct SolidAnglePdf(pub f32);

/// Density of an edge's directions such that `p_A = pdf |cosθ| / d²` at its far end: per unit solid angle where edges
/// start from a point. Parallel edges have a density per unit area across them, for which d² is read as 1.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct EdgePdf(pub f64);

/// Density per unit area of render space.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct AreaPdf(pub f64);

/// Density of a light's point in the measure that such points have: per unit area of render space on a surface, per unit
/// solid angle (of the directions toward it) at infinity, and the unit mass 1 at a delta light.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct LightPointPdf(pub f64);

/// Density of the edge that leaves a light's point: per unit solid angle or, from a point at infinity, per unit area
/// perpendicular to the edge.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct EmissionPdf(pub f64);

/// Probability of a discrete choice.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Pmf(pub f32);

impl SolidAnglePdf {
    /// The density that cannot occur.
    pub const IMPOSSIBLE: Self = Self(0.0);

    /// The same density per unit area of a surface seen at distance² `d2` under the cosine `cos` between its
    /// geometric normal and the line of sight: `p_A = p_ω |cosθ| / d²` [Veach97 (8.9)].
    #[inline(always)]
    pub fn to_area(self, cos: f32, d2: f64) -> AreaPdf {
        AreaPdf(f64::from(self.0) * f64::from(cos.abs()) / d2)
    }
}

impl EdgePdf {
    /// The density per unit area of a surface at the far end: `p_A = pdf |cosθ| / d²`.
    #[inline(always)]
    pub fn to_area(self, cos: f32, d2: f64) -> AreaPdf {
        AreaPdf(self.0 * f64::from(cos.abs()) / d2)
    }
}

impl AreaPdf {
    /// The same density per unit solid angle, seen from distance² `d2` under the cosine `cos` at the surface:
    /// `p_ω = p_A d² / |cosθ|` [Veach97 (8.9)]. Edge-on surfaces subtend nothing: impossible.
    #[inline(always)]
    pub fn to_solid_angle(self, cos: f32, d2: f64) -> SolidAnglePdf {
        let cos = f64::from(cos.abs());
        if cos > 0.0 { SolidAnglePdf((self.0 * d2 / cos) as f32) } else { SolidAnglePdf::IMPOSSIBLE }
    }
}

impl LightPointPdf {
    /// The density that cannot occur.
    pub const IMPOSSIBLE: Self = Self(0.0);

    /// The unit mass of a delta light's only point.
    pub const UNIT_MASS: Self = Self(1.0);
}

impl From<AreaPdf> for LightPointPdf {
    fn from(pdf: AreaPdf) -> Self {
        Self(pdf.0)
    }
}

impl std::ops::Mul<Pmf> for LightPointPdf {
    type Output = Self;
    #[inline(always)]
    fn mul(self, choice: Pmf) -> Self {
        Self(self.0 * f64::from(choice.0))
    }
}

impl EmissionPdf {
    /// The density that cannot occur.
    pub const IMPOSSIBLE: Self = Self(0.0);
}

impl From<SolidAnglePdf> for EmissionPdf {
    fn from(pdf: SolidAnglePdf) -> Self {
        Self(f64::from(pdf.0))
    }
}

impl std::ops::Mul<Pmf> for AreaPdf {
    type Output = Self;
    #[inline(always)]
    fn mul(self, choice: Pmf) -> Self {
        Self(self.0 * f64::from(choice.0))
    }
}

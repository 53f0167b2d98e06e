//! Oren–Nayar's rough diffuse surface, and the phenomenological lobes of Phong and Blinn in their reciprocal forms.

use std::f32::consts::{FRAC_1_PI, PI};

use super::local::{Local, mirror};
use super::{BsdfSample, BsdfValue, Transport, adjoint_factor};
use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;
use crate::sampling::warp::{cosine_hemisphere, cosine_hemisphere_pdf, cosine_power};

/// Which formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The qualitative model of [OrenNayar94 (30)], `A + B max(0, cos(φi − φo)) sin α tan β`.
    OrenNayar {
        /// Constant term.
        a: f32,
        /// Factor of the retroreflecting term.
        b: f32,
    },
    /// `(n + 2)/(2π) cosⁿ` of the angle to the mirror direction [Lafortune94].
    Phong {
        /// n.
        exponent: f32,
    },
    /// `(n·h)ⁿ` of the half vector h, normalised to reflect everything at normal incidence.
    BlinnPhong {
        /// n.
        exponent: f32,
    },
}

/// Parameters of one of these models.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Empirical {
    /// Factor of the whole.
    pub albedo: [f32; 3],
    /// Which formula.
    pub shape: Shape,
    /// Whether the back reflects as well.
    pub two_sided: bool,
}

impl Shape {
    /// Oren and Nayar's model for facets whose slope angles have the standard deviation `sigma`, radians.
    ///
    /// Its albedo A + B G(θ) grows to A + B/2 at grazing angles, up to 1.5 % above 1 for small σ. There the model is
    /// divided by that number: it stays reciprocal and creates no energy.
    pub fn oren_nayar(sigma: f32) -> Self {
        let s2 = sigma * sigma;
        let (a, b) = (1.0 - 0.5 * s2 / (s2 + 0.33), 0.45 * s2 / (s2 + 0.09));
        let most = (a + 0.5 * b).max(1.0);
        Self::OrenNayar { a: a / most, b: b / most }
    }

    /// BSDF × cosine of a white surface, and the density of `wi` given `wo`, for two directions of the upper hemisphere.
    /// Phong's and Blinn's densities do not change when the two are exchanged.
    fn value(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        match *self {
            Self::OrenNayar { a, b } => {
                // cos(φi − φo) sinα tanβ = (sinθi sinθo cos(φi − φo))/max(cosθi, cosθo).
                let across = (wo.x * wi.x + wo.y * wi.y).max(0.0);
                let f = FRAC_1_PI * (a + b * across / wo.z.max(wi.z));
                (f * wi.z, cosine_hemisphere_pdf(wi.z))
            }
            Self::Phong { exponent } => {
                let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
                // cos = 1 − |wi − mirror|²/2 keeps the digits that narrow lobes are made of.
                let versine = 0.5 * (wi - mirror).length_squared();
                if versine >= 1.0 {
                    return (0.0, 0.0);
                }
                let power = (exponent * (-versine).ln_1p()).exp();
                let lobe = power / (2.0 * PI);
                ((exponent + 2.0) * lobe * wi.z, (exponent + 1.0) * lobe)
            }
            Self::BlinnPhong { exponent: n } => {
                let h = wo + wi;
                let hh = h.dot(h);
                // cos² = 1 − sin².
                let sin2 = ((h.x * h.x + h.y * h.y) / hh).min(1.0);
                let power = (0.5 * n * (-sin2).ln_1p()).exp();
                let norm = (n + 2.0) * (n + 4.0) / (8.0 * PI * ((-0.5 * n).exp2() + n));
                // h by its own density (n+1)/(2π) cosⁿ, dωh/dωi = 1/(4 wo·h), wo·h = |h|/2.
                (norm * power * wi.z, (n + 1.0) * power / (4.0 * PI * hh.sqrt()))
            }
        }
    }

    fn is_symmetric(&self) -> bool {
        !matches!(self, Self::OrenNayar { .. })
    }

    fn sample(&self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        match *self {
            Self::OrenNayar { .. } => cosine_hemisphere(u),
            Self::Phong { exponent } => {
                crate::math::Frame::from_normal(mirror(wo, Vec3::Z)).to_world(cosine_power(exponent, u))
            }
            Self::BlinnPhong { exponent } => mirror(wo, cosine_power(exponent, u)),
        }
    }
}

impl Empirical {
    pub(super) fn sample(&self, at: &SurfacePoint, wo: Vec3, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let local = Local::new(at, wo, self.two_sided, [1.0, 0.0])?;
        let wi = self.shape.sample(local.wo, u);
        // What a lobe sends below the horizon is absorbed.
        if wi.z <= 0.0 {
            return None;
        }
        let world = local.to_world(at, wi)?;
        let value = self.between(&local, wi)?;
        let weight = value.f * (adjoint_factor(at, wo, world, transport) / value.pdf_fwd.0);
        let (pdf_fwd, pdf_rev) = (value.pdf_fwd, value.pdf_rev);
        Some(BsdfSample { wi: world, weight, pdf_fwd, pdf_rev, delta: false, eta_scale: 1.0 })
    }

    pub(super) fn eval(&self, at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> Option<BsdfValue> {
        let local = Local::new(at, wo, self.two_sided, [1.0, 0.0])?;
        let to = local.reflected(at, wi)?;
        let value = self.between(&local, to)?;
        Some(BsdfValue { f: value.f * adjoint_factor(at, wo, wi, transport), ..value })
    }

    /// Without the adjoint factor.
    fn between(&self, local: &Local, wi: Vec3) -> Option<BsdfValue> {
        let (f, pdf) = self.shape.value(local.wo, wi);
        let reverse = if self.shape.is_symmetric() { pdf } else { cosine_hemisphere_pdf(local.wo.z) };
        // Far out a narrow lobe's density underflows, and the other way alike.
        (pdf > 0.0).then_some(BsdfValue {
            f: Rgb::from(self.albedo) * f,
            pdf_fwd: SolidAnglePdf(pdf),
            pdf_rev: SolidAnglePdf(reverse),
        })
    }
}

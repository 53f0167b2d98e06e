//! A diffuse base under a smooth or rough dielectric coat.
//!
//! The base sees what the coat lets through: with E(θ) the fraction that the coat reflects, Ē its hemispherical mean,
//!
//! ```text
//! f_base = ρ' (1 − E(θo)) (1 − E(θi)) / (π (1 − Ē)),      ρ' = ρ (1 − Ēi)/(1 − ρ Ēi) if `nonlinear`, else ρ
//! ```
//!
//! [Kelemen01], so that coat and base together reflect E + ρ'(1 − E) ≤ 1. Ēi = 1 − (1 − Ē)/η² is the mean reflectance
//! from inside; ρ' sums the light that goes back and forth under the coat, colours included. For a smooth coat this is
//! `plastic` of Mitsuba [Mitsuba3], since (1 − Ēi) η² = 1 − Ē.

use std::f32::consts::FRAC_1_PI;

use super::coat::{Coat, smooth_mean};
use super::fresnel::fresnel_dielectric;
use super::local::{Local, mirror};
use super::microfacet::{Distribution, Masking, SMOOTH, reflection};
use super::{BsdfSample, BsdfValue, Transport, adjoint_factor};
use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;
use crate::sampling::warp::{cosine_hemisphere, cosine_hemisphere_pdf};

/// A plastic's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plastic {
    /// ρ' of the base, divided by 1 − Ē.
    base: [f32; 3],
    /// Mean of ρ' over the channels, which the choice between the lobes follows.
    base_mean: f32,
    /// Index of the coat over that of the outside, at least 1.
    ior: f32,
    /// Of the coat; without `coat` it is smooth.
    alpha: f32,
    coat: Option<&'static Coat>,
    two_sided: bool,
}

/// Coat and base between two directions of one side.
#[derive(Clone, Copy, Debug)]
struct Mixture {
    f: Rgb,
    forward: f32,
    reverse: f32,
}

impl Plastic {
    /// A base of the given albedo under a coat of the index `ior` ≥ 1 and the roughness `alpha`, GGX with separable
    /// masking.
    pub fn new(albedo: Rgb, ior: f32, alpha: f32, nonlinear: bool, two_sided: bool) -> Self {
        let coat = (alpha >= SMOOTH).then(|| Coat::of(ior));
        let mean = coat.map_or_else(|| smooth_mean(ior), |c| c.mean(alpha));
        let inside = 1.0 - (1.0 - mean) / (ior * ior);
        let base = if nonlinear { albedo * (1.0 - inside) / (Rgb::ONE - albedo * inside) } else { albedo };
        let base_mean = base.element_sum() / 3.0;
        Self { base: (base / (1.0 - mean)).to_array(), base_mean, ior, alpha, coat, two_sided }
    }

    /// Roughness of the coat.
    pub fn alpha(&self) -> f32 {
        self.alpha
    }

    /// Index of refraction of the coat over what is outside it.
    pub fn ior(&self) -> f32 {
        self.ior
    }

    /// Whether the back reflects as well.
    pub fn two_sided(&self) -> bool {
        self.two_sided
    }

    /// Whether the coat is a delta lobe.
    pub fn is_smooth(&self) -> bool {
        self.coat.is_none()
    }

    /// E at a cosine, and the probability of sampling the coat from there. Either walk knows both cosines.
    #[inline]
    fn coat_at(&self, cos: f32) -> (f32, f32) {
        let e = match self.coat {
            Some(coat) => coat.albedo(self.alpha, cos),
            None => fresnel_dielectric(cos, self.ior).0,
        };
        let base = (1.0 - e) * self.base_mean;
        // Nothing reflects: 0/0.
        (e, if e > 0.0 { e / (e + base) } else { 0.0 })
    }

    /// All but the delta lobe.
    fn mixture(&self, wo: Vec3, wi: Vec3) -> Option<Mixture> {
        let ((eo, po), (ei, pi)) = (self.coat_at(wo.z), self.coat_at(wi.z));
        let f = Rgb::from(self.base) * (FRAC_1_PI * wi.z * (1.0 - eo) * (1.0 - ei));
        let mut sum = Mixture {
            f,
            forward: (1.0 - po) * cosine_hemisphere_pdf(wi.z),
            reverse: (1.0 - pi) * cosine_hemisphere_pdf(wo.z),
        };
        if self.coat.is_some() {
            if let Some(r) = reflection(Distribution::Ggx, Masking::Separable, [self.alpha; 2], wo, wi) {
                let (fresnel, _) = fresnel_dielectric(r.cos, self.ior);
                sum.f += Rgb::splat(fresnel * r.d * r.value);
                sum.forward += po * r.d * r.forward;
                sum.reverse += pi * r.d * r.reverse;
            }
        }
        (sum.forward > 0.0 && sum.reverse > 0.0).then_some(sum)
    }

    pub(super) fn sample(
        &self,
        at: &SurfacePoint,
        wo: Vec3,
        lobe: f32,
        u: [f32; 2],
        transport: Transport,
    ) -> Option<BsdfSample> {
        let local = Local::new(at, wo, self.two_sided, [1.0, 0.0])?;
        let (e, p) = self.coat_at(local.wo.z);
        let coated = lobe < p;
        let delta = coated && self.coat.is_none();
        let wi = if delta {
            mirror(local.wo, Vec3::Z)
        } else if coated {
            let m = Distribution::Ggx.sample([self.alpha; 2], local.wo, u)?;
            mirror(local.wo, m)
        } else {
            cosine_hemisphere(u)
        };
        if wi.z <= 0.0 {
            return None;
        }
        let world = local.to_world(at, wi)?;
        let adjoint = adjoint_factor(at, wo, world, transport);
        if delta {
            return Some(BsdfSample {
                wi: world,
                weight: Rgb::splat(e / p * adjoint),
                pdf_fwd: SolidAnglePdf(p),
                // The same cosine on the way back.
                pdf_rev: SolidAnglePdf(p),
                delta: true,
                eta_scale: 1.0,
            });
        }
        let sum = self.mixture(local.wo, wi)?;
        Some(BsdfSample {
            wi: world,
            weight: sum.f * (adjoint / sum.forward),
            pdf_fwd: SolidAnglePdf(sum.forward),
            pdf_rev: SolidAnglePdf(sum.reverse),
            delta: false,
            eta_scale: 1.0,
        })
    }

    pub(super) fn eval(&self, at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> Option<BsdfValue> {
        let local = Local::new(at, wo, self.two_sided, [1.0, 0.0])?;
        let to = local.reflected(at, wi)?;
        let sum = self.mixture(local.wo, to)?;
        Some(BsdfValue {
            f: sum.f * adjoint_factor(at, wo, wi, transport),
            pdf_fwd: SolidAnglePdf(sum.forward),
            pdf_rev: SolidAnglePdf(sum.reverse),
        })
    }
}

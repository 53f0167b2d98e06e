//! Rough interface between two dielectrics [Walter07].

use super::fresnel::{fresnel_dielectric, fresnel_transmittance};
use super::local::{Local, mirror};
use super::microfacet::{self, Distribution, Masking, Roughness, reflection, stretched};
use super::{BsdfSample, BsdfValue, Transport, adjoint_factor, radiance_scale};
use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;

/// A rough dielectric's parameters. The facets are GGX, masking is separable as in [Walter07].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoughDielectric {
    /// Index of refraction behind the surface over the index in front of it.
    pub ior: f32,
    /// Fraction of the refracted light that is let through, per channel.
    pub transmittance: [f32; 3],
    /// Of the facets.
    pub roughness: Roughness,
}

/// Value and densities of a pair of local directions, the common factor `common` left out.
#[derive(Clone, Copy, Debug)]
struct Scattering {
    /// D, times the share of light that the facet sends this way.
    common: f32,
    /// BSDF times |wi.z| over `common`; for refraction without `radiance_scale`, that is, for importance.
    value: f32,
    forward: f32,
    reverse: f32,
}

/// The roughness to compute with, or `None` where refraction cannot be told from that of a smooth interface: it spreads
/// by α|η − 1|, and half vectors of directions in f32 are known to 6e-8/|η − 1|.
pub(super) fn rough(ior: f32, alpha: [f32; 2]) -> Option<[f32; 2]> {
    let alpha = microfacet::rough(alpha)?;
    let bend = ior.max(1.0 / ior) - 1.0;
    // As everywhere, a direction that is too narrow beside a wide one is widened.
    (alpha[0].max(alpha[1]) * bend >= 1e-5).then(|| alpha.map(|a| a.max(1e-5 / bend)))
}

impl RoughDielectric {
    /// The index on the far side over that on the side of `wo`.
    #[inline]
    fn eta(&self, front: bool) -> f32 {
        if front { self.ior } else { 1.0 / self.ior }
    }

    /// Both directions local, `wo.z` > 0.
    fn scattering(&self, eta: f32, wo: Vec3, wi: Vec3) -> Option<Scattering> {
        let alpha = self.roughness.alpha;
        if wi.z > 0.0 {
            let r = reflection(Distribution::Ggx, Masking::Separable, alpha, wo, wi)?;
            let (f, _) = fresnel_dielectric(r.cos, eta);
            return Some(Scattering { common: r.d * f, value: r.value, forward: r.forward, reverse: r.reverse })
                .filter(|s| s.common > 0.0);
        }
        // The half vector of refraction points into the rarer medium [Walter07 (16)].
        let h = wo + wi * eta;
        let h = if h.z < 0.0 { -h } else { h };
        let hh = h.dot(h);
        let length = hh.sqrt();
        let (co, ci) = (wo.dot(h) / length, -wi.dot(h) / length);
        // Facets are refracted through from one side to the other: both ways or neither. NaN is neither.
        if !(co > 0.0 && ci > 0.0 && wi.z < 0.0) {
            return None;
        }
        // From the rarer side, where nothing is reflected totally: one number for both directions of travel.
        let t = if eta >= 1.0 { fresnel_transmittance(co, eta) } else { fresnel_transmittance(ci, 1.0 / eta) };
        let common = Distribution::Ggx.d(alpha, h, hh) * t;
        if common.is_nan() || common <= 0.0 {
            return None;
        }
        // G1(w)/|w.z| = 2/(|w.z| + |stretched w|).
        let (go, gi) = (2.0 / (wo.z + stretched(alpha, wo)), 2.0 / (-wi.z + stretched(alpha, wi)));
        // dωm/dωi = η² ci/(co − η ci)², and (co − η ci)² = h·h [Walter07 (17)]; dωm/dωo is the same without η² ci.
        let jacobian = co * ci / hh;
        Some(Scattering {
            common,
            // [Walter07 (21)] times |wi.z| η².
            value: go * gi * -wi.z * jacobian * eta * eta,
            forward: go * jacobian * eta * eta,
            reverse: gi * jacobian,
        })
    }

    pub(super) fn sample(
        &self,
        at: &SurfacePoint,
        wo: Vec3,
        lobe: f32,
        u: [f32; 2],
        transport: Transport,
    ) -> Option<BsdfSample> {
        let local = Local::new(at, wo, true, self.roughness.tangent)?;
        let eta = self.eta(local.front);
        let m = Distribution::Ggx.sample(self.roughness.alpha, local.wo, u)?;
        let cos_o = local.wo.dot(m);
        let (reflectance, cos_t) = fresnel_dielectric(cos_o, eta);
        let reflected = lobe < reflectance;
        let wi = if reflected {
            mirror(local.wo, m)
        } else {
            // Snell: the tangential part shrinks by η, the normal part is −cosθt.
            ((m * cos_o - local.wo) / eta - m * cos_t).normalize()
        };
        // To the other side than a reflection or a refraction leads: another facet would be in the way.
        if (wi.z > 0.0) != reflected {
            return None;
        }
        let world = local.to_world(at, wi)?;
        let s = self.scattering(eta, local.wo, wi)?;
        let scale = if reflected { 1.0 } else { radiance_scale(eta, transport) };
        let tint = if reflected { Rgb::ONE } else { Rgb::from(self.transmittance) };
        Some(BsdfSample {
            wi: world,
            weight: tint * (s.value / s.forward * scale * adjoint_factor(at, wo, world, transport)),
            pdf_fwd: SolidAnglePdf(s.common * s.forward),
            pdf_rev: SolidAnglePdf(s.common * s.reverse),
            delta: false,
            eta_scale: scale,
        })
    }

    pub(super) fn eval(&self, at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> Option<BsdfValue> {
        let local = Local::new(at, wo, true, self.roughness.tangent)?;
        let eta = self.eta(local.front);
        let to = local.to_local(at, wi)?;
        let reflected = to.z > 0.0;
        let s = self.scattering(eta, local.wo, to)?;
        let scale = if reflected { 1.0 } else { radiance_scale(eta, transport) };
        let tint = if reflected { Rgb::ONE } else { Rgb::from(self.transmittance) };
        Some(BsdfValue {
            f: tint * (s.common * s.value * scale * adjoint_factor(at, wo, wi, transport)),
            pdf_fwd: SolidAnglePdf(s.common * s.forward),
            pdf_rev: SolidAnglePdf(s.common * s.reverse),
        })
    }
}

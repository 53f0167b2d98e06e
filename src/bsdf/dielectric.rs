//! Delta lobes: the ideal mirror, the smooth dielectric interface and the thin pane.

use super::fresnel::fresnel_dielectric;
use super::{BsdfSample, Transport, adjoint_factor, radiance_scale};
use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;
use crate::planted::{Bug, planted};

/// The reflection of `wo` about the unit normal `n`.
#[inline]
fn reflect(wo: Vec3, n: Vec3) -> Vec3 {
    (n * (2.0 * wo.dot(n)) - wo).normalize()
}

pub(super) fn sample_mirror(albedo: Rgb, at: &SurfacePoint, wo: Vec3, transport: Transport) -> Option<BsdfSample> {
    let wi = reflect(wo, at.ns);
    // A shading normal may send the reflection through the surface; that light is absorbed.
    if wi.dot(at.ng) * wo.dot(at.ng) <= 0.0 {
        return None;
    }
    Some(BsdfSample {
        wi,
        weight: albedo * adjoint_factor(at, wo, wi, transport),
        pdf_fwd: SolidAnglePdf(1.0),
        pdf_rev: SolidAnglePdf(1.0),
        delta: true,
        eta_scale: 1.0,
    })
}

/// A pane: reflection, or straight transmission, each with what bounces back and forth inside summed up. Reflectance F
/// of one face becomes 2F/(1 + F) of both.
pub(super) fn sample_thin(
    ior: f32,
    at: &SurfacePoint,
    wo: Vec3,
    lobe: f32,
    transport: Transport,
) -> Option<BsdfSample> {
    let front = wo.dot(at.ng) > 0.0;
    let n = if front { at.ns } else { -at.ns };
    let cos_o = wo.dot(n);
    if cos_o <= 0.0 {
        return None;
    }
    let (face, _) = fresnel_dielectric(cos_o, ior);
    let both = 2.0 * face / (1.0 + face);
    let (wi, pdf) = if lobe < both { (reflect(wo, n), both) } else { (-wo, 1.0 - both) };
    if lobe < both && (wi.dot(at.ng) > 0.0) != front {
        return None;
    }
    Some(BsdfSample {
        wi,
        weight: Rgb::splat(adjoint_factor(at, wo, wi, transport)),
        pdf_fwd: SolidAnglePdf(pdf),
        pdf_rev: SolidAnglePdf(pdf),
        delta: true,
        // Both sides are the same medium.
        eta_scale: 1.0,
    })
}

pub(super) fn sample(
    ior: f32,
    transmittance: Rgb,
    at: &SurfacePoint,
    wo: Vec3,
    lobe: f32,
    transport: Transport,
) -> Option<BsdfSample> {
    // Which side is which is the geometric normal's to say; the shading normal only bends the directions.
    let front = wo.dot(at.ng) > 0.0;
    let n = if front { at.ns } else { -at.ns };
    let eta = if front { ior } else { 1.0 / ior };
    let cos_o = wo.dot(n);
    if cos_o <= 0.0 {
        return None;
    }
    let (reflectance, cos_t) = fresnel_dielectric(cos_o, eta);
    if lobe < reflectance {
        let wi = reflect(wo, n);
        if (wi.dot(at.ng) > 0.0) != front {
            return None;
        }
        return Some(BsdfSample {
            wi,
            weight: Rgb::splat(adjoint_factor(at, wo, wi, transport)),
            pdf_fwd: SolidAnglePdf(reflectance),
            pdf_rev: SolidAnglePdf(reflectance),
            delta: true,
            eta_scale: 1.0,
        });
    }
    // Snell: the tangential part shrinks by η, the normal part is −cosθt.
    let wi = ((n * cos_o - wo) / eta - n * cos_t).normalize();
    if (wi.dot(at.ng) > 0.0) == front {
        return None;
    }
    let scale = radiance_scale(eta, transport);
    let pdf = 1.0 - reflectance;
    Some(BsdfSample {
        wi,
        weight: transmittance * (scale * adjoint_factor(at, wo, wi, transport)),
        pdf_fwd: SolidAnglePdf(pdf),
        // The lobe maps dωo onto dωi with η_o² cosθo dωo = η_i² cosθi dωi, so that a density of wo per dωo is one
        // of wi per dωi times dωi/dωo = cosθo / (η² cosθi).
        pdf_rev: SolidAnglePdf(if planted(Bug::NoSolidAngleRatio) { pdf } else { pdf * cos_o / (eta * eta * cos_t) }),
        delta: true,
        eta_scale: scale,
    })
}

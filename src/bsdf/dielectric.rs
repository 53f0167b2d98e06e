//! Delta lobes: the ideal mirror and the smooth dielectric interface.

use super::{BsdfSample, Transport, adjoint_factor, radiance_scale};
use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;

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

/// Unpolarised Fresnel reflectance of a smooth interface and the cosine of the refracted direction (0 under total
/// reflection). `cos_o` is the cosine on the incident side, `eta` the index on the far side over the near one.
///
/// Exact at `eta = 1` (no reflection) and at grazing angles (all): the refracted cosine comes from
/// `η² − 1 + cos²` rather than from `1 − sin²/η²`, which cancels.
#[inline]
pub fn fresnel_dielectric(cos_o: f32, eta: f32) -> (f32, f32) {
    let cos_o = cos_o.clamp(0.0, 1.0);
    // g = η cosθt; g² = η² − 1 + cos²θo.
    let g2 = (eta - 1.0) * (eta + 1.0) + cos_o * cos_o;
    if g2 <= 0.0 {
        return (1.0, 0.0);
    }
    let g = g2.sqrt();
    let perpendicular = ((cos_o - g) / (cos_o + g)).powi(2);
    let e2 = eta * eta;
    let parallel = ((e2 * cos_o - g) / (e2 * cos_o + g)).powi(2);
    (0.5 * (perpendicular + parallel), g / eta)
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
        pdf_rev: SolidAnglePdf(pdf * cos_o / (eta * eta * cos_t)),
        delta: true,
        eta_scale: scale,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hemispherical reflectance ∫F(θ) 2 cosθ sinθ dθ by the midpoint rule in cos²θ.
    fn hemispherical(eta: f32) -> f64 {
        let n = 400_000;
        (0..n).map(|i| f64::from(fresnel_dielectric(((i as f32 + 0.5) / n as f32).sqrt(), eta).0)).sum::<f64>()
            / f64::from(n)
    }

    #[test]
    fn hemispherical_reflectance_of_glass() {
        assert!((hemispherical(1.5) - 0.09178).abs() < 1e-5, "{}", hemispherical(1.5));
        assert!((hemispherical(1.0 / 1.5) - 0.59635).abs() < 2e-5, "{}", hemispherical(1.0 / 1.5));
    }

    #[test]
    fn a_pane_transmits_what_the_slab_formula_says() {
        for (degrees, want) in [(0.0f32, 0.923_077), (45.0, 0.904_327), (60.0, 0.836_232), (80.0, 0.441_229)] {
            let (f, _) = fresnel_dielectric(degrees.to_radians().cos(), 1.5);
            assert!(((1.0 - f) / (1.0 + f) - want).abs() < 2e-6, "{degrees}°");
        }
    }

    #[test]
    fn limits_are_exact() {
        assert_eq!(fresnel_dielectric(0.3, 1.0), (0.0, 0.3));
        assert_eq!(fresnel_dielectric(0.0, 1.5).0, 1.0);
        assert_eq!(fresnel_dielectric(0.5, 1.0 / 1.5), (1.0, 0.0));
        // Reciprocity: the same interface seen along the refracted ray.
        let (f, cos_t) = fresnel_dielectric(0.4, 1.7);
        let (back, cos_o) = fresnel_dielectric(cos_t, 1.0 / 1.7);
        assert!((f - back).abs() < 1e-6 && (cos_o - 0.4).abs() < 1e-6);
    }
}

//! Diffuse reflection.

use std::f32::consts::FRAC_1_PI;

use super::{BsdfSample, BsdfValue, Transport, adjoint_factor};
use crate::geometry::SurfacePoint;
use crate::math::{Frame, Rgb, Vec3};
use crate::pdf::SolidAnglePdf;
use crate::planted::{Bug, planted};
use crate::sampling::warp::{cosine_hemisphere, cosine_hemisphere_pdf};

/// The shading normal on the side `wo` is on, or `None` when nothing is reflected there.
///
/// Sides are decided by the geometric normal. Where the shading normal disagrees with it about `wo`, nothing is
/// reflected: the condition must hold for both directions alike, or the BSDF is not symmetric.
#[inline]
fn facing_normal(two_sided: bool, at: &SurfacePoint, wo: Vec3) -> Option<Vec3> {
    let front = wo.dot(at.ng) > 0.0;
    let n = if front { at.ns } else { -at.ns };
    ((front || two_sided) && wo.dot(n) > 0.0).then_some(n)
}

#[inline]
pub(super) fn sample(
    albedo: Rgb,
    two_sided: bool,
    at: &SurfacePoint,
    wo: Vec3,
    u: [f32; 2],
    transport: Transport,
) -> Option<BsdfSample> {
    let n = facing_normal(two_sided, at, wo)?;
    let local = cosine_hemisphere(u);
    let wi = Frame::from_normal(n).to_world(local);
    let same_side = at.is_flat() || (wi.dot(at.ng) > 0.0) == (wo.dot(at.ng) > 0.0);
    if local.z <= 0.0 || !same_side {
        return None;
    }
    Some(BsdfSample {
        wi,
        weight: albedo * adjoint_factor(at, wo, wi, transport),
        pdf_fwd: SolidAnglePdf(cosine_hemisphere_pdf(local.z)),
        pdf_rev: SolidAnglePdf(cosine_hemisphere_pdf(wo.dot(n))),
        delta: false,
        eta_scale: 1.0,
    })
}

#[inline]
pub(super) fn eval(
    albedo: Rgb,
    two_sided: bool,
    at: &SurfacePoint,
    wo: Vec3,
    wi: Vec3,
    transport: Transport,
) -> Option<BsdfValue> {
    let n = facing_normal(two_sided, at, wo)?;
    let cos = wi.dot(n);
    let same_side = at.is_flat() || (wi.dot(at.ng) > 0.0) == (wo.dot(at.ng) > 0.0);
    // Written so that a NaN is no reflection either.
    if !(cos > 0.0 && same_side) {
        return None;
    }
    let again = if planted(Bug::CosineTwice) { cos } else { 1.0 };
    Some(BsdfValue {
        f: albedo * (FRAC_1_PI * cos * again * adjoint_factor(at, wo, wi, transport)),
        pdf_fwd: SolidAnglePdf(cosine_hemisphere_pdf(cos)),
        pdf_rev: SolidAnglePdf(cosine_hemisphere_pdf(wo.dot(n))),
    })
}

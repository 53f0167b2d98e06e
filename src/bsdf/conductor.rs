//! Metals: reflection by smooth or rough conductors.

use super::fresnel::{fresnel_conductor, fresnel_schlick};
use super::local::{Local, mirror};
use super::microfacet::{Distribution, Masking, Reflection, Roughness, reflection};
use super::{BsdfSample, BsdfValue, Transport, adjoint_factor};
use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;

/// What a conductor's facets reflect. Arrays, not `Rgb`, whose alignment would make every `Bsdf` larger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// Fresnel's formulas with the index η − ik per channel.
    Index {
        /// η.
        eta: [f32; 3],
        /// k.
        k: [f32; 3],
    },
    /// Schlick's approximation from the reflectance at normal incidence.
    Schlick([f32; 3]),
    /// The same at every angle.
    Constant([f32; 3]),
}

impl Reflectance {
    /// At the cosine between a direction and the facet.
    #[inline]
    pub fn at(&self, cos: f32) -> Rgb {
        match *self {
            Self::Index { eta, k } => fresnel_conductor(cos, Rgb::from(eta), Rgb::from(k)),
            Self::Schlick(normal) => fresnel_schlick(cos, Rgb::from(normal)),
            Self::Constant(f) => Rgb::from(f),
        }
    }
}

/// A rough conductor's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Of its facets.
    pub reflectance: Reflectance,
    /// Their distribution's width.
    pub roughness: Roughness,
    /// Their distribution's shape.
    pub distribution: Distribution,
    /// How they hide each other.
    pub masking: Masking,
    /// Whether the back reflects as well.
    pub two_sided: bool,
}

impl Conductor {
    fn reflection(&self, wo: Vec3, wi: Vec3) -> Option<Reflection> {
        reflection(self.distribution, self.masking, self.roughness.alpha, wo, wi)
    }

    pub(super) fn sample(&self, at: &SurfacePoint, wo: Vec3, u: [f32; 2], transport: Transport) -> Option<BsdfSample> {
        let local = Local::new(at, wo, self.two_sided, self.roughness.tangent)?;
        let m = self.distribution.sample(self.roughness.alpha, local.wo, u)?;
        let wi = mirror(local.wo, m);
        if wi.z <= 0.0 {
            return None;
        }
        let r = self.reflection(local.wo, wi)?;
        let world = local.to_world(at, wi)?;
        Some(BsdfSample {
            wi: world,
            // D cancels.
            weight: self.reflectance.at(r.cos) * (r.value / r.forward * adjoint_factor(at, wo, world, transport)),
            pdf_fwd: SolidAnglePdf(r.d * r.forward),
            pdf_rev: SolidAnglePdf(r.d * r.reverse),
            delta: false,
            eta_scale: 1.0,
        })
    }

    pub(super) fn eval(&self, at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> Option<BsdfValue> {
        let local = Local::new(at, wo, self.two_sided, self.roughness.tangent)?;
        let to = local.reflected(at, wi)?;
        let r = self.reflection(local.wo, to)?;
        Some(BsdfValue {
            f: self.reflectance.at(r.cos) * (r.d * r.value * adjoint_factor(at, wo, wi, transport)),
            pdf_fwd: SolidAnglePdf(r.d * r.forward),
            pdf_rev: SolidAnglePdf(r.d * r.reverse),
        })
    }
}

pub(super) fn sample_smooth(
    reflectance: &Reflectance,
    two_sided: bool,
    at: &SurfacePoint,
    wo: Vec3,
    transport: Transport,
) -> Option<BsdfSample> {
    let local = Local::new(at, wo, two_sided, [1.0, 0.0])?;
    let wi = local.to_world(at, mirror(local.wo, Vec3::Z))?;
    Some(BsdfSample {
        wi,
        weight: reflectance.at(local.wo.z) * adjoint_factor(at, wo, wi, transport),
        pdf_fwd: SolidAnglePdf(1.0),
        pdf_rev: SolidAnglePdf(1.0),
        delta: true,
        eta_scale: 1.0,
    })
}

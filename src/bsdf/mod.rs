//! How surfaces scatter. One enum, one contract, one file per model.
//!
//! Contract: `wo` points to the previous vertex of the subpath, `wi` to the next; both are unit vectors in render
//! space, and densities are per solid angle of the direction they belong to. `eval` and `sample` return the product
//! `F` of BSDF and cosine that a subpath multiplies its throughput by, with everything a shading normal or a change
//! of medium adds for the quantity carried (`Transport`):
//!
//! - radiance (camera subpaths): `F = f(wo, wi)·|wi·ns|`;
//! - importance (light subpaths): `F = f(wi, wo)·|wi·ns|·adjoint_factor`, [Veach97 (5.19)].
//!
//! The forward density (of `wi` given `wo`) and the reverse one (of `wo` given `wi`) come from one call.

mod coat;
mod conductor;
mod dielectric;
mod empirical;
mod fresnel;
mod lambertian;
mod local;
mod microfacet;
mod plastic;
mod rough_dielectric;
mod steepness;

pub use conductor::{Conductor, Reflectance};
pub use empirical::{Empirical, Shape};
pub use fresnel::{fresnel_conductor, fresnel_dielectric, fresnel_schlick, hemispherical_dielectric};
pub use microfacet::{Distribution, Masking, Roughness};
pub use plastic::Plastic;
pub use rough_dielectric::RoughDielectric;

use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;
use crate::planted::{Bug, planted};

/// What a subpath carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Camera subpaths gather radiance.
    Radiance,
    /// Light subpaths spread power, which importance measures.
    Importance,
}

/// A scattering model with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// Reflects nothing.
    Black,
    /// Diffuse reflection with the given albedo, on the normal's side only unless `two_sided`.
    Lambertian {
        /// Reflected fraction per channel, in [0, 1].
        albedo: Rgb,
        /// Whether the back reflects as well.
        two_sided: bool,
    },
    /// Ideal mirror, on both sides.
    Mirror {
        /// Reflected fraction per channel, in [0, 1].
        albedo: Rgb,
    },
    /// Smooth interface between two dielectrics.
    Dielectric {
        /// Index of refraction behind the surface over the index in front of it.
        ior: f32,
        /// Fraction of the refracted light that is let through, per channel.
        transmittance: Rgb,
    },
    /// Index-matched window: paths go straight through, connections are blocked.
    Null,
    /// Rough conductor.
    Conductor(Conductor),
    /// Smooth conductor.
    SmoothConductor {
        /// Of the surface.
        reflectance: Reflectance,
        /// Whether the back reflects as well.
        two_sided: bool,
    },
    /// Rough interface between two dielectrics.
    RoughDielectric(RoughDielectric),
    /// Thin pane: reflects, and lets through without bending.
    ThinDielectric {
        /// Index of refraction of the pane over that around it.
        ior: f32,
    },
    /// Diffuse base under a dielectric coat. A smooth coat is a delta lobe beside the base's, which is not.
    Plastic(Plastic),
    /// Oren–Nayar, Phong, Blinn–Phong.
    Empirical(Empirical),
}

/// A sampled continuation of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The direction to go on in, unit length.
    pub wi: Vec3,
    /// `F / pdf_fwd`: what the throughput is multiplied by.
    pub weight: Rgb,
    /// Density of `wi` given `wo`. For a delta lobe the probability of the lobe.
    pub pdf_fwd: SolidAnglePdf,
    /// Density of `wo` given `wi`. For a delta lobe in the units of `pdf_fwd`: the probability of the lobe times
    /// the ratio of the solid angles dωi/dωo that the lobe maps onto each other.
    pub pdf_rev: SolidAnglePdf,
    /// Whether a delta lobe was sampled: the vertex cannot be connected to along this path.
    pub delta: bool,
    /// What the change of medium multiplied the radiance by; 1 for reflection. Roulette leaves it out.
    pub eta_scale: f32,
}

/// A BSDF's value for a given pair of directions; delta lobes are left out.
#[derive(Clone, Copy, Debug)]
pub struct BsdfValue {
    /// `F`: BSDF times cosine times the factors of the transport.
    pub f: Rgb,
    /// Density with which `sample` finds `wi` given `wo`.
    pub pdf_fwd: SolidAnglePdf,
    /// Density with which `sample` finds `wo` given `wi`.
    pub pdf_rev: SolidAnglePdf,
}

impl Bsdf {
    /// Whether connections can be made at the surface: some lobe is not a delta.
    #[inline]
    pub fn is_connectible(&self) -> bool {
        match self {
            Self::Lambertian { .. }
            | Self::Conductor(_)
            | Self::RoughDielectric(_)
            | Self::Plastic(_)
            | Self::Empirical(_) => true,
            Self::Black
            | Self::Mirror { .. }
            | Self::Dielectric { .. }
            | Self::Null
            | Self::SmoothConductor { .. }
            | Self::ThinDielectric { .. } => false,
        }
    }

    /// Whether some lobe is a delta, which no connection finds.
    pub fn has_delta_lobe(&self) -> bool {
        match self {
            Self::Mirror { .. }
            | Self::Dielectric { .. }
            | Self::SmoothConductor { .. }
            | Self::ThinDielectric { .. } => true,
            Self::Plastic(plastic) => plastic.is_smooth(),
            Self::Lambertian { .. }
            | Self::Black
            | Self::Null
            | Self::Conductor(_)
            | Self::RoughDielectric(_)
            | Self::Empirical(_) => false,
        }
    }

    /// A conductor of GGX or Beckmann facets with the roughness `alpha` along and across the tangent; a smooth one
    /// below what can be told from it.
    pub fn conductor(
        reflectance: Reflectance,
        alpha: [f32; 2],
        distribution: Distribution,
        masking: Masking,
        two_sided: bool,
    ) -> Self {
        match microfacet::rough(alpha) {
            Some(alpha) => {
                let roughness = Roughness::new(alpha);
                Self::Conductor(Conductor { reflectance, roughness, distribution, masking, two_sided })
            }
            None => Self::SmoothConductor { reflectance, two_sided },
        }
    }

    /// An interface between two dielectrics with GGX facets of the roughness `alpha` along and across the tangent; a
    /// smooth one below what can be told from it.
    pub fn dielectric(ior: f32, transmittance: Rgb, alpha: [f32; 2]) -> Self {
        match rough_dielectric::rough(ior, alpha) {
            Some(alpha) => {
                let (transmittance, roughness) = (transmittance.to_array(), Roughness::new(alpha));
                Self::RoughDielectric(RoughDielectric { ior, transmittance, roughness })
            }
            None => Self::Dielectric { ior, transmittance },
        }
    }

    /// Whether connections may pass from one side to the other.
    #[inline]
    pub fn transmits(&self) -> bool {
        matches!(self, Self::RoughDielectric(_))
    }

    /// Whether `sample` looks at its number `lobe`: others need not draw one.
    #[inline]
    pub fn chooses_lobe(&self) -> bool {
        match self {
            Self::Dielectric { .. } | Self::RoughDielectric(_) | Self::ThinDielectric { .. } | Self::Plastic(_) => true,
            Self::Black
            | Self::Lambertian { .. }
            | Self::Mirror { .. }
            | Self::Null
            | Self::Conductor(_)
            | Self::SmoothConductor { .. }
            | Self::Empirical(_) => false,
        }
    }

    /// Whether the model scatters at all.
    #[inline]
    pub fn scatters(&self) -> bool {
        !matches!(self, Self::Black)
    }

    /// Continues a subpath at `at`, which it reached from `wo`. `lobe` chooses between lobes, `u` the direction.
    /// `None` when the path is absorbed.
    #[inline]
    pub fn sample(
        &self,
        at: &SurfacePoint,
        wo: Vec3,
        lobe: f32,
        u: [f32; 2],
        transport: Transport,
    ) -> Option<BsdfSample> {
        match *self {
            Self::Lambertian { albedo, two_sided } => lambertian::sample(albedo, two_sided, at, wo, u, transport),
            Self::Mirror { albedo } => dielectric::sample_mirror(albedo, at, wo, transport),
            Self::Dielectric { ior, transmittance } => dielectric::sample(ior, transmittance, at, wo, lobe, transport),
            Self::Black | Self::Null => None,
            _ => self.sample_other(at, wo, lobe, u, transport),
        }
    }

    /// The value and densities for the directions `wo` and `wi`, or `None` where they are zero.
    #[inline]
    pub fn eval(&self, at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> Option<BsdfValue> {
        match *self {
            Self::Lambertian { albedo, two_sided } => lambertian::eval(albedo, two_sided, at, wo, wi, transport),
            Self::Mirror { .. } | Self::Dielectric { .. } | Self::Black | Self::Null => None,
            _ => self.eval_other(at, wo, wi, transport),
        }
    }

    /// The larger models, kept out of the loops that `sample` is inlined into: a scene without them pays nothing.
    #[inline(never)]
    fn sample_other(
        &self,
        at: &SurfacePoint,
        wo: Vec3,
        lobe: f32,
        u: [f32; 2],
        transport: Transport,
    ) -> Option<BsdfSample> {
        match self {
            Self::Conductor(b) => b.sample(at, wo, u, transport),
            Self::SmoothConductor { reflectance, two_sided } => {
                conductor::sample_smooth(reflectance, *two_sided, at, wo, transport)
            }
            Self::RoughDielectric(b) => b.sample(at, wo, lobe, u, transport),
            Self::ThinDielectric { ior } => dielectric::sample_thin(*ior, at, wo, lobe, transport),
            Self::Plastic(b) => b.sample(at, wo, lobe, u, transport),
            Self::Empirical(b) => b.sample(at, wo, u, transport),
            Self::Lambertian { .. } | Self::Mirror { .. } | Self::Dielectric { .. } | Self::Black | Self::Null => None,
        }
    }

    /// See `sample_other`.
    #[inline(never)]
    fn eval_other(&self, at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> Option<BsdfValue> {
        match self {
            Self::Conductor(b) => b.eval(at, wo, wi, transport),
            Self::RoughDielectric(b) => b.eval(at, wo, wi, transport),
            Self::Plastic(b) => b.eval(at, wo, wi, transport),
            Self::Empirical(b) => b.eval(at, wo, wi, transport),
            Self::SmoothConductor { .. }
            | Self::ThinDielectric { .. }
            | Self::Lambertian { .. }
            | Self::Mirror { .. }
            | Self::Dielectric { .. }
            | Self::Black
            | Self::Null => None,
        }
    }
}

/// What makes a BSDF with a shading normal adjoint to itself when importance is carried instead of radiance:
/// `|wo·ns| |wi·ng| / (|wo·ng| |wi·ns|)` [Veach97 (5.19)]. 1 for flat surfaces and for radiance.
#[inline]
pub fn adjoint_factor(at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> f32 {
    if transport == Transport::Radiance || at.is_flat() || planted(Bug::NoAdjointFactor) {
        return 1.0;
    }
    let numerator = wo.dot(at.ns).abs() * wi.dot(at.ng).abs();
    let denominator = wo.dot(at.ng).abs() * wi.dot(at.ns).abs();
    if denominator > 0.0 { numerator / denominator } else { 0.0 }
}

/// What refraction multiplies radiance by: `(η_o/η_i)²`, the indices on the sides of `wo` and `wi`
/// [Veach97 (5.13)]. Importance is not scaled. `eta` is η_i/η_o.
#[inline]
pub fn radiance_scale(eta: f32, transport: Transport) -> f32 {
    match transport {
        Transport::Radiance if planted(Bug::NoRadianceScale) => 1.0,
        Transport::Importance if planted(Bug::ImportanceScaled) => 1.0 / (eta * eta),
        Transport::Radiance => 1.0 / (eta * eta),
        Transport::Importance => 1.0,
    }
}

#[cfg(test)]
mod tests;

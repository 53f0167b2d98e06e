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

mod dielectric;
mod lambertian;

pub use dielectric::fresnel_dielectric;

use crate::geometry::SurfacePoint;
use crate::math::{Rgb, Vec3};
use crate::pdf::SolidAnglePdf;

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
        matches!(self, Self::Lambertian { .. })
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
        }
    }

    /// The value and densities for the directions `wo` and `wi`, or `None` where they are zero.
    #[inline]
    pub fn eval(&self, at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> Option<BsdfValue> {
        match *self {
            Self::Lambertian { albedo, two_sided } => lambertian::eval(albedo, two_sided, at, wo, wi, transport),
            Self::Mirror { .. } | Self::Dielectric { .. } | Self::Black | Self::Null => None,
        }
    }
}

/// What makes a BSDF with a shading normal adjoint to itself when importance is carried instead of radiance:
/// `|wo·ns| |wi·ng| / (|wo·ng| |wi·ns|)` [Veach97 (5.19)]. 1 for flat surfaces and for radiance.
#[inline]
pub fn adjoint_factor(at: &SurfacePoint, wo: Vec3, wi: Vec3, transport: Transport) -> f32 {
    if transport == Transport::Radiance || at.flat {
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
        Transport::Radiance => 1.0 / (eta * eta),
        Transport::Importance => 1.0,
    }
}

//! From a material as written to the scattering model of a point: parameters are looked up, models are chosen.

use super::desc::{Color, MaterialKind, Param, is_black};
use crate::bsdf::Bsdf;
use crate::math::{DVec3, Rgb};

/// Finds the values of parameters: those that are the same everywhere, or those at a point.
pub(super) trait Lookup {
    /// A colour.
    fn color(&self, param: &Param<Color>) -> Color;
}

/// Looks up parameters that are the same everywhere.
pub(super) struct Constants;

impl Lookup for Constants {
    fn color(&self, param: &Param<Color>) -> Color {
        let Param::Value(value) = *param;
        value
    }
}

/// A colour as rendering has it.
pub(super) fn rgb(c: Color) -> Rgb {
    DVec3::from(c).as_vec3a()
}

/// The scattering model of a material whose parameters `lookup` knows. Materials that scatter nothing are
/// `Bsdf::Black`: walks end there without sampling.
pub(super) fn bsdf(kind: &MaterialKind, lookup: &impl Lookup) -> Bsdf {
    match kind {
        MaterialKind::Lambertian { albedo, two_sided } => {
            let albedo = lookup.color(albedo);
            if is_black(albedo) { Bsdf::Black } else { Bsdf::Lambertian { albedo: rgb(albedo), two_sided: *two_sided } }
        }
        MaterialKind::Mirror { albedo } => {
            let albedo = lookup.color(albedo);
            if is_black(albedo) { Bsdf::Black } else { Bsdf::Mirror { albedo: rgb(albedo) } }
        }
        MaterialKind::Dielectric { ior, transmittance } => {
            Bsdf::Dielectric { ior: *ior as f32, transmittance: rgb(lookup.color(transmittance)) }
        }
        MaterialKind::Null => Bsdf::Null,
        MaterialKind::Black | MaterialKind::PointLight { .. } | MaterialKind::SpotLight { .. } => Bsdf::Black,
    }
}

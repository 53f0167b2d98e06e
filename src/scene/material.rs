//! From a material as written to the scattering model of a point: parameters are looked up, models are chosen.

use super::desc::{Color, EmpiricalModel, Facets, FresnelDesc, MaterialKind, Param, is_black};
use crate::bsdf::{Bsdf, Distribution, Empirical, Masking, Plastic, Reflectance, Shape};
use crate::math::{DVec3, Rgb};

/// Finds the values of parameters: those that are the same everywhere, or those at a point.
pub(super) trait Lookup {
    /// A colour.
    fn color(&self, param: &Param<Color>) -> Color;

    /// A number.
    fn scalar(&self, param: &Param<f64>) -> f64;
}

/// Looks up parameters that are the same everywhere.
pub(super) struct Constants;

impl Lookup for Constants {
    fn color(&self, param: &Param<Color>) -> Color {
        let Param::Value(value) = *param;
        value
    }

    fn scalar(&self, param: &Param<f64>) -> f64 {
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
        MaterialKind::Dielectric { ior, transmittance, roughness } => {
            Bsdf::dielectric(*ior as f32, rgb(lookup.color(transmittance)), alphas(roughness, lookup))
        }
        MaterialKind::Conductor { fresnel, roughness, facets, separable_masking, two_sided } => {
            let color = |param| rgb(lookup.color(param)).to_array();
            let reflectance = match fresnel {
                FresnelDesc::Index { eta, k } => Reflectance::Index { eta: color(eta), k: color(k) },
                FresnelDesc::Schlick { albedo } => Reflectance::Schlick(color(albedo)),
                FresnelDesc::Constant { albedo } => Reflectance::Constant(color(albedo)),
            };
            if reflectance == Reflectance::Constant([0.0; 3]) {
                return Bsdf::Black;
            }
            let distribution = match facets {
                Facets::Ggx => Distribution::Ggx,
                Facets::Beckmann => Distribution::Beckmann,
            };
            let masking = if *separable_masking { Masking::Separable } else { Masking::HeightCorrelated };
            Bsdf::conductor(reflectance, alphas(roughness, lookup), distribution, masking, *two_sided)
        }
        MaterialKind::Plastic { albedo, ior, roughness, nonlinear, two_sided } => {
            let (albedo, alpha) = (rgb(lookup.color(albedo)), lookup.scalar(roughness) as f32);
            Bsdf::Plastic(Plastic::new(albedo, *ior as f32, alpha, *nonlinear, *two_sided))
        }
        MaterialKind::ThinDielectric { ior } => Bsdf::ThinDielectric { ior: *ior as f32 },
        MaterialKind::Empirical { albedo, model, two_sided } => {
            let albedo = lookup.color(albedo);
            if is_black(albedo) {
                return Bsdf::Black;
            }
            let shape = match model {
                EmpiricalModel::OrenNayar { sigma } => Shape::oren_nayar(lookup.scalar(sigma) as f32),
                EmpiricalModel::Phong { exponent } => Shape::Phong { exponent: lookup.scalar(exponent) as f32 },
                EmpiricalModel::BlinnPhong { exponent } => {
                    Shape::BlinnPhong { exponent: lookup.scalar(exponent) as f32 }
                }
            };
            Bsdf::Empirical(Empirical { albedo: rgb(albedo).to_array(), shape, two_sided: *two_sided })
        }
        MaterialKind::Null => Bsdf::Null,
        MaterialKind::Black | MaterialKind::PointLight { .. } | MaterialKind::SpotLight { .. } => Bsdf::Black,
    }
}

/// α along and across the tangent.
fn alphas(roughness: &[Param<f64>; 2], lookup: &impl Lookup) -> [f32; 2] {
    [lookup.scalar(&roughness[0]) as f32, lookup.scalar(&roughness[1]) as f32]
}

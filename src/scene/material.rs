//! From a material as written to the scattering model of a point: parameters are looked up, models are chosen.

use std::cell::{Cell, RefCell};

use super::desc::{Color, EmpiricalModel, Facets, FresnelDesc, MaterialKind, Param, is_black};
use crate::bsdf::{Bsdf, Distribution, Empirical, Masking, Plastic, Reflectance, Shape};
use crate::geometry::SurfacePoint;
use crate::math::{DVec3, Rgb};
use crate::texture::{Texture, mean};

/// Finds the values of parameters: those that are the same everywhere, or those at a point.
pub(super) trait Lookup {
    /// A colour.
    fn color(&self, param: &Param<Color>) -> Color;

    /// A number.
    fn scalar(&self, param: &Param<f64>) -> f64;

    /// Cosine and sine of the angle by which the surface's tangent is turned from the x axis of
    /// `Frame::from_normal(ns)`: for anisotropic models. Whoever asks is resolved point by point.
    fn tangent(&self) -> [f32; 2];
}

/// Looks up parameters that are the same everywhere, and takes note when one is not; a texture's stand-in is its upper
/// bound, or its lower one.
pub(super) struct Everywhere<'a> {
    textures: &'a [Texture],
    asked: RefCell<Vec<usize>>,
    tangents: Cell<bool>,
    lower: bool,
}

impl<'a> Everywhere<'a> {
    /// A look-up among these textures.
    pub fn new(textures: &'a [Texture]) -> Self {
        Self { textures, asked: RefCell::default(), tangents: Cell::new(false), lower: false }
    }

    /// The same with lower bounds.
    pub fn lower(textures: &'a [Texture]) -> Self {
        Self { lower: true, ..Self::new(textures) }
    }

    /// Whether some parameter varied.
    pub fn varies(&self) -> bool {
        !self.asked.borrow().is_empty() || self.wants_tangents()
    }

    /// Whether tangents were asked for.
    pub fn wants_tangents(&self) -> bool {
        self.tangents.get()
    }

    /// The textures that were asked for.
    pub fn asked(self) -> Vec<usize> {
        self.asked.into_inner()
    }

    fn bound(&self, texture: usize) -> Rgb {
        self.asked.borrow_mut().push(texture);
        if self.lower { self.textures[texture].smallest() } else { self.textures[texture].largest() }
    }
}

impl Lookup for Everywhere<'_> {
    fn color(&self, param: &Param<Color>) -> Color {
        match *param {
            Param::Value(value) => value,
            Param::Texture(i) => self.bound(i).as_dvec3().to_array(),
        }
    }

    fn scalar(&self, param: &Param<f64>) -> f64 {
        match *param {
            Param::Value(value) => value,
            Param::Texture(i) if self.lower => f64::from(self.bound(i).min_element()),
            Param::Texture(i) => f64::from(self.bound(i).max_element()),
        }
    }

    fn tangent(&self) -> [f32; 2] {
        self.tangents.set(true);
        [1.0, 0.0]
    }
}

/// Looks up parameters at a surface point.
pub(super) struct AtPoint<'a> {
    pub textures: &'a [Texture],
    pub at: &'a SurfacePoint,
    /// As `Lookup::tangent`.
    pub tangent: [f32; 2],
}

impl Lookup for AtPoint<'_> {
    fn color(&self, param: &Param<Color>) -> Color {
        match *param {
            Param::Value(value) => value,
            Param::Texture(i) => self.textures[i].color(self.at).as_dvec3().to_array(),
        }
    }

    fn scalar(&self, param: &Param<f64>) -> f64 {
        match *param {
            Param::Value(value) => value,
            Param::Texture(i) => f64::from(mean(self.textures[i].color(self.at))),
        }
    }

    fn tangent(&self) -> [f32; 2] {
        self.tangent
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
            let bsdf = Bsdf::dielectric(*ior as f32, rgb(lookup.color(transmittance)), alphas(roughness, lookup));
            aligned(bsdf, roughness, lookup)
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
            let bsdf = Bsdf::conductor(reflectance, alphas(roughness, lookup), distribution, masking, *two_sided);
            aligned(bsdf, roughness, lookup)
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
        // Its parts are chosen among before they are looked up (`detail`).
        MaterialKind::Blend { .. } => Bsdf::Black,
        MaterialKind::Black | MaterialKind::PointLight { .. } | MaterialKind::SpotLight { .. } => Bsdf::Black,
    }
}

/// α along and across the tangent.
fn alphas(roughness: &[Param<f64>; 2], lookup: &impl Lookup) -> [f32; 2] {
    [lookup.scalar(&roughness[0]) as f32, lookup.scalar(&roughness[1]) as f32]
}

/// A model whose lobes follow the surface's tangent, where they are not the same all around the normal.
fn aligned(mut bsdf: Bsdf, roughness: &[Param<f64>; 2], lookup: &impl Lookup) -> Bsdf {
    if roughness[0] != roughness[1] {
        let tangent = lookup.tangent();
        match &mut bsdf {
            Bsdf::Conductor(c) => c.roughness.tangent = tangent,
            Bsdf::RoughDielectric(d) => d.roughness.tangent = tangent,
            _ => {}
        }
    }
    bsdf
}

//! From a material as written to the scattering model of a point: parameters are looked up, models are chosen.

use std::cell::{Cell, RefCell};

use super::desc::{Color, MaterialKind, Param, is_black};
use crate::bsdf::Bsdf;
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
    #[allow(dead_code)] // No model is anisotropic yet.
    fn tangent(&self) -> [f32; 2];
}

/// Looks up parameters that are the same everywhere, and takes note when one is not; a texture's stand-in is its bound.
pub(super) struct Everywhere<'a> {
    textures: &'a [Texture],
    asked: RefCell<Vec<usize>>,
    tangents: Cell<bool>,
}

impl<'a> Everywhere<'a> {
    /// A look-up among these textures.
    pub fn new(textures: &'a [Texture]) -> Self {
        Self { textures, asked: RefCell::default(), tangents: Cell::new(false) }
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
        self.textures[texture].largest()
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
    #[allow(dead_code)] // As there.
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
        MaterialKind::Dielectric { ior, transmittance } => {
            Bsdf::Dielectric { ior: *ior as f32, transmittance: rgb(lookup.color(transmittance)) }
        }
        MaterialKind::Null => Bsdf::Null,
        // Its parts are chosen among before they are looked up (`detail`).
        MaterialKind::Blend { .. } => Bsdf::Black,
        MaterialKind::Black | MaterialKind::PointLight { .. } | MaterialKind::SpotLight { .. } => Bsdf::Black,
    }
}

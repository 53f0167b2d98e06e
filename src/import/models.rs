//! Materials that reflect by facets, coats and lobes: their keys.

use super::context::{Context, Object};
use super::json::Kind;
use super::value::{EXPONENT, EXTINCTION, IOR, IOR_COAT, ROUGHNESS, Range, SLOPE};
use crate::scene::desc::{Color, EmpiricalModel, Facets, FresnelDesc, MaterialKind, Param};

/// Keys that only types read here have.
pub(super) const OWN_KEYS: &[&str] = &["roughness", "eta", "k", "fresnel", "masking", "nonlinear", "exponent", "sigma"];

impl<'a> Context<'a> {
    /// A material of a type that is read here: GGX conductors unless it says otherwise.
    pub fn model(&mut self, object: &Object<'a>, type_name: &str) -> Option<MaterialKind> {
        match type_name {
            "plastic" => self.plastic(object),
            "thin dielectric" => {
                self.check_material_keys(object, &["ior", "emit", "emit_two_sided"], &[]);
                let ior = object.get("ior").map_or(Some(1.5), |node| self.number(node, IOR));
                Some(MaterialKind::ThinDielectric { ior: ior? })
            }
            "phong" => self.lobe(object, |exponent| EmpiricalModel::Phong { exponent }),
            "blinnphong" => self.lobe(object, |exponent| EmpiricalModel::BlinnPhong { exponent }),
            "oren-nayar" => self.empirical(object, "sigma", SLOPE, |sigma| EmpiricalModel::OrenNayar { sigma }),
            _ => self.conductor(object, if type_name == "beckmann" { Facets::Beckmann } else { Facets::Ggx }),
        }
    }

    /// α of a rough surface, one number for all directions.
    pub fn alpha(&mut self, object: &Object<'a>, default: f64) -> Option<Param<f64>> {
        let node = object.get("roughness");
        node.map_or(Some(Param::Value(default)), |node| self.scalar_or_texture(node, ROUGHNESS))
    }

    /// α along and across the tangent, or one number for both.
    pub fn alphas(&mut self, object: &Object<'a>, default: f64) -> Option<[Param<f64>; 2]> {
        let Some(node) = object.get("roughness") else { return Some([Param::Value(default); 2]) };
        if matches!(node.kind(), Kind::Number | Kind::String | Kind::Object) {
            return self.scalar_or_texture(node, ROUGHNESS).map(|both| [both; 2]);
        }
        let [along, across] = self.vector_nodes::<2>(node)?.map(|node| self.scalar_or_texture(&node, ROUGHNESS));
        Some([along?, across?])
    }

    fn conductor(&mut self, object: &Object<'a>, facets: Facets) -> Option<MaterialKind> {
        let keys = ["albedo", "fresnel", "eta", "k", "roughness", "masking", "two_sided", "emit", "emit_two_sided"];
        self.check_material_keys(object, &keys, &[]);
        let fresnel = self.fresnel(object);
        let roughness = self.alphas(object, 0.1);
        let masking = object.get("masking");
        let masking = masking.map_or(Some("height_correlated"), |node| {
            self.choice(node, "masking", &["height_correlated", "separable"], &[])
        });
        let two_sided = self.flag(object, "two_sided");
        Some(MaterialKind::Conductor {
            fresnel: fresnel?,
            roughness: roughness?,
            facets,
            separable_masking: masking? == "separable",
            two_sided: two_sided?,
        })
    }

    /// `eta` with `k`, or `albedo` with `fresnel`.
    fn fresnel(&mut self, object: &Object<'a>) -> Option<FresnelDesc> {
        let schlick = object.get("fresnel").map(|node| self.choice(node, "fresnel", &["schlick", "none"], &[]));
        if object.has("eta") || object.has("k") {
            for key in ["albedo", "fresnel"] {
                if let Some(node) = object.get(key) {
                    self.error(
                        node,
                        format!("{key:?} has no place beside \"eta\" and \"k\": they say what is reflected"),
                    );
                }
            }
            let eta = self.required(object, "eta").and_then(|node| self.color_or_texture(node, IOR));
            let k = self.required(object, "k").and_then(|node| self.color_or_texture(node, EXTINCTION));
            return Some(FresnelDesc::Index { eta: eta?, k: k? });
        }
        if !object.has("albedo") && self.is_untold(object, "albedo") {
            self.error(&object.node, "\"albedo\", or \"eta\" and \"k\", is missing");
        }
        let albedo = object.has("albedo").then(|| self.reflectance(object, "albedo", None))??;
        match schlick {
            None | Some(Some("schlick")) => Some(FresnelDesc::Schlick { albedo }),
            Some(Some(_)) => Some(FresnelDesc::Constant { albedo }),
            Some(None) => None,
        }
    }

    fn plastic(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        let keys = ["albedo", "ior", "roughness", "nonlinear", "two_sided", "emit", "emit_two_sided"];
        self.check_material_keys(object, &keys, &[]);
        let albedo = self.reflectance(object, "albedo", None);
        let ior = object.get("ior").map_or(Some(1.5), |node| self.number(node, IOR_COAT));
        let roughness = self.alpha(object, 0.1);
        let nonlinear = self.flag(object, "nonlinear");
        let two_sided = self.flag(object, "two_sided");
        Some(MaterialKind::Plastic {
            albedo: albedo?,
            ior: ior?,
            roughness: roughness?,
            nonlinear: nonlinear?,
            two_sided: two_sided?,
        })
    }

    fn lobe(&mut self, object: &Object<'a>, model: fn(Param<f64>) -> EmpiricalModel) -> Option<MaterialKind> {
        self.empirical(object, "exponent", EXPONENT, model)
    }

    /// A model of an albedo and one number.
    fn empirical(
        &mut self,
        object: &Object<'a>,
        key: &str,
        range: Range,
        model: fn(Param<f64>) -> EmpiricalModel,
    ) -> Option<MaterialKind> {
        self.check_material_keys(object, &["albedo", key, "two_sided", "emit", "emit_two_sided"], &[]);
        let albedo: Option<Param<Color>> = self.reflectance(object, "albedo", None);
        let number = self.required(object, key).and_then(|node| self.scalar_or_texture(node, range));
        let two_sided = self.flag(object, "two_sided");
        Some(MaterialKind::Empirical { albedo: albedo?, model: model(number?), two_sided: two_sided? })
    }
}

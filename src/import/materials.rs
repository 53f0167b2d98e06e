//! Materials: named ones, inline ones, and references by name.

use std::collections::HashMap;

use super::context::{Context, Keys, Object, Type, did_you_mean, list, nearest};
use super::json::{Kind, Node, excerpt, printable};
use super::models;
use super::value::{EMISSION, FALLOFF, HALF_ANGLE, IOR, UNIT};
use crate::scene::desc::{
    Color, EmpiricalModel, Facets, FresnelDesc, MaterialDesc, MaterialKind, Param, Place, SpotProfile,
};

/// The types that are built.
const SUPPORTED: &[&str] = &[
    "lambertian",
    "mirror",
    "metal",
    "dielectric",
    "diffuse light",
    "point light",
    "spot light",
    "null",
    "conductor",
    "plastic",
    "thin dielectric",
    "phong",
    "blinnphong",
    "beckmann",
    "oren-nayar",
    "blend",
];

/// Keys of some material.
const OWN_KEYS: &[&str] = &[
    "albedo",
    "two_sided",
    "emit",
    "emit_two_sided",
    "ior",
    "transmittance",
    "inner_angle",
    "outer_angle",
    "falloff",
    "profile",
    "a",
    "b",
    "amount",
];

/// What does not shine.
const DARK: Param<Color> = Param::Value([0.0; 3]);

/// Most blends within each other: what looks into them visits each way to a part.
const MAX_DEPTH: usize = 10;

/// Names listed in a message.
const MAX_NAMES: usize = 20;

/// The materials read so far.
#[derive(Default)]
pub(super) struct Materials {
    /// All materials; `None` stands for one whose errors are already reported.
    list: Vec<Option<MaterialDesc>>,
    by_name: HashMap<String, usize>,
    /// Names in file order, for messages.
    names: Vec<String>,
}

impl Materials {
    /// The material at an index, unless it was in error.
    pub fn get(&self, index: usize) -> Option<&MaterialDesc> {
        self.list.get(index)?.as_ref()
    }

    /// Adds a material and returns its index.
    pub fn push(&mut self, material: Option<MaterialDesc>) -> usize {
        self.list.push(material);
        self.list.len() - 1
    }

    /// Whether a material, or a part of it, is not there.
    fn may_vanish(&self, index: usize) -> bool {
        match self.get(index).map(|m| &m.kind) {
            Some(MaterialKind::Null) => true,
            Some(&MaterialKind::Blend { a, b, .. }) => self.may_vanish(a) || self.may_vanish(b),
            _ => false,
        }
    }

    /// How many blends stand within each other in a material.
    fn depth(&self, index: usize) -> usize {
        match self.get(index).map(|m| &m.kind) {
            Some(&MaterialKind::Blend { a, b, .. }) => 1 + self.depth(a).max(self.depth(b)),
            _ => 0,
        }
    }

    /// All materials, or nothing if one was in error.
    pub fn into_all(self) -> Option<Vec<MaterialDesc>> {
        self.list.into_iter().collect()
    }
}

/// The format's name of a material type.
pub(super) fn type_name(kind: &MaterialKind) -> &'static str {
    match kind {
        MaterialKind::Lambertian { .. } => "lambertian",
        MaterialKind::Mirror { .. } => "mirror",
        MaterialKind::Dielectric { .. } => "dielectric",
        MaterialKind::Black => "diffuse light",
        MaterialKind::Null => "null",
        MaterialKind::Blend { .. } => "blend",
        MaterialKind::PointLight { .. } => "point light",
        MaterialKind::SpotLight { .. } => "spot light",
        MaterialKind::Conductor { facets: Facets::Ggx, .. } => "conductor",
        MaterialKind::Conductor { facets: Facets::Beckmann, .. } => "beckmann",
        MaterialKind::Plastic { .. } => "plastic",
        MaterialKind::ThinDielectric { .. } => "thin dielectric",
        MaterialKind::Empirical { model, .. } => match model {
            EmpiricalModel::OrenNayar { .. } => "oren-nayar",
            EmpiricalModel::Phong { .. } => "phong",
            EmpiricalModel::BlinnPhong { .. } => "blinnphong",
        },
    }
}

impl<'a> Context<'a> {
    /// The scene's named materials.
    pub fn materials(&mut self, scene: &Object<'a>) -> Materials {
        let mut materials = Materials::default();
        let nodes = scene.get("materials").and_then(|node| self.array(node, "an array of materials"));
        let nodes = nodes.unwrap_or_default();
        self.declare("material", &nodes);
        for node in nodes {
            let Some(object) = self.object(&node, "an object") else { continue };
            let name = object.get("name").and_then(|n| self.string(n));
            let material = self.material(&object, name.clone(), &mut materials);
            self.required(&object, "name");
            let index = materials.push(material);
            let Some(name) = name else { continue };
            if materials.by_name.contains_key(&name) {
                let at = object.get("name").unwrap_or(&object.node);
                self.error(at, format!("duplicate material name {:?}; names must differ", excerpt(&name)));
            } else {
                // A material in error keeps its name, so that references to it are not errors, too.
                materials.names.push(name.clone());
                materials.by_name.insert(name, index);
            }
        }
        materials
    }

    /// The index of the material that a value names or holds.
    pub fn material_reference(&mut self, node: &Node<'a>, materials: &mut Materials) -> Option<usize> {
        match node.kind() {
            Kind::String => {
                let name = self.string(node)?;
                let found = materials.by_name.get(&name).copied();
                if let (None, Some(message)) = (found, self.defined_below("material", &name, node)) {
                    self.error(node, message);
                } else if found.is_none() {
                    let known = if materials.names.is_empty() {
                        "there are no named materials".to_owned()
                    } else {
                        let shown: Vec<_> = materials.names.iter().take(MAX_NAMES).map(|n| printable(n)).collect();
                        let more = if materials.names.len() > MAX_NAMES { ", …" } else { "" };
                        format!("known: {}{more}", list(&shown))
                    };
                    let hint = did_you_mean(nearest(&name, &materials.names));
                    self.error(node, format!("no material is named {:?};{hint} {known}", excerpt(&name)));
                }
                found
            }
            Kind::Object => {
                let object = self.object(node, "an object")?;
                let name = object.get("name").and_then(|n| self.string(n));
                let material = self.material(&object, name, materials);
                Some(materials.push(material))
            }
            _ => {
                self.wrong_type(node, "the name of a material or a material object");
                None
            }
        }
    }

    fn material(
        &mut self,
        object: &Object<'a>,
        name: Option<String>,
        materials: &mut Materials,
    ) -> Option<MaterialDesc> {
        let at = self.place(&object.node);
        let name_of_type = match self.type_of(object, "material type", SUPPORTED, &[]) {
            Type::Known(name) => name,
            Type::Unknown | Type::Later => return self.unknown_material(object),
        };
        let kind = match name_of_type {
            "lambertian" => self.lambertian(object),
            "mirror" => self.mirror(object),
            "metal" => self.metal(object),
            "dielectric" => self.dielectric(object),
            "diffuse light" => return self.diffuse_light(object, name, at),
            "point light" => self.point_light(object),
            "spot light" => self.spot_light(object),
            "null" => self.null(object),
            "blend" => self.blend(object, materials),
            _ => self.model(object, name_of_type),
        };
        let (emit, emit_two_sided) = match name_of_type {
            // Their `emit` is an intensity, or an error already reported.
            "point light" | "spot light" | "null" => (DARK, false),
            _ => self.reflecting_emission(object)?,
        };
        Some(MaterialDesc { name, kind: kind?, emit, emit_two_sided, at })
    }

    /// Checks what can be checked in a material whose type is missing or unknown: the keys, and the colours that mean the
    /// same in all types.
    fn unknown_material(&mut self, object: &Object<'a>) -> Option<MaterialDesc> {
        self.check_material_keys(object, &[OWN_KEYS, models::OWN_KEYS].concat(), &[]);
        self.required(object, "type");
        for (key, range) in [("albedo", UNIT), ("transmittance", UNIT), ("emit", EMISSION)] {
            object.get(key).and_then(|node| self.color_or_texture(node, range));
        }
        None
    }

    /// Reports unknown keys of a material with the given keys of its own.
    pub fn check_material_keys(&mut self, object: &Object<'a>, own: &[&str], idle: &[&str]) {
        let allowed = [&["type", "name"], own].concat();
        self.check_keys(object, &Keys { allowed: &allowed, idle, later: &[] });
    }

    /// A colour or texture in [0,1] with an optional default.
    pub fn reflectance(&mut self, object: &Object<'a>, key: &str, default: Option<f64>) -> Option<Param<Color>> {
        match (object.get(key), default) {
            (Some(node), _) => self.color_or_texture(node, UNIT),
            (None, Some(default)) => Some(Param::Value([default; 3])),
            (None, None) => {
                self.required(object, key);
                None
            }
        }
    }

    pub fn flag(&mut self, object: &Object<'a>, key: &str) -> Option<bool> {
        object.get(key).map_or(Some(false), |node| self.boolean(node))
    }

    fn lambertian(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        self.check_material_keys(object, &["albedo", "two_sided", "emit", "emit_two_sided"], &[]);
        let albedo = self.reflectance(object, "albedo", None);
        let two_sided = self.flag(object, "two_sided");
        Some(MaterialKind::Lambertian { albedo: albedo?, two_sided: two_sided? })
    }

    fn mirror(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        self.check_material_keys(object, &["albedo", "emit", "emit_two_sided"], &[]);
        let albedo = self.reflectance(object, "albedo", Some(1.0));
        Some(MaterialKind::Mirror { albedo: albedo? })
    }

    /// The mirror, blurred where it is rough; on both sides, as the mirror is.
    fn metal(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        self.check_material_keys(object, &["albedo", "roughness", "emit", "emit_two_sided"], &[]);
        let albedo = self.reflectance(object, "albedo", Some(1.0));
        let roughness = self.alphas(object, 0.0);
        let (albedo, roughness) = (albedo?, roughness?);
        if roughness == [Param::Value(0.0); 2] {
            return Some(MaterialKind::Mirror { albedo });
        }
        Some(MaterialKind::Conductor {
            fresnel: FresnelDesc::Constant { albedo },
            roughness,
            facets: Facets::Ggx,
            separable_masking: false,
            two_sided: true,
        })
    }

    fn dielectric(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        self.check_material_keys(object, &["ior", "transmittance", "roughness", "emit", "emit_two_sided"], &[]);
        let ior = object.get("ior").map_or(Some(1.5), |node| self.number(node, IOR));
        let transmittance = self.reflectance(object, "transmittance", Some(1.0));
        let roughness = self.alphas(object, 0.0);
        Some(MaterialKind::Dielectric { ior: ior?, transmittance: transmittance?, roughness: roughness? })
    }

    fn diffuse_light(&mut self, object: &Object<'a>, name: Option<String>, at: Place) -> Option<MaterialDesc> {
        self.check_material_keys(object, &["emit", "two_sided"], &[]);
        let emit_two_sided = self.flag(object, "two_sided");
        let emit = self.required(object, "emit").and_then(|node| self.color_or_texture(node, EMISSION));
        Some(MaterialDesc { name, kind: MaterialKind::Black, emit: emit?, emit_two_sided: emit_two_sided?, at })
    }

    /// The optional emission of a material that also reflects.
    fn reflecting_emission(&mut self, object: &Object<'a>) -> Option<(Param<Color>, bool)> {
        let two_sided = self.flag(object, "emit_two_sided");
        let emit = object.get("emit").map_or(Some(DARK), |node| self.color_or_texture(node, EMISSION));
        emit.zip(two_sided)
    }

    /// A mixture of two materials, each named above or inline.
    fn blend(&mut self, object: &Object<'a>, materials: &mut Materials) -> Option<MaterialKind> {
        self.check_material_keys(object, &["a", "b", "amount", "emit", "emit_two_sided"], &[]);
        let mut part = |context: &mut Self, key| {
            let node = context.required(object, key)?;
            let index = context.material_reference(node, materials)?;
            let material = materials.get(index)?;
            let name = type_name(&material.kind);
            if matches!(material.kind, MaterialKind::PointLight { .. } | MaterialKind::SpotLight { .. }) {
                context.error(node, format!("a {name:?} cannot be part of a blend: it has no surface"));
                return None;
            }
            if material.emit != DARK {
                let message = "a part of a blend cannot emit; give the blend itself an \"emit\"";
                context.error(node, message);
                return None;
            }
            Some(index)
        };
        let (a, b) = (part(self, "a"), part(self, "b"));
        // What is not there in part would be hit by fewer rays than are sent to it.
        let may_vanish = [a, b].into_iter().flatten().any(|part| materials.may_vanish(part));
        if let (true, Some(emit)) = (may_vanish, object.get("emit")) {
            self.error(emit, "a blend with a \"null\" part cannot emit; give the light a surface of its own");
            return None;
        }
        if let Some(depth) = [a, b].into_iter().flatten().map(|part| materials.depth(part)).max() {
            if depth >= MAX_DEPTH {
                self.error(&object.node, format!("blends of blends {} deep; allowed: at most {MAX_DEPTH}", depth + 1));
                return None;
            }
        }
        let amount = self.required(object, "amount").and_then(|node| self.scalar_or_texture(node, UNIT));
        Some(MaterialKind::Blend { a: a?, b: b?, amount: amount? })
    }

    fn null(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        self.check_material_keys(object, &[], &["emit"]);
        if let Some(node) = object.get("emit") {
            self.error(node, "a \"null\" surface cannot emit: it is not there; give the light a surface of its own");
            return None;
        }
        Some(MaterialKind::Null)
    }

    fn point_light(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        self.check_material_keys(object, &["emit"], &[]);
        let intensity = self.required(object, "emit").and_then(|node| self.color(node, EMISSION));
        Some(MaterialKind::PointLight { intensity: intensity? })
    }

    fn spot_light(&mut self, object: &Object<'a>) -> Option<MaterialKind> {
        self.check_material_keys(object, &["emit", "inner_angle", "outer_angle", "falloff", "profile"], &[]);
        self.spot(object, "emit")
    }

    /// A spot light whose peak intensity is under `intensity_key`; its keys have been checked.
    pub fn spot(&mut self, object: &Object<'a>, intensity_key: &str) -> Option<MaterialKind> {
        let intensity = self.required(object, intensity_key).and_then(|node| self.color(node, EMISSION));
        let inner = self.required(object, "inner_angle").and_then(|node| self.number(node, HALF_ANGLE));
        let outer = self.required(object, "outer_angle").and_then(|node| self.number(node, HALF_ANGLE));
        let profile = self.spot_profile(object);
        if let Some((inner, outer)) = inner.zip(outer).filter(|(inner, outer)| inner > outer) {
            let message = format!("inner_angle {inner} exceeds outer_angle {outer}; allowed: at most as large");
            self.error(object.get("inner_angle").unwrap_or(&object.node), message);
        }
        let (intensity, inner_angle, outer_angle, profile) = (intensity?, inner?, outer?, profile?);
        Some(MaterialKind::SpotLight { intensity, inner_angle, outer_angle, profile })
    }

    /// How a spot falls off; only a power of the cosine has an exponent.
    fn spot_profile(&mut self, object: &Object<'a>) -> Option<SpotProfile> {
        let falloff = object.get("falloff").map_or(Some(0.5), |node| self.number(node, FALLOFF));
        let word = object
            .get("profile")
            .map_or(Some("cosine"), |node| self.choice(node, "spot profile", &["cosine", "angle"], &[]));
        if word? == "cosine" {
            return Some(SpotProfile::Cosine { falloff: falloff? });
        }
        if let Some(node) = object.get("falloff") {
            let message = "the spot profile \"angle\" falls linearly and takes no \"falloff\"; leave it out, or choose \
                           the profile \"cosine\"";
            self.error(node, message);
            return None;
        }
        Some(SpotProfile::Angle)
    }
}

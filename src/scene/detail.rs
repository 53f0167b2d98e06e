//! What varies over a surface, resolved where a path arrives: textured parameters, blends, maps of the normal, opacity.
//!
//! Neither BSDFs nor integrators hear of textures. Arrival makes a plain `Bsdf` and a plain `SurfacePoint` of them, and
//! decides by the sample's coins whether a cut-out surface is there and which part of a blend it is (docs/MIS.md, §8).

use super::Surface;
use super::desc::{FinishDesc, MaterialKind, Param};
use super::material::{self, AtPoint, Everywhere, Lookup as _};
use crate::bsdf::Bsdf;
use crate::geometry::{Geometry, Hit, SurfacePoint, Tangents};
use crate::math::{Frame, Vec3};
use crate::sampling::Coins;
use crate::texture::Texture;

/// The scene's textures, and the surfaces and materials that vary.
#[derive(Debug, Default)]
pub struct Details {
    textures: Vec<Texture>,
    /// By the file's index.
    materials: Vec<Material>,
    surfaces: Vec<Detail>,
    /// Render units per scene unit, for displacements.
    scale: f32,
}

/// A material, resolved as far as it is the same everywhere.
#[derive(Debug)]
enum Material {
    Fixed(Bsdf),
    Varying(MaterialKind),
    Blend { a: usize, b: usize, amount: Param<f64> },
}

/// A surface that is not the same everywhere.
#[derive(Debug)]
struct Detail {
    material: usize,
    finish: FinishDesc,
    /// Whether tangents are needed: a map of the normal, or an anisotropic material.
    tangents: bool,
}

/// A normal map's or bump map's normal keeps at least this cosine to the geometric one: beyond the horizon it would turn
/// the surface's side.
const LEAST_COSINE: f32 = 0.01;

impl Details {
    /// For a scene's textures and materials; a blend stands after its parts.
    pub fn new<'a>(textures: Vec<Texture>, materials: impl Iterator<Item = &'a MaterialKind>, scale: f64) -> Self {
        let material = |kind: &MaterialKind| {
            if let MaterialKind::Blend { a, b, amount } = *kind {
                return Material::Blend { a, b, amount };
            }
            let everywhere = Everywhere::new(&textures);
            let bsdf = material::bsdf(kind, &everywhere);
            if everywhere.varies() { Material::Varying(kind.clone()) } else { Material::Fixed(bsdf) }
        };
        let materials = materials.map(material).collect();
        Self { textures, materials, surfaces: Vec::new(), scale: scale as f32 }
    }

    /// The texture at an index of the file.
    pub fn texture(&self, index: usize) -> &Texture {
        &self.textures[index]
    }

    /// Whether some texture or material asks for texture coordinates.
    pub fn want_uv(&self) -> bool {
        self.textures.iter().any(Texture::needs_uv) || (0..self.materials.len()).any(|m| self.wants_tangents(m))
    }

    /// Adds a surface: `None` when it is the same everywhere, of the model that `models` gives.
    pub fn add(&mut self, material: usize, finish: FinishDesc) -> Option<u32> {
        let plain = finish == FinishDesc::default() && matches!(self.materials[material], Material::Fixed(_));
        if plain {
            return None;
        }
        let tangents = finish.normal_map.is_some() || finish.bump_map.is_some() || self.wants_tangents(material);
        self.surfaces.push(Detail { material, finish, tangents });
        Some(self.surfaces.len() as u32 - 1)
    }

    /// A material's model, or all kinds that it may turn out to be: textured parameters stand at their upper bounds, then
    /// at their lower ones, between which a model only becomes rougher or brighter.
    pub fn models(&self, material: usize) -> Vec<Bsdf> {
        match &self.materials[material] {
            Material::Fixed(bsdf) => vec![*bsdf],
            Material::Varying(kind) => [Everywhere::new(&self.textures), Everywhere::lower(&self.textures)]
                .map(|l| material::bsdf(kind, &l))
                .into(),
            Material::Blend { a, b, .. } => [self.models(*a), self.models(*b)].concat(),
        }
    }

    /// By surface, whether it lets some light pass for lack of opacity; empty when none does.
    pub fn cut_outs(&self, surfaces: &[Surface]) -> Vec<bool> {
        let is_cut_out = |detail: u32| self.surfaces[detail as usize].finish.opacity != Param::Value(1.0);
        let all: Vec<bool> = surfaces.iter().map(|s| s.detail.is_some_and(is_cut_out)).collect();
        if all.contains(&true) { all } else { Vec::new() }
    }

    /// Whether a texture over texture coordinates, or a map that follows them, is used on a surface.
    pub fn follows_uv(&self, material: usize, finish: &FinishDesc) -> bool {
        finish.normal_map.is_some() || self.uses(material, finish, &Texture::needs_uv)
    }

    /// Whether a texture of some kind is used on a surface, but for its emission.
    pub fn uses(&self, material: usize, finish: &FinishDesc, kind: &dyn Fn(&Texture) -> bool) -> bool {
        let is_one = |i: usize| kind(&self.textures[i]);
        matches!(finish.opacity, Param::Texture(i) if is_one(i))
            || finish.normal_map.is_some_and(is_one)
            || finish.bump_map.is_some_and(is_one)
            || self.material_uses(material, kind)
    }

    fn material_uses(&self, material: usize, kind: &dyn Fn(&Texture) -> bool) -> bool {
        match &self.materials[material] {
            Material::Fixed(_) => false,
            Material::Varying(model) => {
                let everywhere = Everywhere::new(&self.textures);
                material::bsdf(model, &everywhere);
                everywhere.asked().iter().any(|&i| kind(&self.textures[i]))
            }
            Material::Blend { a, b, amount } => {
                matches!(amount, Param::Texture(i) if kind(&self.textures[*i]))
                    || self.material_uses(*a, kind)
                    || self.material_uses(*b, kind)
            }
        }
    }

    fn wants_tangents(&self, material: usize) -> bool {
        match &self.materials[material] {
            Material::Fixed(_) => false,
            Material::Varying(kind) => {
                let everywhere = Everywhere::new(&self.textures);
                material::bsdf(kind, &everywhere);
                everywhere.wants_tangents()
            }
            Material::Blend { a, b, .. } => self.wants_tangents(*a) || self.wants_tangents(*b),
        }
    }

    /// The fraction of the surface that is there at a point.
    pub fn opacity(&self, detail: u32, at: &SurfacePoint) -> f32 {
        match self.surfaces[detail as usize].finish.opacity {
            Param::Value(alpha) => alpha as f32,
            Param::Texture(i) => self.textures[i].scalar(at),
        }
    }

    /// Resolves a surface where a path has arrived: turns the shading normal, returns the model. `None` when the
    /// surface is not there for this path.
    #[inline(never)]
    pub fn resolve(
        &self,
        detail: u32,
        geometry: &Geometry,
        hit: &Hit,
        at: &mut SurfacePoint,
        coins: &mut Coins,
    ) -> Option<Bsdf> {
        let surface = &self.surfaces[detail as usize];
        if surface.finish.opacity != Param::Value(1.0) && coins.flip() >= self.opacity(detail, at) {
            return None;
        }
        let tangents = if surface.tangents { geometry.tangents(hit, at) } else { None };
        if let (Some(i), Some(tangents)) = (surface.finish.normal_map, &tangents) {
            bend(at, mapped_normal(&self.textures[i], at, tangents));
        }
        if let Some(i) = surface.finish.bump_map {
            bend(at, self.bumped_normal(&self.textures[i], at, tangents.as_ref()));
        }
        let mut material = surface.material;
        loop {
            match &self.materials[material] {
                Material::Fixed(bsdf) => return Some(*bsdf),
                Material::Varying(kind) => {
                    let tangent = tangents.as_ref().map_or([1.0, 0.0], |t| turn(at.ns, t.du));
                    return Some(material::bsdf(kind, &AtPoint { textures: &self.textures, at, tangent }));
                }
                Material::Blend { a, b, amount } => {
                    let lookup = AtPoint { textures: &self.textures, at, tangent: [1.0, 0.0] };
                    material = if f64::from(coins.flip()) < lookup.scalar(amount) { *b } else { *a };
                }
            }
        }
    }

    /// The normal of the surface displaced along `ns` by a texture: n − ∇_s d, the gradient along the surface from
    /// differences along u and v [Mikkelsen10]. Where texture coordinates give no tangents, along two others.
    fn bumped_normal(&self, texture: &Texture, at: &SurfacePoint, tangents: Option<&Tangents>) -> Vec3 {
        let n = at.ns;
        if tangents.is_none() && texture.needs_uv() {
            return n;
        }
        // Without coordinates a thousandth of the scene's half extent takes the place of a step in them.
        let frame = Frame::from_normal(n);
        let (du, dv) = tangents.map_or((frame.x, frame.y), |t| (t.du, t.dv));
        let [su, sv] = texture.step();
        let displacement = |u: f32, v: f32| {
            let mut there = *at;
            there.point.p += du * u + dv * v;
            let there = there.with_uv([at.uv()[0] + u, at.uv()[1] + v]);
            texture.scalar(&there) * self.scale
        };
        let by_u = (displacement(su, 0.0) - displacement(-su, 0.0)) / (2.0 * su);
        let by_v = (displacement(0.0, sv) - displacement(0.0, -sv)) / (2.0 * sv);
        let volume = n.dot(du.cross(dv));
        let gradient = (dv.cross(n) * by_u + n.cross(du) * by_v) / volume;
        n - gradient
    }
}

/// The normal that a normal map gives: its x along ∂p/∂u, its y across it to the side of ∂p/∂v, its z along `ns`.
fn mapped_normal(texture: &Texture, at: &SurfacePoint, tangents: &Tangents) -> Vec3 {
    let stored = texture.color(at);
    let local = stored * 2.0 - Vec3::ONE;
    let x = (tangents.du - at.ns * tangents.du.dot(at.ns)).normalize_or_zero();
    let y = at.ns.cross(x);
    let y = if y.dot(tangents.dv) < 0.0 { -y } else { y };
    x * local.x + y * local.y + at.ns * local.z
}

/// Gives a point another shading normal, drawn into the hemisphere of the geometric one.
fn bend(at: &mut SurfacePoint, n: Vec3) {
    // Nothing, or nothing finite, is no direction: the normal stays.
    let Some(n) = n.try_normalize() else { return };
    let cos = n.dot(at.ng);
    let n = if cos < LEAST_COSINE { (n + at.ng * (LEAST_COSINE - cos)).normalize() } else { n };
    at.ns = n;
}

/// Cosine and sine of the angle from `Frame::from_normal(ns).x` to the projection of a tangent.
fn turn(ns: Vec3, tangent: Vec3) -> [f32; 2] {
    let local = Frame::from_normal(ns).to_local(tangent);
    let length = local.x.hypot(local.y);
    if length > 0.0 { [local.x / length, local.y / length] } else { [1.0, 0.0] }
}

//! Surfaces: a shape, its transform and its material.

use std::path::Path;

use super::context::{Context, Keys, Object, Type};
use super::json::Node;
use super::materials::{Materials, type_name};
use super::mesh_file;
use super::value::{ANY, POSITIVE, UNIT};
use crate::scene::desc::{FinishDesc, MaterialKind, MeshDesc, Param, ShapeDesc, SurfaceDesc};

/// The types that are built.
const SUPPORTED: &[&str] = &["quad", "sphere", "disk", "triangle", "mesh", "delta point"];

/// The types that the format names and that are not built yet.
const LATER: &[&str] = &["cube", "cylinder", "group", "instance"];

/// Keys of every surface.
const COMMON_KEYS: &[&str] = &["type", "transform", "material", "flip_normals"];

/// Keys of some surface.
const OWN_KEYS: &[&str] = &["size", "radius", "filename", "positions", "indices", "normals", "uvs"];

/// Keys of every surface that has an area.
const FINISH_KEYS: &[&str] = &["opacity", "normal_map", "bump_map"];

impl<'a> Context<'a> {
    /// The scene's surfaces.
    pub fn surfaces(&mut self, scene: &Object<'a>, materials: &mut Materials) -> Vec<SurfaceDesc> {
        let nodes = scene.get("surfaces").and_then(|node| self.array(node, "an array of surfaces"));
        nodes.unwrap_or_default().iter().filter_map(|node| self.surface(node, materials)).collect()
    }

    fn surface(&mut self, node: &Node<'a>, materials: &mut Materials) -> Option<SurfaceDesc> {
        let object = self.object(node, "an object")?;
        let kind = self.type_of(&object, "surface type", SUPPORTED, LATER);
        let own = match kind {
            Type::Known("quad") => &["size"][..],
            Type::Known("sphere" | "disk") => &["radius"],
            Type::Known("triangle") => &["positions", "normals", "uvs"],
            Type::Known("mesh") => &["filename", "positions", "indices", "normals", "uvs"],
            Type::Known(_) => &[],
            Type::Unknown | Type::Later => OWN_KEYS,
        };
        if kind != Type::Later {
            let finish = if kind == Type::Known("delta point") { &[] } else { FINISH_KEYS };
            let allowed = [COMMON_KEYS, own, finish].concat();
            self.check_keys(&object, &Keys::only(&allowed));
            self.required(&object, "type");
        }
        let shape = match kind {
            Type::Known(kind) => self.shape(kind, &object),
            Type::Unknown | Type::Later => None,
        };
        // What every surface has is checked in one of unknown type, too.
        let transform = self.transform(&object);
        let flip_normals = object.get("flip_normals").map_or(Some(false), |n| self.boolean(n));
        let finish =
            if kind == Type::Known("delta point") { Some(FinishDesc::default()) } else { self.surface_finish(&object) };
        let material = if kind == Type::Later { object.get("material") } else { self.required(&object, "material") };
        let material = material.and_then(|n| Some((n, self.material_reference(n, materials)?)));
        if let (Type::Known(kind), Some((node, index))) = (kind, material) {
            self.check_material_fits(kind, node, index, materials);
            self.check_opacity_fits(&object, &finish, index, materials);
        }
        Some(SurfaceDesc {
            shape: shape?,
            transform: transform?,
            material: material?.1,
            flip_normals: flip_normals?,
            finish: finish?,
            at: self.place(&object.node),
        })
    }

    fn shape(&mut self, kind: &str, object: &Object<'a>) -> Option<ShapeDesc> {
        match kind {
            "quad" => self.quad(object),
            "sphere" => self.radius(object).map(|radius| ShapeDesc::Sphere { radius }),
            "disk" => self.radius(object).map(|radius| ShapeDesc::Disk { radius }),
            "triangle" => self.triangle(object).map(ShapeDesc::Mesh),
            "mesh" => self.mesh(object).map(ShapeDesc::Mesh),
            _ => Some(ShapeDesc::DeltaPoint),
        }
    }

    /// Opacity and maps of the normal.
    fn surface_finish(&mut self, object: &Object<'a>) -> Option<FinishDesc> {
        let default = FinishDesc::default();
        let opacity = object.get("opacity").map_or(Some(default.opacity), |n| self.scalar_or_texture(n, UNIT));
        let normal_map = object.get("normal_map").map(|n| self.data_texture(n, UNIT));
        let bump_map = object.get("bump_map").map(|n| self.data_texture(n, ANY));
        if let (Some(_), Some(node)) = (&normal_map, object.get("bump_map")) {
            self.error(node, "\"normal_map\" and \"bump_map\" both turn the normal; give one of them");
            return None;
        }
        // The outer `None` is a key that is not there, the inner one an error.
        let found = |map: Option<Option<usize>>| map.map_or(Some(None), |index| index.map(Some));
        Some(FinishDesc { opacity: opacity?, normal_map: found(normal_map)?, bump_map: found(bump_map)? })
    }

    /// What shines is there: light starts on it without asking for its opacity.
    fn check_opacity_fits(
        &mut self,
        object: &Object<'a>,
        finish: &Option<FinishDesc>,
        material: usize,
        materials: &Materials,
    ) {
        let clear = finish.is_some_and(|f| f.opacity != Param::Value(1.0));
        let shines = materials.get(material).is_some_and(|m| m.emit != Param::Value([0.0; 3]));
        if let (true, true, Some(node)) = (clear, shines, object.get("opacity")) {
            let message = "a surface that shines has to be opaque: a texture as its \"emit\" makes parts of it dark, and \
                           another surface can stand where it is cut out; allowed: 1";
            self.error(node, message);
        }
    }

    /// Delta points and point or spot lights need each other.
    fn check_material_fits(&mut self, shape: &str, node: &Node<'a>, index: usize, materials: &Materials) {
        let Some(material) = materials.get(index) else { return };
        let is_delta_light = matches!(material.kind, MaterialKind::PointLight { .. } | MaterialKind::SpotLight { .. });
        let name = type_name(&material.kind);
        match (shape == "delta point", is_delta_light) {
            (true, false) => {
                let message = format!(
                    "a \"delta point\" cannot be {name:?}: it has no area; allowed: \"point light\", \"spot light\""
                );
                self.error(node, message);
            }
            (false, true) => {
                let message = format!("a {name:?} material has no place on a {shape:?}; allowed: on a \"delta point\"");
                self.error(node, message);
            }
            _ => {}
        }
    }

    fn quad(&mut self, object: &Object<'a>) -> Option<ShapeDesc> {
        let size = object.get("size").map_or(Some([1.0; 2]), |node| self.vector(node, POSITIVE))?;
        self.check_length(object.get("size"), &size)?;
        Some(ShapeDesc::Quad { size })
    }

    fn radius(&mut self, object: &Object<'a>) -> Option<f64> {
        let radius = object.get("radius").map_or(Some(1.0), |node| self.number(node, POSITIVE))?;
        self.check_length(object.get("radius"), &[radius])?;
        Some(radius)
    }

    /// Lengths that are 0 as 32-bit floats leave nothing to see.
    fn check_length(&mut self, node: Option<&Node<'a>>, lengths: &[f64]) -> Option<()> {
        let lost = lengths.iter().find(|x| **x as f32 == 0.0);
        if let (Some(length), Some(node)) = (lost, node) {
            self.error(node, format!("{length:e} is 0 as a 32-bit float; allowed: 1e-45 or more"));
            return None;
        }
        Some(())
    }

    fn mesh(&mut self, object: &Object<'a>) -> Option<MeshDesc> {
        let inline = ["positions", "indices", "normals", "uvs"].into_iter().find(|key| object.has(key));
        match (object.get("filename"), inline) {
            (Some(node), None) => self.mesh_from_file(node),
            (Some(node), Some(key)) => {
                self.error(node, format!("a mesh has either a \"filename\" or inline {key:?}, not both"));
                None
            }
            (None, Some(_)) => self.inline_mesh(object),
            (None, None) => {
                if ["filename", "positions", "indices"].iter().all(|key| self.is_untold(object, key)) {
                    let message = "a mesh needs a \"filename\", or inline \"positions\" and \"indices\"";
                    self.error(&object.node, message);
                }
                None
            }
        }
    }

    fn mesh_from_file(&mut self, node: &Node<'a>) -> Option<MeshDesc> {
        let name = self.string(node)?;
        let path = self.base_dir.join(&name);
        self.check_memory(node, &path)?;
        // Of a compressed file the size is known when it has been inflated.
        let [most, taken] = self.memory;
        match mesh_file::load_mesh_within(&path, most.saturating_sub(taken)) {
            Ok(mesh) => {
                let MeshDesc { positions, normals, uvs, triangles } = &mesh;
                let sizes = [size_of_val(&positions[..]), size_of_val(&normals[..]), size_of_val(&uvs[..])];
                self.memory[1] += (sizes.iter().sum::<usize>() + size_of_val(&triangles[..])) as u64;
                Some(mesh)
            }
            Err(mesh_file::MeshFileError::Unreadable(what)) => {
                // The system's own words end with its number; others say themselves what to do.
                let hint = match () {
                    () if what.contains("(os error ") => super::CHECK_NAME,
                    () if what.contains("it inflates to more than") => "; use a simpler mesh or a larger --max-memory",
                    () => "",
                };
                self.error(node, format!("cannot read {}: {what}{hint}", path.display()));
                None
            }
            Err(mesh_file::MeshFileError::UnknownFormat) => {
                let message = format!("{name:?} is no mesh format; allowed: .obj, .ply, .obj.gz, .ply.gz");
                self.error(node, message);
                None
            }
            Err(mesh_file::MeshFileError::Invalid(diagnostic)) => {
                let by = self.place(node);
                let message = format!("{} (named by {by})", diagnostic.message);
                self.error_in_asset(node, diagnostic.at, message);
                None
            }
        }
    }
    /// Whether a mesh file can be read within the limit of memory: its bytes are there at once, beside the meshes before it.
    /// Compressed ones are inflated piece by piece, so that their size says nothing.
    fn check_memory(&mut self, node: &Node<'a>, path: &Path) -> Option<()> {
        let [most, taken] = self.memory;
        let compressed = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
        let bytes =
            std::fs::metadata(path).ok().filter(|file| file.is_file() && !compressed).map_or(0, |file| file.len());
        if taken.saturating_add(bytes) <= most {
            return Some(());
        }
        let mib = |bytes: u64| format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20));
        let others = if taken > 0 { format!(", the meshes before it {}", mib(taken)) } else { String::new() };
        let message = format!(
            "{} has {}{others}: more than the {} of memory allowed; use a simpler mesh or a larger --max-memory",
            path.display(),
            mib(bytes),
            mib(most)
        );
        self.error(node, message);
        None
    }
}

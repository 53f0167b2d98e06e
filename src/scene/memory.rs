//! How much memory a scene will take, told from its description before anything is allocated for it.
//!
//! What is counted are the arrays that grow with a scene; what a byte of them costs beside itself (a light's tree, an
//! accelerator's nodes) was measured; `tests/cli/memory.rs` measures it again.

use std::mem::size_of;

use super::desc::{InfiniteLightKind, Param, SceneDesc, ShapeDesc, TextureDesc, is_black};
use crate::accel::Footprint;
use crate::geometry::Quadric;
use crate::math::{DVec3, Rgb, Vec3};

/// Tables and tree for choosing among the triangles of lights, bytes for each: there, and while they are made.
const EMITTER: u64 = 156;
const EMITTER_BUILDING: u64 = 223;

/// An environment's texel beside its colour as read: its colour as rendered, and its bin of the table.
const SKY_TEXEL: u64 = size_of::<Rgb>() as u64 + 20;

/// More for each of them while the table is made.
const SKY_TEXEL_BUILDING: u64 = 20;

/// A texel of a PNG while it is decoded: three channels of 16 bits.
const DECODING: u64 = 6;

/// What a scene takes, in bytes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Memory {
    /// Meshes as they were read, which are gone when they are prepared.
    pub read: u64,
    /// What preparing needs beside them and the geometry.
    preparing: u64,
    /// Shapes as they are rendered.
    pub geometry: u64,
    /// Texels of textures and environments.
    pub textures: u64,
    primitives: u64,
    emitters: u64,
}

impl Memory {
    /// What this scene will take.
    pub fn of(desc: &SceneDesc) -> Self {
        let mut memory = Self::default();
        let (mut vertices, mut with_uvs, mut most, mut normals) = (0, 0, 0, false);
        for surface in &desc.surfaces {
            let shines = match desc.materials[surface.material].emit {
                Param::Value(emit) => !is_black(emit),
                Param::Texture(_) => true,
            };
            let (triangles, corners) = match &surface.shape {
                ShapeDesc::Quad { .. } => (2, 4),
                ShapeDesc::Mesh(mesh) => {
                    let sizes =
                        [bytes(&mesh.positions), bytes(&mesh.normals), bytes(&mesh.uvs), bytes(&mesh.triangles)];
                    memory.read += sizes.iter().sum::<u64>();
                    with_uvs += mesh.uvs.len() as u64;
                    normals |= !mesh.normals.is_empty();
                    (mesh.triangles.len() as u64, mesh.positions.len() as u64)
                }
                ShapeDesc::Sphere { .. } | ShapeDesc::Disk { .. } => {
                    memory.primitives += 1;
                    memory.geometry += size_of::<Quadric>() as u64;
                    (0, 0)
                }
                ShapeDesc::DeltaPoint => (0, 0),
            };
            vertices += corners;
            most = most.max(corners);
            memory.primitives += triangles;
            // Its corners and its surface.
            memory.geometry += triangles * 16;
            memory.emitters += if shines { triangles } else { 0 };
        }
        let vector = size_of::<Vec3>() as u64;
        // Normals are kept if any mesh has some, and there while that is not known.
        memory.geometry += vertices * if normals { 2 * vector } else { vector };
        memory.preparing = most * size_of::<DVec3>() as u64 + if normals { 0 } else { vertices * vector };
        memory.geometry += if with_uvs > 0 && !desc.textures.is_empty() { vertices * 8 } else { 0 };
        // Textures of one file share its texels.
        let (mut seen, mut decoding) = (Vec::new(), 0);
        for texture in &desc.textures {
            if let TextureDesc::Image { texels, .. } = texture {
                if !seen.contains(&texels.rgb.as_ptr()) {
                    seen.push(texels.rgb.as_ptr());
                    memory.textures += bytes(&texels.rgb);
                    if texels.file.to_ascii_lowercase().ends_with(".png") {
                        decoding = decoding.max(texels.rgb.len() as u64 * DECODING);
                    }
                }
            }
        }
        for light in &desc.infinite_lights {
            if let InfiniteLightKind::Image { texels, .. } = &light.kind {
                memory.textures += bytes(texels) + texels.len() as u64 * SKY_TEXEL;
                memory.preparing += texels.len() as u64 * SKY_TEXEL_BUILDING;
            }
        }
        memory.preparing = memory.preparing.max(decoding);
        memory
    }

    /// The accelerator's part once it is built.
    pub fn accelerator(&self, accel: Footprint) -> u64 {
        self.primitives * accel.built
    }

    /// What is there at once where most is, in words and bytes, with a film of so many; and the sum.
    pub fn peak(&self, accel: Footprint, film: u64) -> (Vec<(&'static str, u64)>, u64) {
        let geometry = ("geometry", self.geometry);
        let built = ("accelerator", self.accelerator(accel));
        let phases = [
            vec![("meshes and images as read", self.read + self.preparing), geometry],
            vec![geometry, ("accelerator while it is built", self.primitives * accel.building)],
            vec![geometry, built, ("lights while they are sorted", self.emitters * EMITTER_BUILDING)],
            vec![geometry, built, ("lights", self.emitters * EMITTER), ("film", film)],
        ];
        let phases = phases.map(|mut parts| {
            parts.push(("textures", self.textures));
            let sum = parts.iter().fold(0, |sum: u64, (_, bytes)| sum.saturating_add(*bytes));
            (parts, sum)
        });
        phases.into_iter().max_by_key(|(_, sum)| *sum).unwrap_or_default()
    }
}

fn bytes<T>(items: &[T]) -> u64 {
    size_of_val(items) as u64
}

//! Triangles written in the scene file itself. They may be many: the typed parser reads them, and only a mesh with an
//! error is walked value by value.

use std::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::context::{Context, Object};
use super::json::Node;
use crate::scene::desc::MeshDesc;

/// The corners of a triangle or a quadrilateral.
struct Corners {
    indices: [u32; 4],
    count: usize,
}

impl<'de> Deserialize<'de> for Corners {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Face;
        impl<'de> Visitor<'de> for Face {
            type Value = Corners;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("3 or 4 indices")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Corners, A::Error> {
                let mut corners = Corners { indices: [0; 4], count: 0 };
                while let Some(index) = seq.next_element()? {
                    *corners.indices.get_mut(corners.count).ok_or_else(|| A::Error::custom("too many"))? = index;
                    corners.count += 1;
                }
                if corners.count < 3 { Err(A::Error::custom("too few")) } else { Ok(corners) }
            }
        }
        deserializer.deserialize_seq(Face)
    }
}

impl Corners {
    fn push_triangles(&self, triangles: &mut Vec<[u32; 3]>) {
        let [a, b, c, d] = self.indices;
        triangles.push([a, b, c]);
        if self.count == 4 {
            triangles.push([a, c, d]);
        }
    }
}

impl<'a> Context<'a> {
    /// A single triangle: three positions.
    pub fn triangle(&mut self, object: &Object<'a>) -> Option<MeshDesc> {
        let mesh = self.vertices(object)?;
        if mesh.positions.len() != 3 {
            let message = format!("a triangle has 3 positions, found {}", mesh.positions.len());
            self.error(object.get("positions").unwrap_or(&object.node), message);
            return None;
        }
        Some(MeshDesc { triangles: vec![[0, 1, 2]], ..mesh })
    }

    /// A mesh with positions and indices.
    pub fn inline_mesh(&mut self, object: &Object<'a>) -> Option<MeshDesc> {
        let mesh = self.vertices(object);
        let indices = self.required(object, "indices");
        let (mesh, indices) = (mesh?, indices?);
        let triangles = self.faces(indices, mesh.positions.len())?;
        if triangles.is_empty() {
            self.error(indices, "the mesh has no faces; it needs at least one");
            return None;
        }
        Some(MeshDesc { triangles, ..mesh })
    }

    fn vertices(&mut self, object: &Object<'a>) -> Option<MeshDesc> {
        let positions = self.required(object, "positions").and_then(|node| self.single_vectors::<3>(node));
        let normals = object.get("normals").map_or(Some(Vec::new()), |node| self.single_vectors::<3>(node));
        let uvs = object.get("uvs").map_or(Some(Vec::new()), |node| self.single_vectors::<2>(node));
        let (positions, normals, uvs) = (positions?, normals?, uvs?);
        let counts = [("normals", normals.len()), ("uvs", uvs.len())];
        let mut good = true;
        for (key, count) in counts {
            if let Some(node) = object.get(key).filter(|_| count != positions.len()) {
                self.error(node, format!("{count} {key} for {} positions; allowed: one each", positions.len()));
                good = false;
            }
        }
        if let (Some(i), Some(node)) = (normals.iter().position(|n| *n == [0.0; 3]), object.get("normals")) {
            let at = node.elements().into_iter().nth(i).unwrap_or_else(|| node.clone());
            self.error(&at, format!("the normal {} has no direction; it must not be zero", at.text));
            good = false;
        }
        good.then_some(MeshDesc { positions, normals, uvs, triangles: Vec::new() })
    }

    fn faces(&mut self, node: &Node<'a>, vertices: usize) -> Option<Vec<[u32; 3]>> {
        if let Ok(faces) = serde_json::from_str::<Vec<Corners>>(node.text) {
            let mut triangles = Vec::with_capacity(faces.len());
            faces.iter().for_each(|face| face.push_triangles(&mut triangles));
            if triangles.iter().flatten().all(|&i| (i as usize) < vertices) {
                return Some(triangles);
            }
        }
        let mut triangles = Vec::new();
        let mut good = true;
        for face in self.array(node, "an array of faces, each an array of 3 or 4 indices")? {
            match self.face(&face, vertices) {
                Some(corners) => corners.push_triangles(&mut triangles),
                None => good = false,
            }
        }
        good.then_some(triangles)
    }

    fn face(&mut self, node: &Node<'a>, vertices: usize) -> Option<Corners> {
        let corners = self.array(node, "an array of 3 or 4 indices")?;
        let count = corners.len();
        if !(3..=4).contains(&count) {
            self.error(node, format!("a face has 3 or 4 corners, found {count}"));
            return None;
        }
        if vertices == 0 {
            self.error(node, "the mesh has no positions for its faces");
            return None;
        }
        let most = (vertices as u64 - 1).min(u64::from(u32::MAX));
        let mut indices = [Some(0); 4];
        for (slot, corner) in indices.iter_mut().zip(&corners) {
            *slot = self.integer(corner, 0, most).and_then(|i| u32::try_from(i).ok());
        }
        let [a, b, c, d] = indices;
        Some(Corners { indices: [a?, b?, c?, d?], count })
    }
}

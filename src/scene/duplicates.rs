//! Emitters that stand in the file twice.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::desc::{Param, SceneDesc, ShapeDesc, SurfaceDesc, is_black};
use crate::math::{DVec3, Vec3};

/// By surface, whether it is an emitter exactly where an earlier one is, facing the same way.
///
/// Of two such surfaces rays meet one, and which is chance, while both would be chosen for next-event estimation, each
/// seen where the other is: the lamp would be twice as bright by that technique alone.
pub(super) fn duplicate_emitters(desc: &SceneDesc) -> Vec<bool> {
    let mut seen = HashSet::new();
    let shines = |surface: &SurfaceDesc| match desc.materials[surface.material].emit {
        Param::Value(c) => !is_black(c),
        Param::Texture(_) => true,
    };
    let is_duplicate = |surface: &SurfaceDesc| {
        if matches!(surface.shape, ShapeDesc::DeltaPoint) || !shines(surface) {
            return false;
        }
        !seen.insert(place(surface))
    };
    desc.surfaces.iter().map(is_duplicate).collect()
}

/// A hash of shape, place and side, of 128 bits so that no two differ by chance.
fn place(surface: &SurfaceDesc) -> [u64; 2] {
    [0_u8, 1].map(|salt| {
        let mut h = DefaultHasher::new();
        salt.hash(&mut h);
        let numbers = |h: &mut DefaultHasher, numbers: &[f64]| numbers.iter().for_each(|x| x.to_bits().hash(h));
        let m = &surface.transform;
        for column in [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis, m.translation] {
            numbers(&mut h, &DVec3::to_array(&column));
        }
        match &surface.shape {
            ShapeDesc::Quad { size } => numbers(&mut h, size),
            ShapeDesc::Sphere { radius } | ShapeDesc::Disk { radius } => numbers(&mut h, &[*radius]),
            ShapeDesc::Mesh(mesh) => {
                mesh.positions.iter().flatten().for_each(|x| x.to_bits().hash(&mut h));
                mesh.triangles.hash(&mut h);
            }
            ShapeDesc::DeltaPoint => {}
        }
        std::mem::discriminant(&surface.shape).hash(&mut h);
        surface.flip_normals.hash(&mut h);
        h.finish()
    })
}

/// The triangles of emitters that there are so far.
#[derive(Debug, Default)]
pub(super) struct ShiningTriangles(HashSet<[u64; 2]>);

impl ShiningTriangles {
    /// Whether a triangle is the first with these corners, in this sense of rotation unless it shines to both sides; it is
    /// remembered.
    pub fn insert(&mut self, corners: [Vec3; 3], two_sided: bool) -> bool {
        // The zeros are one place.
        let [a, b, c] = corners.map(|p| (p + 0.0).to_array().map(f32::to_bits));
        let turned = |[a, b, c]: [[u32; 3]; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        let (first, back) = (turned([a, b, c]), turned([a, c, b]));
        let hash = |key: Option<[[u32; 3]; 3]>| {
            [0_u8, 1].map(|salt| {
                let mut h = DefaultHasher::new();
                (salt, key).hash(&mut h);
                h.finish()
            })
        };
        if two_sided && self.0.contains(&hash(back)) {
            return false;
        }
        let is_new = self.0.insert(hash(first));
        if is_new && two_sided {
            self.0.insert(hash(back));
        }
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_of_two_lamps_in_one_place_is_a_duplicate() {
        let text = r#"{"camera": {}, "materials": [
            {"name": "a", "type": "diffuse light", "emit": 1}, {"name": "b", "type": "diffuse light", "emit": 2},
            {"name": "dark", "type": "lambertian", "albedo": 0.5}],
            "surfaces": [
            {"type": "quad", "material": "a"}, {"type": "quad", "material": "dark"}, {"type": "quad", "material": "dark"},
            {"type": "quad", "material": "b"}, {"type": "quad", "material": "a", "flip_normals": true},
            {"type": "quad", "size": 2, "material": "a"}, {"type": "sphere", "material": "a"},
            {"type": "disk", "material": "a"}, {"type": "sphere", "material": "a"},
            {"type": "sphere", "material": "a", "transform": {"translate": [0, 1, 0]}}]}"#;
        let desc = crate::import::scene_from_str(text, "test.json", std::path::Path::new("."))
            .unwrap_or_else(|e| panic!("{e}"));
        let found: Vec<usize> =
            duplicate_emitters(&desc).iter().enumerate().filter(|(_, d)| **d).map(|(i, _)| i).collect();
        assert_eq!(found, [3, 8]);
    }
}

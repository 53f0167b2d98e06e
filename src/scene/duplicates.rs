//! Emitters that stand in the file twice.

use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};

use super::desc::{Param, SceneDesc, ShapeDesc, SurfaceDesc, is_black};
use crate::math::{DAffine3, DVec3, Vec3};

/// A side that a surface shines to, as a bit: its shape's own, or the other.
const FRONT: u8 = 1;
const BACK: u8 = 2;
const BOTH: u8 = FRONT | BACK;

/// The sides that a surface shines to. `is_black` tells it of textures by their index.
fn sides(desc: &SceneDesc, surface: &SurfaceDesc, is_black_texture: &impl Fn(usize) -> bool) -> u8 {
    let material = &desc.materials[surface.material];
    let dark = match material.emit {
        Param::Value(c) => is_black(c),
        Param::Texture(i) => is_black_texture(i),
    };
    match (matches!(surface.shape, ShapeDesc::DeltaPoint) || dark, material.emit_two_sided, surface.flip_normals) {
        (true, _, _) => 0,
        (false, true, _) => BOTH,
        (false, false, false) => FRONT,
        (false, false, true) => BACK,
    }
}

/// By surface, whether it is an emitter exactly where others are that shine to all its sides: earlier ones, or a later one that
/// shines to more.
///
/// Of two such surfaces rays meet one, and which is chance, while both would be chosen for next-event estimation, each
/// seen where the other is: the lamp would be twice as bright by that technique alone.
pub(super) fn duplicate_emitters(desc: &SceneDesc, is_black_texture: impl Fn(usize) -> bool) -> Vec<bool> {
    let mut duplicates = vec![false; desc.surfaces.len()];
    // By place, those that are kept, with their sides.
    let mut kept: HashMap<[u64; 2], Vec<(usize, u8)>> = HashMap::new();
    for (index, surface) in desc.surfaces.iter().enumerate() {
        let own = sides(desc, surface, &is_black_texture);
        if own == 0 {
            continue;
        }
        let here = kept.entry(place(surface)).or_default();
        if own & !here.iter().fold(0, |all, (_, sides)| all | sides) == 0 {
            duplicates[index] = true;
            continue;
        }
        here.retain(|&(earlier, sides)| {
            duplicates[earlier] |= sides & !own == 0;
            !duplicates[earlier]
        });
        here.push((index, own));
    }
    duplicates
}

/// A hash of shape and place, of 128 bits so that no two differ by chance. The zeros are one number.
fn place(surface: &SurfaceDesc) -> [u64; 2] {
    [0_u8, 1].map(|salt| {
        let mut h = DefaultHasher::new();
        salt.hash(&mut h);
        let numbers = |h: &mut DefaultHasher, numbers: &[f64]| numbers.iter().for_each(|x| (x + 0.0).to_bits().hash(h));
        let m = &surface.transform;
        for column in [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis, m.translation] {
            numbers(&mut h, &DVec3::to_array(&column));
        }
        match &surface.shape {
            ShapeDesc::Quad { size } => numbers(&mut h, size),
            ShapeDesc::Sphere { radius } | ShapeDesc::Disk { radius } => numbers(&mut h, &[*radius]),
            ShapeDesc::Mesh(mesh) => {
                mesh.positions.iter().flatten().for_each(|x| (x + 0.0).to_bits().hash(&mut h));
                mesh.triangles.hash(&mut h);
            }
            ShapeDesc::DeltaPoint => {}
        }
        std::mem::discriminant(&surface.shape).hash(&mut h);
        h.finish()
    })
}

/// A place of a triangle: corners as bits, the zeros as one, from the least on.
type Corners = Option<[[u32; 3]; 3]>;

/// The corners in this sense of rotation, and in the other.
fn turned(corners: [Vec3; 3]) -> [Corners; 2] {
    let [a, b, c] = corners.map(|p| (p + 0.0).to_array().map(f32::to_bits));
    [[a, b, c], [a, c, b]].map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min())
}

/// A hash of 128 bits.
fn hashed(key: Corners) -> [u64; 2] {
    [0_u8, 1].map(|salt| {
        let mut h = DefaultHasher::new();
        (salt, key).hash(&mut h);
        h.finish()
    })
}

/// The triangles of emitters that there are so far, and those of all that shine to both sides.
#[derive(Debug, Default)]
pub(super) struct ShiningTriangles {
    taken: HashSet<[u64; 2]>,
    two_sided: HashSet<[u64; 2]>,
}

impl ShiningTriangles {
    /// None so far, of a scene with these surfaces, but for `duplicates`.
    pub fn beside(
        desc: &SceneDesc,
        duplicates: &[bool],
        to_render: &DAffine3,
        is_black_texture: impl Fn(usize) -> bool,
    ) -> Self {
        let mut all = Self::default();
        // Without others beside them, nothing has to know of them.
        let shine = |wanted: &dyn Fn(u8) -> bool| -> Vec<&SurfaceDesc> {
            let kept = desc.surfaces.iter().zip(duplicates).filter(|(_, duplicate)| !**duplicate);
            kept.map(|(surface, _)| surface).filter(|s| wanted(sides(desc, s, &is_black_texture))).collect()
        };
        if shine(&|sides| sides == FRONT || sides == BACK).is_empty() {
            return all;
        }
        for surface in shine(&|sides| sides == BOTH) {
            let map = *to_render * surface.transform;
            let mut add = |positions: &[DVec3], triangles: &[[u32; 3]]| {
                for triangle in triangles {
                    let corners = triangle.map(|i| map.transform_point3(positions[i as usize]).as_vec3a());
                    all.two_sided.extend(turned(corners).map(hashed));
                }
            };
            match &surface.shape {
                ShapeDesc::Quad { size: [w, h] } => {
                    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
                    add(&corners.map(|[x, y]| DVec3::new(x * w, y * h, 0.0)), &[[0, 1, 2], [0, 2, 3]]);
                }
                ShapeDesc::Mesh(mesh) => {
                    let positions: Vec<DVec3> = mesh.positions.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
                    add(&positions, &mesh.triangles);
                }
                ShapeDesc::Sphere { .. } | ShapeDesc::Disk { .. } | ShapeDesc::DeltaPoint => {}
            }
        }
        all
    }

    /// Whether a triangle is the first with these corners, in this sense of rotation unless it shines to both sides, and none
    /// with them shines to more sides; it is remembered.
    pub fn insert(&mut self, corners: [Vec3; 3], two_sided: bool) -> bool {
        let [first, back] = turned(corners).map(hashed);
        // Of those that shine to one side none is there where others shine to both: either side taken is both of them.
        if !two_sided && self.two_sided.contains(&first) {
            return false;
        }
        let is_new = self.taken.insert(first);
        if is_new && two_sided {
            self.taken.insert(back);
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
            duplicate_emitters(&desc, |_| false).iter().enumerate().filter(|(_, d)| **d).map(|(i, _)| i).collect();
        assert_eq!(found, [3, 8]);
    }

    const MATERIALS: &str = r#"{"name": "one", "type": "diffuse light", "emit": 1},
        {"name": "both", "type": "diffuse light", "emit": 1, "two_sided": true},
        {"name": "dark", "type": "diffuse light", "emit": {"type": "checker", "even": 0, "odd": 0, "scale": 1}}"#;

    fn prepared(surfaces: &str) -> crate::scene::Prepared {
        let text = format!(r#"{{"camera": {{}}, "materials": [{MATERIALS}], "surfaces": [{surfaces}]}}"#);
        let desc = crate::import::scene_from_str(&text, "test.json", std::path::Path::new(""))
            .unwrap_or_else(|e| panic!("{e}\n{text}"));
        crate::scene::prepare(&desc).unwrap_or_else(|e| panic!("{e}"))
    }

    /// By light, its surface, and whether it shines on both sides.
    fn lamps(surfaces: &str) -> Vec<(u32, bool)> {
        let area = |light: &crate::light::Light| match light {
            crate::light::Light::Area(l) => (l.surface, l.two_sided),
            other => panic!("{other:?}"),
        };
        prepared(surfaces).lights.iter().map(area).collect()
    }

    #[test]
    fn of_lamps_in_one_place_that_which_shines_to_more_sides_is_kept() {
        for shape in [r#""type": "quad""#, r#""type": "sphere""#, r#""type": "disk""#] {
            let lamp = |rest: &str| format!("{{{shape}, {rest}}}");
            let (one, both) = (lamp(r#""material": "one""#), lamp(r#""material": "both""#));
            let back = lamp(r#""material": "one", "flip_normals": true"#);
            let dark = lamp(r#""material": "dark""#);
            assert_eq!(lamps(&format!("{one}, {both}")), [(1, true)], "{shape}");
            assert_eq!(lamps(&format!("{both}, {one}")), [(0, true)], "{shape}");
            assert_eq!(lamps(&format!("{both}, {back}")), [(0, true)], "{shape}");
            assert_eq!(lamps(&format!("{one}, {back}, {both}")), [(0, false), (1, false)], "{shape}");
            assert_eq!(lamps(&format!("{dark}, {one}")), [(1, false)], "{shape}");
        }
    }

    #[test]
    fn triangles_that_shine_to_both_sides_are_kept() {
        let mesh = |material: &str, indices: &str| {
            format!(
                r#"{{"type": "mesh", "positions": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "indices": {indices}, "material": "{material}"}}"#
            )
        };
        // The first triangle of the quad in either sense, which shines to one side.
        for indices in ["[[0, 1, 2]]", "[[0, 2, 1]]"] {
            let (one, both) = (mesh("one", indices), mesh("both", "[[0, 1, 2], [0, 2, 3]]"));
            for (scene, kept) in [(format!("{one}, {both}"), [1, 1]), (format!("{both}, {one}"), [0, 0])] {
                assert_eq!(prepared(&scene).geometry.triangle_surface, kept, "{scene}");
            }
        }
    }

    #[test]
    fn the_zeros_are_one_place() {
        for shape in ["sphere", "disk", "quad"] {
            let at = |x: &str| {
                format!(r#"{{"type": "{shape}", "material": "one", "transform": {{"translate": [{x}, 0, 1]}}}}"#)
            };
            assert_eq!(lamps(&format!("{}, {}", at("0"), at("-0.0"))), [(0, false)], "{shape}");
        }
    }
}

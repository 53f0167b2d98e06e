//! The `lights[]` sugar: point and spot lights, turned into the delta points that `surfaces[]` would hold.

use super::context::{Context, Object};
use super::json::Node;
use super::materials::Materials;
use super::value::EMISSION;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::desc::{MaterialDesc, MaterialKind, ShapeDesc, SurfaceDesc};

/// The types that are built.
const SUPPORTED: &[&str] = &["point", "spot"];

/// The types that the format names and that are not built yet.
const LATER: &[&str] = &["directional", "constant", "environment"];

const SPOT_KEYS: &[&str] =
    &["type", "position", "at", "direction", "intensity", "inner_angle", "outer_angle", "falloff", "profile"];

impl<'a> Context<'a> {
    /// Adds the scene's lights to its surfaces.
    pub fn lights(&mut self, scene: &Object<'a>, materials: &mut Materials, surfaces: &mut Vec<SurfaceDesc>) {
        let nodes = scene.get("lights").and_then(|node| self.array(node, "an array of lights"));
        for node in nodes.unwrap_or_default() {
            if let Some((kind, transform)) = self.light(&node) {
                let at = self.place(&node);
                let material = MaterialDesc { name: None, kind, emit: [0.0; 3], at: at.clone() };
                let material = materials.push(Some(material));
                let shape = ShapeDesc::DeltaPoint;
                surfaces.push(SurfaceDesc { shape, transform, material, flip_normals: false, at });
            }
        }
    }

    fn light(&mut self, node: &Node<'a>) -> Option<(MaterialKind, DAffine3)> {
        let object = self.object(node, "an object")?;
        let type_node = self.required(&object, "type")?;
        if self.choice(type_node, "light type", SUPPORTED, LATER)? == "point" {
            self.check_keys(&object, &["type", "position", "intensity"], &[]);
            let position = self.required(&object, "position").and_then(|n| self.point(n));
            let intensity = self.required(&object, "intensity").and_then(|n| self.color(n, EMISSION));
            return Some((MaterialKind::PointLight { intensity: intensity? }, DAffine3::from_translation(position?)));
        }
        self.check_keys(&object, SPOT_KEYS, &[]);
        let position = self.required(&object, "position").and_then(|n| self.point(n));
        let kind = self.spot(&object, "intensity");
        let position = position?;
        let axis = self.spot_axis(&object, position)?;
        Some((kind?, aimed(position, axis)))
    }

    /// The unit direction of a spot at `position`.
    fn spot_axis(&mut self, object: &Object<'a>, position: DVec3) -> Option<DVec3> {
        let (node, axis) = match (object.get("at"), object.get("direction")) {
            (Some(node), None) => (node, self.point(node)? - position),
            (None, Some(node)) => (node, self.point(node)?),
            (Some(node), Some(_)) => {
                self.error(node, "\"at\" and \"direction\" both aim the spot; give one of them");
                return None;
            }
            (None, None) => {
                self.error(&object.node, "\"at\" or \"direction\" is missing: the spot aims nowhere");
                return None;
            }
        };
        let unit = axis.try_normalize();
        if unit.is_none() {
            self.error(node, format!("the spot's axis has length 0: {} gives it no direction", node.text));
        }
        unit
    }
}

/// A frame at `position` whose local −z points along the unit `axis`.
fn aimed(position: DVec3, axis: DVec3) -> DAffine3 {
    let z = -axis;
    let (x, y) = z.any_orthonormal_pair();
    DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: position }
}

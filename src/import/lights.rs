//! The `lights[]` sugar: point and spot lights, turned into the delta points that `surfaces[]` would hold.

use super::context::{Context, Keys, Object, Type};
use super::json::Node;
use super::materials::Materials;
use super::value::EMISSION;
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::desc::{FinishDesc, MaterialDesc, MaterialKind, Param, ShapeDesc, SurfaceDesc};

/// The types that are built.
const SUPPORTED: &[&str] = &["point", "spot"];

/// The types that the format names and that are not built yet.
const LATER: &[&str] = &["directional", "constant", "environment"];

const POINT_KEYS: Keys = Keys { allowed: &["type", "position", "intensity"], idle: &[], later: &[] };

/// All that any light has.
const SPOT_KEYS: Keys = Keys {
    allowed: &["type", "position", "at", "direction", "intensity", "inner_angle", "outer_angle", "falloff"],
    idle: &["profile"],
    later: &[],
};

impl<'a> Context<'a> {
    /// Adds the scene's lights to its surfaces.
    pub fn lights(&mut self, scene: &Object<'a>, materials: &mut Materials, surfaces: &mut Vec<SurfaceDesc>) {
        let nodes = scene.get("lights").and_then(|node| self.array(node, "an array of lights"));
        for node in nodes.unwrap_or_default() {
            if let Some((kind, transform)) = self.light(&node) {
                let at = self.place(&node);
                let material = MaterialDesc { name: None, kind, emit: Param::Value([0.0; 3]), at: at.clone() };
                let material = materials.push(Some(material));
                let shape = ShapeDesc::DeltaPoint;
                surfaces.push(SurfaceDesc {
                    shape,
                    transform,
                    material,
                    flip_normals: false,
                    finish: FinishDesc::default(),
                    at,
                });
            }
        }
    }

    fn light(&mut self, node: &Node<'a>) -> Option<(MaterialKind, DAffine3)> {
        let object = self.object(node, "an object")?;
        let kind = self.type_of(&object, "light type", SUPPORTED, LATER);
        if kind == Type::Later {
            return None;
        }
        self.check_keys(&object, if kind == Type::Known("point") { &POINT_KEYS } else { &SPOT_KEYS });
        self.required(&object, "type");
        let position = self.required(&object, "position").and_then(|n| self.point(n));
        if kind == Type::Known("spot") {
            let kind = self.spot(&object, "intensity");
            let axis = self.spot_axis(&object, position);
            return Some((kind?, aimed(position?, axis?)));
        }
        // What every light has is checked in one of unknown type, too.
        let intensity = self.required(&object, "intensity").and_then(|n| self.color(n, EMISSION));
        Some((MaterialKind::PointLight { intensity: intensity? }, DAffine3::from_translation(position?)))
    }

    /// The unit direction of a spot at `position`; what aims it is checked even where the position is in error.
    fn spot_axis(&mut self, object: &Object<'a>, position: Option<DVec3>) -> Option<DVec3> {
        let (node, axis) = match (object.get("at"), object.get("direction")) {
            (Some(node), None) => (node, self.point(node).zip(position).map(|(at, position)| at - position)?),
            (None, Some(node)) => (node, self.point(node)?),
            (Some(node), Some(_)) => {
                self.error(node, "\"at\" and \"direction\" both aim the spot; give one of them");
                return None;
            }
            (None, None) => {
                if self.is_untold(object, "at") && self.is_untold(object, "direction") {
                    self.error(&object.node, "\"at\" or \"direction\" is missing: the spot aims nowhere");
                }
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

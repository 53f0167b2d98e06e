//! `lights[]`: point and spot lights, turned into the delta points that `surfaces[]` would hold, and lights at infinity,
//! with the background among them.

use super::context::{Context, Keys, Object, Type};
use super::json::{Kind, Node};
use super::materials::Materials;
use super::transform::direction;
use super::value::{EMISSION, POSITIVE};
use crate::math::{DAffine3, DMat3, DVec3};
use crate::scene::desc::{
    FinishDesc, InfiniteLightDesc, InfiniteLightKind, MaterialDesc, MaterialKind, Param, ShapeDesc, SurfaceDesc,
    is_black,
};

/// The types that are built.
const SUPPORTED: &[&str] = &["point", "spot", "directional", "constant", "environment"];

const POINT_KEYS: Keys = Keys { allowed: &["type", "position", "intensity"], idle: &[], later: &[] };

const SPOT_KEYS: Keys = Keys {
    allowed: &["type", "position", "at", "direction", "intensity", "inner_angle", "outer_angle", "falloff", "profile"],
    idle: &[],
    later: &[],
};

/// All that any light has.
const ALL_KEYS: Keys = Keys {
    allowed: &[
        "type",
        "position",
        "at",
        "direction",
        "intensity",
        "inner_angle",
        "outer_angle",
        "falloff",
        "profile",
        "irradiance",
        "radiance",
        "filename",
        "scale",
        "transform",
    ],
    ..SPOT_KEYS
};

/// Keys of an image all around the scene, as a light or as the background.
const ENVIRONMENT_KEYS: &[&str] = &["type", "filename", "scale", "transform"];

/// What an entry of `lights[]` is.
enum Read {
    /// A delta point with its material.
    Delta(MaterialKind, DAffine3),
    Infinite(InfiniteLightKind),
}

impl<'a> Context<'a> {
    /// Adds the scene's lights to its surfaces and its lights at infinity.
    pub fn lights(
        &mut self,
        scene: &Object<'a>,
        materials: &mut Materials,
        surfaces: &mut Vec<SurfaceDesc>,
        infinite: &mut Vec<InfiniteLightDesc>,
    ) {
        let nodes = scene.get("lights").and_then(|node| self.array(node, "an array of lights"));
        for node in nodes.unwrap_or_default() {
            let at = self.place(&node);
            match self.light(&node) {
                Some(Read::Delta(kind, transform)) => {
                    let (emit, emit_two_sided) = (Param::Value([0.0; 3]), false);
                    let material = MaterialDesc { name: None, kind, emit, emit_two_sided, at: at.clone() };
                    let material = materials.push(Some(material));
                    let (shape, finish) = (ShapeDesc::DeltaPoint, FinishDesc::default());
                    surfaces.push(SurfaceDesc { shape, transform, material, flip_normals: false, finish, at });
                }
                Some(Read::Infinite(kind)) => infinite.push(InfiniteLightDesc { kind, at }),
                None => {}
            }
        }
    }

    fn light(&mut self, node: &Node<'a>) -> Option<Read> {
        let object = self.object(node, "an object")?;
        let kind = self.type_of(&object, "light type", SUPPORTED, &[]);
        let keys = match kind {
            Type::Known("point") => POINT_KEYS,
            Type::Known("spot") => SPOT_KEYS,
            Type::Known("directional") => Keys::only(&["type", "direction", "irradiance"]),
            Type::Known("constant") => Keys::only(&["type", "radiance"]),
            Type::Known("environment") => Keys::only(ENVIRONMENT_KEYS),
            Type::Known(_) | Type::Unknown | Type::Later => ALL_KEYS,
        };
        self.check_keys(&object, &keys);
        self.required(&object, "type");
        match kind {
            Type::Known("point") => {
                let position = self.required(&object, "position").and_then(|n| self.point(n));
                let intensity = self.required(&object, "intensity").and_then(|n| self.color(n, EMISSION));
                let transform = DAffine3::from_translation(position?);
                Some(Read::Delta(MaterialKind::PointLight { intensity: intensity? }, transform))
            }
            Type::Known("spot") => {
                let position = self.required(&object, "position").and_then(|n| self.point(n));
                let kind = self.spot(&object, "intensity");
                let axis = self.spot_axis(&object, position);
                Some(Read::Delta(kind?, aimed(position?, axis?)))
            }
            Type::Known("directional") => {
                let direction = self.required(&object, "direction").and_then(|n| self.unit(n));
                let irradiance = self.required(&object, "irradiance").and_then(|n| self.color(n, EMISSION));
                Some(Read::Infinite(InfiniteLightKind::Directional { direction: direction?, irradiance: irradiance? }))
            }
            Type::Known("constant") => {
                let radiance = self.required(&object, "radiance").and_then(|n| self.color(n, EMISSION));
                Some(Read::Infinite(InfiniteLightKind::Constant { radiance: radiance? }))
            }
            Type::Known("environment") => self.environment(&object).map(Read::Infinite),
            _ => {
                // What means the same in every light is checked in one of unknown type, too.
                object.get("position").and_then(|n| self.point(n));
                for key in ["intensity", "irradiance", "radiance"] {
                    object.get(key).and_then(|n| self.color(n, EMISSION));
                }
                object.get("scale").and_then(|n| self.number(n, POSITIVE));
                self.turn(&object);
                None
            }
        }
    }

    /// The background: the same radiance from everywhere, or an image; `None` when it is black.
    pub fn background(&mut self, scene: &Object<'a>) -> Option<InfiniteLightDesc> {
        let node = scene.get("background")?;
        let kind = if node.kind() == Kind::Object {
            let object = self.object(node, "an object")?;
            let kind = self.type_of(&object, "background type", &["constant", "image"], &[]);
            let keys = match kind {
                Type::Known("constant") => &["type", "color"],
                Type::Known(_) => ENVIRONMENT_KEYS,
                Type::Unknown | Type::Later => &["type", "color", "filename", "scale", "transform"],
            };
            self.check_keys(&object, &Keys::only(keys));
            self.required(&object, "type");
            match kind {
                Type::Known("constant") => {
                    let color = self.required(&object, "color")?;
                    InfiniteLightKind::Constant { radiance: self.vector(color, EMISSION)? }
                }
                Type::Known(_) => self.environment(&object)?,
                Type::Unknown | Type::Later => {
                    object.get("color").and_then(|n| self.vector::<3>(n, EMISSION));
                    object.get("scale").and_then(|n| self.number(n, POSITIVE));
                    self.turn(&object);
                    return None;
                }
            }
        } else {
            InfiniteLightKind::Constant { radiance: self.vector(node, EMISSION)? }
        };
        if matches!(kind, InfiniteLightKind::Constant { radiance } if is_black(radiance)) {
            return None;
        }
        Some(InfiniteLightDesc { kind, at: self.place(node) })
    }

    /// An image all around the scene; its keys have been checked.
    fn environment(&mut self, object: &Object<'a>) -> Option<InfiniteLightKind> {
        let scale = object.get("scale").map_or(Some(1.0), |n| self.number(n, POSITIVE));
        let transform = self.turn(object);
        let node = self.required(object, "filename");
        let name = node.and_then(|n| self.string(n));
        let texels = self.radiance_image(node?, &name?, scale?)?;
        let size = [texels.width as usize, texels.height as usize];
        let scale = scale? as f32;
        let texels = texels.rgb.iter().map(|t| t.map(|x| x * scale)).collect();
        Some(InfiniteLightKind::Image { size, texels, transform: transform? })
    }

    /// The transform of what is infinitely far away: a rotation.
    fn turn(&mut self, object: &Object<'a>) -> Option<DMat3> {
        let Some(node) = object.get("transform") else { return Some(DMat3::IDENTITY) };
        let map = self.transform(object)?;
        let m = map.matrix3;
        // Written with four digits or more.
        let turned = (m.transpose() * m).abs_diff_eq(DMat3::IDENTITY, 1e-4) && m.determinant() > 0.0;
        if !turned || map.translation != DVec3::ZERO {
            let what = if turned { "moves" } else { "scales, shears or mirrors" };
            let message = format!(
                "the transform {what}: what is infinitely far away can only be turned; allowed: rotations \
                 ({{\"rotate\": [degrees, x, y, z]}}, say)"
            );
            self.error(node, message);
            return None;
        }
        // What is a rotation by all digits stays as it is.
        let x = m.x_axis.normalize();
        let y = (m.y_axis - x * x.dot(m.y_axis)).normalize();
        Some(DMat3::from_cols(x, y, x.cross(y)))
    }

    /// A direction of unit length.
    fn unit(&mut self, node: &Node<'a>) -> Option<DVec3> {
        let unit = direction(self.point(node)?);
        if unit.is_none() {
            let message = format!("the direction {} has length 0: it points nowhere; it must not be zero", node.text);
            self.error(node, message);
        }
        unit
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
        let unit = direction(axis);
        if unit.is_none() {
            let message = if object.has("at") {
                format!("\"at\" {} is the spot's own position: it points nowhere; they must differ", node.text)
            } else {
                format!("the direction {} has length 0: it points nowhere; it must not be zero", node.text)
            };
            self.error(node, message);
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

//! Transforms: look-at, frame, translation, scale, rotation, matrix, and sequences of them.

use super::context::{Context, Keys, Object};
use super::json::{Kind, Node};
use super::value::ANY;
use crate::math::{DAffine3, DMat3, DVec3};

/// Determinant of the columns, each scaled to unit length, below which a matrix is singular: some hundred roundings.
const SINGULAR: f64 = 1e-14;

/// Sine of the angle between the up vector and the view below which they count as parallel.
const PARALLEL: f64 = 1e-9;

/// The forms a transform can take, for messages.
const FORMS: &str = "{from, at, up}, {o, x, y, z}, {translate}, {scale}, {axis, angle}, {rotate}, {matrix}";

/// The keys of all forms.
const KEYS: &[&str] =
    &["from", "at", "to", "up", "o", "x", "y", "z", "translate", "scale", "axis", "angle", "rotate", "matrix"];

impl<'a> Context<'a> {
    /// The transform under `transform`; the identity where there is none.
    pub fn transform(&mut self, object: &Object<'a>) -> Option<DAffine3> {
        match object.get("transform") {
            Some(node) => self.read_transform(node),
            None => Some(DAffine3::IDENTITY),
        }
    }

    fn read_transform(&mut self, node: &Node<'a>) -> Option<DAffine3> {
        if node.kind() != Kind::Array {
            return self.one_transform(node);
        }
        let steps: Vec<_> = node.elements().iter().map(|n| self.one_transform(n)).collect();
        let steps: Option<Vec<DAffine3>> = steps.into_iter().collect();
        // Applied in the order written: each new matrix multiplies on the left.
        let all = steps?.into_iter().fold(DAffine3::IDENTITY, |all, step| step * all);
        self.regular(node, all)
    }

    fn one_transform(&mut self, node: &Node<'a>) -> Option<DAffine3> {
        let object = self.object(node, "an object or an array of objects")?;
        let has_any = |keys: &[&str]| keys.iter().any(|k| object.has(k));
        let transform = if has_any(&["from", "at", "to", "up"]) {
            self.check_keys(&object, &Keys::only(&["from", "at", "to", "up"]));
            self.look_at(&object)
        } else if has_any(&["o", "x", "y", "z"]) {
            self.check_keys(&object, &Keys::only(&["o", "x", "y", "z"]));
            self.frame(&object)
        } else if let Some(value) = object.get("translate") {
            self.check_keys(&object, &Keys::only(&["translate"]));
            self.point(value).map(DAffine3::from_translation)
        } else if let Some(value) = object.get("scale") {
            self.check_keys(&object, &Keys::only(&["scale"]));
            self.point(value).map(DAffine3::from_scale)
        } else if has_any(&["axis", "angle"]) {
            self.check_keys(&object, &Keys::only(&["axis", "angle"]));
            self.axis_angle(&object)
        } else if let Some(value) = object.get("rotate") {
            self.check_keys(&object, &Keys::only(&["rotate"]));
            let [degrees, x, y, z] = self.vector_nodes::<4>(value)?.map(|n| self.number(&n, ANY));
            self.rotation(value, DVec3::new(x?, y?, z?), degrees?)
        } else if let Some(value) = object.get("matrix") {
            self.check_keys(&object, &Keys::only(&["matrix"]));
            self.matrix(value)
        } else {
            // Whatever is there is unknown; only where nothing is, nothing has been told.
            self.check_keys(&object, &Keys::only(KEYS));
            if object.is_empty() {
                self.error(node, format!("no transform; allowed: {FORMS}"));
            }
            None
        }?;
        self.regular(node, transform)
    }

    /// A point or a direction.
    pub fn point(&mut self, node: &Node<'a>) -> Option<DVec3> {
        self.vector::<3>(node, ANY).map(DVec3::from)
    }

    fn point_or(&mut self, object: &Object<'a>, key: &str, default: DVec3) -> Option<DVec3> {
        object.get(key).map_or(Some(default), |node| self.point(node))
    }

    /// Camera to world: the eye in `from`, looking along local −z to `at`. dirt's defaults.
    fn look_at(&mut self, object: &Object<'a>) -> Option<DAffine3> {
        if object.has("at") && object.has("to") {
            self.error(&object.node, "\"at\" and \"to\" mean the same; give one of them");
        }
        let from = self.point_or(object, "from", DVec3::Z);
        let at = self.point_or(object, if object.has("to") { "to" } else { "at" }, DVec3::ZERO);
        let up = self.point_or(object, "up", DVec3::Y);
        let (from, at, up) = (from?, at?, up?);
        let Some(back) = direction(from - at) else {
            let message = format!("\"from\" and \"at\" are the same point {}; they must differ", show(from));
            self.error(&object.node, message);
            return None;
        };
        let Some(upward) = direction(up) else {
            let message = format!("\"up\" {} has length 0: it points nowhere; it must not be zero", show(up));
            self.error(object.get("up").unwrap_or(&object.node), message);
            return None;
        };
        let right = upward.cross(back);
        if right.length() < PARALLEL {
            let message = format!("\"up\" {} is parallel to the view {}; it must not be", show(up), show(at - from));
            self.error(object.get("up").unwrap_or(&object.node), message);
            return None;
        }
        let right = right.normalize();
        Some(DAffine3 { matrix3: DMat3::from_cols(right, back.cross(right), back), translation: from })
    }

    fn frame(&mut self, object: &Object<'a>) -> Option<DAffine3> {
        let o = self.point_or(object, "o", DVec3::ZERO);
        let x = self.point_or(object, "x", DVec3::X);
        let y = self.point_or(object, "y", DVec3::Y);
        let z = self.point_or(object, "z", DVec3::Z);
        let mut good = true;
        for (key, axis) in [("x", x), ("y", y), ("z", z)] {
            if let (Some(DVec3::ZERO), Some(node)) = (axis, object.get(key)) {
                self.error(node, format!("the axis {key:?} has length 0: it points nowhere; it must not be zero"));
                good = false;
            }
        }
        let frame = DAffine3 { matrix3: DMat3::from_cols(x?, y?, z?), translation: o? };
        good.then_some(frame)
    }

    fn axis_angle(&mut self, object: &Object<'a>) -> Option<DAffine3> {
        let axis = self.required(object, "axis").and_then(|node| self.point(node));
        let angle = self.required(object, "angle").and_then(|node| self.number(node, ANY));
        self.rotation(object.get("axis").unwrap_or(&object.node), axis?, angle?)
    }

    fn rotation(&mut self, node: &Node<'a>, axis: DVec3, degrees: f64) -> Option<DAffine3> {
        let Some(axis) = direction(axis) else {
            let message =
                format!("the rotation's axis {} has length 0: it points nowhere; it must not be zero", show(axis));
            self.error(node, message);
            return None;
        };
        Some(DAffine3 { matrix3: rotation_matrix(axis, degrees), translation: DVec3::ZERO })
    }

    fn matrix(&mut self, node: &Node<'a>) -> Option<DAffine3> {
        let elements = self.array(node, "an array of 16 numbers, row by row")?;
        if elements.len() != 16 {
            self.wrong_type(node, "an array of 16 numbers, row by row");
            return None;
        }
        let values: Vec<Option<f64>> = elements.iter().map(|n| self.number(n, ANY)).collect();
        let m = values.into_iter().collect::<Option<Vec<f64>>>()?;
        if m[12..] != [0.0, 0.0, 0.0, 1.0] {
            self.error(node, format!("the last row is {:?}; allowed: 0, 0, 0, 1 (no perspective)", &m[12..]));
            return None;
        }
        let column = |c: usize| DVec3::new(m[c], m[4 + c], m[8 + c]);
        Some(DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
    }

    /// Passes a transform that can be inverted; reports any other.
    fn regular(&mut self, node: &Node<'a>, transform: DAffine3) -> Option<DAffine3> {
        if !transform.is_finite() {
            self.error(node, "the transform overflows; allowed: finite matrices");
            return None;
        }
        let m = transform.matrix3;
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(unit);
        if DMat3::from_cols_array_2d(&columns.map(|c| c.to_array())).determinant().abs() < SINGULAR {
            self.error(node, "the transform is singular: it flattens space; allowed: matrices with an inverse");
            return None;
        }
        Some(transform)
    }
}

/// The direction of a vector; zero has none.
pub(super) fn direction(v: DVec3) -> Option<DVec3> {
    Some(unit(v)).filter(|v| *v != DVec3::ZERO)
}

/// A vector scaled to length one without overflow or underflow on the way; zero stays zero.
fn unit(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 { (v / largest).normalize_or_zero() } else { DVec3::ZERO }
}

/// Rodrigues' rotation; quarter turns are exact, so that walls turned by 90° stay axis-aligned.
fn rotation_matrix(axis: DVec3, degrees: f64) -> DMat3 {
    let turn = degrees.rem_euclid(360.0);
    let (sin, cos) = if turn == 0.0 {
        (0.0, 1.0)
    } else if turn == 90.0 {
        (1.0, 0.0)
    } else if turn == 180.0 {
        (0.0, -1.0)
    } else if turn == 270.0 {
        (-1.0, 0.0)
    } else {
        turn.to_radians().sin_cos()
    };
    let column = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

/// A point as the file would write it.
fn show(p: DVec3) -> String {
    format!("[{}, {}, {}]", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let m = rotation_matrix(DVec3::X, 90.0);
        assert_eq!(m * DVec3::Z, -DVec3::Y);
        assert_eq!(m * DVec3::Y, DVec3::Z);
        assert_eq!(rotation_matrix(DVec3::X, -90.0) * DVec3::Z, DVec3::Y);
        assert_eq!(rotation_matrix(DVec3::Y, 450.0) * DVec3::Z, DVec3::X);
        assert_eq!(rotation_matrix(DVec3::Y, 180.0) * DVec3::Z, -DVec3::Z);
    }

    #[test]
    fn other_turns_agree_with_glam() {
        let axis = DVec3::new(1.0, -2.0, 0.5).normalize();
        for degrees in [0.1, 33.0, 89.999, 200.0, -12.0] {
            let (a, b) = (rotation_matrix(axis, degrees), DMat3::from_axis_angle(axis, f64::to_radians(degrees)));
            assert!(a.abs_diff_eq(b, 1e-14), "{degrees}");
        }
    }
}

//! Numbers, vectors, colours, words: the leaves of a scene file, each with its range.

use serde::Deserialize;

use super::context::Context;
use super::json::{Kind, Node, excerpt};
use crate::scene::desc::Color;

/// The numbers a value may take.
#[derive(Clone, Copy)]
pub(super) struct Range {
    /// The range for a message.
    pub text: &'static str,
    /// Whether a finite number lies in it.
    pub holds: fn(f64) -> bool,
}

/// Any finite number.
pub(super) const ANY: Range = Range { text: "any finite number", holds: |_| true };
/// Reflectances and transmittances.
pub(super) const UNIT: Range = Range { text: "0 to 1", holds: |x| (0.0..=1.0).contains(&x) };
/// Lengths and indices of refraction.
pub(super) const POSITIVE: Range = Range { text: "above 0", holds: |x| x > 0.0 };
/// Indices of refraction: beyond it their squares approach the ends of f32.
pub(super) const IOR: Range = Range { text: "0.001 to 1000", holds: |x| (1e-3..=1e3).contains(&x) };
/// Exponents of a spot's rim: beyond it the rim is thinner than f32 can sample.
pub(super) const FALLOFF: Range = Range { text: "0 to 10000", holds: |x| (0.0..=1e4).contains(&x) };
/// Sizes of a filter or a lens, where 0 is none.
pub(super) const NON_NEGATIVE: Range = Range { text: "0 or above", holds: |x| x >= 0.0 };
/// Imaginary parts of indices of refraction.
pub(super) const EXTINCTION: Range = Range { text: "0 to 1000", holds: |x| (0.0..=1e3).contains(&x) };
/// Indices of a coat over what is outside it.
pub(super) const IOR_COAT: Range = Range { text: "1 to 1000", holds: |x| (1.0..=1e3).contains(&x) };
/// Roughness α of facets: at 1 their normals fill the hemisphere.
pub(super) const ROUGHNESS: Range = Range { text: "0 to 1", holds: |x| (0.0..=1.0).contains(&x) };
/// Exponents of lobes: beyond it they are narrower than 32-bit directions.
pub(super) const EXPONENT: Range = Range { text: "0 to 1000000", holds: |x| (0.0..=1e6).contains(&x) };
/// Standard deviations of slope angles.
pub(super) const SLOPE: Range = Range { text: "0 to 1.5 radians", holds: |x| (0.0..=1.5).contains(&x) };
/// Radiance and radiant intensity: rendering computes in 32-bit floats.
pub(super) const EMISSION: Range = Range { text: "0 to 3.4e38", holds: |x| x >= 0.0 && (x as f32).is_finite() };
/// Half-angles of a spot's cone.
pub(super) const HALF_ANGLE: Range = Range { text: "0 to 180 degrees", holds: |x| (0.0..=180.0).contains(&x) };
/// Coordinates stored in 32 bits.
const SINGLE: Range = Range { text: "-3.4e38 to 3.4e38 (32-bit floats)", holds: |x| (x as f32).is_finite() };

impl<'a> Context<'a> {
    /// A finite number within a range.
    pub fn number(&mut self, node: &Node<'a>, range: Range) -> Option<f64> {
        if node.kind() != Kind::Number {
            self.wrong_type(node, "a number");
            return None;
        }
        // JSON's numbers are a subset of what `f64::from_str` reads, and it rounds correctly.
        let x: f64 = node.text.parse().unwrap_or(f64::NAN);
        if !x.is_finite() {
            self.error(node, format!("{} is not a finite 64-bit number; allowed: {}", excerpt(node.text), range.text));
            return None;
        }
        self.in_range(node, x, range)
    }

    fn in_range(&mut self, node: &Node<'a>, x: f64, range: Range) -> Option<f64> {
        if (range.holds)(x) {
            return Some(x);
        }
        self.error(node, format!("{} is out of range; allowed: {}", excerpt(node.text), range.text));
        None
    }

    /// A whole number between two bounds, both included.
    pub fn integer(&mut self, node: &Node<'a>, least: u64, most: u64) -> Option<u64> {
        if node.kind() != Kind::Number {
            self.wrong_type(node, "a whole number");
            return None;
        }
        let x = match node.text.parse::<u64>() {
            Ok(x) => Some(x),
            // 64.0 and 1e3 are whole, too; every f64 up to 2^53 is exact.
            Err(_) => {
                let x: f64 = node.text.parse().unwrap_or(f64::NAN);
                (x.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(&x)).then_some(x as u64)
            }
        };
        if let Some(x) = x.filter(|x| (least..=most).contains(x)) {
            return Some(x);
        }
        let text = excerpt(node.text);
        self.error(node, format!("{text} is out of range; allowed: whole numbers from {least} to {most}"));
        None
    }

    /// `true` or `false`.
    pub fn boolean(&mut self, node: &Node<'a>) -> Option<bool> {
        if node.kind() == Kind::Bool {
            return Some(node.text == "true");
        }
        self.wrong_type(node, "true or false");
        None
    }

    /// A string.
    pub fn string(&mut self, node: &Node<'a>) -> Option<String> {
        if node.kind() != Kind::String {
            self.wrong_type(node, "a string");
            return None;
        }
        let text = node.string();
        if text.is_none() {
            self.error(node, format!("{} holds an invalid escape", excerpt(node.text)));
        }
        text
    }

    /// The elements of an N-array, or the same number N times.
    pub fn vector_nodes<const N: usize>(&mut self, node: &Node<'a>) -> Option<[Node<'a>; N]> {
        match node.kind() {
            Kind::Number => return Some(std::array::from_fn(|_| node.clone())),
            Kind::Array => {
                if let Ok(elements) = node.elements().try_into() {
                    return Some(elements);
                }
            }
            _ => {}
        }
        self.wrong_type(node, &format!("an array of {N} numbers, or one number for all"));
        None
    }

    /// A vector whose components lie in a range; one number stands for all of them.
    pub fn vector<const N: usize>(&mut self, node: &Node<'a>, range: Range) -> Option<[f64; N]> {
        let nodes = self.vector_nodes::<N>(node)?;
        if node.kind() == Kind::Number {
            // One number is one mistake, not N.
            return self.number(node, range).map(|x| [x; N]);
        }
        let values = nodes.map(|n| self.number(&n, range));
        if values.iter().any(Option::is_none) {
            return None;
        }
        Some(values.map(Option::unwrap_or_default))
    }

    /// A colour where no texture can stand.
    pub fn color(&mut self, node: &Node<'a>, range: Range) -> Option<Color> {
        self.no_texture(node)?;
        self.vector(node, range)
    }

    fn no_texture(&mut self, node: &Node<'a>) -> Option<()> {
        if matches!(node.kind(), Kind::Object | Kind::String) {
            self.error(node, "no texture can stand here; allowed: a number or an array of numbers");
            return None;
        }
        Some(())
    }

    /// An array of vectors of 32-bit floats; it may be long.
    pub fn single_vectors<const N: usize>(&mut self, node: &Node<'a>) -> Option<Vec<[f32; N]>>
    where
        [f32; N]: Deserialize<'a>,
    {
        // The typed parser is the fast road; it knows no places, so that anything odd takes the slow one.
        if let Ok(rows) = serde_json::from_str::<Vec<[f32; N]>>(node.text) {
            if rows.iter().flatten().all(|x| x.is_finite()) {
                return Some(rows);
            }
        }
        let mut rows = Vec::new();
        let mut complete = true;
        for element in self.array(node, &format!("an array of arrays of {N} numbers"))? {
            match self.vector::<N>(&element, SINGLE) {
                Some(row) => rows.push(row.map(|x| x as f32)),
                None => complete = false,
            }
        }
        complete.then_some(rows)
    }
}

//! What is known of a group of emitters: where they are, where to they shine, how much.

use std::f32::consts::PI;

use crate::math::Vec3;
use crate::planted::{Bug, planted};

/// Bounds of emitters in space and direction [ContyKulla18, section 4].
#[derive(Clone, Copy, Debug)]
pub struct EmitterBound {
    /// Lower corner of a box around them, render space.
    pub lo: Vec3,
    /// Upper corner.
    pub hi: Vec3,
    /// Unit axis of a cone that holds their normals.
    pub axis: Vec3,
    /// Its half angle, in [0, π].
    pub theta_normals: f32,
    /// How far from its normal each of them shines, radians.
    pub theta_reach: f32,
    /// Whether they shine to the other side of their normals as well.
    pub two_sided: bool,
    /// Radiant intensity in the direction in which they shine most, as a luminance in render units: what the importance of an
    /// emitter at distance d is d² times of, whatever kind of emitter it is.
    pub intensity: f64,
}

impl EmitterBound {
    /// The bounds of both.
    pub fn union(self, o: Self) -> Self {
        let (axis, theta_normals) = cone_union((self.axis, self.theta_normals), (o.axis, o.theta_normals));
        Self {
            lo: self.lo.min(o.lo),
            hi: self.hi.max(o.hi),
            axis,
            theta_normals,
            theta_reach: self.theta_reach.max(o.theta_reach),
            two_sided: match planted(Bug::BackForgotten) {
                true => self.two_sided && o.two_sided,
                false => self.two_sided || o.two_sided,
            },
            intensity: self.intensity + o.intensity,
        }
    }

    /// The middle of the box.
    pub fn center(&self) -> Vec3 {
        0.5 * (self.lo + self.hi)
    }

    /// What it costs to know no more of the group than these bounds: intensity × solid angle of directions × area of the box
    /// [ContyKulla18, (1)].
    pub fn cost(&self) -> f64 {
        let d = (self.hi - self.lo).as_dvec3();
        // Emitters on a line have a box without area; the line's length still matters.
        let area = d.x * d.y + d.y * d.z + d.z * d.x + 1e-3 * d.max_element() * d.max_element();
        let (o, sin, cos) = (self.theta_normals, self.theta_normals.sin(), self.theta_normals.cos());
        let w = (o + self.theta_reach).min(PI);
        // ∫ over the cone of normals, and beyond it by the cosine up to the reach.
        let directions =
            2.0 * PI * (1.0 - cos) + 0.5 * PI * (2.0 * w * sin - (o - 2.0 * w).cos() - 2.0 * o * sin + cos);
        self.intensity * f64::from(directions) * area
    }
}

/// The angle between two unit vectors.
fn angle(a: Vec3, b: Vec3) -> f32 {
    a.cross(b).length().atan2(a.dot(b))
}

/// A cone around two cones, each with unit axis and half angle [ContyKulla18, algorithm 1].
fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    if wide.1 >= PI {
        return wide;
    }
    let between = angle(wide.0, narrow.0);
    // Roundings of angles: the cone must hold what it is said to hold.
    let slack = 1e-5;
    if between + narrow.1 <= wide.1 {
        return wide;
    }
    let half = 0.5 * (wide.1 + between + narrow.1) + slack;
    let across = (narrow.0 - wide.0 * wide.0.dot(narrow.0)).normalize_or_zero();
    if across == Vec3::ZERO && wide.0.dot(narrow.0) > 0.0 {
        // The same axis but for rounding.
        return (wide.0, half.min(PI));
    }
    if half >= PI || across == Vec3::ZERO {
        return (wide.0, PI);
    }
    let (sin, cos) = (half - wide.1).sin_cos();
    ((wide.0 * cos + across * sin).normalize(), half)
}

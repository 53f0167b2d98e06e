//! Orthonormal frames.

use super::Vec3;

/// An orthonormal frame whose third axis is a given unit normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// First tangent.
    pub x: Vec3,
    /// Second tangent.
    pub y: Vec3,
    /// The normal.
    pub z: Vec3,
}

impl Frame {
    /// Builds a right-handed frame around the unit vector `n`, without a branch or a singular direction
    /// (Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3).
    #[inline]
    pub fn from_normal(n: Vec3) -> Self {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            x: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            y: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            z: n,
        }
    }

    /// From frame coordinates to the frame's surroundings.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// From the surroundings to frame coordinates.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_at_the_poles_and_between() {
        for n in [
            Vec3::Z,
            -Vec3::Z,
            Vec3::X,
            Vec3::new(1e-4, -2e-4, -1.0).normalize(),
            Vec3::new(0.3, -0.5, -0.8).normalize(),
            Vec3::new(0.3, -0.5, 0.0).normalize(),
        ] {
            let f = Frame::from_normal(n);
            for (a, b, want) in [(f.x, f.x, 1.0), (f.y, f.y, 1.0), (f.x, f.y, 0.0), (f.x, f.z, 0.0), (f.y, f.z, 0.0)] {
                assert!((a.dot(b) - want).abs() < 1e-6, "{n:?}: {a:?}·{b:?}");
            }
            assert!((f.x.cross(f.y) - n).length() < 1e-6, "{n:?} is not right-handed");
        }
    }
}

//! Textures: values that vary over a surface, by position or by texture coordinates.

mod image;
mod noise;

use std::sync::Arc;

pub use image::{ImageTexture, Wrap};

use crate::geometry::SurfacePoint;
use crate::math::{DVec3, Rgb};

/// A texture in render space. Cheap to clone: what is large is shared.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    /// Cells by position.
    Checker(Arc<Checker>),
    /// Veins by position.
    Marble(Arc<Marble>),
    /// An image over texture coordinates.
    Image(ImageTexture),
}

/// From render space to the world, where textures by position are defined: `p · factor + offset`.
#[derive(Clone, Copy, Debug)]
pub struct ToWorld {
    /// World units per render unit.
    pub factor: f64,
    /// The world point at render space's origin.
    pub offset: DVec3,
}

impl ToWorld {
    fn point(&self, at: &SurfacePoint) -> DVec3 {
        at.p().as_dvec3() * self.factor + self.offset
    }
}

/// `odd` where sin(sx·x) sin(sy·y) sin(sz·z) is below 0, else `even`.
#[derive(Clone, Debug)]
pub struct Checker {
    /// To the world.
    pub to_world: ToWorld,
    /// Radians per world unit.
    pub scale: DVec3,
    /// Where the product is not negative.
    pub even: Texture,
    /// Where it is.
    pub odd: Texture,
}

/// What the other components of a normal along an axis sum to at most: over the scene, about one unit large, a surface
/// that is tilted no more leaves its plane by no more than it is known to.
const ALONG_AXIS: f32 = 1e-6;

impl Checker {
    /// Whether the product of sines at a point is below zero. On a surface that lies in one of the pattern's own planes
    /// (z = 0, say) the sign would be that of the rounding of its points: there a sine that cannot be told from zero is
    /// zero. Elsewhere such points are as likely on either side, and the cells keep their size.
    fn is_odd(&self, at: &SurfacePoint) -> bool {
        let p = self.to_world.point(at) * self.scale;
        // How far the argument may be off: by the point's error bound, in which the rounding of vertices is small, and
        // by f64's on the way to the world and in the product.
        let error = at.point.error.as_dvec3() * (self.to_world.factor * self.scale.abs());
        let rounding = (p.abs() + (self.to_world.offset * self.scale).abs()) * (4.0 * f64::EPSILON);
        let (p, error, normal) = (p.to_array(), (error + rounding).to_array(), at.ng.abs().to_array());
        let mut odd = false;
        for axis in 0..3 {
            // Zero everywhere, and the product with it.
            if self.scale[axis] == 0.0 {
                return false;
            }
            let sin = p[axis].sin();
            let in_plane = normal[(axis + 1) % 3] + normal[(axis + 2) % 3] <= ALONG_AXIS;
            // |sin(x) − sin(y)| ≤ |x − y|.
            if in_plane && sin.abs() <= error[axis] {
                return false;
            }
            odd ^= sin < 0.0;
        }
        odd
    }
}

/// From `base` to `veins` by ½ (1 + sin(scale·z + 10 turbulence)).
#[derive(Clone, Debug)]
pub struct Marble {
    /// To the world.
    pub to_world: ToWorld,
    /// Radians per world unit along z.
    pub scale: f64,
    /// Where the sine is −1.
    pub base: Texture,
    /// Where it is 1.
    pub veins: Texture,
}

impl Texture {
    /// The value at a surface point.
    pub fn color(&self, at: &SurfacePoint) -> Rgb {
        match self {
            Self::Constant(c) => *c,
            Self::Checker(checker) => {
                if checker.is_odd(at) {
                    checker.odd.color(at)
                } else {
                    checker.even.color(at)
                }
            }
            Self::Marble(marble) => {
                let p = marble.to_world.point(at);
                let t = (0.5 * (1.0 + (marble.scale * p.z + 10.0 * noise::turbulence(p)).sin())) as f32;
                marble.base.color(at) * (1.0 - t) + marble.veins.color(at) * t
            }
            Self::Image(image) => image.value(at.uv()),
        }
    }

    /// The value at a surface point where a number is asked for: the mean of the channels.
    pub fn scalar(&self, at: &SurfacePoint) -> f32 {
        mean(self.color(at))
    }

    /// A bound of the values of each channel.
    pub fn largest(&self) -> Rgb {
        match self {
            Self::Constant(c) => *c,
            Self::Checker(c) => c.even.largest().max(c.odd.largest()),
            Self::Marble(m) => m.base.largest().max(m.veins.largest()),
            Self::Image(image) => image.largest(),
        }
    }

    /// A lower bound of the values of each channel.
    pub fn smallest(&self) -> Rgb {
        match self {
            Self::Constant(c) => *c,
            Self::Checker(c) => c.even.smallest().min(c.odd.smallest()),
            Self::Marble(m) => m.base.smallest().min(m.veins.smallest()),
            Self::Image(image) => image.smallest(),
        }
    }

    /// Whether values depend on texture coordinates, which not every shape has.
    pub fn needs_uv(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Checker(c) => c.even.needs_uv() || c.odd.needs_uv(),
            Self::Marble(m) => m.base.needs_uv() || m.veins.needs_uv(),
            Self::Image(_) => true,
        }
    }

    /// Whether some checker in it is all `even` over the plane where a coordinate of the world has a value, known to an
    /// error: one of its sines is zero there.
    pub fn is_even_in_plane(&self, axis: usize, value: f64, error: f64) -> bool {
        match self {
            Self::Constant(_) | Self::Image(_) => false,
            Self::Checker(c) => {
                (c.scale[axis] * value).sin().abs() <= c.scale[axis].abs() * error
                    || c.even.is_even_in_plane(axis, value, error)
                    || c.odd.is_even_in_plane(axis, value, error)
            }
            Self::Marble(m) => {
                m.base.is_even_in_plane(axis, value, error) || m.veins.is_even_in_plane(axis, value, error)
            }
        }
    }

    /// Whether a checker in it does not vary along an axis of the world, for its scale there is zero: it is "even" in every
    /// plane across.
    pub fn is_even_across(&self, axis: usize) -> bool {
        match self {
            Self::Constant(_) | Self::Image(_) => false,
            Self::Checker(c) => c.scale[axis] == 0.0 || c.even.is_even_across(axis) || c.odd.is_even_across(axis),
            Self::Marble(m) => m.base.is_even_across(axis) || m.veins.is_even_across(axis),
        }
    }

    /// Steps in u and v over which differences stand for derivatives: half a texel of the finest image below, else a
    /// thousandth of the unit square.
    pub fn step(&self) -> [f32; 2] {
        let finer = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].min(b[1])];
        match self {
            Self::Constant(_) => [1e-3; 2],
            Self::Checker(c) => finer(c.even.step(), c.odd.step()),
            Self::Marble(m) => finer(m.base.step(), m.veins.step()),
            Self::Image(image) => image.size().map(|n| 0.5 / n as f32),
        }
    }
}

/// The mean of the channels.
pub fn mean(c: Rgb) -> f32 {
    (c.x + c.y + c.z) * (1.0 / 3.0)
}

#[cfg(test)]
mod tests;

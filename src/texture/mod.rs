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

/// Sines below this are zero: on a plane that lies in one of the pattern's own planes (z = 0, say) the sign would be that
/// of the rounding of its points.
const ZERO_SINE: f64 = 1e-5;

impl Texture {
    /// The value at a surface point.
    pub fn color(&self, at: &SurfacePoint) -> Rgb {
        match self {
            Self::Constant(c) => *c,
            Self::Checker(checker) => {
                let p = checker.to_world.point(at) * checker.scale;
                let sines = [p.x, p.y, p.z].map(f64::sin);
                let zero = sines.iter().any(|s| s.abs() < ZERO_SINE);
                let odd = !zero && sines.iter().filter(|s| **s < 0.0).count() % 2 == 1;
                if odd { checker.odd.color(at) } else { checker.even.color(at) }
            }
            Self::Marble(marble) => {
                let p = marble.to_world.point(at);
                let t = (0.5 * (1.0 + (marble.scale * p.z + 10.0 * noise::turbulence(p)).sin())) as f32;
                marble.base.color(at) * (1.0 - t) + marble.veins.color(at) * t
            }
            Self::Image(image) => image.value(at.uv),
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

//! Textures as written: a tree by index, every index already resolved, every texel decoded.

use std::sync::Arc;

use super::Color;

/// A material's or surface's parameter: one value everywhere, or a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Param<T> {
    /// The same everywhere.
    Value(T),
    /// Index into `SceneDesc::textures`. A number is the mean of the texture's channels.
    Texture(usize),
}

/// A texture of the format. Positions are world coordinates, v grows upwards in images.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureDesc {
    /// The same everywhere.
    Constant(Color),
    /// `odd` where sin(scale·x) sin(scale·y) sin(scale·z) is below 0, else `even`.
    Checker {
        /// Radians per scene unit, per axis.
        scale: [f64; 3],
        /// Where the product is positive.
        even: Param<Color>,
        /// Where it is negative.
        odd: Param<Color>,
    },
    /// From `base` to `veins` by ½ (1 + sin(scale·z + 10 turbulence(x, y, z))).
    Marble {
        /// Radians per scene unit along z.
        scale: f64,
        /// Where the sine is −1.
        base: Param<Color>,
        /// Where it is 1.
        veins: Param<Color>,
    },
    /// An image over the surface's texture coordinates.
    Image {
        /// The texels, shared by all textures of the same file.
        texels: Arc<Texels>,
        /// Multiplies every texel, above 0.
        scale: f64,
        /// What lies beyond the unit square.
        wrap: Wrap,
        /// What lies between texels.
        filter: Filter,
    },
}

/// A decoded image: linear, finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Texels {
    /// The file as messages call it.
    pub file: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row-major from the top left.
    pub rgb: Arc<Vec<[f32; 3]>>,
}

/// What lies beyond an image's edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    Repeat,
    /// Its outermost texels.
    Clamp,
}

/// What lies between an image's texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The nearest one.
    Nearest,
    /// Linear interpolation of four.
    Bilinear,
}

/// What textures do to a surface besides its material's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinishDesc {
    /// Fraction of the surface that is there, in [0, 1].
    pub opacity: Param<f64>,
    /// Index of a texture of tangent-space normals, each component c stored as (c + 1)/2.
    pub normal_map: Option<usize>,
    /// Index of a texture of displacements along the shading normal, scene units.
    pub bump_map: Option<usize>,
}

impl Default for FinishDesc {
    fn default() -> Self {
        Self { opacity: Param::Value(1.0), normal_map: None, bump_map: None }
    }
}

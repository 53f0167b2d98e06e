//! Uniform numbers, and the maps that turn them into directions, points and choices.

mod alias;
mod sampler;
mod spherical;
pub mod warp;

pub use alias::AliasTable;
pub(crate) use sampler::mix;
pub use sampler::{Coins, Sampler, SamplerKind, Stream};
pub use spherical::{SphereCone, SphericalRectangle, SphericalTriangle};

/// The largest f32 below 1: the largest uniform number.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - 0.5 * f32::EPSILON;

//! Uniform numbers, and the maps that turn them into directions, points and choices.

mod alias;
mod sampler;
pub mod warp;

pub use alias::AliasTable;
pub use sampler::{Coins, Sampler, SamplerKind, Stream};

//! How far one image is from another, and whether a difference is more than noise.

mod difference;
mod metrics;
mod noise;
pub mod special;
pub mod stats;

pub use difference::{BLOCK, FULL_COLOUR, difference};
pub use metrics::{CompareError, Metrics, metrics};
pub use noise::{Figure, NoiseShare, Reference, ReferenceNoise};

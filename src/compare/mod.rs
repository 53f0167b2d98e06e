//! How far one image is from another, and whether a difference is more than noise.

mod metrics;
pub mod special;
pub mod stats;

pub use metrics::{CompareError, Metrics, metrics};

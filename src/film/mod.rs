//! The film: exact sums of contributions, and the images they resolve to.

mod accumulator;
mod aov;
mod image;
mod variance;

pub use accumulator::{Accumulator, BYTES_PER_PIXEL, Quanta};
pub use aov::{Channel, Samples};
pub use image::Image;
pub use variance::{Squares, VARIANCE_BYTES_PER_PIXEL, VarianceFilm};

//! A scattering vertex of a subpath.

use super::mis::Partial;
use crate::bsdf::Bsdf;
use crate::geometry::SurfacePoint;
use crate::light::Receiver;
use crate::math::{Rgb, Vec3};

/// A surface point that a subpath scatters at.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<S = f64> {
    /// Where.
    pub at: SurfacePoint,
    /// Unit direction to the previous vertex.
    pub wo: Vec3,
    /// How it scatters.
    pub bsdf: Bsdf,
    /// Throughput of the subpath up to here, this vertex's own scattering left out.
    pub beta: Rgb,
    /// Partial sums of the weights.
    pub partial: Partial<S>,
    /// Number of vertices of the subpath up to here, this one included.
    pub number: u32,
}

impl<S> Vertex<S> {
    /// The vertex as next-event estimation sees it: the same from either end of a path.
    #[inline]
    pub fn receiver(&self) -> Receiver {
        Receiver::new(&self.at, self.wo, self.bsdf.transmits())
    }
}

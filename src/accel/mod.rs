//! Intersection and occlusion behind one trait; the backend is chosen once, by type.

pub mod bvh;
#[cfg(feature = "embree")]
pub mod embree;

use std::fmt;
use std::sync::Arc;

use crate::geometry::{Geometry, Hit};
use crate::math::Ray;

/// What to build besides the transport geometry.
#[derive(Clone, Copy, Debug, Default)]
pub struct AccelOptions {
    /// Build the delta points' own index, for `intersect_delta`. Transport queries never see it.
    pub delta_points: bool,
    /// Threads to build with, where the backend builds with several; 0 for one per logical processor.
    pub threads: u32,
}

/// A delta point met by a query that asked for one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeltaHit {
    /// Ray parameter of closest approach, in lengths of the ray's direction.
    pub t: f32,
    /// Index into `Geometry::delta_points`.
    pub point: u32,
}

/// Memory that a backend takes beside the geometry, bytes for each triangle or quadric, as measured over grids and soups of
/// 10⁵ to 4·10⁶ triangles.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// At most, while it is built.
    pub building: u64,
    /// Once it is built.
    pub built: u64,
}

/// An acceleration structure over a scene's `Geometry`.
///
/// Rays are half-open to nothing: hits with `tmin ≤ t ≤ tmax` count, `t = 0` included, as Embree's robust mode
/// does. Callers start rays off the surface (`SurfacePoint::origin`). Rays with a non-finite or zero direction hit
/// nothing.
pub trait Accel: Sync + Send + Sized {
    /// The backend's name, as the command line spells it.
    const NAME: &'static str;

    /// The memory it takes.
    const FOOTPRINT: Footprint;

    /// Builds the structure. The geometry is shared, not copied.
    ///
    /// # Errors
    /// When the backend cannot be initialised or runs out of memory.
    fn build(geometry: Arc<Geometry>, options: AccelOptions) -> Result<Self, AccelError>;

    /// The nearest hit, or `None`.
    fn intersect(&self, ray: &Ray) -> Option<Hit>;

    /// The nearest hit on a surface that is partly opaque (`Geometry::cut_outs`), or `None`.
    fn intersect_cut_out(&self, ray: &Ray) -> Option<Hit>;

    /// Whether anything that is opaque lies on the segment: all surfaces but `Geometry::cut_outs`.
    fn occluded(&self, ray: &Ray) -> bool;

    /// `occluded` for several rays at once; `out[i]` answers `rays[i]`. The slices have equal length.
    fn occluded_many(&self, rays: &[Ray], out: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(out) {
            *blocked = self.occluded(ray);
        }
    }

    /// The nearest delta point within its ε of the ray, or `None`; always `None` unless
    /// `AccelOptions::delta_points` was set. Transport geometry does not block this query.
    fn intersect_delta(&self, ray: &Ray) -> Option<DeltaHit>;

    /// Name, version and instruction set for the output's metadata, for example `embree 4.3.3 AVX512`.
    fn describe(&self) -> String;
}

#[cfg(test)]
mod tests;

/// Why an acceleration structure could not be built.
#[derive(Debug, Clone)]
pub struct AccelError {
    /// What failed and what to do.
    pub message: String,
}

impl fmt::Display for AccelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for AccelError {}

//! Intersection by Embree 4: the safe side of `embree4_sys`, which nothing else names.
//!
//! What could be misused cannot be written down: a scene is either under construction or committed
//! ([`scene::SceneBuilder`], [`scene::Scene`]), buffers are kept alive by the scene that reads them, every fallible
//! call is followed by a check of Embree's error code, and no panic crosses Embree's frames.

mod device;
mod scene;
mod user;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use self::device::Device;
use self::scene::{RayMask, Scene, SceneBuilder};
use self::user::UserGeometry;
use super::{Accel, AccelError, AccelOptions, DeltaHit};
use crate::geometry::{Geometry, GeometryKind, Hit};
use crate::math::{Ray, Vec3};

/// Embree's number of the triangle geometry.
const TRIANGLES: u32 = 0;
/// Embree's number of the quadrics' user geometry.
const QUADRICS: u32 = 1;

/// Fewer rays than this are faster one by one. Full packets of eight take from 0.7 (a few dozen triangles) to 1.0
/// (many thousands) of the single queries' time, half-full ones never less; sixteen at once and the hint that rays
/// are coherent were slower everywhere.
const MIN_PACKET: usize = 6;

/// The geometry of a scene in Embree's trees.
///
/// Triangles and quadrics, where there are any, share one scene; each kind has a tree of its own there. Delta points
/// have another scene and another mask bit, so that transport rays pay nothing for them.
pub struct EmbreeAccel {
    transport: Scene,
    delta: Option<Scene>,
    description: String,
}

/// `Geometry::quadrics` as Embree sees them.
struct Quadrics(Arc<Geometry>);

impl UserGeometry for Quadrics {
    fn len(&self) -> usize {
        self.0.quadrics.len()
    }

    fn bounds(&self, primitive: u32) -> (Vec3, Vec3) {
        self.0.quadrics[primitive as usize].bounds()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<f32> {
        self.0.quadrics[primitive as usize].intersect(ray)
    }
}

/// `Geometry::delta_points` as Embree sees them.
struct DeltaPoints(Arc<Geometry>);

impl UserGeometry for DeltaPoints {
    fn len(&self) -> usize {
        self.0.delta_points.len()
    }

    fn bounds(&self, primitive: u32) -> (Vec3, Vec3) {
        self.0.delta_points[primitive as usize].bounds()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<f32> {
        self.0.delta_points[primitive as usize].intersect(ray)
    }
}

impl Accel for EmbreeAccel {
    const NAME: &'static str = "embree";

    fn build(geometry: Arc<Geometry>, options: AccelOptions) -> Result<Self, AccelError> {
        let device = Arc::new(Device::new(options.threads)?);
        let mut transport = SceneBuilder::new(&device)?;
        // Each kind of geometry is one more tree that every ray goes through: none is attached empty.
        if !geometry.triangles.is_empty() {
            transport.attach_triangles(&geometry, TRIANGLES, RayMask::TRANSPORT)?;
        }
        if !geometry.quadrics.is_empty() {
            transport.attach_user(Quadrics(Arc::clone(&geometry)), QUADRICS, RayMask::TRANSPORT)?;
        }
        let transport = transport.commit(RayMask::TRANSPORT)?;
        let delta = if options.delta_points && !geometry.delta_points.is_empty() {
            let mut delta = SceneBuilder::new(&device)?;
            delta.attach_user(DeltaPoints(geometry), 0, RayMask::DELTA)?;
            Some(delta.commit(RayMask::DELTA)?)
        } else {
            None
        };
        let description = format!("embree {} {}", device.version(), device.isa());
        Ok(Self { transport, delta, description })
    }

    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.transport.intersect(ray).map(|hit| Hit {
            t: hit.t,
            geometry: if hit.geometry == TRIANGLES { GeometryKind::Triangle } else { GeometryKind::Quadric },
            primitive: hit.primitive,
            u: hit.u,
            v: hit.v,
        })
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.transport.occluded(ray)
    }

    fn occluded_many(&self, rays: &[Ray], out: &mut [bool]) {
        for (rays, out) in rays.chunks(8).zip(out.chunks_mut(8)) {
            if rays.len() >= MIN_PACKET {
                self.transport.occluded8(rays, out);
            } else {
                for (ray, blocked) in rays.iter().zip(out) {
                    *blocked = self.transport.occluded(ray);
                }
            }
        }
    }

    fn intersect_delta(&self, ray: &Ray) -> Option<DeltaHit> {
        let hit = self.delta.as_ref()?.intersect(ray)?;
        Some(DeltaHit { t: hit.t, point: hit.primitive })
    }

    fn describe(&self) -> String {
        self.description.clone()
    }
}

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
use self::scene::{RawHit, RayMask, Scene, SceneBuilder};
use self::user::UserGeometry;
use super::{Accel, AccelError, AccelOptions, DeltaHit, Footprint};
use crate::geometry::{Geometry, GeometryKind, Hit, Quadric};
use crate::math::{Ray, Vec3};

/// Embree's number of the triangle geometry, of opaque surfaces and of cut-outs.
const TRIANGLES: [u32; 2] = [0, 2];
/// Embree's number of the quadrics' user geometry, likewise.
const QUADRICS: [u32; 2] = [1, 3];

/// Fewer rays than this are faster one by one. Full packets of eight take from 0.7 (a few dozen triangles) to 1.0
/// (many thousands) of the single queries' time, half-full ones never less; sixteen at once and the hint that rays
/// are coherent were slower everywhere.
const MIN_PACKET: usize = 6;

/// The geometry of a scene in Embree's trees.
///
/// Triangles and quadrics, where there are any, share one scene; each kind has a tree of its own there. Surfaces that are
/// partly opaque have a mask bit that occlusion rays lack, and a scene of their own besides, so that what looks for them
/// alone goes through no other surface's tree. Delta points have another scene and another mask bit, so that transport
/// rays pay nothing for them.
pub struct EmbreeAccel {
    transport: Scene,
    cut_outs: Option<CutOuts>,
    delta: Option<Scene>,
    description: String,
}

/// Surfaces that are partly opaque.
struct CutOuts {
    scene: Scene,
    /// Corners of a box around them, and the largest coordinate in it: most rays of a large scene with a small cut-out are
    /// spared a query that has a price even when it ends at the root.
    bounds: [Vec3; 2],
    extent: f32,
    /// By Embree's number of a geometry: what its primitives are called in `Geometry`.
    numbers: [Vec<u32>; 4],
}

/// Primitives of `Geometry::quadrics` as Embree sees them.
struct Quadrics {
    geometry: Arc<Geometry>,
    /// Which; `None` for all.
    some: Option<Vec<u32>>,
}

impl Quadrics {
    fn at(&self, primitive: u32) -> &Quadric {
        let number = self.some.as_ref().map_or(primitive, |some| some[primitive as usize]);
        &self.geometry.quadrics[number as usize]
    }
}

impl UserGeometry for Quadrics {
    fn len(&self) -> usize {
        self.some.as_ref().map_or(self.geometry.quadrics.len(), Vec::len)
    }

    fn bounds(&self, primitive: u32) -> (Vec3, Vec3) {
        self.at(primitive).bounds()
    }

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<f32> {
        self.at(primitive).intersect(ray)
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

impl CutOuts {
    /// Attaches all surfaces to `transport`, opaque ones and others apart, and these to a scene of their own.
    fn build(device: &Arc<Device>, geometry: &Arc<Geometry>, transport: &mut SceneBuilder) -> Result<Self, AccelError> {
        let mut own = SceneBuilder::new(device)?;
        let mut numbers = [const { Vec::new() }; 4];
        let masks = [RayMask::OPAQUE, RayMask::CUT_OUT];
        for (cut_out, mask) in [false, true].into_iter().zip(masks) {
            let (triangles, quadrics) = (TRIANGLES[usize::from(cut_out)], QUADRICS[usize::from(cut_out)]);
            let which = |kind, count: usize| -> Vec<u32> {
                (0..count as u32).filter(|&i| geometry.is_cut_out(kind, i) == cut_out).collect()
            };
            let some = which(GeometryKind::Triangle, geometry.triangles.len());
            let corners: Vec<[u32; 3]> = some.iter().map(|&i| geometry.triangles[i as usize]).collect();
            numbers[triangles as usize] = some;
            let some = which(GeometryKind::Quadric, geometry.quadrics.len());
            for scene in [Some(&mut *transport), cut_out.then_some(&mut own)].into_iter().flatten() {
                if !corners.is_empty() {
                    scene.attach_triangles(geometry, Some(corners.clone()), triangles, mask)?;
                }
                if !some.is_empty() {
                    let user = Quadrics { geometry: Arc::clone(geometry), some: Some(some.clone()) };
                    scene.attach_user(user, quadrics, mask)?;
                }
            }
            numbers[quadrics as usize] = some;
        }
        let corners = numbers[TRIANGLES[1] as usize].iter().flat_map(|&i| geometry.corners(i));
        let quadrics = &numbers[QUADRICS[1] as usize];
        let boxes = quadrics.iter().flat_map(|&i| <[Vec3; 2]>::from(geometry.quadrics[i as usize].bounds()));
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for p in corners.chain(boxes) {
            (min, max) = (min.min(p), max.max(p));
        }
        let extent = min.abs().max(max.abs()).max_element();
        let scene = own.commit(RayMask::CUT_OUT, RayMask::CUT_OUT)?;
        Ok(Self { scene, bounds: [min, max], extent, numbers })
    }

    /// Whether a ray may meet the box around them: false only where it does not.
    #[inline]
    fn may_meet(&self, ray: &Ray) -> bool {
        let [min, max] = self.bounds;
        // Of two coordinates' difference and its product four roundings, 2⁻²² of the larger one, and as much again.
        let margin = ray.o.abs().max(Vec3::splat(self.extent)) * (1.0 / (1 << 20) as f32);
        // Clamped, so that nothing times infinity cannot occur.
        let huge = Vec3::splat(f32::MAX);
        let reciprocal = ray.d.recip().clamp(-huge, huge);
        let (a, b) = ((min - margin - ray.o) * reciprocal, (max + margin - ray.o) * reciprocal);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        enter <= leave && leave >= 0.0 && enter <= ray.tmax
    }

    #[inline]
    fn as_hit(&self, hit: &RawHit) -> Hit {
        as_hit(hit, self.numbers[hit.geometry as usize][hit.primitive as usize])
    }
}

/// A hit on the primitive of that number in `Geometry`.
#[inline]
fn as_hit(hit: &RawHit, primitive: u32) -> Hit {
    let geometry = if TRIANGLES.contains(&hit.geometry) { GeometryKind::Triangle } else { GeometryKind::Quadric };
    Hit { t: hit.t, geometry, primitive, u: hit.u, v: hit.v }
}

impl Accel for EmbreeAccel {
    const NAME: &'static str = "embree";
    const FOOTPRINT: Footprint = Footprint { building: 105, built: 80 };

    fn build(geometry: Arc<Geometry>, options: AccelOptions) -> Result<Self, AccelError> {
        let device = Arc::new(Device::new(options.threads)?);
        let mut transport = SceneBuilder::new(&device)?;
        let cut_outs = if geometry.cut_outs.is_empty() {
            // Each kind of geometry is one more tree that every ray goes through: none is attached empty.
            if !geometry.triangles.is_empty() {
                transport.attach_triangles(&geometry, None, TRIANGLES[0], RayMask::OPAQUE)?;
            }
            if !geometry.quadrics.is_empty() {
                let all = Quadrics { geometry: Arc::clone(&geometry), some: None };
                transport.attach_user(all, QUADRICS[0], RayMask::OPAQUE)?;
            }
            None
        } else {
            Some(CutOuts::build(&device, &geometry, &mut transport)?)
        };
        let transport = transport.commit(RayMask::TRANSPORT, RayMask::OPAQUE)?;
        let delta = if options.delta_points && !geometry.delta_points.is_empty() {
            let mut delta = SceneBuilder::new(&device)?;
            delta.attach_user(DeltaPoints(geometry), 0, RayMask::DELTA)?;
            Some(delta.commit(RayMask::DELTA, RayMask::DELTA)?)
        } else {
            None
        };
        let description = format!("embree {} {}", device.version(), device.isa());
        Ok(Self { transport, cut_outs, delta, description })
    }

    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.transport.intersect(ray)?;
        Some(match &self.cut_outs {
            None => as_hit(&hit, hit.primitive),
            Some(cut_outs) => cut_outs.as_hit(&hit),
        })
    }

    #[inline]
    fn intersect_cut_out(&self, ray: &Ray) -> Option<Hit> {
        let cut_outs = self.cut_outs.as_ref().filter(|cut_outs| cut_outs.may_meet(ray))?;
        Some(cut_outs.as_hit(&cut_outs.scene.intersect(ray)?))
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

//! Intersection by Embree 4: the safe side of `embree4_sys`, which nothing else names.
//!
//! What could be misused cannot be written down: a scene is either under construction or committed
//! ([`scene::SceneBuilder`], [`scene::Scene`]), buffers are kept alive by the scene that reads them, every fallible
//! call is followed by a check of Embree's error code, and no panic crosses Embree's frames.

mod device;
mod scene;
mod slivers;
mod user;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use self::device::Device;
use self::scene::{RawHit, RayMask, Scene, SceneBuilder};
use self::slivers::Slivers;
use self::user::{UserGeometry, UserHit};
use super::{Accel, AccelError, AccelOptions, DeltaHit, Footprint};
use crate::geometry::{Geometry, GeometryKind, Hit, Quadric, is_sliver};
use crate::math::{Ray, Vec3};

/// Embree's number of the triangle geometry, of opaque surfaces and of cut-outs.
const TRIANGLES: [u32; 2] = [0, 2];
/// Embree's number of the quadrics' user geometry, likewise.
const QUADRICS: [u32; 2] = [1, 3];
/// Embree's number of the user geometry of triangles that are too thin for it, likewise.
const SLIVERS: [u32; 2] = [4, 5];

/// By Embree's number of a geometry: what its primitives are called in `Geometry`.
type Numbers = [Vec<u32>; 6];

/// Fewer rays than this are faster one by one. Full packets of eight take from 0.7 (a few dozen triangles) to 1.0
/// (many thousands) of the single queries' time, half-full ones never less; sixteen at once and the hint that rays
/// are coherent were slower everywhere.
const MIN_PACKET: usize = 6;

/// The geometry of a scene in Embree's trees.
///
/// Triangles and quadrics, where there are any, share one scene; each kind has a tree of its own there, and so have slivers,
/// triangles too thin for Embree. Surfaces that are
/// partly opaque have a mask bit that occlusion rays lack, and a scene of their own besides, so that what looks for them
/// alone goes through no other surface's tree. Delta points have another scene and another mask bit, so that transport
/// rays pay nothing for them.
pub struct EmbreeAccel {
    transport: Scene,
    /// Where not all triangles are one geometry, and all quadrics another.
    numbers: Option<Numbers>,
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

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<UserHit> {
        self.at(primitive).intersect(ray).map(UserHit::at)
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

    fn intersect(&self, primitive: u32, ray: &Ray) -> Option<UserHit> {
        self.0.delta_points[primitive as usize].intersect(ray).map(UserHit::at)
    }
}

/// Attaches all surfaces to `transport`: opaque ones and others apart, slivers and other triangles apart. The others go into
/// `own` as well.
fn attach_apart(
    geometry: &Arc<Geometry>,
    slivers: &[u32],
    transport: &mut SceneBuilder,
    own: &mut SceneBuilder,
) -> Result<Numbers, AccelError> {
    let mut numbers: Numbers = Default::default();
    let masks = [RayMask::OPAQUE, RayMask::CUT_OUT];
    for (cut_out, mask) in [false, true].into_iter().zip(masks) {
        let [triangles, quadrics, thin] = [TRIANGLES, QUADRICS, SLIVERS].map(|ids| ids[usize::from(cut_out)]);
        let which = |kind, count: usize| -> Vec<u32> {
            (0..count as u32).filter(|&i| geometry.is_cut_out(kind, i) == cut_out).collect()
        };
        let all = which(GeometryKind::Triangle, geometry.triangles.len());
        // `slivers` are in order.
        let (some_thin, some): (Vec<u32>, Vec<u32>) = all.into_iter().partition(|i| slivers.binary_search(i).is_ok());
        let some_thin = Slivers::new(geometry, &some_thin, slivers);
        let corners = || some.iter().map(|&i| geometry.triangles[i as usize]).collect();
        let some_quadrics = which(GeometryKind::Quadric, geometry.quadrics.len());
        for scene in [Some(&mut *transport), cut_out.then_some(&mut *own)].into_iter().flatten() {
            if !some.is_empty() {
                scene.attach_triangles(geometry, Some(corners()), triangles, mask)?;
            }
            if some_thin.len() > 0 {
                scene.attach_user(some_thin.clone(), thin, mask)?;
            }
            if !some_quadrics.is_empty() {
                let user = Quadrics { geometry: Arc::clone(geometry), some: Some(some_quadrics.clone()) };
                scene.attach_user(user, quadrics, mask)?;
            }
        }
        numbers[triangles as usize] = some;
        numbers[thin as usize] = some_thin.numbers();
        numbers[quadrics as usize] = some_quadrics;
    }
    Ok(numbers)
}

impl CutOuts {
    /// Of the surfaces that are in `own`.
    fn build(own: SceneBuilder, geometry: &Geometry, numbers: &Numbers) -> Result<Self, AccelError> {
        let triangles = [TRIANGLES[1], SLIVERS[1]].into_iter().flat_map(|id| &numbers[id as usize]);
        let corners = triangles.flat_map(|&i| geometry.corners(i));
        let quadrics = &numbers[QUADRICS[1] as usize];
        let boxes = quadrics.iter().flat_map(|&i| <[Vec3; 2]>::from(geometry.quadrics[i as usize].bounds()));
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for p in corners.chain(boxes) {
            (min, max) = (min.min(p), max.max(p));
        }
        let extent = min.abs().max(max.abs()).max_element();
        let scene = own.commit(RayMask::CUT_OUT, RayMask::CUT_OUT)?;
        Ok(Self { scene, bounds: [min, max], extent })
    }

    /// Whether a ray may meet the box around them: false only where it does not.
    #[inline]
    fn may_meet(&self, ray: &Ray) -> bool {
        let [min, max] = self.bounds;
        // Of two coordinates' difference and its product four roundings, 2⁻²² of the larger one; by less than four times as
        // much slivers are met beside their edges (`slivers::GENEROSITY` of the distance to their corners); as much again.
        let margin = Vec3::splat(ray.o.abs().max_element().max(self.extent) * (1.0 / (1 << 19) as f32));
        // Clamped, so that nothing times infinity cannot occur.
        let huge = Vec3::splat(f32::MAX);
        let reciprocal = ray.d.recip().clamp(-huge, huge);
        let (a, b) = ((min - margin - ray.o) * reciprocal, (max + margin - ray.o) * reciprocal);
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        enter <= leave && leave >= 0.0 && enter <= ray.tmax
    }
}

impl EmbreeAccel {
    /// A hit in the terms of `Geometry`.
    #[inline]
    fn as_hit(&self, hit: &RawHit) -> Hit {
        let primitive = match &self.numbers {
            None => hit.primitive,
            Some(numbers) => numbers[hit.geometry as usize][hit.primitive as usize],
        };
        let geometry = if QUADRICS.contains(&hit.geometry) { GeometryKind::Quadric } else { GeometryKind::Triangle };
        Hit { t: hit.t, geometry, primitive, u: hit.u, v: hit.v }
    }
}

impl Accel for EmbreeAccel {
    const NAME: &'static str = "embree";
    const FOOTPRINT: Footprint = Footprint { building: 105, built: 80 };

    fn build(geometry: Arc<Geometry>, options: AccelOptions) -> Result<Self, AccelError> {
        let device = Arc::new(Device::new(options.threads)?);
        let mut transport = SceneBuilder::new(&device)?;
        // Of a vertex that is not there `attach_triangles` tells.
        let there = |i: u32| geometry.triangles[i as usize].iter().all(|&v| (v as usize) < geometry.positions.len());
        let thin = |i: &u32| there(*i) && is_sliver(geometry.corners(*i));
        let candidates = if geometry.slivers { geometry.triangles.len() as u32 } else { 0 };
        let slivers: Vec<u32> = (0..candidates).filter(thin).collect();
        let (numbers, cut_outs) = if geometry.cut_outs.is_empty() && slivers.is_empty() {
            // Each kind of geometry is one more tree that every ray goes through: none is attached empty.
            if !geometry.triangles.is_empty() {
                transport.attach_triangles(&geometry, None, TRIANGLES[0], RayMask::OPAQUE)?;
            }
            if !geometry.quadrics.is_empty() {
                let all = Quadrics { geometry: Arc::clone(&geometry), some: None };
                transport.attach_user(all, QUADRICS[0], RayMask::OPAQUE)?;
            }
            (None, None)
        } else {
            let mut own = SceneBuilder::new(&device)?;
            let numbers = attach_apart(&geometry, &slivers, &mut transport, &mut own)?;
            let any = !geometry.cut_outs.is_empty();
            let cut_outs = if any { Some(CutOuts::build(own, &geometry, &numbers)?) } else { None };
            (Some(numbers), cut_outs)
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
        Ok(Self { transport, numbers, cut_outs, delta, description })
    }

    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        Some(self.as_hit(&self.transport.intersect(ray)?))
    }

    #[inline]
    fn intersect_cut_out(&self, ray: &Ray) -> Option<Hit> {
        let cut_outs = self.cut_outs.as_ref().filter(|cut_outs| cut_outs.may_meet(ray))?;
        Some(self.as_hit(&cut_outs.scene.intersect(ray)?))
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

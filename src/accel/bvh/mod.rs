//! The pure-Rust backend: a four-wide BVH whose rays leak through no shared edge or vertex.
//!
//! `obvhs` builds a binary tree (PLOC and reinsertion, single-threaded and so deterministic); `tree` collapses it to
//! four-wide nodes with boxes of its own and traverses those; `triangle` tests four triangles at a time. obvhs' own
//! traversal is not used: its Möller–Trumbore tests treat a weight of −0 as a miss, its boxes are tested without
//! room for rounding, and its reciprocal directions are clamped at 2²³, so that rays aimed at edges slip out of
//! closed meshes.
//!
//! Everything here is safe Rust on 128-bit vectors.

mod ray;
mod tree;
mod triangle;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::{Accel, AccelError, AccelOptions, DeltaHit, Footprint};
use crate::geometry::{Geometry, GeometryKind, Hit};
use crate::math::{Ray, Vec3};
use ray::PreparedRay;
use tree::{Bounds, Tree};
use triangle::{Shear, TriangleBlock};

/// The pure-Rust acceleration structure.
pub struct BvhAccel {
    geometry: Arc<Geometry>,
    opaque: Surfaces,
    /// Those that are partly opaque, which occlusion leaves out.
    cut_outs: Surfaces,
    /// Leaves are indices into `Geometry::delta_points`; empty unless asked for.
    delta_points: Tree,
}

/// Triangles to a leaf: one block.
const BLOCK: usize = 4;

/// The surfaces that some queries see.
struct Surfaces {
    /// Leaves are indices into `blocks`.
    triangles: Tree,
    blocks: Vec<TriangleBlock>,
    /// Leaves are indices into `Geometry::quadrics`.
    quadrics: Tree,
}

impl Surfaces {
    /// Those of a geometry that are partly opaque, or those that are not. Triangles with a non-finite corner are left out:
    /// nothing can meet them.
    fn build(geometry: &Geometry, cut_outs: bool) -> Result<Self, AccelError> {
        let corner_bounds = |i: u32| {
            let [a, b, c] = geometry.corners(i);
            let is_one = geometry.is_cut_out(GeometryKind::Triangle, i) == cut_outs;
            (is_one && a.is_finite() && b.is_finite() && c.is_finite())
                .then(|| Bounds { min: a.min(b).min(c), max: a.max(b).max(c) })
        };
        let (triangles, leaves) = Tree::build("triangles", geometry.triangles.len(), BLOCK, corner_bounds)?;
        let blocks = leaves.iter().map(|ids| TriangleBlock::new(geometry, ids)).collect();
        let quadric_bounds = |i: u32| {
            let is_one = geometry.is_cut_out(GeometryKind::Quadric, i) == cut_outs;
            is_one.then(|| of_pair(geometry.quadrics[i as usize].bounds())).flatten()
        };
        let (quadrics, _) = Tree::build("quadrics", geometry.quadrics.len(), 1, quadric_bounds)?;
        Ok(Self { triangles, blocks, quadrics })
    }

    /// The nearest hit at a parameter up to `tmax`.
    #[inline]
    fn nearest(&self, geometry: &Geometry, ray: &Ray, prepared: &PreparedRay, tmax: f32) -> Option<Hit> {
        let triangle = self.triangle_hit::<false>(ray, prepared, tmax);
        let tmax = triangle.map_or(tmax, |h| h.t);
        self.quadric_hit::<false>(geometry, ray, prepared, tmax).or(triangle)
    }

    /// Nearest (or, with `ANY`, some) triangle at a parameter up to `tmax`.
    #[inline]
    fn triangle_hit<const ANY: bool>(&self, ray: &Ray, prepared: &PreparedRay, tmax: f32) -> Option<Hit> {
        if self.blocks.is_empty() {
            return None;
        }
        let shear = Shear::new(ray, prepared);
        let mut best = None;
        self.triangles.traverse::<ANY>(prepared, tmax, |leaf, tmax| {
            let block = &self.blocks[leaf as usize];
            let Some(found) = block.intersect(&shear, prepared.tmin, *tmax) else { return false };
            *tmax = found.t;
            best = Some(Hit {
                t: found.t,
                geometry: GeometryKind::Triangle,
                primitive: block.id(found.lane),
                u: found.u,
                v: found.v,
            });
            ANY
        });
        best
    }

    /// Nearest (or, with `ANY`, some) quadric at a parameter up to `tmax`.
    #[inline]
    fn quadric_hit<const ANY: bool>(
        &self,
        geometry: &Geometry,
        ray: &Ray,
        prepared: &PreparedRay,
        tmax: f32,
    ) -> Option<Hit> {
        if self.quadrics.is_empty() {
            return None;
        }
        let mut segment = Ray { tmin: prepared.tmin, tmax, ..*ray };
        let mut best = None;
        self.quadrics.traverse::<ANY>(prepared, tmax, |leaf, tmax| {
            let Some(t) = geometry.quadrics[leaf as usize].intersect(&segment) else { return false };
            // Rounding t to f32 may lead past an infinite end; such a point does not exist.
            if !t.is_finite() {
                return false;
            }
            *tmax = t;
            segment.tmax = t;
            best = Some(Hit { t, geometry: GeometryKind::Quadric, primitive: leaf, u: 0.0, v: 0.0 });
            ANY
        });
        best
    }
}

fn of_pair((min, max): (Vec3, Vec3)) -> Option<Bounds> {
    (min.is_finite() && max.is_finite()).then_some(Bounds { min, max })
}

impl Accel for BvhAccel {
    const NAME: &'static str = "bvh";
    const FOOTPRINT: Footprint = Footprint { building: 390, built: 155 };

    fn build(geometry: Arc<Geometry>, options: AccelOptions) -> Result<Self, AccelError> {
        let opaque = Surfaces::build(&geometry, false)?;
        let cut_outs = Surfaces::build(&geometry, true)?;
        let delta_count = if options.delta_points { geometry.delta_points.len() } else { 0 };
        let (delta_points, _) =
            Tree::build("delta points", delta_count, 1, |i| of_pair(geometry.delta_points[i as usize].bounds()))?;
        Ok(Self { geometry, opaque, cut_outs, delta_points })
    }

    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let prepared = PreparedRay::new(ray)?;
        let opaque = self.opaque.nearest(&self.geometry, ray, &prepared, ray.tmax);
        let tmax = opaque.map_or(ray.tmax, |h| h.t);
        self.cut_outs.nearest(&self.geometry, ray, &prepared, tmax).or(opaque)
    }

    #[inline]
    fn intersect_cut_out(&self, ray: &Ray) -> Option<Hit> {
        self.cut_outs.nearest(&self.geometry, ray, &PreparedRay::new(ray)?, ray.tmax)
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        let Some(prepared) = PreparedRay::new(ray) else { return false };
        self.opaque.triangle_hit::<true>(ray, &prepared, ray.tmax).is_some()
            || self.opaque.quadric_hit::<true>(&self.geometry, ray, &prepared, ray.tmax).is_some()
    }

    fn intersect_delta(&self, ray: &Ray) -> Option<DeltaHit> {
        let prepared = PreparedRay::new(ray)?;
        let segment = Ray { tmin: prepared.tmin, ..*ray };
        let mut best: Option<DeltaHit> = None;
        self.delta_points.traverse::<false>(&prepared, ray.tmax, |leaf, tmax| {
            // Against the whole segment: its ε reaches past a shortened end, and a point beyond would be moved to it.
            if let Some(t) = self.geometry.delta_points[leaf as usize].intersect(&segment) {
                // Of several in one place the first in the file, whatever the order of traversal.
                if best.is_none_or(|b| (t, leaf) < (b.t, b.point)) {
                    *tmax = t;
                    best = Some(DeltaHit { t, point: leaf });
                }
            }
            false
        });
        best
    }

    fn describe(&self) -> String {
        "bvh: four-wide, built by obvhs 0.4, 128-bit vectors".to_owned()
    }
}

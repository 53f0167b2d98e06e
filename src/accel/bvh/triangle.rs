//! Four triangles against one ray, watertight (Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection",
//! Journal of Computer Graphics Techniques 2(1)).
//!
//! The ray is sheared onto the axis of its largest component; every vertex is sheared by the same arithmetic
//! wherever it is used, and the sign of an edge function is the exact one for the sheared vertices: the f32
//! difference of two rounded products has the right sign or is zero, and zeros (and overflows) are redone in f64,
//! where the products are exact. So neighbours agree on every shared edge, and a closed mesh has no gaps.

use glam::{DVec3, Vec4};

use super::ray::PreparedRay;
use crate::geometry::Geometry;
use crate::math::Ray;

/// The shear that takes a ray to the z axis, with the axes permuted so that z is its largest component.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shear {
    /// The axes that serve as x, y and z.
    axes: [usize; 3],
    /// Origin, permuted.
    o: [f32; 3],
    /// Direction, permuted.
    d: DVec3,
    /// `1/d_z`.
    per_dz: f64,
    /// `d_x/d_z` and `d_y/d_z`.
    s: [f32; 2],
}

impl Shear {
    #[inline]
    pub(super) fn new(ray: &Ray, prepared: &PreparedRay) -> Self {
        let (d, o) = (ray.d.to_array(), ray.o.to_array());
        // The paper swaps x and y to keep the winding; both faces count here, so the sign of the area is free.
        let kz = prepared.kz;
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        Self {
            axes: [kx, ky, kz],
            o: [o[kx], o[ky], o[kz]],
            d: DVec3::new(f64::from(d[kx]), f64::from(d[ky]), f64::from(d[kz])),
            per_dz: 1.0 / f64::from(d[kz]),
            s: [d[kx] / d[kz], d[ky] / d[kz]],
        }
    }
}

/// Four triangles, by axis, then corner, then triangle; short blocks repeat their last one.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
pub(super) struct TriangleBlock {
    corners: [[Vec4; 3]; 3],
    ids: [u32; 4],
}

/// Edge functions below this are computed in f64.
const TINY: f32 = 1e-30;

/// A triangle of a block that was hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub(super) t: f32,
    pub(super) u: f32,
    pub(super) v: f32,
    pub(super) lane: usize,
}

impl TriangleBlock {
    /// The block of the given triangles, at least one and at most four of them.
    pub(super) fn new(geometry: &Geometry, ids: &[u32]) -> Self {
        let ids: [u32; 4] = std::array::from_fn(|lane| ids[lane.min(ids.len() - 1)]);
        let lanes = ids.map(|id| geometry.corners(id));
        let corners = std::array::from_fn(|axis| {
            std::array::from_fn(|corner| Vec4::from_array(std::array::from_fn(|lane| lanes[lane][corner][axis])))
        });
        Self { corners, ids }
    }

    /// The index, within the geometry's triangles, of the triangle in a lane.
    #[inline]
    pub(super) fn id(&self, lane: usize) -> u32 {
        self.ids[lane]
    }

    /// The nearest of the four with `tmin ≤ t ≤ tmax`.
    #[inline]
    pub(super) fn intersect(&self, shear: &Shear, tmin: f32, tmax: f32) -> Option<Found> {
        let [kx, ky, kz] = shear.axes;
        let (xs, ys, zs) = (&self.corners[kx], &self.corners[ky], &self.corners[kz]);
        let [ox, oy, oz] = shear.o.map(Vec4::splat);
        let [sx, sy] = shear.s.map(Vec4::splat);
        let (az, bz, cz) = (zs[0] - oz, zs[1] - oz, zs[2] - oz);
        let (ax, bx, cx) = (xs[0] - ox - sx * az, xs[1] - ox - sx * bz, xs[2] - ox - sx * cz);
        let (ay, by, cy) = (ys[0] - oy - sy * az, ys[1] - oy - sy * bz, ys[2] - oy - sy * cz);
        // Twice the areas opposite to the first, second and third corner.
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let det = u + v + w;
        let lowest = u.min(v).min(w);
        let highest = u.max(v).max(w);
        // Zeros, values near the underflow, where products lose their digits, and overflows are redone in f64.
        let certain = u.abs().min(v.abs()).min(w.abs()).cmpgt(Vec4::splat(TINY)) & det.abs().cmplt(Vec4::INFINITY);
        let inside = lowest.cmpge(Vec4::ZERO) | highest.cmple(Vec4::ZERO);
        let (inside, certain) = (inside.bitmask(), certain.bitmask());
        if inside & certain == 0 && certain == 0b1111 {
            return None;
        }

        // Beyond the largest f32 there is no point to report.
        let tmax = tmax.min(f32::MAX);
        let mut best: Option<Found> = None;
        let mut mask = inside & certain;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 3;
            mask &= mask - 1;
            let weights = [u[lane], v[lane], w[lane]].map(f64::from);
            let heights = [az[lane], bz[lane], cz[lane]];
            let end = best.map_or(tmax, |b| b.t);
            best = self.at(shear, lane, weights, heights, tmin, end).or(best);
        }
        if certain != 0b1111 {
            let corners = [[ax, ay], [bx, by], [cx, cy]];
            for lane in (0..4).filter(|lane| certain & (1 << lane) == 0) {
                let end = best.map_or(tmax, |b| b.t);
                let heights = [az[lane], bz[lane], cz[lane]];
                let found = exact_weights(corners.map(|corner| corner.map(|c| f64::from(c[lane]))))
                    .and_then(|weights| self.at(shear, lane, weights, heights, tmin, end));
                best = found.or(best);
            }
        }
        best
    }

    /// The hit in a lane whose edge functions (`weights`, not normalised) have one sign, if `t` is within bounds.
    ///
    /// The paper's `t`, the weighted mean of the corners' heights along the ray, loses its digits, and near zero its
    /// sign, where the corners are far away and the ray grazes: rays would meet the surface they start from. So `t`
    /// is the plane's, in f64, where the differences of f32 coordinates are exact, held between the corners' heights.
    #[inline]
    fn at(
        &self,
        shear: &Shear,
        lane: usize,
        weights: [f64; 3],
        heights: [f32; 3],
        tmin: f32,
        tmax: f32,
    ) -> Option<Found> {
        let [t0, t1, t2] = heights.map(|h| f64::from(h) * shear.per_dz);
        let (first, last) = (t0.min(t1).min(t2), t0.max(t1).max(t2));
        // A little generous, since t is rounded to f32 before it is compared.
        if last < f64::from(tmin) * (1.0 - 1e-6) || first > f64::from(tmax) * (1.0 + 1e-6) {
            return None;
        }
        let [kx, ky, kz] = shear.axes;
        let [ox, oy, oz] = shear.o.map(f64::from);
        let corner = |i: usize| {
            DVec3::new(
                f64::from(self.corners[kx][i][lane]),
                f64::from(self.corners[ky][i][lane]),
                f64::from(self.corners[kz][i][lane]),
            )
        };
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let normal = (b - a).cross(c - a);
        let plane = normal.dot(a - DVec3::new(ox, oy, oz)) / normal.dot(shear.d);
        let [u, v, w] = weights;
        let det = u + v + w;
        // Edge-on: any height between the corners' is as good.
        let t = if plane.is_nan() { (u * t0 + v * t1 + w * t2) / det } else { plane };
        let t = t.max(first).min(last);
        // `+ 0.0` turns −0 into 0.
        let t = t as f32 + 0.0;
        // Seen edge-on as a whole, det = 0: it is not met, its neighbours are. NaN fails, too.
        (det != 0.0 && t >= tmin && t <= tmax).then(|| Found { t, u: (v / det) as f32, v: (w / det) as f32, lane })
    }
}

/// The edge functions of one triangle in f64 from its sheared f32 corners, if they have one sign: the products are
/// exact, so every sign is.
#[cold]
fn exact_weights(corners: [[f64; 2]; 3]) -> Option<[f64; 3]> {
    let [[ax, ay], [bx, by], [cx, cy]] = corners;
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    (u.min(v).min(w) >= 0.0 || u.max(v).max(w) <= 0.0).then_some([u, v, w])
}

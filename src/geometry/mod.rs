//! Shapes as the accelerators and the shading see them: one triangle soup, exact quadrics, delta points.
//!
//! All of it is in *render space*: recentred and scaled by a power of two when the scene was prepared
//! (`scene::prepare`), so that coordinates are of order one whatever the units of the file.

mod delta_point;
mod quadric;
mod surface_point;
mod tangents;

pub use delta_point::DeltaPoint;
pub use quadric::{Quadric, QuadricKind};
pub(crate) use surface_point::exact_normal;
pub use surface_point::{SurfacePoint, SurfaceTag};
pub use tangents::Tangents;

use crate::math::Vec3;

/// The geometry of a whole scene, shared by the accelerator and the shading.
#[derive(Debug, Default)]
pub struct Geometry {
    /// Vertex positions of all meshes, render space.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals, parallel to `positions` or empty when no mesh has any;
    /// zero for the vertices of meshes without.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, parallel to `positions` when `wants_uv`, else empty; zero for the vertices of meshes without.
    pub uvs: Vec<[f32; 2]>,
    /// Whether some texture asks for texture coordinates: surface points then carry them.
    pub wants_uv: bool,
    /// Triangles as indices into `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// The surface (index into the scene's surfaces) of each triangle.
    pub triangle_surface: Vec<u32>,
    /// Whether some triangles are slivers (`is_sliver`), for which more care is taken.
    pub slivers: bool,
    /// Exact spheres and disks.
    pub quadrics: Vec<Quadric>,
    /// The surface of each quadric.
    pub quadric_surface: Vec<u32>,
    /// By surface, whether it is partly opaque; empty when none is. Occlusion leaves these surfaces out.
    pub cut_outs: Vec<bool>,
    /// Points of zero size that lights sit on. No transport query ever meets them.
    pub delta_points: Vec<DeltaPoint>,
}

impl Geometry {
    /// Whether a primitive is of a surface that is partly opaque.
    pub fn is_cut_out(&self, kind: GeometryKind, primitive: u32) -> bool {
        let surfaces = match kind {
            GeometryKind::Triangle => &self.triangle_surface,
            GeometryKind::Quadric => &self.quadric_surface,
        };
        !self.cut_outs.is_empty() && self.cut_outs[surfaces[primitive as usize] as usize]
    }
}

/// Which of the scene's two kinds of intersectable geometry a hit lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryKind {
    /// `Geometry::triangles`.
    Triangle,
    /// `Geometry::quadrics`.
    Quadric,
}

/// Where a ray first meets the scene, as every accelerator reports it: interpolation is shared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter, in lengths of the ray's direction.
    pub t: f32,
    /// The kind of geometry.
    pub geometry: GeometryKind,
    /// Index within that kind.
    pub primitive: u32,
    /// Barycentric weight of the triangle's second vertex; unused (0) for quadrics.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex; unused (0) for quadrics.
    pub v: f32,
}

impl Geometry {
    /// The three corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [Vec3; 3] {
        let [a, b, c] = self.triangles[triangle as usize];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The surface a hit lies on.
    #[inline]
    pub fn surface_of(&self, hit: &Hit) -> u32 {
        match hit.geometry {
            GeometryKind::Triangle => self.triangle_surface[hit.primitive as usize],
            GeometryKind::Quadric => self.quadric_surface[hit.primitive as usize],
        }
    }
}

/// Triangles less high than this, over their longest side, are slivers.
///
/// Measured with Embree 4.3.3, rays from random points of triangles with a corner or the middle at the origin, where the bound
/// on a point's error is least, or anywhere, 8·10⁵ for each height, three in ten of them grazing; how many meet their
/// triangle again that start off it by all of what `SurfacePoint::origin` moves them, by half of it and by a quarter:
///
/// | height | 1 | 1/10 | 1/15 | 1/20 | 1/33 | 1/50 | 1/100 | 1/200 | 1/300 | 1/1000 |
/// |---|---|---|---|---|---|---|---|---|---|---|
/// | all | 0 | 0 | 0 | 0 | 0 | 6 | 124 | 1181 | 3013 | 16217 |
/// | half | 0 | 0 | 0 | 3 | 40 | 226 | 1747 | 6344 | 12267 | 38940 |
/// | a quarter | 0 | 7 | 17 | 90 | 616 | 1773 | 7088 | 19705 | 30253 | 71178 |
///
/// Of 2·10⁶ rays from other such triangles one did so at 1/20 with all of it, none at 1/15; of 6·10⁵, eleven at 1/33. So the
/// first height to fail is 1/20, for one ray in millions, and of what is left to Embree half the offset is enough. More room
/// than these factors, 1.3 in height and 2 in the offset, would make user geometry of every quad ten times as long as wide, at
/// the price that docs/PERFORMANCE.md has.
const THIN: f64 = 1.0 / 15.0;

/// Whether a triangle is so thin that the f32 product of its edges, nearly parallel, gives its plane a tilt that rays notice: by
/// about ε · length/height. Those without an area are met by nothing anyway.
pub fn is_sliver(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (b - a).cross(c - a).length() < THIN * longest
}

/// Area of a triangle, summed in f64 from f64 edge differences.
pub fn triangle_area(corners: [Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    0.5 * (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_thin_is_told() {
        let triangle = |height: f32| [Vec3::ZERO, Vec3::X * 3.0, Vec3::new(1.0, 3.0 * height, 0.0)];
        assert!([0.06, 1e-6, 0.0].into_iter().all(|height| is_sliver(triangle(height))));
        assert!([0.07, 1.0].into_iter().all(|height| !is_sliver(triangle(height))));
    }
}

//! From a hit to the point that is shaded.

use super::{Geometry, GeometryKind, Hit};
use crate::math::{PointWithError, Ray, Vec3, Vec4, gamma, offset_origin};

/// A point on a surface: position with its error bound, geometric and shading normal, surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position, render space, with its error bound.
    pub point: PointWithError,
    /// Unit geometric normal, on the side the surface faces (and emits to).
    pub ng: Vec3,
    /// Unit shading normal, in the hemisphere of `ng`.
    pub ns: Vec3,
    /// Which surface, and where on it.
    pub tag: SurfaceTag,
}

/// Surface, primitive and texture coordinates of a point.
///
/// Four numbers in one register: points are passed on by copying, sixteen bytes at a time, and a copy that spans several
/// narrower stores has to wait for all of them to reach the cache (measured: 8 % of a path tracer's time).
#[derive(Clone, Copy)]
pub struct SurfaceTag(Vec4);

impl std::fmt::Debug for SurfaceTag {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [surface, primitive] = [self.0.x.to_bits(), self.0.y.to_bits()];
        write!(f, "surface {surface}, primitive {primitive}, uv ({}, {})", self.0.z, self.0.w)
    }
}

impl SurfaceTag {
    /// `surface` is an index into the scene's surfaces, `primitive` one within the kind of geometry the point lies on
    /// (`Geometry::triangles`, `Geometry::quadrics`), `uv` texture coordinates: zero in a scene without textures over
    /// them, and on meshes without coordinates.
    #[inline(always)]
    pub fn new(surface: u32, primitive: u32, [u, v]: [f32; 2]) -> Self {
        Self(Vec4::new(f32::from_bits(surface), f32::from_bits(primitive), u, v))
    }
}

impl SurfacePoint {
    /// Index into the scene's surfaces.
    #[inline(always)]
    pub fn surface(&self) -> u32 {
        self.tag.0.x.to_bits()
    }

    /// Index within the kind of geometry it lies on (`Geometry::triangles`, `Geometry::quadrics`).
    #[inline(always)]
    pub fn primitive(&self) -> u32 {
        self.tag.0.y.to_bits()
    }

    /// Texture coordinates; zero in a scene without textures over them, and on meshes without coordinates.
    #[inline(always)]
    pub fn uv(&self) -> [f32; 2] {
        [self.tag.0.z, self.tag.0.w]
    }

    /// The point with other texture coordinates.
    #[inline]
    pub fn with_uv(self, uv: [f32; 2]) -> Self {
        Self { tag: SurfaceTag::new(self.surface(), self.primitive(), uv), ..self }
    }

    /// Position, render space.
    #[inline]
    pub fn p(&self) -> Vec3 {
        self.point.p
    }

    /// Whether `ns` equals `ng`: the adjoint shading-normal factor is then 1.
    #[inline]
    pub fn is_flat(&self) -> bool {
        self.ns == self.ng
    }

    /// Where a ray that leaves this point to the side of `towards` starts.
    #[inline]
    pub fn origin(&self, towards: Vec3) -> Vec3 {
        offset_origin(self.point, self.ng, towards)
    }

    /// Where a segment that starts at `from` and leads to this point ends: just before the surface, as the traversal
    /// sees it from `from`. Its error grows with the segment, which `origin` knows nothing of.
    #[inline]
    pub fn segment_end(&self, from: Vec3) -> Vec3 {
        let back = from - self.point.p;
        let error = self.point.error + back.abs() * gamma(SEGMENT_ROUNDINGS);
        offset_origin(PointWithError { error, ..self.point }, self.ng, back)
    }
}

/// Roundings relative to a segment's length that bound how far from its far end the traversal finds the surface: for the
/// direction `b − a`, for vertices taken relative to the origin and for the distance along the ray. Their worst case adds up
/// to more, and more would let light through sheets close before a lamp, which 16 ulps of their coordinate have to keep out.
///
/// So six is a measurement: of 10⁷ segments each of the lengths ½, 2 and 8 to triangles as high as 1/2 of their longest side,
/// and as many to others of 1/10, three in ten of them grazing, Embree 4.3.3 finds blocked by their own end
///
/// | roundings | 2 | 4 | 6 | 8 | 16 |
/// |---|---|---|---|---|---|
/// | length ½ | 13255 | 39 | 9 | 9 | 9 |
/// | length 2 | 71267 | 180 | 0 | 0 | 0 |
/// | length 8 | 203746 | 511 | 0 | 0 | 0 |
///
/// and the nine, to triangles three times as long, start within the rounding of their plane.
const SEGMENT_ROUNDINGS: u32 = 6;

/// Roundings, relative to the corners, that bound the distance between a point interpolated from barycentrics and the
/// plane the traversal intersects: 7 for the interpolation (Pharr et al. 2023, (6.26)), the rest for the traversal's own
/// edge and plane arithmetic, which works on vertices relative to the ray's origin.
const TRIANGLE_ROUNDINGS: u32 = 16;

/// A quadric's point is computed in f64 and rounded once; the traversal transforms in f64 as well.
const QUADRIC_ROUNDINGS: u32 = 3;

/// A triangle's unit normal, its edges' product in f64: of a thin triangle's, nearly parallel, f32 would leave few digits.
pub(crate) fn exact_normal(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero().as_vec3a()
}

impl Geometry {
    /// The point a ray hit. `flip` of the surface is already in the winding of triangles and the orientation of quadrics.
    #[inline]
    pub fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        match hit.geometry {
            GeometryKind::Triangle => self.triangle_point(hit.primitive, hit.u, hit.v),
            GeometryKind::Quadric => {
                let q = &self.quadrics[hit.primitive as usize];
                let along = ray.o.as_dvec3() + ray.d.as_dvec3() * f64::from(hit.t);
                let (p, n) = q.project(along);
                self.quadric_point(hit.primitive, p.as_vec3a(), n.as_vec3a())
            }
        }
    }

    /// The point of a triangle with barycentric weights `(1−u−v, u, v)`.
    #[inline]
    pub fn triangle_point(&self, triangle: u32, u: f32, v: f32) -> SurfacePoint {
        let [a, b, c] = self.corners(triangle);
        let w = 1.0 - u - v;
        let (pa, pb, pc) = (a * w, b * u, c * v);
        // The traversal's plane test is off by roundings of the vertices relative to the origin: the bound follows the
        // corners, not the point, which may lie near zero while they do not.
        let error = a.abs().max(b.abs()).max(c.abs()) * gamma(TRIANGLE_ROUNDINGS);
        let ng = if self.slivers { exact_normal(a, b, c) } else { (b - a).cross(c - a).normalize_or_zero() };
        let mut ns = ng;
        if !self.normals.is_empty() {
            let [ia, ib, ic] = self.triangles[triangle as usize];
            let n = self.normals[ia as usize] * w + self.normals[ib as usize] * u + self.normals[ic as usize] * v;
            // Zero normals stand for "none given": the geometric normal serves.
            if let Some(n) = n.try_normalize() {
                // The winding decides the side: an interpolated normal on the other one is turned over.
                ns = if n.dot(ng) < 0.0 { -n } else { n };
            }
        }
        let uv = if self.wants_uv { self.triangle_uv(triangle, u, v) } else { [0.0; 2] };
        SurfacePoint {
            point: PointWithError { p: pa + pb + pc, error },
            ng,
            ns,
            tag: SurfaceTag::new(self.triangle_surface[triangle as usize], triangle, uv),
        }
    }

    /// A point of a quadric already projected onto it.
    #[inline]
    pub fn quadric_point(&self, quadric: u32, p: Vec3, n: Vec3) -> SurfacePoint {
        // The offset must also clear the sagitta that f32 origins cut off a small sphere: it is second order.
        let error = (p.abs() + self.quadrics[quadric as usize].to_world.translation.abs().as_vec3a())
            * gamma(QUADRIC_ROUNDINGS);
        let uv = if self.wants_uv { self.quadrics[quadric as usize].uv(p.as_dvec3()) } else { [0.0; 2] };
        SurfacePoint {
            point: PointWithError { p, error },
            ng: n,
            ns: n,
            tag: SurfaceTag::new(self.quadric_surface[quadric as usize], quadric, uv),
        }
    }
}

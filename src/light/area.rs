//! Emitting surfaces.

mod direct;

use std::f64::consts::PI;
use std::ops::Range;

use crate::geometry::{Geometry, Quadric, QuadricKind, SurfacePoint, SurfaceTag, exact_normal, triangle_area};
use crate::math::{DMat3, DVec3, Frame, PointWithError, Rgb, Vec2, Vec3, gamma};
use crate::pdf::{AreaPdf, SolidAnglePdf};
use crate::planted::{Bug, planted};
use crate::sampling::{AliasTable, ONE_MINUS_EPSILON, warp};
use crate::texture::Texture;

use super::{EmissionSample, LightPoint};

/// A surface that emits the same radiance in all directions on its normal's side or on both.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// The shape.
    pub emitter: Emitter,
    /// Emitted radiance, W·m⁻²·sr⁻¹; of a textured light its mean over the surface.
    pub radiance: Rgb,
    /// Radiance by place, where it varies.
    pub texture: Option<Texture>,
    /// Area in render units, summed in f64 (for an ellipsoid: of the ellipsoid).
    pub area: f64,
    /// The surface that shines.
    pub surface: u32,
    /// Whether it shines on both sides.
    pub two_sided: bool,
}

/// What a surface emits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Radiance, W·m⁻²·sr⁻¹.
    pub radiance: Rgb,
    /// Whether on both sides.
    pub two_sided: bool,
}

/// How points on an emitting surface are chosen.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// Two triangles that are one parallelogram: uniform by one bilinear map, which keeps a net a net.
    Parallelogram {
        /// One corner.
        corner: Vec3,
        /// The edges that leave it.
        edges: [Vec3; 2],
        /// Unit normals on the emitting side: of the half along the first edge, and of that along the second. But for the
        /// corners' roundings they are one; of a thin lamp these tilt the halves, and what hits a half sees its own.
        normals: [Vec3; 2],
        /// Texture coordinates of the corner, and their differences along the edges.
        uv: [Vec2; 3],
        /// Unit vectors along the edges and their lengths, where the edges are at right angles.
        rectangle: Option<([DVec3; 2], [f64; 2])>,
        /// The first of the two triangles: an index into `Geometry::triangles`.
        first: u32,
    },
    /// Any triangles: chosen by area, then uniform.
    Triangles {
        /// Indices into `Geometry::triangles`.
        triangles: Range<u32>,
        /// Chooses among them.
        choice: AliasTable,
    },
    /// A sphere or disk under an affine map: uniform on the unit shape.
    Quadric {
        /// Index into `Geometry::quadrics`.
        index: u32,
        /// Centre and radius, render space, of what is a sphere and not an ellipsoid.
        ball: Option<(DVec3, f64)>,
    },
}

impl AreaLight {
    /// A light of these triangles, or `None` when they have no area.
    pub fn from_triangles(
        geometry: &Geometry,
        triangles: Range<u32>,
        emission: Emission,
        surface: u32,
    ) -> Option<Self> {
        let Emission { radiance, two_sided } = emission;
        let areas: Vec<f64> = triangles.clone().map(|t| triangle_area(geometry.corners(t))).collect();
        let area: f64 = areas.iter().sum();
        let emitter = match parallelogram(geometry, triangles.clone()) {
            Some(p) => p,
            None => Emitter::Triangles { choice: AliasTable::new(&areas)?, triangles },
        };
        (area > 0.0).then_some(Self { emitter, radiance, texture: None, area, surface, two_sided })
    }

    /// A light of a quadric, or `None` when it has no area.
    pub fn from_quadric(geometry: &Geometry, index: u32, emission: Emission, surface: u32) -> Option<Self> {
        let Emission { radiance, two_sided } = emission;
        let q = &geometry.quadrics[index as usize];
        let area = match q.kind {
            QuadricKind::Disk => PI * q.area_stretch(DVec3::Z),
            QuadricKind::Sphere => {
                // Mean stretch over a fixed spiral of directions: exact for a sphere, and for an ellipsoid only
                // the choice among lights depends on it.
                let n = 1024;
                let stretch = |i: u32| {
                    let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
                    let (s, c) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
                    let r = (1.0 - z * z).sqrt();
                    q.area_stretch(DVec3::new(r * c, r * s, z))
                };
                4.0 * PI * (0..n).map(stretch).sum::<f64>() / f64::from(n)
            }
        };
        let ball = (q.kind == QuadricKind::Sphere).then(|| sphere(q)).flatten();
        let emitter = Emitter::Quadric { index, ball };
        (area > 0.0).then_some(Self { emitter, radiance, texture: None, area, surface, two_sided })
    }

    /// The same light with a radiance that varies over it.
    pub fn textured(mut self, geometry: &Geometry, texture: Texture) -> Self {
        // The mean, on which the choice among lights depends and nothing else: a lattice of rank 1 over part and point
        // (Roberts' additive recurrence, inverse powers of the plastic number's analogue in three dimensions).
        let (mut sum, n) = (DVec3::ZERO, 4096);
        for i in 0..n {
            let x = |step: f64| (0.5 + step * f64::from(i)).fract();
            let u = [x(0.671_043_606_703_788_8) as f32, x(0.549_700_477_901_970_1) as f32];
            if let Some((at, _)) = self.sample_point(geometry, x(0.819_172_513_396_164_5), u) {
                sum += texture.color(&at).as_dvec3();
            }
        }
        // Light that all of these miss must be found by someone.
        self.radiance = (sum / f64::from(n)).as_vec3a().max(texture.largest() * 1e-3);
        self.texture = Some(texture);
        self
    }

    /// A bound of the radiance of each channel.
    pub fn largest_radiance(&self) -> Rgb {
        self.texture.as_ref().map_or(self.radiance, Texture::largest)
    }

    /// A point on the surface with its density per area. `u_part` chooses among triangles.
    #[inline]
    pub fn sample_point(&self, geometry: &Geometry, u_part: f64, u: [f32; 2]) -> Option<(SurfacePoint, AreaPdf)> {
        match &self.emitter {
            Emitter::Parallelogram { .. } => Some((self.parallelogram_point(u)?, AreaPdf(1.0 / self.area))),
            Emitter::Triangles { triangles, choice } => {
                let (i, _) = choice.sample(u_part);
                let [b, c] = warp::uniform_triangle(u);
                Some((geometry.triangle_point(triangles.start + i as u32, b, c), AreaPdf(1.0 / self.area)))
            }
            Emitter::Quadric { index, .. } => {
                let q = &geometry.quadrics[*index as usize];
                let (local, normal) = match q.kind {
                    QuadricKind::Sphere => {
                        let d = warp::uniform_sphere(u).as_dvec3().normalize();
                        (d, d)
                    }
                    QuadricKind::Disk => {
                        let [x, y] = warp::concentric_disk(u);
                        (DVec3::new(f64::from(x), f64::from(y), 0.0), DVec3::Z)
                    }
                };
                let p = q.to_world.transform_point3(local).as_vec3a();
                let n = q.normal_to_world(normal).as_vec3a();
                Some((geometry.quadric_point(*index, p, n), quadric_pdf(q, normal)))
            }
        }
    }

    /// The point of a parallelogram at the fractions `u` of its edges; `None` of another shape.
    #[inline(always)]
    pub(super) fn parallelogram_point(&self, u: [f32; 2]) -> Option<SurfacePoint> {
        let Emitter::Parallelogram { corner, edges, normals, uv, first, .. } = &self.emitter else { return None };
        let (a, b) = (edges[0] * u[0], edges[1] * u[1]);
        // As for triangles, the bound follows the corners, not the point.
        let error = (corner.abs() + edges[0].abs() + edges[1].abs()) * gamma(16);
        let point = PointWithError { p: *corner + a + b, error };
        let uv = (uv[0] + uv[1] * u[0] + uv[2] * u[1]).to_array();
        let normal = normals[usize::from(u[0] < u[1])];
        Some(SurfacePoint { point, ng: normal, ns: normal, tag: SurfaceTag::new(self.surface, *first, uv) })
    }

    /// Density with which `sample_point` chooses the point `p` of this light.
    #[inline]
    pub fn pdf_point(&self, geometry: &Geometry, p: Vec3) -> AreaPdf {
        match &self.emitter {
            Emitter::Parallelogram { .. } | Emitter::Triangles { .. } => AreaPdf(1.0 / self.area),
            Emitter::Quadric { index, .. } => {
                let q = &geometry.quadrics[*index as usize];
                let normal = match q.kind {
                    QuadricKind::Sphere => q.to_local.transform_point3(p.as_dvec3()).normalize_or(DVec3::Z),
                    QuadricKind::Disk => DVec3::Z,
                };
                quadric_pdf(q, normal)
            }
        }
    }

    /// Starts a light subpath: a point by area, a direction by cosine.
    #[inline]
    pub fn sample_emission(
        &self,
        geometry: &Geometry,
        u_part: f64,
        u_point: [f32; 2],
        u_dir: [f32; 2],
    ) -> Option<EmissionSample> {
        let (mut at, pdf_position) = self.sample_point(geometry, u_part, u_point)?;
        if planted(Bug::FixedLightNormal) {
            (at.ng, at.ns) = (Vec3::NEG_Y, Vec3::NEG_Y);
        }
        let mut u_dir = u_dir;
        let mut side = 1.0;
        if self.two_sided {
            // The first half of the numbers are the front's; what is left of them is uniform again.
            let back = u_dir[0] >= 0.5;
            side = if back { -1.0 } else { 1.0 };
            u_dir[0] = (2.0 * u_dir[0] - f32::from(u8::from(back))).min(ONE_MINUS_EPSILON);
        }
        let local = warp::cosine_hemisphere(u_dir);
        if local.z <= 0.0 {
            return None;
        }
        let w = Frame::from_normal(at.ng * side).to_world(local);
        let le = self.emitted(&at, w);
        if self.texture.is_some() && le == Rgb::ZERO {
            return None;
        }
        Some(EmissionSample {
            point: LightPoint::Surface(at),
            origin: at.origin(w),
            w,
            le,
            pdf_position: pdf_position.into(),
            pdf_direction: self.pdf_direction(&at, w).into(),
        })
    }

    /// Radiance that leaves `at` along the unit vector `w`.
    #[inline]
    pub fn emitted(&self, at: &SurfacePoint, w: Vec3) -> Rgb {
        match &self.texture {
            _ if !self.two_sided && w.dot(at.ng) <= 0.0 && !planted(Bug::EmissionOnBothSides) => Rgb::ZERO,
            None => self.radiance,
            Some(texture) => texture.color(at),
        }
    }

    /// Density of the direction of `sample_emission`: `cosθ/π` on the emitting side, half of it on each of two.
    #[inline]
    pub fn pdf_direction(&self, at: &SurfacePoint, w: Vec3) -> SolidAnglePdf {
        let cos = if planted(Bug::UniformEmission) { 0.5 } else { w.dot(at.ng) };
        SolidAnglePdf(warp::cosine_hemisphere_pdf(if self.two_sided { 0.5 * cos.abs() } else { cos }))
    }

    /// Emitted power per channel, π L A per side.
    pub(super) fn power(&self) -> Rgb {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        self.radiance * (sides * PI * self.area) as f32
    }
}

/// Density per area of a point that is uniform on the unit shape.
#[inline]
fn quadric_pdf(q: &Quadric, local_normal: DVec3) -> AreaPdf {
    let unit_area = match q.kind {
        QuadricKind::Sphere => 4.0 * PI,
        QuadricKind::Disk => PI,
    };
    AreaPdf(1.0 / (unit_area * q.area_stretch(local_normal)))
}

/// Recognises two triangles `abc`, `acd` (or, turned over, `acb`, `adc`) that form a parallelogram.
fn parallelogram(geometry: &Geometry, triangles: Range<u32>) -> Option<Emitter> {
    if triangles.len() != 2 {
        return None;
    }
    let (first, second) = (triangles.start, triangles.start + 1);
    let ([a, p, q], [a2, r, s]) = (geometry.corners(first), geometry.corners(second));
    // The diagonal's end is the corner, besides the first, that both share.
    let (b, c, d, uv) = if a == a2 && q == r {
        (p, q, s, affine_uv(geometry, [(first, [0, 1, 2]), (second, [0, 2, 1])])?)
    } else if a == a2 && p == s {
        (r, p, q, affine_uv(geometry, [(second, [0, 1, 2]), (first, [0, 2, 1])])?)
    } else {
        return None;
    };
    // Corners are rounded to f32: equal edges are equal up to that.
    let scale = a.abs().max(b.abs()).max(c.abs()).max(d.abs()).max_element();
    let gap = ((b - a) - (c - d)).abs().max_element();
    let edges = [b - a, d - a];
    // Those of hits, which may be f32's where no triangle of the scene is thin: there the difference is a rounding or two.
    let normals = [exact_normal(a, b, c), exact_normal(a, c, d)];
    // The gap must be small against the edges too, or a sliver's density would not be uniform.
    let small = edges[0].length().min(edges[1].length());
    (gap <= 4.0 * f32::EPSILON * scale && gap <= 1e-4 * small).then_some(Emitter::Parallelogram {
        corner: a,
        edges,
        normals,
        uv,
        rectangle: rectangle(edges),
        first,
    })
}

/// Unit vectors along the edges, and their lengths, if the edges are at right angles but for the rounding of corners.
fn rectangle(edges: [Vec3; 2]) -> Option<([DVec3; 2], [f64; 2])> {
    let edges = edges.map(|e| e.as_dvec3());
    let size = edges.map(DVec3::length);
    let [x, y] = [edges[0] / size[0], edges[1] / size[1]];
    // A skew of δ moves samples by δ of an edge: far below what any test of the density sees.
    (x.dot(y).abs() <= 1e-5).then(|| ([x, (y - x * x.dot(y)).normalize()], size))
}

/// Centre and radius of a quadric that is a sphere but for rounding.
fn sphere(q: &Quadric) -> Option<(DVec3, f64)> {
    let m = q.to_world.matrix3;
    let radius = m.determinant().abs().cbrt();
    let gram = m.transpose() * m * (1.0 / (radius * radius)) - DMat3::IDENTITY;
    let skew = [gram.x_axis, gram.y_axis, gram.z_axis].iter().fold(0.0_f64, |m, c| m.max(c.abs().max_element()));
    (skew <= 1e-9).then_some((q.to_world.translation, radius))
}

/// Texture coordinates over a parallelogram: at its corner, and their differences along its edges. Each half is a
/// triangle with the places among its vertices of the corner, of the edge's end that is its own, and of the diagonal's
/// end. `None` when the halves do not continue each other.
fn affine_uv(geometry: &Geometry, halves: [(u32, [usize; 3]); 2]) -> Option<[Vec2; 3]> {
    if !geometry.wants_uv {
        return Some([Vec2::ZERO; 3]);
    }
    let [[a, b, c], [a2, d, c2]] = halves.map(|(triangle, places)| {
        let vertices = geometry.triangles[triangle as usize];
        places.map(|i| Vec2::from_array(geometry.uvs[vertices[i] as usize]))
    });
    let gap = (a - a2).abs().max((c - c2).abs()).max((b - a - (c - d)).abs()).max_element();
    let size = a.abs().max(b.abs()).max(c.abs()).max(d.abs()).max_element();
    (gap <= 4.0 * f32::EPSILON * size).then_some([a, b - a, d - a])
}

//! Texture coordinates and the tangents that belong to them.

use super::{Geometry, GeometryKind, Hit, SurfacePoint};
use crate::math::Vec3;

/// How a surface runs on as its texture coordinates do, render units per unit of u and v.
#[derive(Clone, Copy, Debug)]
pub struct Tangents {
    /// ∂p/∂u.
    pub du: Vec3,
    /// ∂p/∂v.
    pub dv: Vec3,
}

impl Geometry {
    /// Texture coordinates at barycentric weights `u` and `v` of a triangle's second and third vertex. The scene must want
    /// them (`wants_uv`).
    pub fn triangle_uv(&self, triangle: u32, u: f32, v: f32) -> [f32; 2] {
        let [a, b, c] = self.triangles[triangle as usize].map(|i| self.uvs[i as usize]);
        let w = 1.0 - u - v;
        [0, 1].map(|i| a[i] * w + b[i] * u + c[i] * v)
    }

    /// The tangents at a hit; `None` where texture coordinates do not tell any: a mesh without them or with a triangle that
    /// is one line in them, a sphere's pole.
    pub fn tangents(&self, hit: &Hit, at: &SurfacePoint) -> Option<Tangents> {
        match hit.geometry {
            GeometryKind::Triangle => self.triangle_tangents(hit.primitive),
            GeometryKind::Quadric => {
                let [du, dv] = self.quadrics[hit.primitive as usize].tangents(at.p().as_dvec3())?;
                Some(Tangents { du: du.as_vec3a(), dv: dv.as_vec3a() })
            }
        }
    }

    /// The solution of e₁ = Δu₁ ∂p/∂u + Δv₁ ∂p/∂v and e₂ = Δu₂ ∂p/∂u + Δv₂ ∂p/∂v for the edges of a triangle.
    fn triangle_tangents(&self, triangle: u32) -> Option<Tangents> {
        if !self.wants_uv {
            return None;
        }
        let [a, b, c] = self.corners(triangle).map(|p| p.as_dvec3());
        let [ta, tb, tc] = self.triangles[triangle as usize].map(|i| self.uvs[i as usize].map(f64::from));
        let (e1, e2) = (b - a, c - a);
        let [u1, v1] = [tb[0] - ta[0], tb[1] - ta[1]];
        let [u2, v2] = [tc[0] - ta[0], tc[1] - ta[1]];
        let determinant = u1 * v2 - u2 * v1;
        let du = (e1 * v2 - e2 * v1) / determinant;
        let dv = (e2 * u1 - e1 * u2) / determinant;
        let (du, dv) = (du.as_vec3a(), dv.as_vec3a());
        // Division by a determinant of zero shows here, too.
        let usable = du.is_finite() && dv.is_finite() && du.cross(dv).try_normalize().is_some();
        usable.then_some(Tangents { du, dv })
    }
}

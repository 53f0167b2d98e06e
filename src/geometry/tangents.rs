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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Quadric, QuadricKind};
    use crate::math::{DAffine3, DVec3, Ray};

    fn quadric(kind: QuadricKind) -> Geometry {
        let map = DAffine3::from_translation(DVec3::new(0.1, -0.2, 0.3))
            * DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7)
            * DAffine3::from_scale(DVec3::new(0.5, 0.8, 0.6));
        Geometry {
            quadrics: vec![Quadric::new(kind, map, false)],
            quadric_surface: vec![0],
            wants_uv: true,
            ..Geometry::default()
        }
    }

    fn on(geometry: &Geometry, local: DVec3) -> SurfacePoint {
        let q = &geometry.quadrics[0];
        let (p, n) = q.project(q.to_world.transform_point3(local));
        geometry.quadric_point(0, p.as_vec3a(), n.as_vec3a())
    }

    #[test]
    fn spheres_and_disks_have_the_coordinates_the_format_says() {
        let sphere = quadric(QuadricKind::Sphere);
        let half = std::f64::consts::FRAC_1_SQRT_2;
        for (local, uv) in [
            (DVec3::X, [0.0, 0.5]),
            (DVec3::Y, [0.25, 0.5]),
            (-DVec3::X, [0.5, 0.5]),
            (-DVec3::Y, [0.75, 0.5]),
            (DVec3::Z, [0.0, 1.0]),
            (-DVec3::Z, [0.0, 0.0]),
            (DVec3::new(0.0, half, half), [0.25, 0.75]),
            (DVec3::new(half, -half, 0.0), [0.875, 0.5]),
        ] {
            let found = on(&sphere, local).uv();
            // At the poles u is any, and just below the seam it is 1.
            let du =
                if local.z.abs() == 1.0 { 0.0 } else { (found[0] - uv[0]).abs().min(1.0 - (found[0] - uv[0]).abs()) };
            assert!(du < 1e-6 && (found[1] - uv[1]).abs() < 1e-6, "{local}: {found:?}, not {uv:?}");
        }
        let disk = quadric(QuadricKind::Disk);
        for (local, uv) in [(DVec3::ZERO, [0.5, 0.5]), (DVec3::X, [1.0, 0.5]), (DVec3::new(-0.6, 0.8, 0.0), [0.2, 0.9])]
        {
            let found = on(&disk, local).uv();
            assert!((found[0] - uv[0]).abs().max((found[1] - uv[1]).abs()) < 1e-6, "{local}: {found:?}");
        }
    }

    /// p + ∂p/∂u Δu + ∂p/∂v Δv is where the coordinates are u + Δu, v + Δv.
    fn check(geometry: &Geometry, hit: &Hit, at: &SurfacePoint, uv_near: impl Fn(Vec3) -> [f32; 2]) {
        let t = geometry.tangents(hit, at).expect("has tangents");
        for (step, direction) in [([1e-2, 0.0], t.du), ([0.0, 1e-2], t.dv)] {
            let moved = [1.0_f32, -1.0].map(|side| uv_near(at.p() + direction * (side * 1e-2)));
            for i in 0..2 {
                let by = 0.5 * (moved[0][i] - moved[1][i]);
                assert!((by - step[i]).abs() < 2e-4, "{at:?}: {by} for {step:?}");
            }
        }
    }

    #[test]
    fn tangents_are_the_derivatives_of_the_coordinates() {
        for (kind, local) in [
            (QuadricKind::Sphere, DVec3::new(-0.48, 0.6, 0.64)),
            (QuadricKind::Sphere, DVec3::new(0.8, 0.0, -0.6)),
            (QuadricKind::Disk, DVec3::new(0.3, -0.4, 0.0)),
        ] {
            let geometry = quadric(kind);
            let at = on(&geometry, local);
            let hit = Hit { t: 1.0, geometry: GeometryKind::Quadric, primitive: 0, u: 0.0, v: 0.0 };
            let unwrap = |p: Vec3| {
                let [u, v] = geometry.quadrics[0].uv(p.as_dvec3());
                // Across the seam.
                [if u - at.uv()[0] > 0.5 { u - 1.0 } else { u }, v]
            };
            check(&geometry, &hit, &at, unwrap);
        }
        let pole = quadric(QuadricKind::Sphere);
        let hit = Hit { t: 1.0, geometry: GeometryKind::Quadric, primitive: 0, u: 0.0, v: 0.0 };
        assert!(pole.tangents(&hit, &on(&pole, DVec3::Z)).is_none());
    }

    #[test]
    fn triangles_interpolate_the_coordinates_of_their_vertices() {
        let (a, b, c) = (Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.9, -0.1, 0.2), Vec3::new(0.3, 0.8, -0.4));
        let mut geometry = Geometry {
            positions: vec![a, b, c],
            uvs: vec![[0.2, 0.1], [0.9, 0.3], [0.1, 1.4]],
            wants_uv: true,
            triangles: vec![[0, 1, 2]],
            triangle_surface: vec![0],
            ..Geometry::default()
        };
        let hit = Hit { t: 1.0, geometry: GeometryKind::Triangle, primitive: 0, u: 0.25, v: 0.5 };
        let at = geometry.surface_point(&Ray::new(Vec3::ZERO, Vec3::Z), &hit);
        let wanted = [0.25 * 0.2 + 0.25 * 0.9 + 0.5 * 0.1, 0.25 * 0.1 + 0.25 * 0.3 + 0.5 * 1.4];
        assert!((at.uv()[0] - wanted[0]).abs() < 1e-6 && (at.uv()[1] - wanted[1]).abs() < 1e-6, "{:?}", at.uv());
        // Barycentric coordinates of a point of the plane by areas.
        let n = (b - a).cross(c - a);
        let uv = |p: Vec3| {
            let (u, v) = ((p - a).cross(c - a).dot(n) / n.dot(n), (b - a).cross(p - a).dot(n) / n.dot(n));
            geometry.triangle_uv(0, u, v)
        };
        check(&geometry, &hit, &at, uv);
        // One line in its coordinates: there is no telling.
        geometry.uvs = vec![[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]];
        assert!(geometry.tangents(&hit, &at).is_none());
        geometry.wants_uv = false;
        assert!(geometry.tangents(&hit, &at).is_none());
    }
}

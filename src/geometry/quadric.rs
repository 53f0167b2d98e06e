//! Exact spheres and disks under any affine map, intersected in f64.

use std::f64::consts::{FRAC_1_PI, PI};

use crate::math::{DAffine3, DVec3, Ray, Vec3};

/// The unit shape a quadric is the affine image of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuadricKind {
    /// The unit sphere.
    Sphere,
    /// The unit disk in the plane z = 0, normal +z.
    Disk,
}

/// The affine image of a unit sphere or unit disk.
#[derive(Clone, Copy, Debug)]
pub struct Quadric {
    /// The unit shape.
    pub kind: QuadricKind,
    /// From the unit shape's space to render space.
    pub to_world: DAffine3,
    /// From render space to the unit shape's space.
    pub to_local: DAffine3,
    /// −1 when the surface's normal is turned (by the file or by a mirroring map), else +1.
    pub orientation: f64,
}

impl Quadric {
    /// The image of the unit shape under `to_world`, which must be invertible.
    ///
    /// The normal points as the outward (sphere) or +z (disk) normal does under the map's inverse transpose;
    /// `flip` turns it.
    pub fn new(kind: QuadricKind, to_world: DAffine3, flip: bool) -> Self {
        Self { kind, to_world, to_local: to_world.inverse(), orientation: if flip { -1.0 } else { 1.0 } }
    }

    /// Lower and upper corner of an enclosing box, rounded outwards.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let m = self.to_world.matrix3;
        let center = self.to_world.translation;
        let row = |i: usize| match self.kind {
            QuadricKind::Sphere => m.row(i).length(),
            QuadricKind::Disk => m.row(i).truncate().length(),
        };
        let half = DVec3::new(row(0), row(1), row(2));
        // A relative 1e-6 covers the f64 → f32 conversion of both ends with room to spare.
        let pad = (center.abs() + half) * 1e-6;
        let (lo, hi) = (center - half - pad, center + half + pad);
        (lo.as_vec3a(), hi.as_vec3a())
    }

    /// The smallest ray parameter in `[tmin, tmax]` at which the ray meets the surface.
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let o = self.to_local.transform_point3(ray.o.as_dvec3());
        let d = self.to_local.transform_vector3(ray.d.as_dvec3());
        let (tmin, tmax) = (f64::from(ray.tmin), f64::from(ray.tmax));
        let inside = |t: f64| (t >= tmin && t <= tmax).then_some(t as f32);
        match self.kind {
            QuadricKind::Disk => {
                if d.z == 0.0 {
                    return None;
                }
                let t = -o.z / d.z;
                let p = o + d * t;
                (p.x * p.x + p.y * p.y <= 1.0).then(|| inside(t)).flatten()
            }
            QuadricKind::Sphere => {
                // The discriminant from the point of closest approach, so that a far origin does not cancel it
                // (Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems).
                let a = d.length_squared();
                if a == 0.0 {
                    return None;
                }
                let b = -o.dot(d);
                let closest = o + d * (b / a);
                let discriminant = a * (1.0 - closest.length_squared());
                if discriminant < 0.0 {
                    return None;
                }
                let q = b + discriminant.sqrt().copysign(b);
                let c = (o.length() - 1.0) * (o.length() + 1.0);
                let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
                let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
                inside(near).or_else(|| inside(far))
            }
        }
    }

    /// The surface point nearest to `p` (which lies on the surface but for rounding) and the unit normal there.
    pub fn project(&self, p: DVec3) -> (DVec3, DVec3) {
        let local = self.to_local.transform_point3(p);
        let (on, normal) = match self.kind {
            QuadricKind::Sphere => {
                let unit = local.normalize_or(DVec3::Z);
                (unit, unit)
            }
            QuadricKind::Disk => (DVec3::new(local.x, local.y, 0.0), DVec3::Z),
        };
        (self.to_world.transform_point3(on), self.normal_to_world(normal))
    }

    /// A normal of the unit shape, mapped by the inverse transpose, oriented and normalised.
    pub fn normal_to_world(&self, local_normal: DVec3) -> DVec3 {
        (self.to_local.matrix3.transpose() * local_normal).normalize() * self.orientation
    }

    /// Texture coordinates of a point of the surface. On the sphere u runs about z from +x, v from 0 at −z to 1 at +z; the
    /// disk is the inscribed circle of the unit square, u along x, v along y.
    pub fn uv(&self, p: DVec3) -> [f32; 2] {
        let local = self.to_local.transform_point3(p);
        match self.kind {
            QuadricKind::Sphere => {
                let unit = local.normalize_or(DVec3::Z);
                let turn = unit.y.atan2(unit.x) * (0.5 * FRAC_1_PI);
                // From the nearer pole's distance: acos loses half the digits there.
                let polar = f64::hypot(unit.x, unit.y).atan2(unit.z) * FRAC_1_PI;
                [(if turn < 0.0 { turn + 1.0 } else { turn }) as f32, (1.0 - polar) as f32]
            }
            QuadricKind::Disk => [(0.5 * (local.x + 1.0)) as f32, (0.5 * (local.y + 1.0)) as f32],
        }
    }

    /// ∂p/∂u and ∂p/∂v of `uv` at a point of the surface, render space; `None` at a sphere's poles.
    pub fn tangents(&self, p: DVec3) -> Option<[DVec3; 2]> {
        let local = self.to_local.transform_point3(p);
        let [du, dv] = match self.kind {
            QuadricKind::Sphere => {
                let n = local.normalize_or(DVec3::Z);
                let rho = f64::hypot(n.x, n.y);
                if rho < 1e-6 {
                    return None;
                }
                let to_north = DVec3::new(-n.z * n.x / rho, -n.z * n.y / rho, rho);
                [DVec3::new(-n.y, n.x, 0.0) * (2.0 * PI), to_north * PI]
            }
            QuadricKind::Disk => [DVec3::X * 2.0, DVec3::Y * 2.0],
        };
        Some([self.to_world.transform_vector3(du), self.to_world.transform_vector3(dv)])
    }

    /// By how much the map stretches a surface element at the unit shape's point with this normal:
    /// `|det M| · |M⁻ᵀ n|`, render-space area per unit-shape area.
    pub fn area_stretch(&self, local_normal: DVec3) -> f64 {
        let m = self.to_world.matrix3;
        m.determinant().abs() * (self.to_local.matrix3.transpose() * local_normal).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(radius: f64, center: DVec3) -> Quadric {
        let m = DAffine3::from_translation(center) * DAffine3::from_scale(DVec3::splat(radius));
        Quadric::new(QuadricKind::Sphere, m, false)
    }

    #[test]
    fn a_ray_from_afar_meets_a_small_sphere_at_its_front() {
        let s = sphere(1e-3, DVec3::new(0.0, 0.0, -100.0));
        let t = s.intersect(&Ray::new(Vec3::ZERO, -Vec3::Z)).expect("aimed at the centre");
        assert!((f64::from(t) - 99.999).abs() < 1e-5);
    }

    #[test]
    fn from_inside_the_far_side_is_met() {
        let s = sphere(2.0, DVec3::ZERO);
        let t = s.intersect(&Ray::new(Vec3::ZERO, Vec3::X)).expect("inside");
        assert!((t - 2.0).abs() < 1e-6);
        assert!(s.intersect(&Ray { tmax: 1.9, ..Ray::new(Vec3::ZERO, Vec3::X) }).is_none());
    }

    #[test]
    fn an_ellipsoids_stretch_integrates_to_its_area() {
        // Prolate spheroid, semi-axes 1, 1, 2: A = 2π(1 + c/e·asin e), e² = 1 − 1/c².
        let m = DAffine3::from_scale(DVec3::new(1.0, 1.0, 2.0));
        let q = Quadric::new(QuadricKind::Sphere, m, false);
        let n = 200_000;
        let area: f64 = (0..n)
            .map(|i| {
                let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
                q.area_stretch(DVec3::new((1.0 - z * z).sqrt(), 0.0, z))
            })
            .sum::<f64>()
            * 4.0
            * std::f64::consts::PI
            / f64::from(n);
        let e = (1.0_f64 - 0.25).sqrt();
        let want = 2.0 * std::f64::consts::PI * (1.0 + 2.0 / e * e.asin());
        assert!((area / want - 1.0).abs() < 1e-8, "{area} {want}");
    }
}

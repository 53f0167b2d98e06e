//! How fast densities change with directions: what the rounding of a direction does to them.

use super::{Bsdf, Distribution, Reflectance, Roughness, Shape};
use crate::geometry::SurfacePoint;
use crate::math::Vec3;

impl Bsdf {
    /// About how fast the densities between two directions from `at` change as `turned` turns, per radian and relatively; 0 of
    /// delta lobes, and of what changes by the geometric cosine alone. Of a mixture it is that of its steepest part.
    pub fn steepness(&self, at: &SurfacePoint, turned: Vec3, other: Vec3) -> f64 {
        // Where the shading normal is another, its cosine is.
        let by_cosine = if at.is_flat() { 0.0 } else { 1.0 / f64::from(at.ns.dot(turned).abs()) };
        let lobe = match self {
            Self::Conductor(b) => {
                let facets = reflected(b.distribution, &b.roughness, at.ns, turned, other);
                match b.reflectance {
                    Reflectance::Schlick(normal) => facets + schlick(normal, turned, other),
                    Reflectance::Index { .. } | Reflectance::Constant(_) => facets,
                }
            }
            Self::RoughDielectric(b) => {
                let [side, beyond] = [turned, other].map(|w| w.dot(at.ns));
                if side * beyond > 0.0 {
                    // Near index 1 Fresnel's reflectance is the square of a small difference of numbers near 1, whose
                    // roundings count by 1/|η − 1|.
                    let bend = f64::from(b.ior.max(1.0 / b.ior)) - 1.0;
                    reflected(Distribution::Ggx, &b.roughness, at.ns, turned, other) + 2.0 / bend
                } else {
                    refracted(&b.roughness, if side > 0.0 { b.ior } else { 1.0 / b.ior }, at.ns, turned, other)
                }
            }
            Self::Plastic(b) if !b.is_smooth() => {
                reflected(Distribution::Ggx, &Roughness::new([b.alpha(); 2]), at.ns, turned, other)
            }
            Self::Empirical(b) => match b.shape {
                Shape::OrenNayar { .. } => 0.0,
                // cosⁿ of the angle θ to the mirror direction, which turns as either does: n tanθ.
                Shape::Phong { exponent } => {
                    let mirror = at.ns * (2.0 * at.ns.dot(other)) - other;
                    power(exponent, mirror, turned)
                }
                Shape::BlinnPhong { exponent } => {
                    let half = turned + other;
                    power(exponent, at.ns, half) / f64::from(half.length()) + 1.0 / f64::from(half.length())
                }
            },
            _ => 0.0,
        };
        by_cosine + lobe
    }
}

/// The tangent of the angle between two directions, of any length.
fn tangent(a: Vec3, b: Vec3) -> f64 {
    let (a, b) = (a.as_dvec3(), b.as_dvec3());
    a.cross(b).length() / a.dot(b).abs()
}

/// The slope of ln cosⁿ, n tanθ; at the least that of a quarter of the lobe's width √(1/n), where rounding may lead.
fn power(exponent: f32, axis: Vec3, w: Vec3) -> f64 {
    let n = f64::from(exponent);
    // Of exponent 0 it is none; `max` passes over the 0 · ∞ at a right angle.
    (n * tangent(axis, w)).max(0.25 * n.sqrt())
}

/// The slope of ln D at a half vector of any length, per radian that it turns; at the least that of a quarter of the lobe's
/// width off its middle, where rounding may lead.
fn facets(distribution: Distribution, roughness: &Roughness, ns: Vec3, half: Vec3) -> f64 {
    let [narrow, wide] = {
        let [a, b] = roughness.alpha.map(f64::from);
        [a.min(b), a.max(b)]
    };
    let t = tangent(ns, half).max(0.25 * narrow);
    match distribution {
        // 4e/(1 + e²) per change of e = |(x/αx, y/αy)|, which is at least t over the wide one; at most 2 of it.
        Distribution::Ggx => {
            let e = (t / wide).max(if wide > narrow { 1.0_f64.min(t / narrow) } else { 0.0 });
            4.0 * e / (1.0 + e * e) / narrow
        }
        // The gradient of e².
        Distribution::Beckmann => 2.0 * t * (1.0 + t * t) / (narrow * narrow),
    }
}

/// The slope of ln F by Schlick, F = r + (1 − r)u⁵ with u = 1 − cosθ, as the facet turns, and the roundings of u itself: where
/// nothing is reflected at normal incidence they are all there is.
fn schlick(normal: [f32; 3], turned: Vec3, other: Vec3) -> f64 {
    let (w, half) = (turned.as_dvec3(), (turned + other).as_dvec3().normalize_or_zero());
    let (u, sine) = (0.5 * (half - w.normalize()).length_squared(), half.cross(w).length());
    let r = f64::from(normal[0].min(normal[1]).min(normal[2]));
    let rest = (1.0 - r) * u.powi(4);
    let slope = 5.0 * rest * (sine + 1.0) / (r + rest * u);
    // At normal incidence itself nothing is reflected, and nothing judged.
    if slope.is_finite() { slope } else { 0.0 }
}

/// Facets that reflect: the half vector turns by at most 1/|h|, and the Jacobian 1/(4 cos) has half its length.
fn reflected(distribution: Distribution, roughness: &Roughness, ns: Vec3, turned: Vec3, other: Vec3) -> f64 {
    let half = turned + other;
    (facets(distribution, roughness, ns, half) + 1.0) / f64::from(half.length())
}

/// Facets that refract [Walter07 (16)]: `eta` is the index on the side of `other` over that of `turned`. The half vector turns by 1/|h|, with both of its cosines, and
/// its square is in the Jacobian. Near index 1 it is short: 1/|η − 1| of a turn is what it turns.
fn refracted(roughness: &Roughness, eta: f32, ns: Vec3, turned: Vec3, other: Vec3) -> f64 {
    let half = turned + other * eta;
    let length = f64::from(half.length());
    let cosine = |w: Vec3| f64::from(half.dot(w).abs()) / length;
    (facets(Distribution::Ggx, roughness, ns, half) + 1.0 / cosine(turned) + 1.0 / cosine(other) + 2.0) / length
}

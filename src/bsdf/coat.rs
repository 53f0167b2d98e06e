//! What a dielectric coat reflects in all: the number that a plastic's base has to leave to it.

use std::sync::OnceLock;

use super::fresnel::{fresnel_dielectric, hemispherical_dielectric};
use super::local::mirror;
use super::microfacet::{Distribution, Masking, SMOOTH, reflection};
use crate::math::Vec3;

/// Intervals of the roughness, in √α up to 1.
const ROUGH_STEPS: usize = 20;
/// Intervals of the direction, in √cosθ.
const COS_STEPS: usize = 40;
/// Points along each side of the unit square that an albedo is averaged over.
const POINTS: u32 = 24;

/// Directional albedos of a rough coat of one index of refraction, tabulated on demand. The same table serves whoever
/// asks for the same index, so that a `Bsdf` stays a plain value.
#[derive(Debug)]
pub struct Coat {
    ior: f32,
    rows: [OnceLock<Row>; ROUGH_STEPS + 1],
    next: OnceLock<Box<Coat>>,
}

/// Albedos at one roughness.
#[derive(Clone, Debug)]
struct Row {
    by_sqrt_cos: [f32; COS_STEPS + 1],
    /// `2 ∫ E(cosθ) cosθ dcosθ` of the interpolant.
    mean: f32,
}

/// The tables made so far: a list that only grows.
static COATS: OnceLock<Box<Coat>> = OnceLock::new();

impl PartialEq for Coat {
    fn eq(&self, other: &Self) -> bool {
        self.ior == other.ior
    }
}

impl Coat {
    /// The tables of a coat of the index `ior` ≥ 1.
    pub fn of(ior: f32) -> &'static Self {
        let mut slot = &COATS;
        loop {
            let coat = slot.get_or_init(|| {
                Box::new(Self { ior, rows: [const { OnceLock::new() }; ROUGH_STEPS + 1], next: OnceLock::new() })
            });
            if coat.ior == ior {
                return coat;
            }
            slot = &coat.next;
        }
    }

    /// The row before a roughness, and the share of the next one.
    fn rows(&self, alpha: f32) -> (&Row, &Row, f32) {
        let x = alpha.clamp(0.0, 1.0).sqrt() * ROUGH_STEPS as f32;
        let i = (x as usize).min(ROUGH_STEPS - 1);
        let row = |i: usize| self.rows[i].get_or_init(|| Row::new(self.ior, (i as f32 / ROUGH_STEPS as f32).powi(2)));
        (row(i), row(i + 1), x - i as f32)
    }

    /// Fraction of the light from the direction with the given cosine that the coat reflects.
    pub fn albedo(&self, alpha: f32, cos: f32) -> f32 {
        let x = cos.clamp(0.0, 1.0).sqrt() * COS_STEPS as f32;
        let i = (x as usize).min(COS_STEPS - 1);
        let (a, b, f) = self.rows(alpha);
        let at = |row: &Row| row.by_sqrt_cos[i] + (row.by_sqrt_cos[i + 1] - row.by_sqrt_cos[i]) * (x - i as f32);
        at(a) + (at(b) - at(a)) * f
    }

    /// The same for diffuse light.
    pub fn mean(&self, alpha: f32) -> f32 {
        let (a, b, f) = self.rows(alpha);
        a.mean + (b.mean - a.mean) * f
    }
}

impl Row {
    fn new(ior: f32, alpha: f32) -> Self {
        if alpha < SMOOTH {
            let at = |i: usize| fresnel_dielectric((i as f32 / COS_STEPS as f32).powi(2), ior).0;
            return Self::of(std::array::from_fn(at));
        }
        Self::of(std::array::from_fn(|i| directional(ior, alpha, (i as f32 / COS_STEPS as f32).powi(2))))
    }

    fn of(by_sqrt_cos: [f32; COS_STEPS + 1]) -> Self {
        // With x = √cos, 2 cos dcos = 4x³ dx; each linear piece exactly, so that mean and values belong together.
        let h = 1.0 / COS_STEPS as f64;
        let mut mean = 0.0;
        for i in 0..COS_STEPS {
            let (x0, x1) = (i as f64 * h, (i + 1) as f64 * h);
            let (y0, y1) = (f64::from(by_sqrt_cos[i]), f64::from(by_sqrt_cos[i + 1]));
            let slope = (y1 - y0) / h;
            mean += (y0 - slope * x0) * (x1.powi(4) - x0.powi(4)) + slope * 0.8 * (x1.powi(5) - x0.powi(5));
        }
        Self { by_sqrt_cos, mean: mean as f32 }
    }
}

/// `∫ f(wo, wi) |wi.z| dωi` of a rough coat, by the midpoint rule over the visible normals.
fn directional(ior: f32, alpha: f32, cos: f32) -> f32 {
    // Grazing itself is the limit: everything that is reflected is, at facets that are seen edge-on or not.
    let cos = cos.max(1e-4);
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for k in 0..POINTS * POINTS {
        let u = [((k % POINTS) as f32 + 0.5) / POINTS as f32, ((k / POINTS) as f32 + 0.5) / POINTS as f32];
        let Some(m) = Distribution::Ggx.sample([alpha; 2], wo, u) else { continue };
        let wi = mirror(wo, m);
        if wi.z <= 0.0 {
            continue;
        }
        if let Some(r) = reflection(Distribution::Ggx, Masking::Separable, [alpha; 2], wo, wi) {
            sum += f64::from(fresnel_dielectric(r.cos, ior).0 * r.value / r.forward);
        }
    }
    (sum / f64::from(POINTS * POINTS)) as f32
}

/// Hemispherical reflectance of a smooth coat, see [`hemispherical_dielectric`].
pub(super) fn smooth_mean(ior: f32) -> f32 {
    hemispherical_dielectric(f64::from(ior)) as f32
}

//! The spot light, with the source report's attenuation sampled exactly.

use std::f32::consts::PI;

use crate::math::{Frame, Rgb, Vec3};
use crate::pdf::SolidAnglePdf;
use crate::planted::{Bug, planted};
use crate::sampling::warp::direction_from_versine;

/// A delta point that shines into a cone: full intensity within the inner angle, none beyond the outer one, and
/// `((cosθ − cos outer)/(cos inner − cos outer))^falloff` between.
///
/// Cosines are carried as versines `1 − cosθ = 2 sin²(θ/2)`, which keep their digits in narrow cones.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// Where, render space.
    pub position: Vec3,
    /// Peak radiant intensity, W·sr⁻¹ in render units.
    pub intensity: Rgb,
    frame: Frame,
    versine_inner: f32,
    versine_outer: f32,
    falloff: f32,
    /// `∫ attenuation dω / 2π`: what the inner cone and the rim contribute.
    inner_share: f32,
    rim_share: f32,
}

/// `1 − cosθ` for an angle in degrees, without cancellation.
fn versine(degrees: f64) -> f64 {
    let s = (0.5 * degrees.to_radians()).sin();
    2.0 * s * s
}

impl SpotLight {
    /// A spot at `position` along the unit vector `axis`; half-angles in degrees, `0 ≤ inner ≤ outer ≤ 180`,
    /// `falloff ≥ 0`.
    pub fn new(position: Vec3, axis: Vec3, intensity: Rgb, inner: f64, outer: f64, falloff: f64) -> Self {
        let (vi, vo) = (versine(inner), versine(outer));
        Self {
            position,
            intensity,
            frame: Frame::from_normal(axis),
            versine_inner: vi as f32,
            versine_outer: vo as f32,
            falloff: falloff as f32,
            inner_share: vi as f32,
            rim_share: ((vo - vi) / (falloff + 1.0)) as f32,
        }
    }

    /// The unit axis.
    pub fn axis(&self) -> Vec3 {
        self.frame.z
    }

    /// `∫ attenuation dω = 2π[(1 − cos inner) + (cos inner − cos outer)/(falloff + 1)]`, sr: flux over peak intensity.
    pub fn solid_angle(&self) -> f32 {
        2.0 * PI * (self.inner_share + self.rim_share)
    }

    /// Attenuation along the unit vector `w`, in [0, 1].
    #[inline]
    pub fn attenuation(&self, w: Vec3) -> f32 {
        // |w − axis|²/2 = 1 − cosθ for unit vectors, without cancellation near the axis.
        let v = 0.5 * (w - self.frame.z).length_squared();
        if v <= self.versine_inner {
            1.0
        } else if v >= self.versine_outer {
            0.0
        } else {
            ((self.versine_outer - v) / (self.versine_outer - self.versine_inner)).powf(self.falloff)
        }
    }

    /// Intensity along the unit vector `w`.
    #[inline]
    pub fn emitted(&self, w: Vec3) -> Rgb {
        let cos = if planted(Bug::SpotOverCosine) { w.dot(self.axis()) } else { 1.0 };
        self.intensity * (self.attenuation(w) / cos)
    }

    /// A direction with density proportional to the attenuation, so that every light path carries the same power.
    #[inline]
    pub fn sample_direction(&self, u: [f32; 2]) -> (Vec3, SolidAnglePdf) {
        let total = self.inner_share + self.rim_share;
        let x = u[0] * total;
        let v = if x < self.inner_share {
            x
        } else {
            // Inverse of the rim's share: with q the attenuation's base, ∝ q^(falloff+1).
            let q = (1.0 - (x - self.inner_share) / self.rim_share).clamp(0.0, 1.0).powf(1.0 / (self.falloff + 1.0));
            self.versine_outer - (self.versine_outer - self.versine_inner) * q
        };
        let w = self.frame.to_world(direction_from_versine(v, 2.0 * PI * u[1])).normalize();
        (w, self.pdf_direction(w))
    }

    /// Density of `sample_direction`: attenuation over its integral.
    #[inline]
    pub fn pdf_direction(&self, w: Vec3) -> SolidAnglePdf {
        let total = if planted(Bug::SpotUnnormalised) { 1.0 } else { self.solid_angle() };
        if total > 0.0 { SolidAnglePdf(self.attenuation(w) / total) } else { SolidAnglePdf::IMPOSSIBLE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(inner: f64, outer: f64, falloff: f64) -> SpotLight {
        let axis = Vec3::new(0.3, -0.9, 0.2).normalize();
        SpotLight::new(Vec3::ZERO, axis, Rgb::ONE, inner, outer, falloff)
    }

    #[test]
    fn flux_over_intensity_is_the_integral_of_the_attenuation() {
        for (inner, outer, falloff) in [(20.0, 40.0, 0.5), (0.0, 90.0, 2.0), (29.99, 30.0, 1.0), (60.0, 180.0, 0.0)] {
            let s = spot(inner, outer, falloff);
            let n = 2_000_000;
            let integral: f64 = (0..n)
                .map(|i| {
                    let v = 2.0 * (f64::from(i) + 0.5) / f64::from(n);
                    let local = direction_from_versine(v as f32, 1.0);
                    f64::from(s.attenuation(s.frame.to_world(local)))
                })
                .sum::<f64>()
                * 4.0
                * std::f64::consts::PI
                / f64::from(n);
            assert!((integral / f64::from(s.solid_angle()) - 1.0).abs() < 2e-4, "{inner} {outer} {falloff}");
        }
    }

    #[test]
    fn a_hard_edge_has_the_closed_forms_flux() {
        let s = spot(30.0, 30.0, 0.5);
        let want = 2.0 * PI * (1.0 - 30.0f32.to_radians().cos());
        assert!((s.solid_angle() / want - 1.0).abs() < 1e-5);
    }

    #[test]
    fn every_emitted_direction_carries_the_same_power() {
        for (inner, outer, falloff) in [(20.0, 40.0, 0.5), (0.0, 90.0, 2.0), (0.001, 0.002, 1.0), (45.0, 180.0, 3.0)] {
            let s = spot(inner, outer, falloff);
            for i in 0..10_000u32 {
                let u = [(i as f32 + 0.5) / 10_000.0, (i as f32 * 0.618_034).fract()];
                let (w, pdf) = s.sample_direction(u);
                if pdf.0 == 0.0 {
                    continue; // the rim itself, lost to rounding
                }
                let power = s.emitted(w).x / pdf.0;
                assert!((power / s.solid_angle() - 1.0).abs() < 1e-6, "{inner} {outer} {falloff}: {power}");
            }
        }
    }

    #[test]
    fn sampled_versines_follow_the_attenuation() {
        // The distribution function of the versine at the middle of the rim, in closed form.
        let s = spot(20.0, 60.0, 0.5);
        let (vi, vo) = (versine(20.0), versine(60.0));
        let mid = 0.5 * (vi + vo);
        let want = (vi + (vo - vi) / 1.5 * (1.0 - 0.5f64.powf(1.5))) / (vi + (vo - vi) / 1.5);
        let n = 100_000;
        let below = (0..n)
            .filter(|&i| {
                let (w, _) = s.sample_direction([(i as f32 + 0.5) / n as f32, 0.25]);
                0.5 * f64::from((w - s.axis()).length_squared()) < mid
            })
            .count();
        assert!((below as f64 / f64::from(n) - want).abs() < 1e-4);
    }
}

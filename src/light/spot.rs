//! The spot light, with its attenuation sampled exactly: the source report's, or one that is linear in the angle.

mod angle_rim;

use std::f32::consts::PI;

use self::angle_rim::AngleRim;
use super::DeltaPlace;
use crate::math::{Frame, Rgb, Vec3};
use crate::pdf::SolidAnglePdf;
use crate::planted::{Bug, planted};
use crate::sampling::warp::direction_from_versine;

/// A delta point that shines into a cone: full intensity within the inner angle, none beyond the outer one, and what
/// its profile says between.
///
/// Cosines are carried as versines `1 − cosθ = 2 sin²(θ/2)`, which keep their digits in narrow cones.
#[derive(Clone, Debug)]
pub struct SpotLight {
    /// Where.
    pub place: DeltaPlace,
    /// Peak radiant intensity, W·sr⁻¹ in render units.
    pub intensity: Rgb,
    frame: Frame,
    versine_inner: f32,
    versine_outer: f32,
    rim: Rim,
    cone: Cone,
    /// `∫ attenuation dω / 2π`: what the inner cone and the rim contribute.
    inner_share: f32,
    rim_share: f32,
}

/// A spot's cone, as the format gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Half-angle of full intensity, degrees, 0 or above.
    pub inner: f64,
    /// Half-angle beyond which it is dark, degrees, at least `inner` and at most 180.
    pub outer: f64,
    /// What is between.
    pub profile: Profile,
}

/// How a spot's intensity falls from the inner to the outer angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// `((cosθ − cos outer)/(cos inner − cos outer))^falloff`.
    Cosine {
        /// 0 or above.
        falloff: f64,
    },
    /// `(outer − θ)/(outer − inner)`, as Mitsuba's spot [Mitsuba3].
    Angle,
}

/// A profile, ready to compute with.
#[derive(Clone, Copy, Debug)]
enum Rim {
    Cosine { falloff: f32 },
    Angle(AngleRim),
}

/// `1 − cosθ` for an angle in degrees, without cancellation.
fn versine(degrees: f64) -> f64 {
    let s = (0.5 * degrees.to_radians()).sin();
    2.0 * s * s
}

impl SpotLight {
    /// A spot at `position` along the unit vector `axis`, with the peak intensity `intensity`.
    pub fn new(position: Vec3, axis: Vec3, intensity: Rgb, cone: Cone) -> Self {
        let (vi, vo) = (versine(cone.inner), versine(cone.outer));
        let (rim, rim_share) = match cone.profile {
            Profile::Cosine { falloff } => (Rim::Cosine { falloff: falloff as f32 }, (vo - vi) / (falloff + 1.0)),
            Profile::Angle => {
                let rim = AngleRim::new(cone.inner.to_radians(), cone.outer.to_radians());
                (Rim::Angle(rim), rim.share())
            }
        };
        Self {
            place: DeltaPlace::free(position),
            intensity,
            frame: Frame::from_normal(axis),
            versine_inner: vi as f32,
            versine_outer: vo as f32,
            rim,
            cone,
            inner_share: vi as f32,
            rim_share: rim_share as f32,
        }
    }

    /// The unit axis.
    pub fn axis(&self) -> Vec3 {
        self.frame.z
    }

    /// The cone that it was made of.
    pub fn cone(&self) -> &Cone {
        &self.cone
    }

    /// The angle beyond which it is dark, radians.
    pub fn outer_angle(&self) -> f32 {
        self.cone.outer.to_radians() as f32
    }

    /// `∫ attenuation dω`, sr: flux over peak intensity. `2π[(1 − cos inner) + (cos inner − cos outer)/(falloff + 1)]`,
    /// or for the linear profile (angles in radians) `2π[1 − (sin outer − sin inner)/(outer − inner)]`.
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
            match &self.rim {
                Rim::Cosine { falloff } => {
                    ((self.versine_outer - v) / (self.versine_outer - self.versine_inner)).powf(*falloff)
                }
                Rim::Angle(rim) => rim.attenuation(w, self.frame.z),
            }
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
            // The fraction of the rim's share that lies farther out.
            let beyond = (1.0 - (x - self.inner_share) / self.rim_share).clamp(0.0, 1.0);
            match &self.rim {
                // With q the attenuation's base, ∝ q^(falloff+1).
                Rim::Cosine { falloff } => {
                    let q = beyond.powf(1.0 / (falloff + 1.0));
                    self.versine_outer - (self.versine_outer - self.versine_inner) * q
                }
                Rim::Angle(rim) => rim.versine_at(beyond),
            }
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
    use crate::compare::stats::chi_squared_p;

    fn spot(inner: f64, outer: f64, profile: Profile) -> SpotLight {
        let axis = Vec3::new(0.3, -0.9, 0.2).normalize();
        SpotLight::new(Vec3::ZERO, axis, Rgb::ONE, Cone { inner, outer, profile })
    }

    fn cosine(falloff: f64) -> Profile {
        Profile::Cosine { falloff }
    }

    #[test]
    fn flux_over_intensity_is_the_integral_of_the_attenuation() {
        for (inner, outer, profile) in [
            (20.0, 40.0, cosine(0.5)),
            (0.0, 90.0, cosine(2.0)),
            (29.99, 30.0, cosine(1.0)),
            (60.0, 180.0, cosine(0.0)),
            (20.0, 40.0, Profile::Angle),
            (0.0, 90.0, Profile::Angle),
            (29.99, 30.0, Profile::Angle),
            (60.0, 180.0, Profile::Angle),
            (180.0, 180.0, Profile::Angle),
        ] {
            let s = spot(inner, outer, profile);
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
            assert!((integral / f64::from(s.solid_angle()) - 1.0).abs() < 2e-4, "{inner} {outer} {profile:?}");
        }
    }

    #[test]
    fn a_hard_edge_has_the_closed_forms_flux() {
        for profile in [cosine(0.5), Profile::Angle] {
            let s = spot(30.0, 30.0, profile);
            let want = 2.0 * PI * (1.0 - 30.0f32.to_radians().cos());
            assert!((s.solid_angle() / want - 1.0).abs() < 1e-5);
        }
    }

    /// 2π[1 − (sinτ − sinβ)/(τ − β)], and its limits for narrow cones: π(τ² + τβ + β²)/3.
    #[test]
    fn the_linear_profile_has_the_closed_forms_flux() {
        use std::f64::consts::PI;
        for (inner, outer) in [(20.0, 40.0), (0.0, 90.0), (60.0, 180.0), (0.0, 180.0), (1e-4, 2e-4), (0.0, 1e-3)] {
            let (b, t) = (f64::to_radians(inner), f64::to_radians(outer));
            let closed = 2.0 * PI * (1.0 - (t.sin() - b.sin()) / (t - b));
            let narrow = PI * (t * t + t * b + b * b) / 3.0;
            let want = if outer > 1.0 { closed } else { narrow };
            let got = f64::from(spot(inner, outer, Profile::Angle).solid_angle());
            assert!((got / want - 1.0).abs() < 1e-6, "{inner} {outer}: {got}, not {want}");
        }
    }

    /// At the middle of the angle it is a half, at a quarter three quarters; not the cosine's.
    #[test]
    fn the_linear_profile_is_linear_in_the_angle() {
        for (inner, outer) in [(20.0, 60.0), (0.0, 180.0), (1.0, 1.001), (100.0, 170.0), (0.001, 0.002)] {
            let s = spot(inner, outer, Profile::Angle);
            for (fraction, want) in [(0.0, 1.0), (0.25, 0.75), (0.5, 0.5), (0.9, 0.1), (1.0, 0.0)] {
                let angle: f64 = inner + fraction * (outer - inner);
                let w = s.frame.to_world(direction_from_versine(versine(angle) as f32, 2.0)).normalize();
                // A direction in f32 is known to 1e-7.
                let rounding = 1e-6 + 2e-7 / f32::to_radians((outer - inner) as f32);
                let got = s.attenuation(w);
                assert!((got - want).abs() < rounding, "{inner} {outer} at {angle}: {got}, not {want}");
            }
        }
    }

    #[test]
    fn every_emitted_direction_carries_the_same_power() {
        for (inner, outer, profile) in [
            (20.0, 40.0, cosine(0.5)),
            (0.0, 90.0, cosine(2.0)),
            (0.001, 0.002, cosine(1.0)),
            (45.0, 180.0, cosine(3.0)),
            (20.0, 40.0, Profile::Angle),
            (0.0, 90.0, Profile::Angle),
            (0.001, 0.002, Profile::Angle),
            (0.0, 180.0, Profile::Angle),
            (180.0, 180.0, Profile::Angle),
            (90.0, 90.0, Profile::Angle),
        ] {
            let s = spot(inner, outer, profile);
            for i in 0..10_000u32 {
                let u = [(i as f32 + 0.5) / 10_000.0, (i as f32 * 0.618_034).fract()];
                let (w, pdf) = s.sample_direction(u);
                if pdf.0 == 0.0 {
                    continue; // the rim itself, lost to rounding
                }
                let power = s.emitted(w).x / pdf.0;
                assert!((power / s.solid_angle() - 1.0).abs() < 1e-6, "{inner} {outer} {profile:?}: {power}");
            }
        }
    }

    #[test]
    fn sampled_versines_follow_the_attenuation() {
        // The distribution function of the versine at the middle of the rim, in closed form.
        let s = spot(20.0, 60.0, cosine(0.5));
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

    /// Directions against the density, in rings of equal width and half as many sectors: χ².
    #[test]
    fn sampled_directions_follow_the_density() {
        const RINGS: usize = 20;
        const SECTORS: usize = 8;
        for (inner, outer, profile) in [
            (20.0, 60.0, cosine(0.5)),
            (20.0, 60.0, Profile::Angle),
            (0.0, 90.0, Profile::Angle),
            (0.0, 180.0, Profile::Angle),
            (100.0, 175.0, Profile::Angle),
            (0.5, 1.0, Profile::Angle),
        ] {
            let s = spot(inner, outer, profile);
            let width = outer.to_radians() / RINGS as f64;
            let mut counts = [[0_u32; SECTORS]; RINGS];
            let n = 200_000_u32;
            for i in 0..n {
                // Points of the R2 sequence, shuffled enough to be independent of the cells.
                let hash = |salt: u32| {
                    let mut x = i.wrapping_mul(2_654_435_769) ^ salt;
                    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
                    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
                    (x ^ (x >> 16)) as f32 / 4_294_967_296.0
                };
                let (w, _) = s.sample_direction([hash(1).min(0.999_999_9), hash(0x9e37_79b9).min(0.999_999_9)]);
                let local = s.frame.to_local(w);
                let angle = 2.0 * (0.5 * f64::from((w - s.axis()).length())).min(1.0).asin();
                let ring = ((angle / width) as usize).min(RINGS - 1);
                let around = f64::from(local.y).atan2(f64::from(local.x)) / std::f64::consts::TAU + 0.5;
                counts[ring][((around * SECTORS as f64) as usize).min(SECTORS - 1)] += 1;
            }
            let (mut statistic, mut cells) = (0.0, 0.0);
            for (ring, sectors) in counts.iter().enumerate() {
                // The density's integral over a ring, by the midpoint rule.
                let m = 2000;
                let expected: f64 = (0..m)
                    .map(|k| {
                        let angle = (ring as f64 + (f64::from(k) + 0.5) / f64::from(m)) * width;
                        let v = 2.0 * (0.5 * angle).sin().powi(2);
                        let w = s.frame.to_world(direction_from_versine(v as f32, 1.0)).normalize();
                        f64::from(s.pdf_direction(w).0) * angle.sin()
                    })
                    .sum::<f64>()
                    * width
                    * std::f64::consts::TAU
                    / f64::from(m * SECTORS as i32)
                    * f64::from(n);
                if expected < 5.0 {
                    continue;
                }
                statistic += sectors.iter().map(|c| (f64::from(*c) - expected).powi(2) / expected).sum::<f64>();
                cells += SECTORS as f64;
            }
            let p = chi_squared_p(statistic, cells - 1.0);
            assert!(p > 1e-3, "{inner} {outer} {profile:?}: χ² = {statistic} over {cells} cells, p = {p}");
        }
    }
}

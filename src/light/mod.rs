//! Lights: where light paths start, with true densities for every way of choosing a point or direction on them.
//!
//! Contract: a light is one that paths can hit by chance (emitting surfaces, environments) or a *delta* light (delta
//! points, directional lights). Its points lie on surfaces, at delta points or at infinity (`LightPoint`), with densities
//! in the measure that belongs to each. Directions point away from the light. Light is chosen among lights by
//! `LightChoice`; every density here is conditional on that choice.

mod area;
mod choice;
mod environment_map;
mod infinite;
mod point;
mod receiver;
mod spot;
mod tree;

pub use area::{AreaLight, Emission, Emitter};
pub use choice::LightChoice;
pub use environment_map::EnvironmentMap;
pub use infinite::{DirectionalLight, Environment, EnvironmentLight, SceneBall};
pub use point::{DeltaPlace, LightEdge, LightPoint};
pub use receiver::Receiver;
pub use spot::{Cone, Profile, SpotLight};
pub use tree::{EmitterBound, LightTree};

use std::f32::consts::PI;

use crate::geometry::Geometry;
use crate::math::{Rgb, Vec3, luminance};
use crate::pdf::{EmissionPdf, LightPointPdf, SolidAnglePdf};
use crate::sampling::warp;

/// A light source in render space.
#[derive(Clone, Debug)]
pub enum Light {
    /// An emitting surface.
    Area(AreaLight),
    /// A delta point that shines alike in all directions.
    Point(PointLight),
    /// A delta point that shines into a cone.
    Spot(SpotLight),
    /// Parallel light from infinity.
    Directional(DirectionalLight),
    /// Radiance from all around.
    Environment(EnvironmentLight),
}

/// An isotropic point light.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Where.
    pub place: DeltaPlace,
    /// Radiant intensity, W·sr⁻¹ in render units (scaled with the square of the scene's scale).
    pub intensity: Rgb,
}

/// The first vertex of a light subpath and its first edge.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// Where light starts.
    pub point: LightPoint,
    /// Where the ray of the first edge starts: beside the point or, for one at infinity, outside the scene.
    pub origin: Vec3,
    /// Unit direction of the first edge.
    pub w: Vec3,
    /// Radiance (area light, environment), radiant intensity (delta point) or irradiance (directional light) along `w`.
    pub le: Rgb,
    /// Density of the point.
    pub pdf_position: LightPointPdf,
    /// Density of the edge given the point.
    pub pdf_direction: EmissionPdf,
}

/// A point on a light for next-event estimation.
#[derive(Clone, Copy, Debug)]
pub struct DirectSample {
    /// The point.
    pub point: LightPoint,
    /// Its density.
    pub pdf: LightPointPdf,
}

/// The least share of an emitter's radiance that the film expects of it, however small it is.
const SMALLEST_SHARE: f64 = 1.0 / (1u64 << 27) as f64;

impl Light {
    /// Whether no path can hit the light by chance.
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Point(_) | Self::Spot(_) | Self::Directional(_))
    }

    /// Whether the light's points lie at infinity.
    #[inline]
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Directional(_) | Self::Environment(_))
    }

    /// Emitted power per channel in render units (for an ellipsoid its bound); of a light at infinity what enters the
    /// scene's ball.
    pub fn power(&self) -> Rgb {
        match self {
            Self::Area(l) => l.power(),
            Self::Point(l) => l.intensity * (4.0 * PI),
            Self::Spot(l) => l.intensity * l.solid_angle(),
            Self::Directional(l) => l.power(),
            Self::Environment(l) => l.power(),
        }
    }

    /// What a pixel may be expected to hold of the light at most, but for the light itself: the largest channel of its
    /// radiance, intensity or irradiance, or of its power (in a scene of about unit size) where that is less, as it is for
    /// a small emitter. A multiple of the emission, for a scene of one shape, so that it follows emission × 2ᵏ exactly.
    ///
    /// `near` is the spread of what the camera is among (`scene::Prepared`): light within it is brighter by 1/`near`² than a
    /// unit away, of which the film leaves 2²⁰ to what may be brighter than expected. And an emitter itself, which is seen
    /// however small it is, is brighter by 2²⁷ at most.
    pub fn brightness(&self, near: f64) -> f32 {
        let closer = (1024.0 * near).powi(2).min(1.0).recip();
        let emitted = match self {
            Self::Area(l) => l.largest_radiance().max_element(),
            Self::Point(l) => l.intensity.max_element(),
            Self::Spot(l) => l.intensity.max_element(),
            Self::Directional(l) => l.irradiance.max_element(),
            Self::Environment(l) => l.brightest(),
        };
        let power = f64::from(self.power().max_element());
        let expected = match self {
            Self::Area(_) => {
                let emitted = f64::from(emitted);
                emitted.min(power * closer).max(emitted * SMALLEST_SHARE)
            }
            Self::Point(_) | Self::Spot(_) => f64::from(emitted).min(power) * closer,
            Self::Directional(_) | Self::Environment(_) => f64::from(emitted).min(power),
        };
        expected.min(f64::from(f32::MAX)) as f32
    }

    /// Whether emission chooses among parts of the light, so that its `u_part` is used.
    #[inline]
    pub fn emits_in_parts(&self) -> bool {
        match self {
            Self::Area(l) => matches!(l.emitter, Emitter::Triangles { .. }),
            _ => self.shines_in_parts(),
        }
    }

    /// Where it stands, if it is a point.
    pub fn place(&self) -> Option<&DeltaPlace> {
        match self {
            Self::Point(PointLight { place, .. }) | Self::Spot(SpotLight { place, .. }) => Some(place),
            Self::Area(_) | Self::Directional(_) | Self::Environment(_) => None,
        }
    }

    /// That place, to be told what surface it is on.
    pub fn place_mut(&mut self) -> Option<&mut DeltaPlace> {
        match self {
            Self::Point(PointLight { place, .. }) | Self::Spot(SpotLight { place, .. }) => Some(place),
            Self::Area(_) | Self::Directional(_) | Self::Environment(_) => None,
        }
    }

    /// Starts a light subpath: point, first edge and their densities.
    #[inline]
    pub fn sample_emission(
        &self,
        geometry: &Geometry,
        u_part: f64,
        u_position: [f32; 2],
        u_direction: [f32; 2],
    ) -> Option<EmissionSample> {
        let delta = |place, w, le, pdf: SolidAnglePdf| {
            let point = LightPoint::Delta(place);
            EmissionSample {
                point,
                origin: point.origin(w),
                w,
                le,
                pdf_position: LightPointPdf::UNIT_MASS,
                pdf_direction: pdf.into(),
            }
        };
        match self {
            Self::Area(l) => l.sample_emission(geometry, u_part, u_position, u_direction),
            Self::Point(l) => {
                let w = warp::uniform_sphere(u_direction);
                Some(delta(l.place, w, l.intensity, SolidAnglePdf(0.25 / PI)))
            }
            Self::Spot(l) => {
                let (w, pdf) = l.sample_direction(u_direction);
                // Rounding may carry the last direction of the rim out of the cone, where 0/0 would be its power.
                if pdf.0 == 0.0 {
                    return None;
                }
                Some(delta(l.place, w, l.emitted(w), pdf))
            }
            Self::Directional(l) => Some(l.sample_emission(u_position)),
            Self::Environment(l) => l.sample_emission(u_part, u_position, u_direction),
        }
    }

    /// How many parts `LightChoice` chooses among for next-event estimation.
    pub fn parts(&self) -> u32 {
        if let Self::Area(l) = self { l.parts() } else { 1 }
    }

    /// The part that a point of the light belongs to.
    #[inline]
    pub fn part_of(&self, point: &LightPoint) -> u32 {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.part_of(s),
            _ => 0,
        }
    }

    /// Where a part of the light is and where to it shines; `None` at infinity.
    pub fn bound(&self, geometry: &Geometry, part: u32) -> Option<EmitterBound> {
        let at = |p: Vec3, axis: Vec3, theta_normals: f32, intensity: Rgb| EmitterBound {
            lo: p,
            hi: p,
            axis,
            theta_normals,
            theta_reach: 0.0,
            two_sided: false,
            intensity: f64::from(luminance(intensity)),
        };
        match self {
            Self::Area(l) => Some(l.bound(geometry, part)),
            Self::Point(l) => Some(at(l.place.p, Vec3::Z, PI, l.intensity)),
            Self::Spot(l) => Some(at(l.place.p, l.axis(), l.outer_angle(), l.intensity)),
            Self::Directional(_) | Self::Environment(_) => None,
        }
    }

    /// Whether `sample_direct` uses `u_part`.
    #[inline]
    pub fn shines_in_parts(&self) -> bool {
        matches!(self, Self::Environment(EnvironmentLight { radiance: Environment::Map(_), .. }))
    }

    /// A point on part `part` of the light for next-event estimation at `from`, with its density given the part.
    #[inline(always)]
    pub fn sample_direct(
        &self,
        geometry: &Geometry,
        from: Vec3,
        part: u32,
        u_part: f64,
        u: [f32; 2],
    ) -> Option<DirectSample> {
        match self {
            Self::Area(l) => {
                let (point, pdf) = l.sample_direct(geometry, from, part, u)?;
                Some(DirectSample { point: LightPoint::Surface(point), pdf: pdf.into() })
            }
            Self::Point(PointLight { place, .. }) | Self::Spot(SpotLight { place, .. }) => {
                Some(DirectSample { point: LightPoint::Delta(*place), pdf: LightPointPdf::UNIT_MASS })
            }
            Self::Directional(l) => {
                Some(DirectSample { point: LightPoint::Infinite(l.toward), pdf: LightPointPdf::UNIT_MASS })
            }
            Self::Environment(l) => {
                let (toward, pdf) = l.sample_direction(u_part, u)?;
                Some(DirectSample { point: LightPoint::Infinite(toward), pdf })
            }
        }
    }

    /// Radiance, intensity (delta points) or irradiance (directional lights) sent from `point` along the unit vector `w`.
    #[inline]
    pub fn emitted(&self, point: &LightPoint, w: Vec3) -> Rgb {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.emitted(s, w),
            (Self::Point(l), _) => l.intensity,
            (Self::Spot(l), _) => l.emitted(w),
            (Self::Directional(l), _) => l.irradiance,
            (Self::Environment(l), LightPoint::Infinite(toward)) => l.radiance(*toward),
            // No other light has such points: nothing is emitted there.
            (Self::Area(_) | Self::Environment(_), _) => Rgb::ZERO,
        }
    }

    /// Density with which `sample_emission` chooses the point.
    #[inline]
    pub fn pdf_emission_position(&self, geometry: &Geometry, point: &LightPoint) -> LightPointPdf {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.pdf_point(geometry, s.p()).into(),
            (Self::Environment(l), LightPoint::Infinite(toward)) => l.pdf(*toward),
            (Self::Point(_) | Self::Spot(_) | Self::Directional(_), _) => LightPointPdf::UNIT_MASS,
            (Self::Area(_) | Self::Environment(_), _) => LightPointPdf::IMPOSSIBLE,
        }
    }

    /// Density with which `sample_emission` chooses the edge along `w` from `point`.
    #[inline]
    pub fn pdf_emission_direction(&self, point: &LightPoint, w: Vec3) -> EmissionPdf {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.pdf_direction(s, w).into(),
            (Self::Point(_), _) => SolidAnglePdf(0.25 / PI).into(),
            (Self::Spot(l), _) => l.pdf_direction(w).into(),
            (Self::Directional(l), _) => l.pdf_direction(),
            (Self::Environment(l), _) => l.pdf_direction(),
            (Self::Area(_), _) => EmissionPdf::IMPOSSIBLE,
        }
    }

    /// Density with which `sample_direct` at `from` chooses the point, given its part.
    #[inline]
    pub fn pdf_direct(&self, geometry: &Geometry, from: Vec3, point: &LightPoint) -> LightPointPdf {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.pdf_direct(geometry, from, s).into(),
            _ => self.pdf_emission_position(geometry, point),
        }
    }
}

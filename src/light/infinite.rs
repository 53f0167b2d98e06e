//! Lights at infinity: directional lights and environments.
//!
//! A point at infinity is a direction, and its density is per solid angle. Light subpaths that start there choose the
//! direction first, then a point of the disk that the scene's ball shows in that direction: density 1/(πR²) per
//! perpendicular area, the same for all edges of one direction. No 1/d² belongs to such an edge (docs/MIS.md, section 7).

use std::f64::consts::PI;

use super::environment_map::EnvironmentMap;
use super::{EmissionSample, LightPoint};
use crate::math::{Frame, Rgb, Vec3};
use crate::pdf::{EmissionPdf, LightPointPdf};
use crate::sampling::warp;

/// A ball that holds all of the scene's geometry, render space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneBall {
    /// Its centre.
    pub center: Vec3,
    /// Its radius, above 0.
    pub radius: f32,
}

impl SceneBall {
    /// A ball around the box from `lo` to `hi`, with room for rounding: what lies on its rim must not lie beyond.
    pub fn around(lo: Vec3, hi: Vec3) -> Self {
        let radius = 0.5 * (hi - lo).length();
        Self { center: 0.5 * (lo + hi), radius: (1.001 * radius).max(1e-6) }
    }

    /// Area of its shadow, πR².
    #[inline]
    pub fn disk_area(&self) -> f64 {
        PI * f64::from(self.radius) * f64::from(self.radius)
    }

    /// Density per perpendicular area of the edges that light subpaths of one direction start with.
    #[inline]
    fn edge_pdf(&self) -> EmissionPdf {
        EmissionPdf(1.0 / self.disk_area())
    }

    /// Where a light subpath that comes from the unit direction `toward` enters: on the ball's tangent disk.
    #[inline]
    fn entry(&self, toward: Vec3, u: [f32; 2]) -> Vec3 {
        let [x, y] = warp::concentric_disk(u);
        self.center + Frame::from_normal(toward).to_world(Vec3::new(x, y, 1.0)) * self.radius
    }
}

/// A light so far away that it comes from one direction and is equally strong everywhere: a delta light.
#[derive(Clone, Debug)]
pub struct DirectionalLight {
    /// Unit direction toward the light.
    pub toward: Vec3,
    /// Irradiance of a surface that faces it, W·m⁻².
    pub irradiance: Rgb,
    /// What it shines on.
    pub ball: SceneBall,
}

impl DirectionalLight {
    /// Starts a light subpath.
    #[inline]
    pub(super) fn sample_emission(&self, u_position: [f32; 2]) -> EmissionSample {
        EmissionSample {
            point: LightPoint::Infinite(self.toward),
            origin: self.ball.entry(self.toward, u_position),
            w: -self.toward,
            le: self.irradiance,
            pdf_position: LightPointPdf::UNIT_MASS,
            pdf_direction: self.ball.edge_pdf(),
        }
    }

    /// Power that enters the scene's ball.
    pub(super) fn power(&self) -> Rgb {
        self.irradiance * self.ball.disk_area() as f32
    }

    #[inline]
    pub(super) fn pdf_direction(&self) -> EmissionPdf {
        self.ball.edge_pdf()
    }
}

/// Radiance from all directions.
#[derive(Clone, Debug)]
pub struct EnvironmentLight {
    /// How much from where.
    pub radiance: Environment,
    /// What it shines on.
    pub ball: SceneBall,
}

/// The radiance of an environment, W·m⁻²·sr⁻¹.
#[derive(Clone, Debug)]
pub enum Environment {
    /// The same from everywhere.
    Constant(Rgb),
    /// An image's.
    Map(Box<EnvironmentMap>),
}

impl EnvironmentLight {
    /// Radiance that arrives from the unit direction `toward`.
    #[inline]
    pub fn radiance(&self, toward: Vec3) -> Rgb {
        match &self.radiance {
            Environment::Constant(radiance) => *radiance,
            Environment::Map(map) => map.radiance(toward),
        }
    }

    /// The largest radiance of any channel from anywhere.
    pub fn brightest(&self) -> f32 {
        match &self.radiance {
            Environment::Constant(radiance) => radiance.max_element(),
            Environment::Map(map) => map.brightest(),
        }
    }

    /// A direction toward the light with its density per solid angle; `None` where nothing comes from.
    #[inline]
    pub(super) fn sample_direction(&self, u_part: f64, u: [f32; 2]) -> Option<(Vec3, LightPointPdf)> {
        match &self.radiance {
            Environment::Constant(_) => Some((warp::uniform_sphere(u), LightPointPdf(0.25 / PI))),
            Environment::Map(map) => map.sample(u_part, u),
        }
    }

    /// Density of `sample_direction`.
    #[inline]
    pub(super) fn pdf(&self, toward: Vec3) -> LightPointPdf {
        match &self.radiance {
            Environment::Constant(_) => LightPointPdf(0.25 / PI),
            Environment::Map(map) => map.pdf(toward),
        }
    }

    /// Starts a light subpath.
    #[inline]
    pub(super) fn sample_emission(&self, u_part: f64, u_position: [f32; 2], u: [f32; 2]) -> Option<EmissionSample> {
        let (toward, pdf_position) = self.sample_direction(u_part, u)?;
        Some(EmissionSample {
            point: LightPoint::Infinite(toward),
            origin: self.ball.entry(toward, u_position),
            w: -toward,
            le: self.radiance(toward),
            pdf_position,
            pdf_direction: self.ball.edge_pdf(),
        })
    }

    /// Power that enters the scene's ball.
    pub(super) fn power(&self) -> Rgb {
        let integral = match &self.radiance {
            Environment::Constant(radiance) => *radiance * (4.0 * PI) as f32,
            Environment::Map(map) => map.integral(),
        };
        integral * self.ball.disk_area() as f32
    }

    #[inline]
    pub(super) fn pdf_direction(&self) -> EmissionPdf {
        self.ball.edge_pdf()
    }
}

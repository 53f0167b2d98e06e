//! Lights: where light paths start, with true densities for every way of choosing a point or direction on them.
//!
//! Contract: a light is either an *area* light (any emitting surface; camera subpaths can hit it) or a *delta* light
//! (a delta point; they cannot). Directions point away from the light. Light is chosen among lights by
//! `LightChoice`; every density here is conditional on that choice.

mod area;
mod choice;
mod spot;

pub use area::{AreaLight, Emitter};
pub use choice::LightChoice;
pub use spot::SpotLight;

use std::f32::consts::PI;

use crate::geometry::{Geometry, SurfacePoint};
use crate::math::{Rgb, Vec3, gamma};
use crate::pdf::{AreaPdf, SolidAnglePdf};
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
}

/// An isotropic point light.
#[derive(Clone, Debug)]
pub struct PointLight {
    /// Where, render space.
    pub position: Vec3,
    /// Radiant intensity, W·sr⁻¹ in render units (scaled with the square of the scene's scale).
    pub intensity: Rgb,
}

/// A point on a light, chosen for a light subpath or for next-event estimation.
#[derive(Clone, Copy, Debug)]
pub enum LightPoint {
    /// On an emitting surface.
    Surface(SurfacePoint),
    /// At a delta light.
    Delta(Vec3),
}

impl LightPoint {
    /// Position, render space.
    #[inline]
    pub fn p(&self) -> Vec3 {
        match self {
            Self::Surface(s) => s.p(),
            Self::Delta(p) => *p,
        }
    }

    /// Where a segment between this point and something on the side of `towards` ends.
    #[inline]
    pub fn origin(&self, towards: Vec3) -> Vec3 {
        match self {
            Self::Surface(s) => s.origin(towards),
            Self::Delta(p) => beside(*p, towards.normalize_or_zero(), 0.0),
        }
    }

    /// Where a segment from `from` to this point ends.
    #[inline]
    pub fn segment_end(&self, from: Vec3) -> Vec3 {
        match self {
            Self::Surface(s) => s.segment_end(from),
            Self::Delta(p) => {
                let back = from - *p;
                let length = back.length();
                if length > 0.0 { beside(*p, back / length, length) } else { *p }
            }
        }
    }

    /// The cosine that turns a solid angle at the other end into area here: 1 at a delta point, where the "area"
    /// is the point's unit mass.
    #[inline]
    pub fn cos(&self, w: Vec3) -> f32 {
        match self {
            Self::Surface(s) => s.ng.dot(w),
            Self::Delta(_) => 1.0,
        }
    }
}

/// A delta point moved towards the unit vector `w` by what the traversal of a segment of this length may be off, so that
/// a surface it stands on does not hide it. Render space is about one unit large, and so are its largest triangles.
#[inline]
fn beside(p: Vec3, w: Vec3, length: f32) -> Vec3 {
    p + w * (gamma(16) * (1.0 + p.abs().max_element() + length))
}

/// The first vertex of a light subpath and its first direction.
#[derive(Clone, Copy, Debug)]
pub struct EmissionSample {
    /// Where light starts.
    pub point: LightPoint,
    /// Unit direction of the first edge.
    pub w: Vec3,
    /// Radiance (area light) or radiant intensity (delta light) along `w`.
    pub le: Rgb,
    /// Density of the point; for a delta light its unit mass, 1.
    pub pdf_position: AreaPdf,
    /// Density of `w` given the point.
    pub pdf_direction: SolidAnglePdf,
}

/// A point on a light for next-event estimation.
#[derive(Clone, Copy, Debug)]
pub struct DirectSample {
    /// The point.
    pub point: LightPoint,
    /// Its density; for a delta light its unit mass, 1.
    pub pdf: AreaPdf,
}

impl Light {
    /// Whether no path can hit the light by chance.
    #[inline]
    pub fn is_delta(&self) -> bool {
        !matches!(self, Self::Area(_))
    }

    /// Emitted power per channel in render units (for an ellipsoid its bound).
    pub fn power(&self) -> Rgb {
        match self {
            Self::Area(l) => l.radiance * (f64::from(PI) * l.area) as f32,
            Self::Point(l) => l.intensity * (4.0 * PI),
            Self::Spot(l) => l.intensity * l.solid_angle(),
        }
    }

    /// Whether the light has parts to choose among, so that `u_part` below is used.
    #[inline]
    pub fn has_parts(&self) -> bool {
        matches!(self, Self::Area(AreaLight { emitter: Emitter::Triangles { .. }, .. }))
    }

    /// Starts a light subpath: point, direction and their densities.
    #[inline]
    pub fn sample_emission(
        &self,
        geometry: &Geometry,
        u_part: f64,
        u_position: [f32; 2],
        u_direction: [f32; 2],
    ) -> Option<EmissionSample> {
        let delta = |position, w, le, pdf| EmissionSample {
            point: LightPoint::Delta(position),
            w,
            le,
            pdf_position: AreaPdf(1.0),
            pdf_direction: pdf,
        };
        match self {
            Self::Area(l) => l.sample_emission(geometry, u_part, u_position, u_direction),
            Self::Point(l) => {
                let w = warp::uniform_sphere(u_direction);
                Some(delta(l.position, w, l.intensity, SolidAnglePdf(0.25 / PI)))
            }
            Self::Spot(l) => {
                let (w, pdf) = l.sample_direction(u_direction);
                // Rounding may carry the last direction of the rim out of the cone, where 0/0 would be its power.
                if pdf.0 == 0.0 {
                    return None;
                }
                Some(delta(l.position, w, l.emitted(w), pdf))
            }
        }
    }

    /// A point on the light for next-event estimation.
    #[inline]
    pub fn sample_direct(&self, geometry: &Geometry, u_part: f64, u: [f32; 2]) -> Option<DirectSample> {
        match self {
            Self::Area(l) => {
                let (point, pdf) = l.sample_point(geometry, u_part, u)?;
                Some(DirectSample { point: LightPoint::Surface(point), pdf })
            }
            Self::Point(PointLight { position, .. }) | Self::Spot(SpotLight { position, .. }) => {
                Some(DirectSample { point: LightPoint::Delta(*position), pdf: AreaPdf(1.0) })
            }
        }
    }

    /// Radiance (area) or intensity (delta) sent from `point` along the unit vector `w`.
    #[inline]
    pub fn emitted(&self, point: &LightPoint, w: Vec3) -> Rgb {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.emitted(s, w),
            (Self::Point(l), _) => l.intensity,
            (Self::Spot(l), _) => l.emitted(w),
            // An area light has no delta points: nothing is emitted there.
            (Self::Area(_), LightPoint::Delta(_)) => Rgb::ZERO,
        }
    }

    /// Density with which `sample_emission` chooses the point (unit mass for a delta light).
    #[inline]
    pub fn pdf_emission_position(&self, geometry: &Geometry, point: &LightPoint) -> AreaPdf {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.pdf_point(geometry, s.p()),
            _ => AreaPdf(1.0),
        }
    }

    /// Density with which `sample_emission` chooses the direction `w` from `point`.
    #[inline]
    pub fn pdf_emission_direction(&self, point: &LightPoint, w: Vec3) -> SolidAnglePdf {
        match (self, point) {
            (Self::Area(l), LightPoint::Surface(s)) => l.pdf_direction(s, w),
            (Self::Point(_), _) => SolidAnglePdf(0.25 / PI),
            (Self::Spot(l), _) => l.pdf_direction(w),
            (Self::Area(_), LightPoint::Delta(_)) => SolidAnglePdf::IMPOSSIBLE,
        }
    }

    /// Density with which `sample_direct` chooses the point (unit mass for a delta light).
    #[inline]
    pub fn pdf_direct(&self, geometry: &Geometry, point: &LightPoint) -> AreaPdf {
        // Next-event estimation samples by area, as emission does; kept apart because it need not.
        self.pdf_emission_position(geometry, point)
    }
}

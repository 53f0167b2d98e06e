//! What a sample did, step by step: kept by a `Recorder<true>`, for replays. A plain recorder is compiled without it.

use super::Technique;
use super::bdpt::Partial;
use crate::bsdf::{Bsdf, BsdfSample};
use crate::camera::LensNumbers;
use crate::geometry::{GeometryKind, SurfacePoint};
use crate::light::{EmissionSample, LightPoint};
use crate::math::{Rgb, Vec3};
use crate::pdf::Pmf;
use crate::scene::Arrival;

/// One step. Points and directions are in render space, densities in its units.
#[derive(Clone, Debug)]
pub enum Step {
    /// A camera subpath starts.
    Camera {
        /// Where its ray starts.
        from: Vec3,
        /// Unit direction.
        toward: Vec3,
        /// Density of the pixel's rays: per solid angle, per area for parallel rays.
        pdf: f64,
        /// The point of the lens, of cameras that have one.
        lens: [f32; 2],
    },
    /// A light subpath starts.
    Light {
        /// Which light.
        light: u32,
        /// Probability of its choice.
        pmf: f64,
        /// Where on it.
        point: LightPoint,
        /// Unit direction.
        toward: Vec3,
        /// Density of the point, the choice included: per area, discrete for delta lights.
        pdf_position: f64,
        /// Density of the direction, per solid angle (per area for lights at infinity).
        pdf_direction: f64,
        /// Radiance (intensity, irradiance) that leaves it.
        le: Rgb,
    },
    /// The subpath has come to a surface.
    Arrived(Arrived),
    /// The subpath has left the scene in a direction.
    Left {
        /// Unit direction.
        toward: Vec3,
        /// Whether a camera subpath came through a window.
        through_window: bool,
    },
    /// The subpath scatters.
    Scattered {
        /// Unit direction.
        toward: Vec3,
        /// Density per solid angle of that direction; of a delta lobe, the probability of the lobe.
        pdf_fwd: f64,
        /// The same of the way back.
        pdf_rev: f64,
        /// What the throughput is multiplied by.
        weight: Rgb,
        /// Whether by a delta lobe.
        delta: bool,
    },
    /// Roulette let it live with a probability.
    Survived(f32),
    /// The subpath ends.
    Ended(End),
    /// Next-event estimation has chosen a point of a light.
    LightSampled {
        /// Which light.
        light: u32,
        /// Where on it.
        point: LightPoint,
        /// Density, the choice included: per area (per solid angle at infinity, discrete for delta lights).
        pdf: f64,
    },
    /// A technique has made a path.
    Made(Made),
    /// What blocks the path made last: the surface nearest along its connection.
    Blocked {
        /// Its index.
        surface: u32,
    },
}

/// A vertex that a subpath has come to.
#[derive(Clone, Debug)]
pub struct Arrived {
    /// Number of the subpath's vertices up to here.
    pub number: u32,
    /// What kind of primitive it lies on.
    pub geometry: GeometryKind,
    /// Where.
    pub at: SurfacePoint,
    /// Unit direction to the previous vertex.
    pub wo: Vec3,
    /// Squared length of the edge, or 1 where it has none that counts.
    pub d2: f64,
    /// How the surface scatters.
    pub bsdf: Bsdf,
    /// The light it is.
    pub light: Option<u32>,
    /// Whether a window lies before.
    pub through_window: bool,
    /// Throughput up to here.
    pub beta: Rgb,
    /// Partial sums of the weights; of integrators that have such.
    pub partial: Option<Partial>,
}

impl Arrived {
    /// What is known of an arrival, but for the edge's length.
    pub(super) fn of(arrival: &Arrival<'_>, wo: Vec3, beta: Rgb, number: u32, partial: Option<Partial>) -> Self {
        let Arrival { geometry, at, bsdf, light, through_window } = *arrival;
        Self { number, geometry, at, wo, d2: 1.0, bsdf: *bsdf, light, through_window, beta, partial }
    }
}

/// Why a subpath ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// It has as many scattering events as are allowed.
    Length,
    /// The surface scatters nothing.
    Black,
    /// It runs along the surface, within rounding.
    Grazing,
    /// No direction was found: absorbed, or sampled below the surface.
    Absorbed,
    /// Roulette.
    Roulette,
    /// The rest is none of the paths that are asked for.
    Class,
}

/// A path made by a technique.
#[derive(Clone, Debug)]
pub struct Made {
    /// Which.
    pub technique: Technique,
    /// The pixel it lands on and the numbers with which the camera was connected to; `None` for the sample's own.
    pub seen: Option<([u32; 2], LensNumbers)>,
    /// The light it starts on, where the technique chose it.
    pub light: Option<u32>,
    /// What it contributes with the weight 1, and with its weight; both before visibility. `None` where the surfaces or the
    /// light send nothing along the connection.
    pub values: Option<[Rgb; 2]>,
    /// The fraction that passes along the connection.
    pub visible: f32,
}

impl Made {
    /// The weight: the ratio of the two values in the channel in which they are largest; NaN where that cannot be told.
    pub fn weight(&self) -> f64 {
        let Some([plain, weighted]) = self.values else { return 0.0 };
        let largest = plain.max_element();
        let channel = plain.to_array().iter().position(|x| *x == largest).unwrap_or(0);
        f64::from(weighted.to_array()[channel]) / f64::from(plain.to_array()[channel])
    }
}

impl Step {
    /// The start of a light subpath on a light chosen with the probability `pmf`.
    pub(super) fn of_light(light: u32, pmf: Pmf, emission: &EmissionSample) -> Self {
        Self::Light {
            light,
            pmf: pmf.0.into(),
            point: emission.point,
            toward: emission.w,
            pdf_position: (emission.pdf_position * pmf).0,
            pdf_direction: emission.pdf_direction.0,
            le: emission.le,
        }
    }
}

impl From<&BsdfSample> for Step {
    fn from(s: &BsdfSample) -> Self {
        let (pdf_fwd, pdf_rev) = (f64::from(s.pdf_fwd.0), f64::from(s.pdf_rev.0));
        Self::Scattered { toward: s.wi, pdf_fwd, pdf_rev, weight: s.weight, delta: s.delta }
    }
}

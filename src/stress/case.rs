//! What a case is.

use serde_json::Value;

use crate::integrator::Integrator;

/// What a case's image must be.
#[derive(Clone, Debug)]
pub enum Expected {
    /// That of another scene, so many times as bright, in the mean.
    SameAs {
        /// The undisturbed scene.
        scene: Value,
        /// The case's radiance over its.
        times: f64,
    },
    /// The same to the last bit, multiplied by a power of two.
    SameBits {
        /// The undisturbed scene.
        scene: Value,
        /// The case's radiance over its, a power of two.
        times: f64,
    },
    /// Of this mean radiance.
    Mean(f64),
    /// Black.
    Nothing,
}

/// A scene that is hard on numbers.
#[derive(Clone, Debug)]
pub struct Case {
    /// Short and unique.
    pub name: String,
    /// What is disturbed, and how.
    pub what: &'static str,
    /// The scene, in the native format.
    pub scene: Value,
    /// What it must look like.
    pub expected: Expected,
    /// Whether every ray must meet something.
    pub closed: bool,
    /// Those that can render it.
    pub integrators: &'static [Integrator],
    /// Scattering events at most.
    pub bounces: u32,
    /// Whether paths are ended at random.
    pub roulette: bool,
    /// Bound on the relative difference of the energy.
    pub bound: f64,
    /// How far the energies do differ, relatively, and why: what is compared is not quite the same.
    pub apart: Option<(f64, &'static str)>,
    /// Samples, in multiples of the usual number.
    pub effort: u32,
}

impl Case {
    /// Where no camera path finds the light.
    pub const FROM_LIGHT: &[Integrator] = &[Integrator::Light, Integrator::Bdpt];
    /// All integrators, few bounces.
    pub const ALL: &[Integrator] = &[Integrator::Path, Integrator::Light, Integrator::Bdpt];
    /// Where light tracing cannot see what the camera does.
    pub const FROM_CAMERA: &[Integrator] = &[Integrator::Path, Integrator::Bdpt];

    /// A case in an open scene with the usual settings.
    pub fn new(name: impl Into<String>, what: &'static str, scene: Value, expected: Expected) -> Self {
        Self {
            name: name.into(),
            what,
            scene,
            expected,
            closed: false,
            integrators: Self::ALL,
            bounces: 6,
            roulette: true,
            bound: 0.01,
            apart: None,
            effort: 1,
        }
    }

    /// In a room that no ray leaves.
    #[must_use]
    pub fn closed(self) -> Self {
        Self { closed: true, ..self }
    }

    /// With another bound on the energy.
    #[must_use]
    pub fn within(self, bound: f64) -> Self {
        Self { bound, ..self }
    }

    /// With more samples.
    #[must_use]
    pub fn samples(self, effort: u32) -> Self {
        Self { effort, ..self }
    }

    /// With energies that do differ, by up to this.
    #[must_use]
    pub fn apart(self, by: f64, why: &'static str) -> Self {
        Self { apart: Some((by, why)), ..self }
    }

    /// By light tracing alone.
    #[must_use]
    pub fn by_light(self) -> Self {
        Self { integrators: &[Integrator::Light], ..self }
    }

    /// By path tracing and `bdpt` alone.
    #[must_use]
    pub fn from_camera(self) -> Self {
        Self { integrators: Self::FROM_CAMERA, ..self }
    }
}

//! What runs are measured by.

use super::plan::{Backend, REFERENCE_SEEDS};
use super::run::{Built, cpu_seconds};
use super::{BenchError, machine};
use crate::compare::{Reference, ReferenceNoise};
use crate::film::Image;
use crate::integrator::{Integrator, Settings};
use crate::scene::desc::SceneDesc;

/// Samples of each half of a reference, in those of the longest run: its noise is then some 1/32 of what that run's would be
/// by the same integrator.
const MORE: u32 = 16;

/// An image that was given to measure by.
#[derive(Clone, Debug)]
pub struct Given {
    /// The image, of the runs' size.
    pub image: Image,
    /// Its file, as named on the command line.
    pub file: String,
    /// Its noise as relMSE, where it is known.
    pub noise: Option<f64>,
}

/// Where a reference comes from.
#[derive(Clone, Debug)]
pub enum ReferenceJob {
    /// A file.
    Given(Given),
    /// Two independent halves, rendered by these settings, with so many samples per pixel each, or else by the longest run.
    Made(Settings, Option<u32>),
}

/// Where the reference came from, for the report.
#[derive(Clone, Debug)]
pub enum Origin {
    /// A file.
    File(String),
    /// Two halves.
    Halves {
        /// The integrator.
        integrator: Integrator,
        /// Samples per pixel of each.
        samples: u32,
        /// Processor time of both, seconds.
        cpu_seconds: f64,
    },
}

/// A reference and all that is told of it.
#[derive(Clone, Debug)]
pub struct Measure {
    /// The image and its noise.
    pub reference: Reference,
    /// Where it came from.
    pub origin: Origin,
    /// MSE of the reference against the truth, if known.
    pub mse: Option<f64>,
    /// Its relMSE, if known.
    pub rel_mse: Option<f64>,
}

impl Measure {
    /// Reads or renders the reference. `longest` is the largest number of samples per pixel of a run.
    ///
    /// # Errors
    /// When it cannot be rendered.
    pub fn new(
        job: &ReferenceJob,
        desc: &SceneDesc,
        backend: Backend,
        longest: u32,
        tell: &mut dyn FnMut(&str),
    ) -> Result<Self, BenchError> {
        let (reference, origin) = match job {
            ReferenceJob::Given(given) => {
                let noise = given.noise.map_or(ReferenceNoise::Unknown, ReferenceNoise::RelMse);
                (Reference { image: given.image.clone(), noise }, Origin::File(given.file.clone()))
            }
            ReferenceJob::Made(settings, samples) => {
                let samples = samples.unwrap_or(longest.saturating_mul(MORE));
                tell(&format!("rendering the reference, 2 × {samples} spp"));
                // Nobody measures its time: all processors may help. Its bits do not depend on them.
                let threads = machine::Machine::this().processors;
                let start = cpu_seconds()?;
                let scene = Built::new(desc, backend, threads)?;
                let half = |seed| scene.render(Settings { seed, ..*settings }, samples, threads).map(|r| r.image);
                let [a, b] = [half(REFERENCE_SEEDS[0])?, half(REFERENCE_SEEDS[1])?];
                let cpu_seconds = cpu_seconds()? - start;
                let reference = Reference::of_halves(&a, &b).map_err(BenchError::new)?;
                (reference, Origin::Halves { integrator: settings.integrator, samples, cpu_seconds })
            }
        };
        let share = reference.share(&reference.image).map_err(BenchError::new)?;
        Ok(Self { reference, origin, mse: share.mse, rel_mse: share.rel_mse })
    }
}

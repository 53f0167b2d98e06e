//! The passes of `auto`: scout, survey, and the rest by what they have taught.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use rayon::prelude::*;

use super::{Observe, Progress, RenderError, RenderJob, Run, pool};
use crate::accel::Accel;
use crate::integrator::auto::{
    Brightness, PILOT, Plan, SCOUT, Scattering, Scout, Survey, Tally, scout, survey, undecided,
};
use crate::integrator::{Crop, Integrator, PixelSample, Recorder, SampleLoop, Settings, Thresholds};
use crate::scene::Scene;

impl Observe for Survey<'_> {
    type Seen = Tally;

    fn sample(&mut self, sample: PixelSample, recorder: &mut Recorder) {
        Survey::sample(self, sample.pixel, recorder.take_notes());
    }

    fn take(&mut self) -> Tally {
        Survey::take(self)
    }

    fn collect(tasks: impl IndexedParallelIterator<Item = Tally>) -> Vec<Tally> {
        tasks.collect()
    }
}

impl Observe for Scout {
    type Seen = Scattering;

    fn sample(&mut self, _: PixelSample, recorder: &mut Recorder) {
        Scout::sample(self, recorder.take_notes());
    }

    fn take(&mut self) -> Scattering {
        Scout::take(self)
    }

    fn collect(tasks: impl IndexedParallelIterator<Item = Scattering>) -> Vec<Scattering> {
        tasks.collect()
    }
}

impl<A: Accel> Run<'_, A> {
    /// All samples of a job that leaves the choice of techniques to its pilot.
    pub(super) fn auto(&self) -> Option<Plan> {
        let (job, scene) = (self.job, self.scene);
        let samples = job.samples;
        if let Err((lane, why)) = undecided(&job.settings, &scene.needs, Crop::full(scene.camera.resolution()).pixels())
        {
            let plan = Plan::exact(&job.settings, lane, why);
            self.pass(0..samples, || SampleLoop::new(scene, plan.settings), || ());
            return Some(plan);
        }
        let plan = if job.crop == Crop::full(scene.camera.resolution()) && samples >= PILOT {
            self.pilot()?
        } else {
            // What is learnt of the full image holds for a crop: the crop has the full image's bits. And few samples are
            // the first of many.
            let plan = match samples > SCOUT {
                true => match plan(scene, &job.settings, self.progress) {
                    None => {
                        self.stopped.store(true, Ordering::Relaxed);
                        return None;
                    }
                    plan => plan,
                },
                false => None,
            };
            let by_scout = || SampleLoop::new(scene, scout(&job.settings));
            self.pass(0..samples.min(SCOUT), by_scout, || ());
            let plan = plan?;
            self.pass(SCOUT..samples.min(PILOT), || SampleLoop::new(scene, plan.survey), || ());
            plan
        };
        if samples > PILOT {
            let loops = || SampleLoop::thrifty(scene, plan.settings, plan.thresholds.clone());
            self.pass(PILOT..samples, loops, || ());
        }
        Some(plan)
    }

    /// The pilot's samples of the full image, and the plan they make; `None` if it was stopped.
    fn pilot(&self) -> Option<Plan> {
        let settings = scout(&self.job.settings);
        let seen = self.pass(0..SCOUT, || SampleLoop::survey(self.scene, settings), Scout::default);
        let mut scattering = Scattering::default();
        seen.into_iter().for_each(|task| scattering += task);
        let brightness = Brightness::of(&self.film.resolve(u64::from(SCOUT)));
        let settings = survey(&self.job.settings, &scattering);
        let seen = self.pass(
            SCOUT..PILOT,
            || SampleLoop::survey(self.scene, settings),
            || Survey::new(&brightness, settings.heuristic),
        );
        let mut tally = Tally::default();
        seen.into_iter().for_each(|task| tally += task);
        if self.stopped.load(Ordering::Relaxed) {
            return None;
        }
        let rays = self.totals.lock().map_or_else(|e| e.into_inner().rays, |totals| totals.rays);
        Some(Plan::learnt(settings, &self.scene.needs, &brightness, &tally, &rays))
    }
}

/// The plan of a job with these settings, whatever its crop and number of samples; `None` if `progress` stopped it.
fn plan<A: Accel>(scene: &Scene<A>, settings: &Settings, progress: &(dyn Fn(Progress) -> bool + Sync)) -> Option<Plan> {
    let crop = Crop::full(scene.camera.resolution());
    let whole = RenderJob { settings: *settings, samples: PILOT, crop, threads: 0, pyramid: None };
    Run::new(scene, &whole, progress).pilot()
}

/// By what one sample of a pixel is made: settings without `Integrator::Auto`, and what its visibility rays must be worth.
/// Where the pilot has to be asked, it is run.
///
/// # Errors
/// When the threads cannot be started.
pub fn made_by<A: Accel>(
    scene: &Scene<A>,
    settings: &Settings,
    index: u32,
) -> Result<(Settings, Option<Arc<Thresholds>>), RenderError> {
    if settings.integrator != Integrator::Auto {
        return Ok((*settings, None));
    }
    if let Err((lane, why)) = undecided(settings, &scene.needs, Crop::full(scene.camera.resolution()).pixels()) {
        return Ok((Plan::exact(settings, lane, why).settings, None));
    }
    let plan = pool(0)?.install(|| plan(scene, settings, &|_| true));
    Ok(plan.map_or((scout(settings), None), |plan| plan.of_sample(settings, index)))
}

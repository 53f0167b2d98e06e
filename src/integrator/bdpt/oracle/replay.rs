//! Real samples under the judge: each path that `bdpt` has made, its contribution and its weight against those of the path's
//! vertices, multiplied out in f64.
//!
//! Unlike the judge's own paths, these carry throughputs and partial sums along as a render does: densities come from
//! sampled directions, not from the rounded points that the rays found.

use super::condition::Condition;
use super::densities::Densities;
use super::paths::{FullPath, Inner};
use super::{Fault, Faults, Judge, Structural};
use crate::accel::Accel;
use crate::camera::LensNumbers;
use crate::integrator::trace::{Arrived, Made, Step};
use crate::integrator::{Integrator, PixelSample, Recorder, SampleLoop, Settings, Technique};
use crate::light::LightPoint;
use crate::math::Vec3;

/// A path that a sample made, judged.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// How it was made.
    pub technique: Technique,
    /// Relative error of the contribution with the weight 1, in the channel in which it is largest.
    pub contribution: f64,
    /// Relative error of the weight.
    pub weight: f64,
    /// The weight multiplied out in f64.
    pub exact_weight: f64,
    /// The weighted contribution in f64, in the channel in which it is largest.
    pub value: f64,
    /// How far the densities of its edges may be off by the rounding of their ends; see `condition.rs`.
    pub condition: f64,
}

/// What came of samples' paths that were not judged.
#[derive(Clone, Debug, Default)]
pub struct Judged {
    /// Paths that carry light and that the judge cannot tell, such as those seen edge-on.
    pub untold: u64,
    /// What is wrong beyond rounding.
    pub faults: Faults,
}

/// Makes one sample of `bdpt` and judges its paths, each of which `found` is told; those that are blocked are passed over.
pub fn judge<A: Accel>(
    judge: &Judge<'_, A>,
    samples: &mut SampleLoop<'_, A>,
    sample: PixelSample,
    recorder: &mut Recorder<true>,
    out: &mut Judged,
    found: &mut impl FnMut(&Compared),
) {
    recorder.clear();
    samples.sample(sample, recorder);
    let mut walks = Walks::default();
    for step in recorder.steps() {
        if let Step::Made(made) = step {
            // What a camera ray sees of the sky has one technique, and no factors.
            let sky = made.technique == (Technique { s: 0, t: 2 }) && walks.left.is_some();
            // Visibility is asked for last: a refusal before it is judged as well.
            if sky || (made.values.is_some() && made.visible == 0.0) {
                continue;
            }
            let survival = walks.survival(made);
            let path = walks.path(made).and_then(|path| path.with_lens(judge.scene));
            match path.map(|path| compare(judge, &path, made, survival)) {
                Some(Ok(Some(compared))) => found(&compared),
                Some(Ok(None)) => {}
                Some(Err(Some(fault))) => out.faults.push(fault),
                Some(Err(None)) | None => out.untold += u64::from(made.values.is_some()),
            }
        } else {
            walks.follow(step);
        }
    }
}

/// Settings that can be judged: of `bdpt`, weighted, with one light subpath.
pub fn settings(settings: Settings) -> Settings {
    Settings { integrator: Integrator::Bdpt, weighted: true, only: None, light_paths: 1, connections: 1, ..settings }
}

/// `None` for a path that contributes nothing, or too little for an f32's digits.
///
/// # Errors
/// What is wrong; nothing where the judge cannot tell the path's densities.
fn compare<A: Accel>(
    judge: &Judge<'_, A>,
    path: &FullPath,
    made: &Made,
    survival: f64,
) -> Result<Option<Compared>, Option<Fault>> {
    let mut fault = None;
    let Some(densities) = Densities::of(judge, path, &mut fault) else { return Err(fault) };
    let s = made.technique.s as usize;
    let exact = densities.contribution(s) / survival;
    let (exact_weight, largest) = (densities.weight(s), exact.max_element());
    // By f64's numbers, not by what is to be judged.
    if largest * exact_weight <= 1e-30 || largest <= 1e-30 {
        return Ok(None);
    }
    let Some([plain, _]) = made.values else {
        let details = format!("{:?} carries {largest:.1e}", made.technique);
        return Err(Some(Fault { kind: Structural::Refused, details }));
    };
    let channel = exact.to_array().iter().position(|x| *x == largest).unwrap_or(0);
    let contribution = f64::from(plain.to_array()[channel]) / largest - 1.0;
    let weight = made.weight() / exact_weight - 1.0;
    let (condition, value) = (Condition::of(judge, path).all, largest * exact_weight);
    Ok(Some(Compared { technique: made.technique, contribution, weight, exact_weight, value, condition }))
}

/// The two walks of a sample, as far as they have come.
#[derive(Debug, Default)]
struct Walks {
    /// Where the light subpath started, its vertices from the second on, and with what probability roulette let it come to
    /// each.
    light: Option<(u32, LightPoint)>,
    light_side: Vec<Inner>,
    light_survival: Vec<f64>,
    /// The camera's numbers, once its walk has begun, and the same of it.
    camera: Option<LensNumbers>,
    camera_side: Vec<Inner>,
    camera_survival: Vec<f64>,
    /// That probability from now on.
    survival: f64,
    /// Where the camera subpath left the scene, and whether through a window.
    left: Option<(Vec3, bool)>,
    /// The last point of a light that next-event estimation has chosen.
    sampled: Option<LightPoint>,
}

impl Walks {
    fn side(&mut self) -> &mut Vec<Inner> {
        if self.camera.is_some() { &mut self.camera_side } else { &mut self.light_side }
    }

    fn follow(&mut self, step: &Step) {
        match step {
            Step::Light { light, point, .. } => (self.light, self.survival) = (Some((*light, *point)), 1.0),
            Step::Camera { lens, .. } => {
                self.camera = Some(LensNumbers { lens: *lens, pixel: [0.5; 2] });
                self.survival = 1.0;
            }
            Step::Survived(q) => self.survival *= f64::from(*q),
            Step::Arrived(Arrived { at, bsdf, light, through_window, .. }) => {
                let (at, bsdf, light, through_window) = (*at, *bsdf, *light, *through_window);
                let delta = !bsdf.is_connectible();
                self.side().push(Inner { at, bsdf, light, through_window, delta });
                let survival = self.survival;
                if self.camera.is_some() { &mut self.camera_survival } else { &mut self.light_survival }.push(survival);
            }
            Step::Scattered { delta, .. } => {
                if let Some(last) = self.side().last_mut() {
                    last.delta |= delta;
                }
            }
            Step::Left { toward, through_window } if self.camera.is_some() => {
                self.left = Some((*toward, *through_window));
            }
            Step::LightSampled { point, .. } => self.sampled = Some(*point),
            Step::Left { .. } | Step::Ended(_) | Step::Made(_) | Step::Blocked { .. } => {}
        }
    }

    /// The probability with which roulette let both subpaths come to where they were joined.
    fn survival(&self, made: &Made) -> f64 {
        let at = |all: &[f64], n: u32| n.checked_sub(2).map_or(1.0, |i| all.get(i as usize).copied().unwrap_or(1.0));
        let Technique { s, t } = made.technique;
        let camera = if s == 0 && self.left.is_some() { self.survival } else { at(&self.camera_survival, t) };
        at(&self.light_survival, s) * camera
    }

    /// The path that was made of them.
    fn path(&self, made: &Made) -> Option<FullPath> {
        let Technique { s, t } = made.technique;
        let light_side = |n: u32| self.light_side.get(..n.checked_sub(1)? as usize).map(<[Inner]>::to_vec);
        let camera_side = |n: u32| {
            let side = self.camera_side.get(..n.checked_sub(1)? as usize)?;
            Some(side.iter().rev().copied().collect::<Vec<Inner>>())
        };
        let windows = |side: &[Inner]| side.iter().map(|v| v.through_window).collect::<Vec<bool>>();
        // The joined vertices scatter by what of them is no delta, whatever the walks do next.
        let joined = |mut v: Inner| {
            v.delta = !v.bsdf.is_connectible();
            v
        };
        let path = match (s, t) {
            (0, _) => {
                let (start, first, inner) = match self.left {
                    Some((toward, window)) => (LightPoint::Infinite(toward), window, camera_side(t - 1)?),
                    None => {
                        let hit = self.camera_side.get(t as usize - 2)?;
                        (LightPoint::Surface(hit.at), hit.through_window, camera_side(t - 1)?)
                    }
                };
                let windows = [vec![first], windows(&inner)].concat();
                let (light, numbers) = (made.light?, self.camera?);
                FullPath { light, start, inner, camera: Vec3::ZERO, numbers, windows, joined: None }
            }
            (1, 2..) => {
                let mut inner = camera_side(t)?;
                let first = inner.first_mut()?;
                *first = joined(*first);
                let windows = [vec![false], windows(&inner)].concat();
                let (light, start, numbers) = (made.light?, self.sampled?, self.camera?);
                FullPath { light, start, inner, camera: Vec3::ZERO, numbers, windows, joined: Some(0) }
            }
            (_, 1) => {
                let mut inner = light_side(s)?;
                if let Some(last) = inner.last_mut() {
                    *last = joined(*last);
                }
                let windows = [windows(&inner), vec![false]].concat();
                let ((light, start), numbers) = (self.light?, made.seen?.1);
                let joined = Some(inner.len());
                FullPath { light, start, inner, camera: Vec3::ZERO, numbers, windows, joined }
            }
            _ => {
                let (mut before, mut after) = (light_side(s)?, camera_side(t)?);
                for v in before.last_mut().into_iter().chain(after.first_mut()) {
                    *v = joined(*v);
                }
                let windows = [windows(&before), vec![false], windows(&after)].concat();
                let ((light, start), numbers, joined) = (self.light?, self.camera?, Some(before.len()));
                let inner = [before, after].concat();
                FullPath { light, start, inner, camera: Vec3::ZERO, numbers, windows, joined }
            }
        };
        Some(path)
    }
}

//! Real samples under the judge: each path that `bdpt` has made, its contribution and its weight against those of the path's
//! vertices, multiplied out in f64.
//!
//! Unlike the judge's own paths, these carry throughputs and partial sums along as a render does: densities come from
//! sampled directions, not from the rounded points that the rays found.

use super::Judge;
use super::densities::Densities;
use super::paths::{FullPath, Inner};
use crate::accel::Accel;
use crate::camera::LensNumbers;
use crate::geometry::SurfacePoint;
use crate::integrator::trace::{Arrived, Made, Step};
use crate::integrator::{Integrator, PixelSample, Recorder, SampleLoop, Settings, Technique};
use crate::light::LightPoint;
use crate::math::{Vec3, distance_squared};

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
    /// How far the densities of its edges may be off by the rounding of their ends; see `condition`.
    pub condition: f64,
}

/// What came of a sample's paths.
#[derive(Clone, Debug, Default)]
pub struct Judged {
    /// Those that were judged.
    pub paths: Vec<Compared>,
    /// Paths that carry light and that the judge cannot tell, such as those seen edge-on.
    pub untold: u64,
    /// What is wrong beyond rounding with the last path that has such a fault.
    pub fault: Option<String>,
}

/// Makes one sample of `bdpt` and judges its paths; those that are blocked are passed over.
pub fn judge<A: Accel>(
    judge: &Judge<'_, A>,
    samples: &mut SampleLoop<'_, A>,
    sample: PixelSample,
    recorder: &mut Recorder<true>,
    out: &mut Judged,
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
                Some(Ok(Some(compared))) => out.paths.push(compared),
                Some(Ok(None)) => {}
                Some(Err(fault)) if !fault.is_empty() => out.fault = Some(fault),
                Some(Err(_)) | None => out.untold += u64::from(made.values.is_some()),
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
/// What is wrong; without words where the judge cannot tell the path's densities.
fn compare<A: Accel>(
    judge: &Judge<'_, A>,
    path: &FullPath,
    made: &Made,
    survival: f64,
) -> Result<Option<Compared>, String> {
    let mut fault = None;
    let Some(densities) = Densities::of(judge, path, &mut fault) else { return Err(fault.unwrap_or_default()) };
    let s = made.technique.s as usize;
    let exact = densities.contribution(s) / survival;
    let (exact_weight, largest) = (densities.weight(s), exact.max_element());
    // By f64's numbers, not by what is to be judged.
    if largest * exact_weight <= 1e-30 || largest <= 1e-30 {
        return Ok(None);
    }
    let Some([plain, _]) = made.values else {
        return Err(format!("{:?} refuses a path that carries {largest:.1e}", made.technique));
    };
    let channel = exact.to_array().iter().position(|x| *x == largest).unwrap_or(0);
    let contribution = f64::from(plain.to_array()[channel]) / largest - 1.0;
    let weight = made.weight() / exact_weight - 1.0;
    let (condition, value) = (condition(judge, path), largest * exact_weight);
    Ok(Some(Compared { technique: made.technique, contribution, weight, exact_weight, value, condition }))
}

/// Rays start off their surface by the error bound of its point, beyond which they cannot meet it again, and end on points
/// rounded to f32: the direction between the points of an edge of length d is not that of the ray, by these over d. A cosine c
/// to a surface at its end then changes by 1/c of that relatively, and the density of a lobe of roughness α by 2/α of it (the
/// slope of ln D of GGX and Beckmann is at most about that), that of a spot's directions by its slope; at a delta vertex Snell's law hands it on to the other cosine with
/// another 1/c (see `FullPath::condition`). Summed over a path's edges.
pub(super) fn condition<A: Accel>(judge: &Judge<'_, A>, path: &FullPath) -> f64 {
    let k = path.inner.len() + 1;
    let at_end = |v: usize, to: usize| match v {
        0 => 1.0 / path.start.cos(path.direction(0, 1)) + light_slope(judge, path),
        v if v == k => 1.0 + camera_slope(judge, path),
        v => {
            let inner = &path.inner[v - 1];
            let cos = f64::from(inner.at.ng.dot(path.direction(v, to)).abs());
            if inner.delta { 1.0 / (cos * cos) } else { 1.0 / cos + inner.bsdf.steepness() }
        }
    };
    let edge = |i: usize| {
        if i == 0 && matches!(path.start, LightPoint::Infinite(_)) {
            return 0.0;
        }
        let size = f64::from(path.point(i).abs().max(path.point(i + 1).abs()).max_element());
        let start =
            |at: &SurfacePoint, to: usize, v: usize| f64::from((at.origin(path.direction(v, to)) - at.p()).length());
        let starts = |v: usize, to: usize| match (v, &path.start) {
            (0, LightPoint::Surface(at)) => start(at, to, v),
            (0, _) => 0.0,
            (v, _) if v == k => 0.0,
            (v, _) => start(&path.inner[v - 1].at, to, v),
        };
        let off = f64::from(f32::EPSILON) * size + starts(i, i + 1).max(starts(i + 1, i));
        // The points' own distance: that of parallel rays' edges is 1 in the densities.
        let length = distance_squared(path.point(i), path.point(i + 1)).sqrt();
        off / length * (at_end(i, i + 1) + at_end(i + 1, i))
    };
    (0..k).map(edge).sum()
}

/// The step of differences, in radians.
const STEP: f32 = 1e-4;

/// The largest change of a density's logarithm per radian as a direction is turned by `STEP`; `None` counts for nothing.
fn slope(w: Vec3, density: f64, turned: impl Fn(Vec3) -> Option<f64>) -> f64 {
    let (a, b) = w.any_orthonormal_pair();
    let changes = [a, -a, b, -b].into_iter().filter_map(|t| Some((turned(t * STEP)? / density).ln().abs()));
    changes.fold(0.0, super::worse) / f64::from(STEP)
}

/// How fast the density of a delta light's directions changes about the first edge; without bound at a spot's rim.
fn light_slope<A: Accel>(judge: &Judge<'_, A>, path: &FullPath) -> f64 {
    if !matches!(path.start, LightPoint::Delta(_)) {
        return 0.0;
    }
    let light = &judge.scene.lights[path.light as usize];
    let w = path.direction(0, 1);
    let density = |w: Vec3| light.pdf_emission_direction(&path.start, w).0;
    slope(w, density(w), |t| Some(density((w + t).normalize())))
}

/// How fast the camera's density changes about the last edge: with a filter that reaches over the image's edge, it falls there.
fn camera_slope<A: Accel>(judge: &Judge<'_, A>, path: &FullPath) -> f64 {
    let k = path.inner.len() + 1;
    let (p, distance) = (path.point(k - 1), (path.point(k - 1) - path.camera).length());
    let density = |p: Vec3| judge.scene.camera.sample_lens(p, &path.numbers).map(|lens| lens.pdf.0);
    density(p).map_or(0.0, |here| slope(path.direction(k, k - 1), here, |t| density(p + t * distance)))
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

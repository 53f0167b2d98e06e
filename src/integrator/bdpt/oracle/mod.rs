//! The slow, obvious judge of the weights: every technique's density of a stored path, multiplied out in f64.
//!
//! Real subpaths are walked through real scenes and joined into full paths. For each path and *every* technique that
//! could make it, the production code's contribution and weight are evaluated at the same vertices, and
//!
//! - the weights must be those of the densities multiplied out, and sum to one (TESTING B7);
//! - contribution × density × count must be the same number for every technique (TESTING B6): nothing random is
//!   left in it, so that a cosine, an η² or an adjoint factor in the wrong place cannot hide behind noise.
//!
//! The densities come from the lights, the camera and the BSDFs under test: that they are the densities of what is
//! sampled is for the tests of those to show.

mod densities;
mod paths;
pub mod replay;

use densities::{Densities, Scatter};
use paths::{FullPath, random_path};

use super::connect::EmitterHit;
use super::mis::{Departure, LightStart, Mis, Partial};
use super::{Bdpt, Vertex};
use crate::accel::Accel;
use crate::bsdf::Bsdf;
use crate::geometry::SurfacePoint;
use crate::integrator::{Crop, Settings, SplatConfidence};
use crate::light::LightPoint;
use crate::math::Rgb;
use crate::scene::Scene;
use crate::scene::desc::Heuristic;

/// What both the oracle and the production code are asked about.
#[derive(Debug)]
pub struct Judge<'a, A> {
    scene: &'a Scene<A>,
    weighted: Bdpt,
    plain: Bdpt,
    heuristic: Heuristic,
    connections: f64,
    light_paths: f64,
    splat_confidence: SplatConfidence,
}

/// One technique's verdict on a path.
#[derive(Clone, Copy, Debug)]
struct Verdict {
    s: usize,
    /// The production code's weight and the oracle's.
    weight: f64,
    oracle: f64,
    /// Contribution × density × count.
    measurement: f64,
    /// Relative error of the unweighted contribution.
    contribution: f64,
}

impl<'a, A: Accel> Judge<'a, A> {
    /// For a scene, and `bdpt` with these settings.
    pub fn new(scene: &'a Scene<A>, settings: Settings) -> Self {
        let Settings { heuristic, light_paths, light_one_in, splat_confidence, .. } = settings;
        let pixels = Crop::full(scene.camera.resolution()).pixels() as f64;
        let light_paths = f64::from(light_paths) / f64::from(light_one_in) * pixels;
        let weighted = Bdpt::new(scene, settings, light_paths);
        // None are traced where they would be of no use.
        let traced = if weighted.traces_light() { light_paths } else { 0.0 };
        let plain = Bdpt::new(scene, Settings { weighted: false, ..settings }, light_paths);
        // Subpaths that are not traced are not connected to either.
        let connections = weighted.connections_per_sample;
        Self { scene, weighted, plain, heuristic, connections, light_paths: traced, splat_confidence }
    }

    /// `None` when the path carries nothing or leaves the view, and when `fault` says what is wrong with it.
    fn judge(&self, path: &FullPath, fault: &mut Option<String>) -> Option<Vec<Verdict>> {
        let scene = self.scene;
        let densities = Densities::of(self, path, fault)?;
        let Densities { k, emission, direct, pmf_emission, receiver, .. } = densities;
        let light = &scene.lights[path.light as usize];

        // The production recursion along the same vertices.
        let (light_side, camera_side) = self.subpaths(&densities);
        let mut verdicts = Vec::new();
        for s in (0..=k).filter(|&s| densities.feasible(s)) {
            let value = |b: &Bdpt| -> Option<Rgb> {
                match s {
                    0 => {
                        let Vertex { wo, beta, partial, number, .. } = camera_side(0);
                        let hit = EmitterHit { point: path.start, wo, receiver, beta, partial, number };
                        Some(b.evaluate_emitter(scene, path.light, &hit, pmf_emission).value)
                    }
                    s if s == k && k == 1 => {
                        let LightPoint::Surface(at) = &path.start else { return None };
                        b.evaluate_light_in_lens(scene, light, at, emission, &path.numbers).map(|x| x.1.value)
                    }
                    s if s == k => b.evaluate_lens(scene, &light_side(k - 1), &path.numbers).map(|x| x.1.value),
                    1 => b
                        .evaluate_next_event(scene, light, &path.start, direct, pmf_emission, &camera_side(1))
                        .map(|x| x.value),
                    s => b.evaluate_connection(&light_side(s - 1), &camera_side(s)).map(|x| x.value),
                }
            };
            let (with, without) = (value(&self.weighted)?, value(&self.plain)?);
            let (with, without) = (f64::from(with.max_element()), f64::from(without.max_element()));
            let (oracle, measure) = (densities.weight(s), densities.density(s) * densities.count(s));
            // By the factors that were multiplied out, as f64.
            let contribution = without / densities.contribution(s).max_element() - 1.0;
            verdicts.push(Verdict { s, weight: with / without, oracle, measurement: without * measure, contribution });
        }
        // Of a path that carries nothing, or more or less than f32 holds, no weight can be told by dividing.
        let held = |x: f64| (1e-30..=1e30).contains(&x);
        let carried = |v: Vertex| f64::from(v.beta.max_element());
        let measurement = verdicts.iter().map(|v| v.measurement).filter(|m| m.is_finite()).fold(0.0, f64::max);
        let all_held = (1..k).all(|i| held(carried(light_side(i))) && held(carried(camera_side(i))))
            && verdicts.iter().all(|v| held(measurement / (densities.density(v.s) * densities.count(v.s))));
        all_held.then_some(verdicts)
    }

    /// The vertices of either side with throughput and partial sums, by the production recursion.
    fn subpaths<'p>(
        &'p self,
        densities: &'p Densities<'p>,
    ) -> (impl Fn(usize) -> Vertex + 'p, impl Fn(usize) -> Vertex + 'p) {
        let Densities { path, k, le, emission, direct, direction, lens, .. } = *densities;
        let mis: Mis = self.weighted.mis;
        let light = &self.scene.lights[path.light as usize];
        let dir = |i: usize, j: usize| path.direction(i, j);
        let cos0 = path.start.cos(dir(0, 1));

        let mut lights: Vec<Vertex> = Vec::new();
        let mut beta = le * (cos0 / (emission * direction)) as f32;
        let mut departure: Option<Departure> = None;
        for i in 1..k {
            let v = &path.inner[i - 1];
            let wo = dir(i, i - 1);
            let cos = f64::from(wo.dot(v.at.ng).abs());
            let d2 = path.distance_squared(self.scene, i - 1);
            let open = !path.windows[i - 1];
            let partial = match &departure {
                None => {
                    let start = LightStart {
                        pdf_position: emission,
                        pdf_direction: direction,
                        direct_over_emission: direct / emission,
                        cos: if light.is_delta() { 0.0 } else { cos0 },
                    };
                    mis.arrive_from_light(&start, d2, cos, open)
                }
                Some(d) => mis.arrive(d, d2, cos, open),
            };
            lights.push(Vertex { at: v.at, wo, bsdf: v.bsdf, beta, partial, number: i as u32 + 1 });
            let s = densities.scatter_from_light(i);
            beta *= s.weight;
            let count = if i == 1 { mis.next_event } else { mis.connections };
            let Scatter { pdf_fwd, pdf_rev, cos_out, delta, .. } = s;
            departure = Some(Departure { partial, count, splats: 0.0, cos: cos_out, pdf_fwd, pdf_rev, delta });
        }

        // Camera side, down to vertex 0 when the light is a surface.
        let mut cameras: Vec<Option<Vertex>> = vec![None; k + 1];
        let mut beta = Rgb::ONE;
        let mut departure: Option<Departure> = None;
        for i in (0..k).rev() {
            let (at, bsdf) = match (i, &path.start) {
                (0, LightPoint::Surface(at)) => (*at, Bsdf::Black),
                // The vertex stands for a point at infinity: of its place only the cosine is asked for, 1.
                (0, LightPoint::Infinite(toward)) => (SurfacePoint { ng: *toward, ..path.inner[0].at }, Bsdf::Black),
                (0, LightPoint::Delta(_)) => break,
                (i, _) => (path.inner[i - 1].at, path.inner[i - 1].bsdf),
            };
            let wo = dir(i, i + 1);
            let cos = if i == 0 { path.start.cos(wo) } else { f64::from(wo.dot(at.ng).abs()) };
            let d2 = path.distance_squared(self.scene, i);
            let open = !path.windows[i];
            let partial: Partial = match &departure {
                None => mis.arrive_from_camera(lens.pdf.0, d2, cos, open),
                Some(d) => mis.arrive(d, d2, cos, open),
            };
            let number = (k - i) as u32 + 1;
            cameras[i] = Some(Vertex { at, wo, bsdf, beta, partial, number });
            if i == 0 {
                break;
            }
            let s = densities.scatter_from_camera(i);
            beta *= s.weight;
            let [count, splats] = mis.counts_at_camera_vertex(number);
            let Scatter { pdf_fwd, pdf_rev, cos_out, delta, .. } = s;
            departure = Some(Departure { partial, count, splats, cos: cos_out, pdf_fwd, pdf_rev, delta });
        }
        (move |i: usize| lights[i - 1], move |i: usize| cameras[i].expect("asked for a vertex that exists"))
    }
}

/// What was seen over many paths.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// How many there were.
    pub paths: u64,
    techniques: u64,
    with_delta: u64,
    techniques_with_delta: u64,
    /// Techniques whose identity is off by more than 1e-4 next to a delta vertex.
    tail: u64,
    /// The largest |Σw − 1|.
    pub worst_sum: f64,
    /// The largest deviation of a weight from the oracle's, over that plus 10⁻⁶.
    pub worst_weight: f64,
    /// The same over what rounding the path's points may do, where it is more than 10⁻⁴.
    pub worst_weight_over_condition: f64,
    /// The largest relative error of an unweighted contribution.
    pub worst_contribution: f64,
    worst_identity: f64,
    /// Over the tail: the largest deviation, the largest condition, the largest ratio of the one to the other.
    worst_tail: f64,
    worst_condition: f64,
    worst_ratio: f64,
    /// Paths on which a mixture scattered by its delta lobe; with an edge through a cut-out surface.
    mixtures: u64,
    thinned: u64,
    /// Paths with an edge that was walked along and is not seen along, or not alike from both ends.
    blocked: u64,
    /// What is wrong with the first path that is.
    pub failure: Option<String>,
}

/// The larger of two deviations; a NaN, which `f64::max` would pass over, is larger than all.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

impl Seen {
    /// Looks at the path of this number.
    pub fn path<A: Accel>(judge: &Judge<'_, A>, index: u32) -> Self {
        let mut seen = Self::default();
        let Some(path) = random_path(judge.scene, index) else { return seen };
        let mut fault = None;
        let Some(verdicts) = judge.judge(&path, &mut fault) else {
            seen.failure = fault.map(|fault| format!("{fault}, on {path:?}"));
            return seen;
        };
        if verdicts.is_empty() {
            return seen;
        }
        let delta = path.inner.iter().any(|v| v.delta);
        seen.paths = 1;
        seen.techniques = verdicts.len() as u64;
        seen.with_delta = u64::from(delta);
        seen.techniques_with_delta = if delta { seen.techniques } else { 0 };
        let mut require = |holds: bool, what: &str| {
            if !holds && seen.failure.is_none() {
                seen.failure = Some(format!("{what}: {verdicts:?} on {path:?}"));
            }
        };
        let oracle_sum: f64 = verdicts.iter().map(|v| v.oracle).sum();
        require((oracle_sum - 1.0).abs() < 1e-9, "the oracle's weights do not sum to 1");
        let sum: f64 = verdicts.iter().map(|v| v.weight).sum();
        seen.worst_sum = (sum - 1.0).abs();
        require(seen.worst_sum < 1e-4, "the weights do not sum to 1");
        seen.mixtures = u64::from(path.inner.iter().any(|v| v.delta && v.bsdf.is_connectible()));
        let visibilities = path.visibilities(judge.scene);
        seen.thinned = u64::from(visibilities.iter().flatten().any(|x| 0.0 < *x && *x < 1.0));
        seen.blocked =
            u64::from(visibilities.iter().any(|[a, b]| *a == 0.0 || *b == 0.0 || (a / b - 1.0).abs() > 1e-4));
        for v in &verdicts {
            let off = (v.weight - v.oracle).abs() / (v.oracle + 1e-6);
            seen.worst_weight = worse(seen.worst_weight, off);
            if off.is_nan() || off >= 1e-4 {
                let condition = replay::condition(judge, &path);
                seen.worst_weight_over_condition = worse(seen.worst_weight_over_condition, off / condition);
            }
            require(off < 1e-4, "a weight differs from the oracle's");
            seen.worst_contribution = worse(seen.worst_contribution, v.contribution.abs());
            require(v.contribution.abs() < 1e-5, "a contribution is not the product of its factors");
            // The stored points around a delta vertex are a rounding away from Snell's law: the cosines there are off
            // by that rounding over the edge's length and the cosine. Everywhere else the identity holds to rounding.
            let spread = (v.measurement / verdicts[0].measurement - 1.0).abs();
            if delta && spread >= 1e-4 {
                let condition = path.condition(judge.scene);
                seen.tail += 1;
                seen.worst_tail = worse(seen.worst_tail, spread);
                seen.worst_condition = worse(seen.worst_condition, condition);
                seen.worst_ratio = worse(seen.worst_ratio, spread / condition);
                require(spread < 2.0 * condition, "techniques measure differently");
            } else {
                seen.worst_identity = worse(seen.worst_identity, spread);
                require(spread < 1e-4, "techniques measure differently");
            }
        }
        seen
    }

    /// Both together.
    #[must_use]
    pub fn merge(self, o: Self) -> Self {
        Self {
            paths: self.paths + o.paths,
            techniques: self.techniques + o.techniques,
            with_delta: self.with_delta + o.with_delta,
            techniques_with_delta: self.techniques_with_delta + o.techniques_with_delta,
            tail: self.tail + o.tail,
            worst_sum: worse(self.worst_sum, o.worst_sum),
            worst_weight: worse(self.worst_weight, o.worst_weight),
            worst_weight_over_condition: worse(self.worst_weight_over_condition, o.worst_weight_over_condition),
            worst_contribution: worse(self.worst_contribution, o.worst_contribution),
            worst_identity: worse(self.worst_identity, o.worst_identity),
            worst_tail: worse(self.worst_tail, o.worst_tail),
            worst_condition: worse(self.worst_condition, o.worst_condition),
            worst_ratio: worse(self.worst_ratio, o.worst_ratio),
            mixtures: self.mixtures + o.mixtures,
            thinned: self.thinned + o.thinned,
            blocked: self.blocked + o.blocked,
            // Of two faults the one that cannot be told in numbers.
            failure: if o.worst_sum.is_nan() { o.failure.or(self.failure) } else { self.failure.or(o.failure) },
        }
    }
}

#[cfg(test)]
mod tests;

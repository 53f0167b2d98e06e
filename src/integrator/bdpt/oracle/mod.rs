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

mod condition;
mod densities;
mod fault;
mod paths;
pub mod replay;
mod seen;

pub use fault::{Fault, Faults, Structural};
pub use seen::{Seen, worse};

use densities::{Densities, Scatter};
use paths::FullPath;

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
        let Settings { heuristic, light_paths, connections, light_one_in, splat_confidence, .. } = settings;
        let pixels = Crop::full(scene.camera.resolution()).pixels() as f64;
        let per_pass = f64::from(light_paths) / f64::from(light_one_in) * pixels;
        let weighted = Bdpt::new(scene, settings, per_pass);
        // None are traced where they would be of no use.
        let traced = if weighted.traces_light() { per_pass } else { 0.0 };
        let plain = Bdpt::new(scene, Settings { weighted: false, ..settings }, per_pass);
        // Subpaths that are not traced are not connected to either.
        let connections = if traced > 0.0 { f64::from(connections.min(light_paths)) } else { 0.0 };
        let connections = connections / f64::from(light_one_in);
        Self { scene, weighted, plain, heuristic, connections, light_paths: traced, splat_confidence }
    }

    /// `None` when the path carries nothing or leaves the view, and when `fault` says what is wrong with it.
    fn judge(&self, path: &FullPath, fault: &mut Option<Fault>) -> Option<Vec<Verdict>> {
        let scene = self.scene;
        let densities = Densities::of(self, path, fault)?;
        let Densities { k, emission, direct, pmf_emission, receiver, .. } = densities;
        let light = &scene.lights[path.light as usize];

        // The production recursion along the same vertices.
        let (light_side, camera_side) = self.subpaths(&densities);
        // Of a path that carries nothing, or more or less than f32 holds, no weight can be told by dividing.
        let held = |x: f64| (1e-30..=1e30).contains(&x);
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
            let (oracle, measure) = (densities.weight(s), densities.density(s) * densities.count(s));
            // By the factors that were multiplied out, as f64.
            let exact = densities.contribution(s).max_element();
            let (Some(with), Some(without)) = (value(&self.weighted), value(&self.plain)) else {
                if held(exact) {
                    *fault = Some(Fault { kind: Structural::Refused, details: format!("s = {s} carries {exact:.1e}") });
                }
                return None;
            };
            let (with, without) = (f64::from(with.max_element()), f64::from(without.max_element()));
            let contribution = without / exact - 1.0;
            verdicts.push(Verdict { s, weight: with / without, oracle, measurement: without * measure, contribution });
        }
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

#[cfg(test)]
mod tests;

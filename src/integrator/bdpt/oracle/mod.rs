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

mod paths;

use paths::{FullPath, Inner, random_path};

use super::connect::EmitterHit;
use super::mis::{Departure, LightStart, Mis, Partial};
use super::{Bdpt, Vertex};
use crate::accel::Accel;
use crate::bsdf::{Bsdf, Transport};
use crate::camera::CameraSample;
use crate::geometry::SurfacePoint;
use crate::integrator::{Crop, Settings};
use crate::light::{LightPoint, Receiver};
use crate::math::{Rgb, Vec3};
use crate::scene::Scene;
use crate::scene::desc::Heuristic;

/// What one direction of travel makes of a scattering vertex.
#[derive(Clone, Copy, Debug)]
struct Scatter {
    weight: Rgb,
    pdf_fwd: f64,
    pdf_rev: f64,
    cos_out: f64,
    delta: bool,
}

/// The BSDF between given directions: evaluated, or for delta lobes sampled anew (of lacquer the coat, which reflects).
fn scatter(v: &Inner, to_previous: Vec3, to_next: Vec3, transport: Transport) -> Option<Scatter> {
    let cos_out = f64::from(to_next.dot(v.at.ng).abs());
    if !v.delta {
        let value = v.bsdf.eval(&v.at, to_previous, to_next, transport)?;
        let pdf_fwd = f64::from(value.pdf_fwd.0);
        return Some(Scatter {
            weight: value.f / value.pdf_fwd.0,
            pdf_fwd,
            pdf_rev: f64::from(value.pdf_rev.0),
            cos_out,
            delta: false,
        });
    }
    let lobe = if to_previous.dot(v.at.ng) * to_next.dot(v.at.ng) > 0.0 { 0.0 } else { 1.0 - 0.5 * f32::EPSILON };
    let s = v.bsdf.sample(&v.at, to_previous, lobe, [0.5, 0.5], transport)?;
    (s.wi.dot(to_next) > 1.0 - 1e-5).then_some(Scatter {
        weight: s.weight,
        pdf_fwd: f64::from(s.pdf_fwd.0),
        pdf_rev: f64::from(s.pdf_rev.0),
        cos_out,
        delta: true,
    })
}

/// Whether the facets of a rough interface that refract one direction into the other are seen nearly edge-on. The cosine is
/// then a difference of numbers near 1, of which f32 keeps few digits, and it is a factor of every density.
fn facet_edge_on(v: &Inner, a: Vec3, b: Vec3) -> bool {
    let Bsdf::RoughDielectric(interface) = v.bsdf else { return false };
    let [sa, sb] = [a, b].map(|w| w.dot(v.at.ng));
    if sa * sb > 0.0 {
        return false;
    }
    let eta = |side: f32| if side > 0.0 { 1.0 } else { interface.ior };
    let half = (a * eta(sa) + b * eta(sb)).normalize();
    half.dot(a).abs().min(half.dot(b).abs()) < 0.02
}

/// What both the oracle and the production code are asked about.
#[derive(Debug)]
pub struct Judge<'a, A> {
    scene: &'a Scene<A>,
    weighted: Bdpt,
    plain: Bdpt,
    heuristic: Heuristic,
    connections: f64,
    light_paths: f64,
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
}

impl<'a, A: Accel> Judge<'a, A> {
    /// For a scene, and `bdpt` with these settings.
    pub fn new(scene: &'a Scene<A>, settings: Settings) -> Self {
        let Settings { heuristic, light_paths, .. } = settings;
        let light_paths = f64::from(light_paths) * Crop::full(scene.camera.resolution()).pixels() as f64;
        let weighted = Bdpt::new(scene, settings, light_paths);
        // None are traced where they would be of no use.
        let traced = if weighted.traces_light() { light_paths } else { 0.0 };
        let plain = Bdpt::new(scene, Settings { weighted: false, ..settings }, light_paths);
        // Subpaths that are not traced are not connected to either.
        let connections = f64::from(weighted.connections);
        Self { scene, weighted, plain, heuristic, connections, light_paths: traced }
    }

    /// `None` when the path carries nothing or leaves the view, and when `fault` says what is wrong with it.
    fn judge(&self, path: &FullPath, fault: &mut Option<String>) -> Option<Vec<Verdict>> {
        let scene = self.scene;
        let k = path.inner.len() + 1; // the camera's index
        let light = &scene.lights[path.light as usize];
        let choice = scene.light_choice.as_ref()?;
        // The lens point is the path's own; that of parallel rays follows from the vertex they see.
        let lens = path.lens(scene)?;
        let p = |i: usize| path.point(i);
        let dir = |i: usize, j: usize| path.direction(i, j);
        let d2 = |i: usize| path.distance_squared(scene, i); // edge i, i+1
        let cos_in = |i: usize, from: usize| match i {
            0 => path.start.cos(dir(0, from)),
            i => f64::from(path.inner[i - 1].at.ng.dot(dir(i, from)).abs()),
        };
        if light.is_infinite() && k == 1 {
            return None; // Seen directly; no other technique makes that path.
        }
        let le = light.emitted(&path.start, dir(0, 1));
        if le == Rgb::ZERO {
            return None;
        }
        // Joined points of one plane see each other edge-on; visibility, left out here, excludes them.
        if (0..k).any(|i| (i > 0 && cos_in(i, i - 1) < 1e-6) || cos_in(i, i + 1) < 1e-6) {
            return None;
        }
        if (1..k).any(|i| facet_edge_on(&path.inner[i - 1], dir(i, i - 1), dir(i, i + 1))) {
            return None;
        }
        let geometry = &scene.geometry;
        let pmf_emission = choice.pmf_emission(path.light);
        let emission = (light.pdf_emission_position(geometry, &path.start) * pmf_emission).0;
        // Nobody asks for light at the camera: (1,1) starts by emission.
        let receiver = match path.inner.first() {
            Some(v) => Receiver::new(&v.at, dir(1, 0), v.bsdf.transmits()),
            None => Receiver::anywhere(p(1)),
        };
        let direct = scene.pdf_direct(&receiver, path.light, &path.start).0;
        let direction = light.pdf_emission_direction(&path.start, dir(0, 1)).0;

        // Scattering in both directions of travel; index 0 unused.
        let mut from_light: Vec<Option<Scatter>> = vec![None];
        let mut from_camera: Vec<Option<Scatter>> = vec![None];
        for i in 1..k {
            let v = &path.inner[i - 1];
            let (back, forth) = (dir(i, i - 1), dir(i, i + 1));
            let outwards = scatter(v, back, forth, Transport::Importance)?;
            let mut inwards = scatter(v, forth, back, Transport::Radiance)?;
            if !v.delta {
                // The same bits, but for refraction by facets: their half vectors are scaled by η one way, by 1/η the other.
                // Of a lobe of width α the density changes by 2/α of what the half vector's direction is off.
                let off = match v.bsdf {
                    Bsdf::RoughDielectric(b) => {
                        let alpha = f64::from(b.roughness.alpha[0].min(b.roughness.alpha[1]));
                        1e-5_f64.max(1e-6 / alpha) * f64::from(b.ior.max(1.0 / b.ior))
                    }
                    _ => 0.0,
                };
                let same = |a: f64, b: f64| a == b || (a / b - 1.0).abs() < off;
                let holds = same(outwards.pdf_fwd, inwards.pdf_rev) && same(outwards.pdf_rev, inwards.pdf_fwd);
                if !holds {
                    *fault = Some(format!("densities at a vertex: {outwards:?} {inwards:?}"));
                    return None;
                }
            } else {
                // Both walks must give the lobe the same ratio of densities. Sampled anew, each follows Snell's law
                // from its own rounding, which grazing refraction magnifies: one of the two serves as the stored one.
                let ratio = outwards.pdf_rev * inwards.pdf_rev / (outwards.pdf_fwd * inwards.pdf_fwd);
                if (ratio - 1.0).abs() >= 2e-2 {
                    // Nearly along the interface, or what bends to be it, the two have no digit in common.
                    let along = |w: Vec3| w.dot(v.at.ng).abs().min(w.dot(v.at.ns).abs()) < 1e-2;
                    if along(back) || along(forth) {
                        return None;
                    }
                    *fault = Some(format!("densities of a delta lobe: {outwards:?} {inwards:?}"));
                    return None;
                }
                (inwards.pdf_fwd, inwards.pdf_rev) = (outwards.pdf_rev, outwards.pdf_fwd);
            }
            from_light.push(Some(outwards));
            from_camera.push(Some(inwards));
        }
        let fl = |i: usize| from_light[i].expect("filled above");
        let fc = |i: usize| from_camera[i].expect("filled above");

        // Densities per area of vertex i from either side, multiplied out in f64. At a delta vertex both are counted
        // in the light walk's units, as `BsdfSample::pdf_rev` says.
        let forward = |i: usize| {
            let w = if i == 1 { direction } else { fl(i - 1).pdf_fwd };
            w * cos_in(i, i - 1) / d2(i - 1)
        };
        let backward = |i: usize| {
            let w = if i == k - 1 { lens.pdf.0 } else { fc(i + 1).pdf_fwd };
            w * cos_in(i, i + 1) / d2(i)
        };
        // Light arrives along this path: next-event estimation must have a chance to find it, whatever the choice of the light
        // knows of receivers. Its bounds are good to a rounding at grazing angles.
        if k > 1 && !path.windows[0] && !path.inner[0].delta {
            let grazing = cos_in(1, 0) < 1e-4 || path.start.cos(dir(0, 1)) < 1e-4;
            if direct == 0.0 {
                if !grazing {
                    *fault = Some("the choice of the light misses what shines on the receiver".to_owned());
                }
                return None;
            }
        }
        let density = |s: usize| {
            let mut product = 1.0;
            for i in 0..k {
                product *= match i {
                    0 if s == 0 => backward(0),
                    0 if s == 1 && k > 1 => direct,
                    0 => emission,
                    i if i < s => forward(i),
                    i => backward(i),
                };
            }
            product
        };
        let connectible = |i: usize| i == 0 || i == k || !path.inner[i - 1].delta;
        let feasible = |s: usize| match s {
            0 => !light.is_delta(),
            s if s == k && k == 1 => !light.is_delta() && !path.windows[0],
            s => connectible(s - 1) && connectible(s) && !path.windows[s - 1],
        };
        let count = |s: usize| match s {
            s if s == k => self.light_paths,
            0 | 1 => 1.0,
            _ => self.connections,
        };
        let feasible = |s: usize| feasible(s) && count(s) > 0.0;
        let terms: Vec<f64> = (0..=k)
            .map(|s| {
                let x = if feasible(s) { density(s) * count(s) } else { 0.0 };
                match self.heuristic {
                    Heuristic::Power => x * x,
                    Heuristic::Balance => x,
                    Heuristic::Uniform => f64::from(u8::from(x > 0.0)),
                }
            })
            .collect();
        let total: f64 = terms.iter().sum();

        // The production recursion along the same vertices.
        let (light_side, camera_side) = self.subpaths(path, k, le, emission, direct, direction, &lens, &fl, &fc);
        let mut verdicts = Vec::new();
        for s in (0..=k).filter(|&s| feasible(s)) {
            let value = |b: &Bdpt| -> Option<Rgb> {
                match s {
                    0 => {
                        let Vertex { wo, beta, partial, number, .. } = camera_side(0);
                        let hit = EmitterHit { point: path.start, wo, receiver, beta, partial, number };
                        Some(b.evaluate_emitter(scene, path.light, &hit, pmf_emission))
                    }
                    s if s == k && k == 1 => {
                        let LightPoint::Surface(at) = &path.start else { return None };
                        b.evaluate_light_in_lens(scene, light, at, emission, &path.numbers).map(|x| x.1)
                    }
                    s if s == k => b.evaluate_lens(scene, &light_side(k - 1), &path.numbers).map(|x| x.1),
                    1 => b.evaluate_next_event(scene, light, &path.start, direct, pmf_emission, &camera_side(1)),
                    s => b.evaluate_connection(&light_side(s - 1), &camera_side(s)),
                }
            };
            let (with, without) = (value(&self.weighted)?, value(&self.plain)?);
            let (with, without) = (f64::from(with.max_element()), f64::from(without.max_element()));
            let oracle = terms[s] / total;
            verdicts.push(Verdict { s, weight: with / without, oracle, measurement: without * density(s) * count(s) });
        }
        // Of a path that carries nothing, or more or less than f32 holds, no weight can be told by dividing.
        let held = |x: f64| (1e-30..=1e30).contains(&x);
        let carried = |v: Vertex| f64::from(v.beta.max_element());
        let measurement = verdicts.iter().map(|v| v.measurement).filter(|m| m.is_finite()).fold(0.0, f64::max);
        let all_held = (1..k).all(|i| held(carried(light_side(i))) && held(carried(camera_side(i))))
            && verdicts.iter().all(|v| held(measurement / (density(v.s) * count(v.s))));
        all_held.then_some(verdicts)
    }

    /// The vertices of either side with throughput and partial sums, by the production recursion.
    #[allow(clippy::too_many_arguments, clippy::type_complexity)] // one caller; a struct would only rename them
    fn subpaths<'p>(
        &'p self,
        path: &'p FullPath,
        k: usize,
        le: Rgb,
        emission: f64,
        direct: f64,
        direction: f64,
        lens: &CameraSample,
        fl: &dyn Fn(usize) -> Scatter,
        fc: &dyn Fn(usize) -> Scatter,
    ) -> (impl Fn(usize) -> Vertex + 'p, impl Fn(usize) -> Vertex + 'p) {
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
            let s = fl(i);
            beta *= s.weight;
            let count = if i == 1 { mis.next_event } else { mis.connections };
            let Scatter { pdf_fwd, pdf_rev, cos_out, delta, .. } = s;
            departure = Some(Departure { partial, count, cos: cos_out, pdf_fwd, pdf_rev, delta });
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
            let s = fc(i);
            beta *= s.weight;
            let count = if number == 2 { mis.light_paths } else { mis.connections };
            let Scatter { pdf_fwd, pdf_rev, cos_out, delta, .. } = s;
            departure = Some(Departure { partial, count, cos: cos_out, pdf_fwd, pdf_rev, delta });
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
fn worse(a: f64, b: f64) -> f64 {
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
            require(off < 1e-4, "a weight differs from the oracle's");
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

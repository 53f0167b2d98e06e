//! A path's densities by every technique, and what it contributes by each, multiplied out in f64.

use super::paths::{FullPath, Inner};
use super::{Fault, Judge, Structural};
use crate::accel::Accel;
use crate::bsdf::{Bsdf, Transport};
use crate::camera::CameraSample;
use crate::light::Receiver;
use crate::math::{DVec3, Rgb, Vec3};
use crate::pdf::Pmf;
use crate::scene::desc::Heuristic;

/// What one direction of travel makes of a scattering vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatter {
    /// BSDF × cosine, with what the transport adds, over `pdf_fwd`: what a throughput is multiplied by.
    pub weight: Rgb,
    /// Density with which the walk goes on to the next vertex, per solid angle of that direction; of a delta lobe its
    /// probability.
    pub pdf_fwd: f64,
    /// The same the other way, per solid angle of the direction to the vertex before; of a delta lobe its probability times the
    /// ratio of solid angles dωi/dωo, as `BsdfSample::pdf_rev` says.
    pub pdf_rev: f64,
    /// |cosine| between the geometric normal and the direction to the next vertex.
    pub cos_out: f64,
    /// Whether the lobe is a delta.
    pub delta: bool,
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

/// A path with all that its densities are made of. Vertex 0 is the light's, vertex `k` the camera's.
#[derive(Debug)]
pub(super) struct Densities<'p> {
    pub path: &'p FullPath,
    /// Number of edges.
    pub k: usize,
    /// What the light emits along the first edge: radiance, intensity of a point or spot, irradiance of a direction.
    pub le: Rgb,
    /// Density of the light and of its point by emission, per area of the light; of a delta light the probability of its choice
    /// (its place has the unit mass). Of a light at infinity it is the direction that stands for the point: per solid angle, or
    /// that probability alone.
    pub emission: f64,
    /// The same by next-event estimation from the first vertex, in the same measure.
    pub direct: f64,
    /// Density of the first direction by emission, the point being given: per solid angle. Of a light at infinity that of the
    /// edge's place, per area across its direction.
    pub direction: f64,
    /// Probability of the light's choice for emission.
    pub pmf_emission: Pmf,
    /// The first vertex, as next-event estimation sees it.
    pub receiver: Receiver,
    pub lens: CameraSample,
    /// By vertex; none of the ends.
    from_light: Vec<Option<Scatter>>,
    from_camera: Vec<Option<Scatter>>,
    /// Squared lengths by edge, 1 where it does not count.
    d2: Vec<f64>,
    /// |cosines| at the first and the second end of each edge.
    cos: Vec<[f64; 2]>,
    delta_light: bool,
    connections: f64,
    light_paths: f64,
    /// `h(n p)` by number of light vertices, 0 where a technique cannot make the path.
    terms: Vec<f64>,
}

impl<'p> Densities<'p> {
    /// `None` when the path carries nothing or leaves the view, and when `fault` says what is wrong with it.
    pub fn of<A: Accel>(judge: &Judge<'_, A>, path: &'p FullPath, fault: &mut Option<Fault>) -> Option<Self> {
        let scene = judge.scene;
        let k = path.inner.len() + 1;
        let light = &scene.lights[path.light as usize];
        let choice = scene.light_choice.as_ref()?;
        // The lens point is the path's own; that of parallel rays follows from the vertex they see.
        let lens = path.lens(scene)?;
        let dir = |i: usize, j: usize| path.direction(i, j);
        if light.is_infinite() && k == 1 {
            return None; // Seen directly; no other technique makes that path.
        }
        let le = light.emitted(&path.start, dir(0, 1));
        if le == Rgb::ZERO {
            return None;
        }
        let cos_in = |i: usize, from: usize| match i {
            0 => path.start.cos(dir(0, from)),
            i if i == k => 1.0,
            i => f64::from(path.inner[i - 1].at.ng.dot(dir(i, from)).abs()),
        };
        let cos: Vec<[f64; 2]> = (0..k).map(|i| [cos_in(i, i + 1), cos_in(i + 1, i)]).collect();
        // Joined points of one plane see each other edge-on; visibility, left out here, excludes them.
        if cos.iter().flatten().any(|c| *c < 1e-6) {
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
            None => Receiver::anywhere(path.point(1)),
        };
        let direct = scene.pdf_direct(&receiver, path.light, &path.start).0;
        let direction = light.pdf_emission_direction(&path.start, dir(0, 1)).0;
        // Light arrives along this path: next-event estimation must have a chance to find it, whatever the choice of the
        // light knows of receivers. Its bounds are good to a rounding at grazing angles.
        let next_event = k > 1 && !path.windows[0] && !path.inner[0].delta;
        let (mut from_light, mut from_camera) = (vec![None], vec![None]);
        for i in 1..k {
            let [outwards, inwards] = both_ways(&path.inner[i - 1], dir(i, i - 1), dir(i, i + 1), fault)?;
            from_light.push(Some(outwards));
            from_camera.push(Some(inwards));
        }
        if next_event && direct == 0.0 {
            if cos[0][0] >= 1e-4 && cos[0][1] >= 1e-4 {
                *fault = Some(Fault { kind: Structural::LightMissed, details: String::new() });
            }
            return None;
        }
        let d2 = (0..k).map(|i| path.distance_squared(scene, i)).collect();
        let (delta_light, terms) = (light.is_delta(), Vec::new());
        let (connections, light_paths) = (judge.connections, judge.light_paths);
        let mut densities = Self {
            path,
            k,
            le,
            emission,
            direct,
            direction,
            pmf_emission,
            receiver,
            lens,
            from_light,
            from_camera,
            d2,
            cos,
            delta_light,
            connections,
            light_paths,
            terms,
        };
        let term = |s: usize| {
            // Splats count in the weights by how far they are trusted.
            let trust = if s == k { judge.splat_confidence.on(k as u32) } else { 1.0 };
            let x = if densities.feasible(s) { densities.density(s) * densities.count(s) * trust } else { 0.0 };
            match judge.heuristic {
                Heuristic::Power => x * x,
                Heuristic::Balance => x,
                Heuristic::Uniform => f64::from(u8::from(x > 0.0)),
            }
        };
        densities.terms = (0..=k).map(term).collect();
        Some(densities)
    }

    /// What vertex `i`, between the ends, makes of light that comes from the light.
    pub fn scatter_from_light(&self, i: usize) -> Scatter {
        self.from_light[i].expect("an inner vertex")
    }

    /// The same toward the light.
    pub fn scatter_from_camera(&self, i: usize) -> Scatter {
        self.from_camera[i].expect("an inner vertex")
    }

    /// Density per area of vertex `i` from the light's side. At a delta vertex both sides are counted in the light walk's
    /// units, as `BsdfSample::pdf_rev` says.
    fn forward(&self, i: usize) -> f64 {
        let w = if i == 1 { self.direction } else { self.scatter_from_light(i - 1).pdf_fwd };
        w * self.cos[i - 1][1] / self.d2[i - 1]
    }

    /// Density per area of vertex `i` from the camera's side.
    fn backward(&self, i: usize) -> f64 {
        let w = if i == self.k - 1 { self.lens.pdf.0 } else { self.scatter_from_camera(i + 1).pdf_fwd };
        w * self.cos[i][0] / self.d2[i]
    }

    /// Density of the path by the technique with `s` light vertices.
    pub fn density(&self, s: usize) -> f64 {
        let factor = |i: usize| match i {
            0 if s == 0 => self.backward(0),
            0 if s == 1 && self.k > 1 => self.direct,
            0 => self.emission,
            i if i < s => self.forward(i),
            i => self.backward(i),
        };
        (0..self.k).map(factor).product()
    }

    /// Whether that technique can make the path.
    pub fn feasible(&self, s: usize) -> bool {
        let connectible = |i: usize| i == 0 || i == self.k || !self.path.inner[i - 1].delta;
        let open = match s {
            0 => !self.delta_light,
            s if s == self.k && self.k == 1 => !self.delta_light && !self.path.windows[0],
            s => connectible(s - 1) && connectible(s) && !self.path.windows[s - 1],
        };
        open && self.count(s) > 0.0
    }

    /// How many samples it takes.
    pub fn count(&self, s: usize) -> f64 {
        match s {
            s if s == self.k => self.light_paths,
            0 | 1 => 1.0,
            _ => self.connections,
        }
    }

    /// Its weight.
    pub fn weight(&self, s: usize) -> f64 {
        self.terms[s] / self.terms.iter().sum::<f64>()
    }

    /// What it contributes with the weight 1, visibility left out.
    pub fn contribution(&self, s: usize) -> DVec3 {
        let le = self.le.as_dvec3();
        let f = |scatter: Scatter| scatter.weight.as_dvec3() * scatter.pdf_fwd;
        // Throughputs up to a vertex, its own scattering left out.
        let light_side = |i: usize| -> DVec3 {
            let scattered: DVec3 = (1..i).map(|j| self.scatter_from_light(j).weight.as_dvec3()).product();
            scattered * le * self.cos[0][0] / (self.emission * self.direction)
        };
        let camera_side =
            |i: usize| -> DVec3 { (i + 1..self.k).map(|j| self.scatter_from_camera(j).weight.as_dvec3()).product() };
        let value = match s {
            0 => le * camera_side(0),
            s if s == self.k && s == 1 => le * (self.cos[0][0] * self.lens.pdf.0 / (self.emission * self.d2[0])),
            s if s == self.k => {
                light_side(s - 1) * f(self.scatter_from_light(s - 1)) * (self.lens.pdf.0 / self.d2[s - 1])
            }
            1 => camera_side(1) * f(self.scatter_from_camera(1)) * le * (self.cos[0][0] / (self.direct * self.d2[0])),
            s => {
                let joined = f(self.scatter_from_light(s - 1)) * f(self.scatter_from_camera(s)) / self.d2[s - 1];
                light_side(s - 1) * joined * camera_side(s)
            }
        };
        value / self.count(s)
    }
}

/// Scattering at a vertex in both directions of travel, from the light and from the camera.
fn both_ways(v: &Inner, back: Vec3, forth: Vec3, fault: &mut Option<Fault>) -> Option<[Scatter; 2]> {
    let outwards = scatter(v, back, forth, Transport::Importance)?;
    let mut inwards = scatter(v, forth, back, Transport::Radiance)?;
    if !v.delta {
        // The same bits, but for refraction by facets: their half vectors are scaled by η one way, by 1/η the other.
        // These are half vectors with other roundings: the density changes by its steepness times those.
        let off = match v.bsdf {
            Bsdf::RoughDielectric(_) => {
                let steepness = v.bsdf.steepness(&v.at, back, forth).max(v.bsdf.steepness(&v.at, forth, back));
                1e-5_f64.max(2.0 * f64::from(f32::EPSILON) * steepness)
            }
            _ => 0.0,
        };
        let same = |a: f64, b: f64| a == b || (a / b - 1.0).abs() < off;
        let holds = same(outwards.pdf_fwd, inwards.pdf_rev) && same(outwards.pdf_rev, inwards.pdf_fwd);
        if !holds {
            let details = format!("{outwards:?} {inwards:?}");
            *fault = Some(Fault { kind: Structural::Densities, details });
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
            let details = format!("{outwards:?} {inwards:?}");
            *fault = Some(Fault { kind: Structural::DeltaDensities, details });
            return None;
        }
        (inwards.pdf_fwd, inwards.pdf_rev) = (outwards.pdf_rev, outwards.pdf_fwd);
    }
    Some([outwards, inwards])
}

//! The four ways of joining a light and a camera subpath, each with its weight.
//!
//! Every one of them multiplies what the two subpaths carry, the BSDFs (with their cosines) at the joined vertices
//! and the weight over distance², and asks for visibility last.

use super::sums::Sums;
use super::{Bdpt, Partial, Vertex};
use crate::accel::Accel;
use crate::bsdf::Transport;
use crate::camera::{CameraSample, LensNumbers};
use crate::geometry::SurfacePoint;
use crate::integrator::light::lens_numbers;
use crate::integrator::path::sample_light;
use crate::integrator::recorder::Noted;
use crate::integrator::trace::{Made, Step};
use crate::integrator::worth::RayRoulette;
use crate::integrator::{Recorder, Technique};
use crate::light::{Light, LightEdge, LightPoint, Receiver};
use crate::math::{Ray, Rgb, Vec3, distance_squared, scaled};
use crate::pdf::Pmf;
use crate::planted::{Bug, planted};
use crate::sampling::Sampler;
use crate::scene::Scene;

/// A camera subpath that has come upon a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct EmitterHit<S = f64> {
    /// The point of the light.
    pub point: LightPoint,
    /// Unit direction to the previous vertex, and that vertex as next-event estimation sees it.
    pub wo: Vec3,
    pub receiver: Receiver,
    /// Throughput and partial sums of the subpath up to the light.
    pub beta: Rgb,
    pub partial: Partial<S>,
    /// Number of vertices of the subpath, the light's included.
    pub number: u32,
}

/// What a technique makes of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Valued<S = f64> {
    /// The contribution, weighted, visibility left out.
    pub value: Rgb,
    /// Σ h(n_j p_j)/h(p_s) over the other techniques j: the technique's own count is left out.
    pub others: S,
}

/// What a camera vertex shines with toward the camera: no connection's business, unless by a planted bug.
fn emission<A: Accel, S: Sums>(scene: &Scene<A>, z: &Vertex<S>) -> Rgb {
    let light = scene.surfaces[z.at.surface() as usize].light;
    light.map_or(Rgb::ZERO, |id| z.beta * scene.lights[id as usize].emitted(&LightPoint::Surface(z.at), z.wo))
}

/// For who replays a sample: a path that technique (`s`, `t`) has made, its value with the weight 1 and with its own.
#[cold]
fn made(
    s: u32,
    t: u32,
    seen: Option<([u32; 2], LensNumbers)>,
    light: Option<u32>,
    values: Option<[Rgb; 2]>,
    visible: f32,
) -> Step {
    Step::Made(Made { technique: Technique { s, t }, seen, light, values, visible })
}

/// For a survey: see `Noted`. Without sums of several sets of counts nothing is noted.
#[inline(always)]
fn note<S: Sums, const T: bool>(
    recorder: &mut Recorder<T>,
    technique: Technique,
    splat: Option<[u32; 2]>,
    value: Rgb,
    [own, others]: [S; 2],
) {
    if let (Some(own), Some(others)) = (own.candidates(), others.candidates()) {
        recorder.note(Noted { technique, splat, value, own: own.0, others: others.0 });
    }
}

impl<S: Sums> Bdpt<S> {
    /// `h` of the number of samples of the technique in which light vertex `number` would be the camera's.
    #[inline(always)]
    fn count_behind_light(&self, number: u32) -> S {
        if number == 2 { self.mis.next_event } else { self.mis.connections }
    }

    /// s = 0: the camera subpath has hit light `id`.
    #[inline]
    pub(super) fn hit_emitter<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        id: u32,
        hit: &EmitterHit<S>,
        recorder: &mut Recorder<T>,
    ) {
        let (Some(choice), true) = (&scene.light_choice, self.settings.wants(0, hit.number)) else { return };
        let light = &scene.lights[id as usize];
        if light.emitted(&hit.point, hit.wo) == Rgb::ZERO {
            return;
        }
        let pmf = choice.pmf_emission(id);
        let Valued { value, others } = self.evaluate_emitter(scene, id, hit, pmf);
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_emitter(scene, id, hit, pmf).value;
            made(0, hit.number, None, Some(id), Some([plain, value]), 1.0)
        });
        recorder.add(0, hit.number, value);
        note(recorder, Technique { s: 0, t: hit.number }, None, value, [S::splat(self.mis.h(1.0)), others]);
    }

    /// The weighted contribution of light `id` that a camera subpath has hit, chosen for emission with the probability
    /// `pmf`.
    #[inline]
    pub(super) fn evaluate_emitter<A: Accel>(
        &self,
        scene: &Scene<A>,
        id: u32,
        hit: &EmitterHit<S>,
        pmf: Pmf,
    ) -> Valued<S> {
        let light = &scene.lights[id as usize];
        let others = self.emitter_alternatives(scene, id, hit, pmf);
        let w = self.mis.weight(others.taken());
        Valued { value: hit.beta * light.emitted(&hit.point, hit.wo) * w as f32, others }
    }

    /// Σ_{j>0} h(n_j p_j)/h(p_0) for a path whose emitter a camera subpath has hit.
    #[inline]
    fn emitter_alternatives<A: Accel>(&self, scene: &Scene<A>, id: u32, hit: &EmitterHit<S>, pmf: Pmf) -> S {
        let EmitterHit { point, partial, .. } = hit;
        let light = &scene.lights[id as usize];
        let emission = (light.pdf_emission_position(&scene.geometry, point) * pmf).0;
        if hit.number == 2 {
            if light.is_infinite() || planted(Bug::LightSeenTwice) {
                return S::default();
            }
            // Seen directly: the one alternative, (1,1), starts as light subpaths do.
            return self.mis.splats(1) * self.mis.h(emission) * partial.direct;
        }
        // Behind a delta vertex or a window next-event estimation is no alternative, whatever its density.
        let direct = if planted(Bug::NoLightChoiceAtHits) {
            light.pdf_direct(&scene.geometry, hit.receiver.p, point).0
        } else if partial.direct > 0.0 {
            scene.pdf_direct(&hit.receiver, id, point).0
        } else {
            0.0
        };
        let direction = light.pdf_emission_direction(point, hit.wo).0;
        self.mis.next_event * self.mis.h(direct) * partial.direct
            + self.mis.earlier(partial, hit.number - 1) * (self.mis.h(emission) * self.mis.h(direction))
    }

    /// s = 1: next-event estimation at camera vertex `z`; `block` is the first dimension of the bounce.
    #[inline]
    pub(super) fn connect_to_light<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        z: &Vertex<S>,
        sampler: &mut Sampler,
        block: u32,
        roulette: &mut RayRoulette,
        recorder: &mut Recorder<T>,
    ) {
        let (Some(choice), true) = (&scene.light_choice, self.settings.wants(1, z.number)) else { return };
        let Some((id, y)) = sample_light(scene, &z.receiver(), sampler, block) else { return };
        let (light, pmf) = (&scene.lights[id as usize], choice.pmf_emission(id));
        recorder.tell(|| Step::LightSampled { light: id, point: y.point, pdf: y.pdf.0 });
        let made_of = self.evaluate_next_event(scene, light, &y.point, y.pdf.0, pmf, z);
        let Some(Valued { value, others }) = made_of else {
            recorder.tell(|| made(1, z.number, None, Some(id), None, 0.0));
            return;
        };
        let segment = y.point.shadow_ray(&z.at);
        let visible = roulette.visible(value, || scene.visibility(&segment, &mut recorder.rays.shadow));
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_next_event(scene, light, &y.point, y.pdf.0, pmf, z);
            made(1, z.number, None, Some(id), plain.map(|plain| [plain.value, value]), visible)
        });
        recorder.tell_blocker(visible, || scene.blocker(&segment));
        if visible > 0.0 {
            recorder.add(1, z.number, value * visible);
            let own = S::splat(self.mis.h(1.0));
            note(recorder, Technique { s: 1, t: z.number }, None, value * visible, [own, others]);
        }
    }

    /// The weighted contribution of a next-event sample, visibility left out; `None` where it is zero. `pdf_direct` holds
    /// the choice of the light, `pmf` is the probability of the choice for emission.
    #[inline]
    pub(super) fn evaluate_next_event<A: Accel>(
        &self,
        scene: &Scene<A>,
        light: &Light,
        y: &LightPoint,
        pdf_direct: f64,
        pmf: Pmf,
        z: &Vertex<S>,
    ) -> Option<Valued<S>> {
        let LightEdge { wi, d2, cos: cos_light } = y.edge_from(z.at.p())?;
        let le = light.emitted(y, -wi);
        if le == Rgb::ZERO || planted(Bug::DeltaLightUnconnected) && light.is_delta() {
            return None;
        }
        let value = z.bsdf.eval(&z.at, z.wo, wi, Transport::Radiance)?;
        let cos_z = f64::from(wi.dot(z.at.ng).abs());
        let mis = &self.mis;
        // j = 0: the camera subpath goes on and hits the light. h(1/d²) is left out throughout.
        let hit = if light.is_delta() { 0.0 } else { mis.h(f64::from(value.pdf_fwd.0) * cos_light / pdf_direct) };
        // j ≥ 2: the light subpath starts here and goes on.
        let pmf = if planted(Bug::NoEmissionDensity) { Pmf(0.0) } else { pmf };
        let emission = (light.pdf_emission_position(&scene.geometry, y) * pmf).0;
        let direction = light.pdf_emission_direction(y, -wi).0;
        let behind = mis.behind_camera(&z.partial, z.number, z.number, f64::from(value.pdf_rev.0));
        let started = behind * mis.h(emission / pdf_direct * direction * cos_z);
        let others = started + S::splat(hit);
        let weight = mis.weight_over_d2(others.taken() / mis.next_event.taken(), d2);
        let value = scaled(z.beta * value.f, le, cos_light / pdf_direct * weight);
        Some(Valued { value, others: others * mis.h(1.0 / d2) })
    }

    /// s ≥ 2, t ≥ 2: camera vertex `z` with every kept vertex of the light subpaths it connects to.
    #[inline]
    pub(super) fn connect_to_subpaths<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        z: &Vertex<S>,
        roulette: &mut RayRoulette,
        recorder: &mut Recorder<T>,
    ) {
        // s + t − 2 scattering events.
        let most = self.settings.max_bounces + 2 + u32::from(planted(Bug::DepthOfConnections));
        for y in &self.light_vertices[..self.connectible_end] {
            if y.number + z.number > most || !self.settings.wants(y.number, z.number) {
                continue;
            }
            let Some(Valued { value, others }) = self.evaluate_connection(y, z) else {
                recorder.tell(|| made(y.number, z.number, None, None, None, 0.0));
                continue;
            };
            let wi = y.at.p() - z.at.p();
            let segment = Ray::segment(z.at.origin(wi), y.at.segment_end(z.at.p()));
            let visible = roulette.visible(value, || scene.visibility(&segment, &mut recorder.rays.connection));
            recorder.tell(|| {
                let plain = self.unweighted().evaluate_connection(y, z);
                made(y.number, z.number, None, None, plain.map(|plain| [plain.value, value]), visible)
            });
            recorder.tell_blocker(visible, || scene.blocker(&segment));
            if visible > 0.0 {
                let value = if planted(Bug::EmissionInConnections) { value + emission(scene, z) } else { value };
                recorder.add(y.number, z.number, value * visible);
                let technique = Technique { s: y.number, t: z.number };
                note(recorder, technique, None, value * visible, [self.mis.connections, others]);
            }
        }
    }

    /// The weighted contribution of a connection, visibility left out; `None` where it is zero.
    #[inline]
    pub(super) fn evaluate_connection(&self, y: &Vertex<S>, z: &Vertex<S>) -> Option<Valued<S>> {
        let d2 = distance_squared(y.at.p(), z.at.p());
        // Two points on one place of the f32 lattice have no direction to each other.
        if d2 == 0.0 {
            return None;
        }
        let wi = (y.at.p() - z.at.p()).normalize();
        let at_z = z.bsdf.eval(&z.at, z.wo, wi, Transport::Radiance)?;
        let at_y = y.bsdf.eval(&y.at, y.wo, -wi, Transport::Importance)?;
        let (cos_y, cos_z) = (f64::from(wi.dot(y.at.ng).abs()), f64::from(wi.dot(z.at.ng).abs()));
        let mis = &self.mis;
        // Technique s−1 would find y from z, technique s+1 z from y; h(1/d²) is left out of both.
        let light_side = mis.behind(&y.partial, self.count_behind_light(y.number), f64::from(at_y.pdf_rev.0))
            * mis.h(f64::from(at_z.pdf_fwd.0) * cos_y);
        let edges = if planted(Bug::TrustOfSubpath) { z.number } else { y.number + z.number - 1 };
        let camera_side = mis.behind_camera(&z.partial, z.number, edges, f64::from(at_z.pdf_rev.0))
            * mis.h(f64::from(at_y.pdf_fwd.0) * cos_z);
        let others = light_side + camera_side;
        let weight = mis.weight_over_d2(others.taken() / mis.connections.taken(), d2);
        let again = if planted(Bug::CosineTwiceInConnections) { cos_y * cos_z } else { 1.0 };
        let value = scaled(z.beta * at_z.f, at_y.f * y.beta, again * weight / self.connections_per_sample);
        Some(Valued { value, others: others * mis.h(1.0 / d2) })
    }

    /// t = 1, s ≥ 2: light vertex `y` seen by the camera.
    #[inline]
    pub(super) fn connect_to_camera<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        y: &Vertex<S>,
        sampler: &mut Sampler,
        roulette: &mut RayRoulette,
        recorder: &mut Recorder<T>,
    ) {
        if !self.settings.wants(y.number, 1) || planted(Bug::NoLightTracing) {
            return;
        }
        let numbers = lens_numbers(&scene.camera, sampler, y.number);
        let Some((lens, Valued { value, others })) = self.evaluate_lens(scene, y, &numbers) else {
            recorder.tell(|| made(y.number, 1, None, None, None, 0.0));
            return;
        };
        roulette.turn_to(self.thresholds.as_deref(), lens.pixel);
        let segment = Ray::segment(y.at.origin(lens.wi), lens.p);
        let visible = roulette.visible(value, || scene.visibility(&segment, &mut recorder.rays.lens));
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_lens(scene, y, &numbers);
            let values = plain.map(|(_, plain)| [plain.value, value]);
            made(y.number, 1, Some((lens.pixel, numbers)), None, values, visible)
        });
        recorder.tell_blocker(visible, || scene.blocker(&segment));
        if visible > 0.0 {
            recorder.splat(y.number, 1, lens.pixel, value * visible);
            let technique = Technique { s: y.number, t: 1 };
            note(recorder, technique, Some(lens.pixel), value * visible, [self.mis.splats(y.number), others]);
        }
    }

    /// The weighted contribution of light vertex `y` to the pixel it is seen through, visibility left out.
    #[inline]
    pub(super) fn evaluate_lens<A: Accel>(
        &self,
        scene: &Scene<A>,
        y: &Vertex<S>,
        numbers: &LensNumbers,
    ) -> Option<(CameraSample, Valued<S>)> {
        let lens = scene.camera.sample_lens(y.at.p(), numbers)?;
        let value = y.bsdf.eval(&y.at, y.wo, lens.wi, Transport::Importance)?;
        let pdf_lens = lens.pdf.0;
        let cos = f64::from(lens.wi.dot(y.at.ng).abs());
        let behind = self.mis.behind(&y.partial, self.count_behind_light(y.number), f64::from(value.pdf_rev.0));
        let others = behind * self.mis.h(pdf_lens * cos);
        let weight = self.mis.weight_over_d2(others.taken() / self.mis.splats(y.number).taken(), lens.d2);
        // F holds the cosine at y, and We·cosθ is the camera's density.
        let scale = pdf_lens * weight / self.light_paths_per_pass;
        let others = others * self.mis.h(1.0 / lens.d2);
        Some((lens, Valued { value: y.beta * value.f * scale as f32, others }))
    }

    /// s = 1, t = 1: a point on an area light, seen by the camera.
    #[inline]
    pub(super) fn connect_light_to_camera<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        light: &Light,
        y: &SurfacePoint,
        pdf_position: f64,
        sampler: &mut Sampler,
        recorder: &mut Recorder<T>,
    ) {
        if !self.settings.wants(1, 1) {
            return;
        }
        let numbers = lens_numbers(&scene.camera, sampler, 1);
        let made_of = self.evaluate_light_in_lens(scene, light, y, pdf_position, &numbers);
        let Some((lens, Valued { value, others })) = made_of else {
            recorder.tell(|| made(1, 1, None, None, None, 0.0));
            return;
        };
        let segment = Ray::segment(y.origin(lens.wi), lens.p);
        let visible = scene.visibility(&segment, &mut recorder.rays.lens);
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_light_in_lens(scene, light, y, pdf_position, &numbers);
            let values = plain.map(|(_, plain)| [plain.value, value]);
            made(1, 1, Some((lens.pixel, numbers)), None, values, visible)
        });
        recorder.tell_blocker(visible, || scene.blocker(&segment));
        if visible > 0.0 {
            recorder.splat(1, 1, lens.pixel, value * visible);
            let technique = Technique { s: 1, t: 1 };
            note(recorder, technique, Some(lens.pixel), value * visible, [self.mis.splats(1), others]);
        }
    }

    /// The weighted contribution of a point on a light to the pixel it is seen through, visibility left out.
    #[inline]
    pub(super) fn evaluate_light_in_lens<A: Accel>(
        &self,
        scene: &Scene<A>,
        light: &Light,
        y: &SurfacePoint,
        pdf_position: f64,
        numbers: &LensNumbers,
    ) -> Option<(CameraSample, Valued<S>)> {
        let lens = scene.camera.sample_lens(y.p(), numbers)?;
        let le = light.emitted(&LightPoint::Surface(*y), lens.wi);
        if le == Rgb::ZERO {
            return None;
        }
        let seen = lens.pdf.0 * f64::from(y.ng.dot(lens.wi).abs()) / pdf_position;
        // The one alternative is the camera ray that hits the light.
        let others = self.mis.h(seen);
        let weight = self.mis.weight_over_d2(others / self.mis.splats(1).taken(), lens.d2);
        let value = le * (seen * weight / self.light_paths_per_pass) as f32;
        Some((lens, Valued { value, others: S::splat(others * self.mis.h(1.0 / lens.d2)) }))
    }
}

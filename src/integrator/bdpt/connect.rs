//! The four ways of joining a light and a camera subpath, each with its weight.
//!
//! Every one of them multiplies what the two subpaths carry, the BSDFs (with their cosines) at the joined vertices
//! and the weight over distance², and asks for visibility last.

use super::{Bdpt, Partial, Vertex};
use crate::accel::Accel;
use crate::bsdf::Transport;
use crate::camera::{CameraSample, LensNumbers};
use crate::geometry::SurfacePoint;
use crate::integrator::light::lens_numbers;
use crate::integrator::path::sample_light;
use crate::integrator::trace::{Made, Step};
use crate::integrator::{Recorder, Technique};
use crate::light::{Light, LightEdge, LightPoint, Receiver};
use crate::math::{Ray, Rgb, Vec3, distance_squared, scaled};
use crate::pdf::Pmf;
use crate::planted::{Bug, planted};
use crate::sampling::Sampler;
use crate::scene::Scene;

/// A camera subpath that has come upon a light.
#[derive(Clone, Copy, Debug)]
pub(super) struct EmitterHit {
    /// The point of the light.
    pub point: LightPoint,
    /// Unit direction to the previous vertex, and that vertex as next-event estimation sees it.
    pub wo: Vec3,
    pub receiver: Receiver,
    /// Throughput and partial sums of the subpath up to the light.
    pub beta: Rgb,
    pub partial: Partial,
    /// Number of vertices of the subpath, the light's included.
    pub number: u32,
}

/// What a camera vertex shines with toward the camera: no connection's business, unless by a planted bug.
fn emission<A: Accel>(scene: &Scene<A>, z: &Vertex) -> Rgb {
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

impl Bdpt {
    /// `h` of the number of samples of the technique in which camera vertex `number` would be the light's.
    #[inline(always)]
    fn count_behind_camera(&self, number: u32) -> f64 {
        if number == 2 { self.mis.light_paths } else { self.mis.connections }
    }

    /// `h` of the number of samples of the technique in which light vertex `number` would be the camera's.
    #[inline(always)]
    fn count_behind_light(&self, number: u32) -> f64 {
        if number == 2 { self.mis.next_event } else { self.mis.connections }
    }

    /// s = 0: the camera subpath has hit light `id`.
    #[inline]
    pub(super) fn hit_emitter<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        id: u32,
        hit: &EmitterHit,
        recorder: &mut Recorder<T>,
    ) {
        let (Some(choice), true) = (&scene.light_choice, self.settings.wants(0, hit.number)) else { return };
        let light = &scene.lights[id as usize];
        if light.emitted(&hit.point, hit.wo) == Rgb::ZERO {
            return;
        }
        let pmf = choice.pmf_emission(id);
        let value = self.evaluate_emitter(scene, id, hit, pmf);
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_emitter(scene, id, hit, pmf);
            made(0, hit.number, None, Some(id), Some([plain, value]), 1.0)
        });
        recorder.add(0, hit.number, value);
    }

    /// The weighted contribution of light `id` that a camera subpath has hit, chosen for emission with the probability
    /// `pmf`.
    #[inline]
    pub(super) fn evaluate_emitter<A: Accel>(&self, scene: &Scene<A>, id: u32, hit: &EmitterHit, pmf: Pmf) -> Rgb {
        let light = &scene.lights[id as usize];
        let w = self.mis.weight(self.emitter_alternatives(scene, id, hit, pmf));
        hit.beta * light.emitted(&hit.point, hit.wo) * w as f32
    }

    /// Σ_{j>0} h(n_j p_j)/h(p_0) for a path whose emitter a camera subpath has hit.
    #[inline]
    fn emitter_alternatives<A: Accel>(&self, scene: &Scene<A>, id: u32, hit: &EmitterHit, pmf: Pmf) -> f64 {
        let EmitterHit { point, partial, .. } = hit;
        let light = &scene.lights[id as usize];
        let emission = (light.pdf_emission_position(&scene.geometry, point) * pmf).0;
        if hit.number == 2 {
            if light.is_infinite() || planted(Bug::LightSeenTwice) {
                return 0.0;
            }
            // Seen directly: the one alternative, (1,1), starts as light subpaths do.
            return self.mis.light_paths * self.mis.h(emission) * partial.direct;
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
            + self.mis.h(emission) * self.mis.h(direction) * partial.earlier
    }

    /// s = 1: next-event estimation at camera vertex `z`; `block` is the first dimension of the bounce.
    #[inline]
    pub(super) fn connect_to_light<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        z: &Vertex,
        sampler: &mut Sampler,
        block: u32,
        recorder: &mut Recorder<T>,
    ) {
        let (Some(choice), true) = (&scene.light_choice, self.settings.wants(1, z.number)) else { return };
        let Some((id, y)) = sample_light(scene, &z.receiver(), sampler, block) else { return };
        let (light, pmf) = (&scene.lights[id as usize], choice.pmf_emission(id));
        recorder.tell(|| Step::LightSampled { light: id, point: y.point, pdf: y.pdf.0 });
        let Some(value) = self.evaluate_next_event(scene, light, &y.point, y.pdf.0, pmf, z) else {
            recorder.tell(|| made(1, z.number, None, Some(id), None, 0.0));
            return;
        };
        let segment = y.point.shadow_ray(&z.at);
        let visible = scene.visibility(&segment, &mut recorder.rays.shadow);
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_next_event(scene, light, &y.point, y.pdf.0, pmf, z);
            made(1, z.number, None, Some(id), plain.map(|plain| [plain, value]), visible)
        });
        recorder.tell_blocker(visible, || scene.blocker(&segment));
        if visible > 0.0 {
            recorder.add(1, z.number, value * visible);
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
        z: &Vertex,
    ) -> Option<Rgb> {
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
        let behind = mis.behind(&z.partial, self.count_behind_camera(z.number), f64::from(value.pdf_rev.0));
        let started = mis.h(emission / pdf_direct * direction * cos_z) * behind;
        let scale = cos_light / pdf_direct * mis.weight_over_d2((hit + started) / mis.next_event, d2);
        Some(scaled(z.beta * value.f, le, scale))
    }

    /// s ≥ 2, t ≥ 2: camera vertex `z` with every kept vertex of the light subpaths it connects to.
    #[inline]
    pub(super) fn connect_to_subpaths<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        z: &Vertex,
        recorder: &mut Recorder<T>,
    ) {
        // s + t − 2 scattering events.
        let most = self.settings.max_bounces + 2 + u32::from(planted(Bug::DepthOfConnections));
        for y in &self.light_vertices[..self.connectible_end] {
            if y.number + z.number > most || !self.settings.wants(y.number, z.number) {
                continue;
            }
            let Some(value) = self.evaluate_connection(y, z) else {
                recorder.tell(|| made(y.number, z.number, None, None, None, 0.0));
                continue;
            };
            let wi = y.at.p() - z.at.p();
            let segment = Ray::segment(z.at.origin(wi), y.at.segment_end(z.at.p()));
            let visible = scene.visibility(&segment, &mut recorder.rays.connection);
            recorder.tell(|| {
                let plain = self.unweighted().evaluate_connection(y, z);
                made(y.number, z.number, None, None, plain.map(|plain| [plain, value]), visible)
            });
            recorder.tell_blocker(visible, || scene.blocker(&segment));
            if visible > 0.0 {
                let value = if planted(Bug::EmissionInConnections) { value + emission(scene, z) } else { value };
                recorder.add(y.number, z.number, value * visible);
            }
        }
    }

    /// The weighted contribution of a connection, visibility left out; `None` where it is zero.
    #[inline]
    pub(super) fn evaluate_connection(&self, y: &Vertex, z: &Vertex) -> Option<Rgb> {
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
        let light_side = mis.h(f64::from(at_z.pdf_fwd.0) * cos_y)
            * mis.behind(&y.partial, self.count_behind_light(y.number), f64::from(at_y.pdf_rev.0));
        let camera_side = mis.h(f64::from(at_y.pdf_fwd.0) * cos_z)
            * mis.behind(&z.partial, self.count_behind_camera(z.number), f64::from(at_z.pdf_rev.0));
        let others = (light_side + camera_side) / mis.connections;
        let again = if planted(Bug::CosineTwiceInConnections) { cos_y * cos_z } else { 1.0 };
        let scale = again * mis.weight_over_d2(others, d2) / f64::from(self.connections);
        Some(scaled(z.beta * at_z.f, at_y.f * y.beta, scale))
    }

    /// t = 1, s ≥ 2: light vertex `y` seen by the camera.
    #[inline]
    pub(super) fn connect_to_camera<A: Accel, const T: bool>(
        &self,
        scene: &Scene<A>,
        y: &Vertex,
        sampler: &mut Sampler,
        recorder: &mut Recorder<T>,
    ) {
        if !self.settings.wants(y.number, 1) || planted(Bug::NoLightTracing) {
            return;
        }
        let numbers = lens_numbers(&scene.camera, sampler, y.number);
        let Some((lens, value)) = self.evaluate_lens(scene, y, &numbers) else {
            recorder.tell(|| made(y.number, 1, None, None, None, 0.0));
            return;
        };
        let segment = Ray::segment(y.at.origin(lens.wi), lens.p);
        let visible = scene.visibility(&segment, &mut recorder.rays.lens);
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_lens(scene, y, &numbers);
            made(y.number, 1, Some((lens.pixel, numbers)), None, plain.map(|(_, plain)| [plain, value]), visible)
        });
        recorder.tell_blocker(visible, || scene.blocker(&segment));
        if visible > 0.0 {
            recorder.splat(y.number, 1, lens.pixel, value * visible);
        }
    }

    /// The weighted contribution of light vertex `y` to the pixel it is seen through, visibility left out.
    #[inline]
    pub(super) fn evaluate_lens<A: Accel>(
        &self,
        scene: &Scene<A>,
        y: &Vertex,
        numbers: &LensNumbers,
    ) -> Option<(CameraSample, Rgb)> {
        let lens = scene.camera.sample_lens(y.at.p(), numbers)?;
        let value = y.bsdf.eval(&y.at, y.wo, lens.wi, Transport::Importance)?;
        let pdf_lens = lens.pdf.0;
        let cos = f64::from(lens.wi.dot(y.at.ng).abs());
        let behind = self.mis.behind(&y.partial, self.count_behind_light(y.number), f64::from(value.pdf_rev.0));
        let others = self.mis.h(pdf_lens * cos) * behind / self.mis.light_paths;
        // F holds the cosine at y, and We·cosθ is the camera's density.
        let scale = pdf_lens * self.mis.weight_over_d2(others, lens.d2) / self.light_paths_per_pass;
        Some((lens, y.beta * value.f * scale as f32))
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
        let Some((lens, value)) = self.evaluate_light_in_lens(scene, light, y, pdf_position, &numbers) else {
            recorder.tell(|| made(1, 1, None, None, None, 0.0));
            return;
        };
        let segment = Ray::segment(y.origin(lens.wi), lens.p);
        let visible = scene.visibility(&segment, &mut recorder.rays.lens);
        recorder.tell(|| {
            let plain = self.unweighted().evaluate_light_in_lens(scene, light, y, pdf_position, &numbers);
            made(1, 1, Some((lens.pixel, numbers)), None, plain.map(|(_, plain)| [plain, value]), visible)
        });
        recorder.tell_blocker(visible, || scene.blocker(&segment));
        if visible > 0.0 {
            recorder.splat(1, 1, lens.pixel, value * visible);
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
    ) -> Option<(CameraSample, Rgb)> {
        let lens = scene.camera.sample_lens(y.p(), numbers)?;
        let le = light.emitted(&LightPoint::Surface(*y), lens.wi);
        if le == Rgb::ZERO {
            return None;
        }
        let seen = lens.pdf.0 * f64::from(y.ng.dot(lens.wi).abs()) / pdf_position;
        // The one alternative is the camera ray that hits the light.
        let others = self.mis.h(seen) / self.mis.light_paths;
        let scale = seen * self.mis.weight_over_d2(others, lens.d2) / self.light_paths_per_pass;
        Some((lens, le * scale as f32))
    }
}

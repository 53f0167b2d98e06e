//! The two random walks.

use super::connect::EmitterHit;
use super::mis::{Departure, LightStart};
use super::sums::Sums;
use super::{Bdpt, Vertex};
use crate::accel::Accel;
use crate::bsdf::{Bsdf, BsdfSample, Transport};
use crate::integrator::light::dimensions as light_dimensions;
use crate::integrator::path::{camera_ray, dimensions as camera_dimensions};
use crate::integrator::trace::{Arrived, End, Step};
use crate::integrator::worth::RayRoulette;
use crate::integrator::{Recorder, Roulette};
use crate::light::{LightPoint, Receiver};
use crate::math::{Ray, Rgb, Vec3, distance_squared};
use crate::pdf::Pmf;
use crate::planted::{Bug, planted};
use crate::sampling::Sampler;
use crate::scene::{Reached, Scene};

impl<S: Sums> Bdpt<S> {
    /// Traces a light subpath, connects its vertices to the camera and keeps those that can be connected to.
    pub(super) fn walk_light<A: Accel, const T: bool>(
        &mut self,
        scene: &Scene<A>,
        mut sampler: Sampler,
        recorder: &mut Recorder<T>,
    ) {
        let Some(choice) = &scene.light_choice else { return };
        let mut coins = sampler.coins();
        let mut ray_roulette = RayRoulette::new(&sampler);
        recorder.rays.light_paths += 1;
        let (id, pmf) = choice.sample_emission(sampler.next_f64());
        let light = &scene.lights[id as usize];
        sampler.set_dimension(light_dimensions::PART);
        let part = if light.emits_in_parts() { sampler.next_f64() } else { 0.0 };
        sampler.set_dimension(light_dimensions::POINT);
        let (u_point, u_direction) = (sampler.next_2d(), sampler.next_2d());
        let Some(emission) = light.sample_emission(&scene.geometry, part, u_point, u_direction) else { return };
        let pmf = if planted(Bug::NoLightChoice) { Pmf(1.0) } else { pmf };
        let pdf_position = (emission.pdf_position * pmf).0;
        recorder.tell(|| Step::of_light(id, pmf, &emission));
        // A delta light has no area to be seen, an environment no place.
        if let LightPoint::Surface(at) = &emission.point {
            self.connect_light_to_camera(scene, light, at, pdf_position, &mut sampler, recorder);
        }
        if self.settings.max_bounces == 0 {
            recorder.tell(|| Step::Ended(End::Length));
            return;
        }

        let cos = if planted(Bug::NoCosineAtLight) { 1.0 } else { emission.point.cos(emission.w) };
        let pdf_direction = emission.pdf_direction.0;
        let mut beta = emission.le * (cos / (pdf_position * pdf_direction)) as f32;
        let mut roulette = self.settings.roulette(beta);
        let mut ray = Ray::new(emission.origin, emission.w);
        let mut from = ray.o;
        let mut varying = Bsdf::Black;
        let mut departure: Option<Departure<S>> = None;
        let mut number = 2;
        while number - 1 <= self.settings.max_bounces {
            let Some(arrival) = scene.arrive(ray, &mut coins, &mut recorder.rays.light, &mut varying) else {
                recorder.tell(|| Step::Left { toward: ray.d, through_window: false });
                return;
            };
            if self.settings.class.ends_light_subpath(light, number, arrival.through_window) {
                recorder.tell(|| Step::Ended(End::Class));
                return;
            }
            let at = arrival.at;
            let wo = -ray.d;
            let cos_in = f64::from(wo.dot(at.ng).abs());
            if cos_in == 0.0 || !arrival.bsdf.scatters() {
                recorder.tell(|| Step::Ended(if cos_in == 0.0 { End::Grazing } else { End::Black }));
                return;
            }
            let partial = match &departure {
                None => {
                    // Only from here is it known with which density next-event estimation would have found the light;
                    // at a delta vertex it has none.
                    let bsdf = arrival.bsdf;
                    let direct = if bsdf.is_connectible() {
                        let receiver = match planted(Bug::OneReceiver) {
                            true => Receiver::anywhere(Vec3::ZERO),
                            false => Receiver::new(&at, wo, bsdf.transmits()),
                        };
                        scene.pdf_direct(&receiver, id, &emission.point).0
                    } else {
                        0.0
                    };
                    let start = LightStart {
                        pdf_position,
                        pdf_direction,
                        direct_over_emission: direct / pdf_position,
                        cos: if light.is_delta() { 0.0 } else { cos },
                    };
                    let d2 = emission.point.distance_squared(at.p());
                    self.mis.arrive_from_light(&start, d2, cos_in, !arrival.through_window)
                }
                Some(departure) => {
                    self.mis.arrive(departure, distance_squared(from, at.p()), cos_in, !arrival.through_window)
                }
            };
            let vertex = Vertex { at, wo, bsdf: *arrival.bsdf, beta, partial, number };
            recorder.tell(|| {
                let d2 = if departure.is_none() {
                    emission.point.distance_squared(at.p())
                } else {
                    distance_squared(from, at.p())
                };
                Step::Arrived(Arrived { d2, ..Arrived::of(&arrival, wo, beta, number, Some(partial.taken())) })
            });
            if vertex.bsdf.is_connectible() {
                self.connect_to_camera(scene, &vertex, &mut sampler, &mut ray_roulette, recorder);
                self.light_vertices.push(vertex);
            }
            let block = light_dimensions::START + (number - 2) * light_dimensions::BLOCK;
            sampler.set_dimension(block);
            let Some(next) = scatter(&vertex, Transport::Importance, &mut sampler, recorder) else { return };
            if self.settings.class.ends_light_subpath(light, number, next.delta) {
                recorder.tell(|| Step::Ended(End::Class));
                return;
            }
            sampler.set_dimension(block + light_dimensions::ROULETTE);
            let Some(thinned) = thin(&vertex, &next, &mut roulette, &mut sampler, recorder) else { return };
            beta = thinned;
            // `direct` at vertex i stands for the technique with i light vertices.
            let count = if number == 2 { self.mis.next_event } else { self.mis.connections };
            departure = Some(depart(&vertex, &next, [count, S::default()]));
            from = at.p();
            ray = Ray::new(at.origin(next.wi), next.wi);
            number += 1;
        }
        recorder.tell(|| Step::Ended(End::Length));
    }

    /// Walks a camera subpath, connecting each of its vertices to the light.
    pub(super) fn walk_camera<A: Accel, const T: bool>(
        &mut self,
        scene: &Scene<A>,
        pixel: [u32; 2],
        mut sampler: Sampler,
        recorder: &mut Recorder<T>,
    ) {
        recorder.rays.camera_paths += 1;
        if !scene.needs.light {
            return;
        }
        let mut coins = sampler.coins();
        let mut ray_roulette = RayRoulette::new(&sampler);
        ray_roulette.turn_to(self.thresholds.as_deref(), pixel);
        let primary = camera_ray(&scene.camera, pixel, &mut sampler);
        let mut ray = primary.ray;
        recorder.tell(|| Step::Camera { from: ray.o, toward: ray.d, pdf: primary.pdf.0, lens: primary.lens });
        let mut receiver = Receiver::anywhere(ray.o);
        let mut varying = Bsdf::Black;
        let mut beta = Rgb::ONE;
        let mut roulette = self.settings.roulette(beta);
        let mut departure: Option<Departure<S>> = None;
        let mut number = 2;
        loop {
            let wo = -ray.d;
            let arrival = match scene.follow(ray, &mut coins, &mut recorder.rays.camera, &mut varying) {
                Reached::Surface(arrival) => arrival,
                Reached::Infinity { through_window } => {
                    recorder.tell(|| Step::Left { toward: ray.d, through_window });
                    if !scene.environments.is_empty() && !self.settings.class.ends_camera_subpath(number, true) {
                        // A point at infinity: no distance and no cosine belong to the edge.
                        let partial = match &departure {
                            None => self.mis.arrive_from_camera(primary.pdf.0, 1.0, 1.0, !through_window),
                            Some(departure) => self.mis.arrive(departure, 1.0, 1.0, !through_window),
                        };
                        let point = LightPoint::Infinite(ray.d);
                        let hit = EmitterHit { point, wo, receiver, beta, partial, number };
                        for &id in &scene.environments {
                            self.hit_emitter(scene, id, &hit, recorder);
                        }
                    }
                    return;
                }
            };
            let at = arrival.at;
            let cos_in = f64::from(wo.dot(at.ng).abs());
            if cos_in == 0.0 || self.settings.class.ends_camera_subpath(number, arrival.through_window) {
                recorder.tell(|| Step::Ended(if cos_in == 0.0 { End::Grazing } else { End::Class }));
                return;
            }
            let from = receiver.p;
            let d2 = distance_squared(from, at.p());
            let partial = match &departure {
                None => {
                    let d2 = scene.camera.edge_d2(from, at.p());
                    self.mis.arrive_from_camera(primary.pdf.0, d2, cos_in, !arrival.through_window)
                }
                Some(departure) => self.mis.arrive(departure, d2, cos_in, !arrival.through_window),
            };
            let vertex = Vertex { at, wo, bsdf: *arrival.bsdf, beta, partial, number };
            recorder.tell(|| {
                let d2 = if departure.is_none() { scene.camera.edge_d2(from, at.p()) } else { d2 };
                Step::Arrived(Arrived { d2, ..Arrived::of(&arrival, wo, beta, number, Some(partial.taken())) })
            });
            if let Some(id) = arrival.light {
                let hit = EmitterHit { point: LightPoint::Surface(at), wo, receiver, beta, partial, number };
                self.hit_emitter(scene, id, &hit, recorder);
            }
            // Vertex `number` would scatter for the (number − 1)th time.
            if number - 1 > self.settings.max_bounces || !vertex.bsdf.scatters() {
                recorder.tell(|| Step::Ended(if vertex.bsdf.scatters() { End::Length } else { End::Black }));
                return;
            }
            let block = (number - 2) * camera_dimensions::BLOCK;
            if vertex.bsdf.is_connectible() {
                self.connect_to_light(scene, &vertex, &mut sampler, block, &mut ray_roulette, recorder);
                self.connect_to_subpaths(scene, &vertex, &mut ray_roulette, recorder);
            }
            sampler.set_dimension(block + camera_dimensions::DIRECTION);
            let Some(next) = scatter(&vertex, Transport::Radiance, &mut sampler, recorder) else { return };
            if self.settings.class.ends_camera_subpath(number, next.delta) {
                recorder.tell(|| Step::Ended(End::Class));
                return;
            }
            sampler.set_dimension(block + camera_dimensions::ROULETTE);
            let Some(thinned) = thin(&vertex, &next, &mut roulette, &mut sampler, recorder) else { return };
            beta = thinned;
            // `direct` at camera vertex i stands for the technique with i − 1 camera vertices.
            departure = Some(depart(&vertex, &next, self.mis.counts_at_camera_vertex(number)));
            receiver = vertex.receiver();
            ray = Ray::new(at.origin(next.wi), next.wi);
            number += 1;
        }
    }
}

/// Samples the BSDF from the sampler's current dimension on.
#[inline]
fn scatter<S: Sums, const T: bool>(
    vertex: &Vertex<S>,
    transport: Transport,
    sampler: &mut Sampler,
    recorder: &mut Recorder<T>,
) -> Option<BsdfSample> {
    let u = sampler.next_2d();
    let lobe = if vertex.bsdf.chooses_lobe() { sampler.next_1d() } else { 0.0 };
    let next = vertex.bsdf.sample(&vertex.at, vertex.wo, lobe, u, transport);
    recorder.tell(|| next.as_ref().map_or(Step::Ended(End::Absorbed), Step::from));
    next
}

/// The throughput after a scattering that roulette let live.
#[inline]
fn thin<S: Sums, const T: bool>(
    vertex: &Vertex<S>,
    next: &BsdfSample,
    roulette: &mut Roulette,
    sampler: &mut Sampler,
    recorder: &mut Recorder<T>,
) -> Option<Rgb> {
    let beta = vertex.beta * next.weight;
    let q = roulette.survive(beta, next.eta_scale, || sampler.next_1d());
    recorder.tell(|| q.map_or(Step::Ended(End::Roulette), Step::Survived));
    Some(beta / q?)
}

/// The vertex as the edge that leaves it sees it.
#[inline]
fn depart<S: Sums>(vertex: &Vertex<S>, next: &BsdfSample, [count, splats]: [S; 2]) -> Departure<S> {
    Departure {
        partial: vertex.partial,
        count,
        splats,
        cos: f64::from(next.wi.dot(vertex.at.ng).abs()),
        pdf_fwd: f64::from(next.pdf_fwd.0),
        pdf_rev: f64::from(next.pdf_rev.0),
        delta: next.delta,
    }
}

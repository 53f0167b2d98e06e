//! Light tracing: light subpaths, every vertex connected to the camera (techniques t = 1).

use super::trace::{Arrived, End, Made, Step};
use super::{PixelSample, Recorder, Settings, Technique};
use crate::accel::Accel;
use crate::bsdf::{Bsdf, Transport};
use crate::camera::{Camera, LensNumbers};
use crate::light::LightPoint;
use crate::math::{Ray, Rgb, distance_squared};
use crate::planted::{Bug, planted};
use crate::sampling::{Sampler, Stream};
use crate::scene::Scene;

/// Sampler dimensions of light subpaths: the start takes four, each bounce a block.
pub(super) mod dimensions {
    pub const PART: u32 = 1;
    pub const POINT: u32 = 2;
    pub const START: u32 = 4;
    pub const BLOCK: u32 = 3;
    pub const ROULETTE: u32 = 2;
    /// Connections to the camera stand beyond all bounces, two for each light vertex: cameras that take no numbers
    /// leave all others where they are.
    pub const LENS: u32 = 1 << 31;
}

/// The numbers with which light vertex `s` is connected to the camera.
#[inline]
pub(super) fn lens_numbers(camera: &Camera, sampler: &mut Sampler, s: u32) -> LensNumbers {
    if !camera.needs_numbers() {
        return LensNumbers::IDLE;
    }
    sampler.set_dimension(dimensions::LENS + 2 * s);
    LensNumbers { lens: sampler.next_2d(), pixel: sampler.next_2d() }
}

/// For who replays a sample: see `Made`.
#[cold]
fn made(s: u32, pixel: [u32; 2], numbers: LensNumbers, value: Rgb, visible: f32) -> Step {
    let technique = Technique { s, t: 1 };
    Step::Made(Made { technique, seen: Some((pixel, numbers)), light: None, values: Some([value; 2]), visible })
}

/// The light paths that belong to one sample of a pixel; they may land on any pixel.
pub(super) fn sample<A: Accel, const T: bool>(
    scene: &Scene<A>,
    settings: &Settings,
    light_paths_per_pass: f64,
    sample: PixelSample,
    recorder: &mut Recorder<T>,
) {
    recorder.begin(sample.pixel, sample.index);
    for number in 0..settings.light_paths.max(1) {
        trace(scene, settings, light_paths_per_pass, sample, number, recorder);
    }
}

fn trace<A: Accel, const T: bool>(
    scene: &Scene<A>,
    settings: &Settings,
    light_paths_per_pass: f64,
    sample: PixelSample,
    number: u32,
    recorder: &mut Recorder<T>,
) {
    let Some(choice) = &scene.light_choice else { return };
    let pixel_key = sample.key(scene.camera.resolution());
    let mut sampler = Sampler::new(settings.sampler, settings.seed, pixel_key, Stream::Light(number), sample.index);
    let mut coins = sampler.coins();
    recorder.rays.light_paths += 1;

    let (id, pmf) = choice.sample_emission(sampler.next_f64());
    let light = &scene.lights[id as usize];
    sampler.set_dimension(dimensions::PART);
    let part = if light.emits_in_parts() { sampler.next_f64() } else { 0.0 };
    sampler.set_dimension(dimensions::POINT);
    let (u_point, u_direction) = (sampler.next_2d(), sampler.next_2d());
    let Some(start) = light.sample_emission(&scene.geometry, part, u_point, u_direction) else { return };
    let pdf_position = (start.pdf_position * pmf).0;
    recorder.tell(|| Step::of_light(id, pmf, &start));

    // s = 1: the light itself, seen by the camera. A delta light has no area to be seen, an environment no place.
    if let (true, LightPoint::Surface(at)) = (settings.wants(1, 1), &start.point) {
        let numbers = lens_numbers(&scene.camera, &mut sampler, 1);
        if let Some(lens) = scene.camera.sample_lens(at.p(), &numbers) {
            let le = light.emitted(&start.point, lens.wi);
            if le.max_element() > 0.0 {
                let segment = Ray::segment(at.origin(lens.wi), lens.p);
                let visible = scene.visibility(&segment, &mut recorder.rays.lens);
                let area = lens.pdf.to_area(lens.wi.dot(at.ng), lens.d2);
                let scale = area.0 / (pdf_position * light_paths_per_pass);
                recorder.tell(|| made(1, lens.pixel, numbers, le * scale as f32, visible));
                if visible > 0.0 {
                    recorder.splat(1, 1, lens.pixel, le * (scale as f32 * visible));
                }
            }
        }
    }

    let cos = start.point.cos(start.w);
    let mut beta = start.le * (cos / (pdf_position * start.pdf_direction.0)) as f32;
    let mut roulette = settings.roulette(beta);
    let mut ray = Ray::new(start.origin, start.w);
    let mut from = ray.o;
    let mut varying = Bsdf::Black;
    // Light vertices including the one being arrived at; s − 1 of them scatter when the camera is connected.
    let mut s = 2;
    while s - 1 + u32::from(planted(Bug::DepthOfLight)) <= settings.max_bounces {
        let Some(arrival) = scene.arrive(ray, &mut coins, &mut recorder.rays.light, &mut varying) else {
            recorder.tell(|| Step::Left { toward: ray.d, through_window: false });
            return;
        };
        if settings.class.ends_light_subpath(light, s, arrival.through_window) {
            recorder.tell(|| Step::Ended(End::Class));
            return;
        }
        let at = &arrival.at;
        let bsdf = arrival.bsdf;
        let wo = -ray.d;
        recorder.tell(|| {
            let d2 = if s == 2 { start.point.distance_squared(at.p()) } else { distance_squared(from, at.p()) };
            Step::Arrived(Arrived { d2, ..Arrived::of(&arrival, wo, beta, s, None) })
        });
        if bsdf.is_connectible() && settings.wants(s, 1) {
            let numbers = lens_numbers(&scene.camera, &mut sampler, s);
            if let Some(lens) = scene.camera.sample_lens(at.p(), &numbers) {
                if let Some(value) = bsdf.eval(at, wo, lens.wi, Transport::Importance) {
                    let segment = Ray::segment(at.origin(lens.wi), lens.p);
                    let visible = scene.visibility(&segment, &mut recorder.rays.lens);
                    // F holds the cosine at the surface: We·cosθ/d² is the camera's density over d².
                    let scale = lens.pdf.0 / (lens.d2 * light_paths_per_pass);
                    recorder.tell(|| made(s, lens.pixel, numbers, beta * value.f * scale as f32, visible));
                    if visible > 0.0 {
                        recorder.splat(s, 1, lens.pixel, beta * value.f * (scale as f32 * visible));
                    }
                }
            }
        }
        let block = dimensions::START + (s - 2) * dimensions::BLOCK;
        sampler.set_dimension(block);
        let u = sampler.next_2d();
        let lobe = if bsdf.chooses_lobe() { sampler.next_1d() } else { 0.0 };
        let Some(next) = bsdf.sample(at, wo, lobe, u, Transport::Importance) else {
            recorder.tell(|| Step::Ended(End::Absorbed));
            return;
        };
        recorder.tell(|| Step::from(&next));
        if settings.class.ends_light_subpath(light, s, next.delta) {
            recorder.tell(|| Step::Ended(End::Class));
            return;
        }
        beta *= next.weight;
        let Some(q) = roulette.survive(beta, next.eta_scale, || {
            sampler.set_dimension(block + dimensions::ROULETTE);
            sampler.next_1d()
        }) else {
            recorder.tell(|| Step::Ended(End::Roulette));
            return;
        };
        recorder.tell(|| Step::Survived(q));
        beta /= q;
        if T {
            from = at.p();
        }
        ray = Ray::new(at.origin(next.wi), next.wi);
        s += 1;
    }
    recorder.tell(|| Step::Ended(End::Length));
}

//! Path tracing: camera subpaths with next-event estimation and BSDF sampling, combined by MIS.

use super::trace::{Arrived, End, Made, Step};
use super::worth::{RayRoulette, Thresholds};
use super::{PixelSample, Recorder, Settings, Technique};
use crate::accel::Accel;
use crate::bsdf::{Bsdf, Transport};
use crate::camera::{Camera, CameraRay};
use crate::light::{DirectSample, LightEdge, LightPoint, Receiver};
use crate::math::{Ray, Rgb, distance_squared, scaled};
use crate::planted::{Bug, planted};
use crate::sampling::{Sampler, Stream};
use crate::scene::desc::Heuristic;
use crate::scene::{Reached, Scene};

/// Sampler dimensions: the film takes number 0, each bounce a block.
pub(crate) mod dimensions {
    pub const BLOCK: u32 = 6;
    /// Followed by the choice of a lobe.
    pub const DIRECTION: u32 = 1;
    pub const ROULETTE: u32 = 3;
    /// Followed by the choice of a part of the light.
    pub const LIGHT_CHOICE: u32 = 4;
    pub const LIGHT_POINT: u32 = 6;
    /// The lens point stands beyond all bounces: cameras without a lens leave all others where they are.
    pub const LENS: u32 = 1 << 31;
}

/// The camera ray of a sample whose sampler stands at its start.
#[inline]
pub(crate) fn camera_ray(camera: &Camera, pixel: [u32; 2], sampler: &mut Sampler) -> CameraRay {
    let film = sampler.next_2d();
    let lens = if camera.has_lens() {
        sampler.set_dimension(dimensions::LENS);
        sampler.next_2d()
    } else {
        [0.5; 2]
    };
    camera.generate_ray(pixel, film, lens)
}

/// A light and a point on it for next-event estimation at the receiver, their density with the choice of the light in it;
/// `None` where no light shines on the receiver. `block` is the first dimension of the bounce.
#[inline(always)]
pub(super) fn sample_light<A: Accel>(
    scene: &Scene<A>,
    receiver: &Receiver,
    sampler: &mut Sampler,
    block: u32,
) -> Option<(u32, DirectSample)> {
    let choice = scene.light_choice.as_ref()?;
    sampler.set_dimension(block + dimensions::LIGHT_CHOICE);
    let (id, part, pmf) = choice.sample_direct(receiver, || sampler.next_f64())?;
    let light = &scene.lights[id as usize];
    let u_part = if light.shines_in_parts() { sampler.next_f64() } else { 0.0 };
    sampler.set_dimension(block + dimensions::LIGHT_POINT);
    let y = light.sample_direct(&scene.geometry, receiver.p, part, u_part, sampler.next_2d())?;
    Some((id, DirectSample { pdf: y.pdf * pmf, ..y }))
}

/// Weight of a technique of density `p` against one of density `q` (same measure) under the heuristic
/// [Veach97 (9.15)].
#[inline]
fn weight(settings: &Settings, p: f64, q: f64) -> f32 {
    if !settings.weighted {
        return 1.0;
    }
    // Of two points in one plane, to rounding, neither density need be above zero.
    if q == 0.0 {
        return 1.0;
    }
    let w = match settings.heuristic {
        Heuristic::Power => {
            let r = q / p;
            1.0 / (1.0 + r * r)
        }
        Heuristic::Balance => 1.0 / (1.0 + q / p),
        Heuristic::Uniform => 0.5,
    };
    w as f32
}

/// For who replays a sample: see `Made`.
#[cold]
fn made(s: u32, t: u32, light: u32, values: Option<[Rgb; 2]>, visible: f32) -> Step {
    Step::Made(Made { technique: Technique { s, t }, seen: None, light: Some(light), values, visible })
}

/// One camera path.
pub(super) fn sample<A: Accel, const T: bool>(
    scene: &Scene<A>,
    settings: &Settings,
    thresholds: Option<&Thresholds>,
    sample: PixelSample,
    recorder: &mut Recorder<T>,
) {
    let pixel_key = sample.key(scene.camera.resolution());
    let mut sampler = Sampler::new(settings.sampler, settings.seed, pixel_key, Stream::Camera, sample.index);
    let mut coins = sampler.coins();
    let mut ray_roulette = RayRoulette::new(&sampler);
    ray_roulette.turn_to(thresholds, sample.pixel);
    recorder.begin(sample.pixel, sample.index);
    recorder.rays.camera_paths += 1;
    if !scene.needs.light {
        return;
    }
    let CameraRay { mut ray, pdf, lens, .. } = camera_ray(&scene.camera, sample.pixel, &mut sampler);
    recorder.tell(|| Step::Camera { from: ray.o, toward: ray.d, pdf: pdf.0, lens });
    let mut beta = Rgb::ONE;
    let mut roulette = settings.roulette(beta);
    // Density per solid angle of the last sampled direction; `None` when next-event estimation could not have
    // made the edge: the camera's own, or one that left a delta lobe.
    let mut pdf_last: Option<f64> = None;
    let mut receiver = Receiver::anywhere(ray.o);
    let mut varying = Bsdf::Black;
    // Vertices including the camera's and the one being arrived at.
    let mut t = 2;
    loop {
        let wo = -ray.d;
        let reached = scene.follow(ray, &mut coins, &mut recorder.rays.camera, &mut varying);
        recorder.tell(|| match &reached {
            Reached::Surface(arrival) => {
                let d2 = if t == 2 {
                    scene.camera.edge_d2(ray.o, arrival.at.p())
                } else {
                    distance_squared(receiver.p, arrival.at.p())
                };
                Step::Arrived(Arrived { d2, ..Arrived::of(arrival, wo, beta, t, None) })
            }
            Reached::Infinity { through_window } => Step::Left { toward: ray.d, through_window: *through_window },
        });
        // s = 0: the path has hit light `id`. Next-event estimation could not have found it behind a window.
        let mut hit = |id: u32, point: LightPoint, through_window: bool| {
            let light = &scene.lights[id as usize];
            let le = light.emitted(&point, wo);
            if le == Rgb::ZERO || !settings.wants(0, t) {
                return;
            }
            let w = match pdf_last {
                Some(p) if !through_window => {
                    let Some(edge) = point.edge_from(receiver.p) else { return };
                    let q = if planted(Bug::NoLightChoiceAtHitsOfPath) {
                        light.pdf_direct(&scene.geometry, receiver.p, &point).0
                    } else {
                        scene.pdf_direct(&receiver, id, &point).0
                    };
                    // Densities at the light, both times d².
                    weight(settings, p * edge.cos, q * edge.d2)
                }
                _ => 1.0,
            };
            recorder.tell(|| made(0, t, id, Some([beta * le, beta * le * w]), 1.0));
            recorder.add(0, t, beta * le * w);
        };
        // Looked at where it lies: a copy made of what was just written waits for it.
        let arrival = match &reached {
            Reached::Surface(arrival) => arrival,
            &Reached::Infinity { through_window } => {
                if settings.class.ends_camera_subpath(t, true) {
                    return;
                }
                for &id in &scene.environments {
                    hit(id, LightPoint::Infinite(ray.d), through_window);
                }
                return;
            }
        };
        if settings.class.ends_camera_subpath(t, arrival.through_window) {
            recorder.tell(|| Step::Ended(End::Class));
            return;
        }
        let at = &arrival.at;
        if let Some(id) = arrival.light {
            hit(id, LightPoint::Surface(*at), arrival.through_window);
        }
        let bounces = t - 1;
        if bounces > settings.max_bounces + u32::from(planted(Bug::DepthOfPath)) || !arrival.bsdf.scatters() {
            recorder.tell(|| Step::Ended(if arrival.bsdf.scatters() { End::Length } else { End::Black }));
            return;
        }
        let bsdf = arrival.bsdf;
        let block = (t - 2) * dimensions::BLOCK;
        receiver = Receiver::new(at, wo, bsdf.transmits());
        // s = 1: next-event estimation.
        if bsdf.is_connectible() && settings.wants(1, t) {
            let y = sample_light(scene, &receiver, &mut sampler, block);
            if let Some((id, y, edge)) = y.and_then(|(id, y)| Some((id, y, y.point.edge_from(at.p())?))) {
                recorder.tell(|| Step::LightSampled { light: id, point: y.point, pdf: y.pdf.0 });
                let light = &scene.lights[id as usize];
                let LightEdge { wi, d2, cos } = edge;
                let le = light.emitted(&y.point, -wi);
                let value = if le == Rgb::ZERO { None } else { bsdf.eval(at, wo, wi, Transport::Radiance) };
                if let Some(value) = value {
                    let pdf_light = y.pdf.0 * d2;
                    // Densities at the light, both multiplied by d²/cos to stay finite as d shrinks.
                    let w = match light.is_delta() {
                        true => 1.0,
                        false => weight(settings, pdf_light, f64::from(value.pdf_fwd.0) * cos),
                    };
                    let weighted = |w: f32| scaled(beta * value.f, le, cos / pdf_light * f64::from(w));
                    let contribution = weighted(w);
                    let segment = y.point.shadow_ray(at);
                    let visible =
                        ray_roulette.visible(contribution, || scene.visibility(&segment, &mut recorder.rays.shadow));
                    recorder.tell(|| made(1, t, id, Some([weighted(1.0), contribution]), visible));
                    recorder.tell_blocker(visible, || scene.blocker(&segment));
                    if visible > 0.0 {
                        recorder.add(1, t, contribution * visible);
                    }
                } else {
                    recorder.tell(|| made(1, t, id, None, 0.0));
                }
            }
        }
        sampler.set_dimension(block + dimensions::DIRECTION);
        let u = sampler.next_2d();
        let lobe = if bsdf.chooses_lobe() { sampler.next_1d() } else { 0.0 };
        let Some(next) = bsdf.sample(at, wo, lobe, u, Transport::Radiance) else {
            recorder.tell(|| Step::Ended(End::Absorbed));
            return;
        };
        recorder.tell(|| Step::from(&next));
        if settings.class.ends_camera_subpath(t, next.delta) {
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
        pdf_last = (!next.delta).then_some(f64::from(next.pdf_fwd.0));
        ray = Ray::new(at.origin(next.wi), next.wi);
        t += 1;
    }
}

//! Path tracing: camera subpaths with next-event estimation and BSDF sampling, combined by MIS.

use super::{PixelSample, Recorder, Settings};
use crate::accel::Accel;
use crate::bsdf::Transport;
use crate::light::LightPoint;
use crate::math::{Ray, Rgb, distance_squared};
use crate::sampling::{Sampler, Stream};
use crate::scene::Scene;
use crate::scene::desc::Heuristic;

/// Sampler dimensions: the film takes number 0, each bounce a block.
pub(super) mod dimensions {
    pub const BLOCK: u32 = 6;
    /// Followed by the choice of a lobe.
    pub const DIRECTION: u32 = 1;
    pub const ROULETTE: u32 = 3;
    /// Followed by the choice of a part of the light.
    pub const LIGHT_CHOICE: u32 = 4;
    pub const LIGHT_POINT: u32 = 6;
}

/// Weight of a technique of density `p` against one of density `q` (same measure) under the heuristic
/// [Veach97 (9.15)].
#[inline]
fn weight(settings: &Settings, p: f64, q: f64) -> f32 {
    if !settings.weighted {
        return 1.0;
    }
    let w = match settings.heuristic {
        Heuristic::Power => {
            let r = q / p;
            1.0 / (1.0 + r * r)
        }
        Heuristic::Balance => 1.0 / (1.0 + q / p),
        Heuristic::Uniform => {
            if q > 0.0 {
                0.5
            } else {
                1.0
            }
        }
    };
    w as f32
}

/// One camera path.
pub(super) fn sample<A: Accel>(scene: &Scene<A>, settings: &Settings, sample: PixelSample, recorder: &mut Recorder) {
    let pixel_key = sample.key(scene.camera.resolution());
    let mut sampler = Sampler::new(settings.sampler, settings.seed, pixel_key, Stream::Camera, sample.index);
    let mut coins = sampler.coins();
    recorder.begin(sample.pixel, sample.index);
    recorder.rays.camera_paths += 1;
    let Some(choice) = &scene.light_choice else { return };

    let mut ray = scene.camera.generate_ray(sample.pixel, sampler.next_2d()).ray;
    let mut beta = Rgb::ONE;
    let mut roulette = settings.roulette(beta);
    // Density per solid angle of the last sampled direction; `None` when next-event estimation could not have
    // made the edge: the camera's own, or one that left a delta lobe.
    let mut pdf_last: Option<f64> = None;
    let mut from = ray.o;
    // Vertices including the camera's and the one being arrived at.
    let mut t = 2;
    loop {
        let Some(arrival) = scene.arrive(ray, &mut coins, &mut recorder.rays.camera) else { return };
        let at = &arrival.at;
        let wo = -ray.d;
        // s = 0: the path has hit an emitter.
        if let (Some(id), true) = (arrival.surface.light, settings.wants(0, t)) {
            let light = &scene.lights[id as usize];
            let point = LightPoint::Surface(*at);
            let le = light.emitted(&point, wo);
            if le != Rgb::ZERO {
                let w = match pdf_last {
                    Some(p) if !arrival.through_window => {
                        let area = light.pdf_direct(&scene.geometry, &point) * choice.pmf(id);
                        let d2 = distance_squared(from, at.p());
                        let q = area.to_solid_angle(point.cos(wo), d2);
                        weight(settings, p, f64::from(q.0))
                    }
                    _ => 1.0,
                };
                recorder.add(0, t, beta * le * w);
            }
        }
        let bounces = t - 1;
        if bounces > settings.max_bounces || !arrival.surface.bsdf.scatters() {
            return;
        }
        let bsdf = &arrival.surface.bsdf;
        let block = (t - 2) * dimensions::BLOCK;
        // s = 1: next-event estimation.
        if bsdf.is_connectible() && settings.wants(1, t) {
            sampler.set_dimension(block + dimensions::LIGHT_CHOICE);
            let (id, pmf) = choice.sample(sampler.next_f64());
            let light = &scene.lights[id as usize];
            let part = if light.has_parts() { sampler.next_f64() } else { 0.0 };
            sampler.set_dimension(block + dimensions::LIGHT_POINT);
            if let Some(y) = light.sample_direct(&scene.geometry, part, sampler.next_2d()) {
                let p = y.point.p();
                let wi = (p - at.p()).normalize();
                let le = light.emitted(&y.point, -wi);
                let value = if le == Rgb::ZERO { None } else { bsdf.eval(at, wo, wi, Transport::Radiance) };
                if let Some(value) = value {
                    let end = y.point.segment_end(at.p());
                    let visible = scene.visibility(at.origin(wi), end, &mut recorder.rays.shadow);
                    if visible > 0.0 {
                        let d2 = distance_squared(at.p(), p);
                        let cos = f64::from(y.point.cos(-wi).abs());
                        let pdf_light = (y.pdf * pmf).0 * d2;
                        // Densities at the light, both multiplied by d²/cos to stay finite as d shrinks.
                        let w = if light.is_delta() {
                            1.0
                        } else {
                            weight(settings, pdf_light, f64::from(value.pdf_fwd.0) * cos)
                        };
                        recorder.add(1, t, beta * value.f * le * ((cos / pdf_light) as f32 * w * visible));
                    }
                }
            }
        }
        sampler.set_dimension(block + dimensions::DIRECTION);
        let u = sampler.next_2d();
        let lobe = sampler.next_1d();
        let Some(next) = bsdf.sample(at, wo, lobe, u, Transport::Radiance) else { return };
        beta *= next.weight;
        let Some(q) = roulette.survive(beta, next.eta_scale, || {
            sampler.set_dimension(block + dimensions::ROULETTE);
            sampler.next_1d()
        }) else {
            return;
        };
        beta /= q;
        pdf_last = (!next.delta).then_some(f64::from(next.pdf_fwd.0));
        from = at.p();
        ray = Ray::new(at.origin(next.wi), next.wi);
        t += 1;
    }
}

//! Delta points: every ray aimed at one finds it, whatever the file's units, and no transport ray ever does.
//!
//! The modules test the same of themselves. Here it is tested of whole scenes: read, prepared (which recentres, scales
//! and chooses each point's ε) and built with `AccelOptions::delta_points`, on both accelerators.

mod common;

use common::{facing, quad, render_job, scene_on, settings, sphere};
use serde_json::{Value, json};
use twinlight::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use twinlight::accel::embree::EmbreeAccel;
use twinlight::accel::{Accel, AccelOptions};
use twinlight::geometry::DeltaPoint;
use twinlight::integrator::{Crop, Integrator, Settings};
use twinlight::math::{DVec3, Ray, Vec3};
use twinlight::render::RenderJob;
use twinlight::scene::Scene;

const WITH: AccelOptions = AccelOptions { delta_points: true, threads: 0 };

/// SplitMix64 (Steele et al. 2014): enough for test cases, and the same on every machine.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform in the cube of ±1.
    fn cube(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// What stands in a scene besides its lights.
#[derive(Clone, Copy, Debug)]
enum Setting {
    /// The lights and the camera alone: preparation brings the lights to the unit cube.
    Alone,
    /// In a room of their own scale.
    Room,
    /// With something at the world's origin, so that the offset stays in render space and the lights crowd there.
    Anchored,
}

/// Point and spot lights within `scale` of `offset`, in the file's units.
fn lights_at(random: &mut Random, setting: Setting, scale: f64, offset: f64, count: usize) -> Value {
    let center = random.cube().normalize() * offset;
    let at = |p: DVec3| json!([p.x, p.y, p.z]);
    let white = json!({ "type": "lambertian", "albedo": 0.5 });
    let surfaces = match setting {
        Setting::Alone => vec![],
        Setting::Room => vec![sphere(center, 2.5 * scale, true, white)],
        Setting::Anchored => vec![sphere(DVec3::ZERO, scale, false, white)],
    };
    let lights: Vec<Value> = (0..count)
        .map(|i| {
            let position = at(center + scale * random.cube());
            if i % 2 == 0 {
                json!({ "type": "point", "position": position, "intensity": 1 })
            } else {
                json!({ "type": "spot", "position": position, "direction": [0, -1, 0], "intensity": 1,
                        "inner_angle": 20, "outer_angle": 40 })
            }
        })
        .collect();
    let eye = center + scale * 4.0 * random.cube().normalize();
    json!({
        "camera": { "resolution": 4, "transform": { "from": at(eye), "at": at(center), "up": [0.6, 0.64, 0.48] } },
        "surfaces": surfaces,
        "lights": lights
    })
}

/// Where a ray toward `p` starts: anywhere that a ray of this scene can, from a few ulps beside the point to the far
/// corner of what preparation promises.
fn origin(random: &mut Random, p: Vec3, eye: Vec3, farthest: f64) -> Vec3 {
    let o = match random.below(4) {
        0 => random.cube() * farthest,
        1 => eye.as_dvec3(),
        // Log-uniform distances down to 1e-7.
        2 => p.as_dvec3() + random.cube() * 10_f64.powf(-7.0 * random.unit()),
        _ => random.cube().signum() * farthest,
    };
    let mut o = o.clamp(DVec3::splat(-farthest), DVec3::splat(farthest)).as_vec3a();
    while o == p {
        let axis = random.below(3);
        o[axis] = f32::from_bits(p[axis].to_bits().wrapping_add(1 + random.below(8) as u32));
    }
    o
}

/// Where a ray meets the nearest delta point, by trying each.
fn by_trying_each(points: &[DeltaPoint], ray: &Ray) -> Option<f32> {
    points.iter().filter_map(|p| p.intersect(ray)).min_by(f32::total_cmp)
}

/// Demands that a ray meets the delta point it is aimed at, or one that lies before it.
fn found<A: Accel>(scene: &Scene<A>, ray: &Ray, aimed: usize, scene_is: &dyn std::fmt::Debug) {
    let points = &scene.geometry.delta_points;
    let hit = scene.accel.intersect_delta(ray);
    let Some(hit) = hit else {
        panic!("{} misses {:?} aimed at by {ray:?} in {scene_is:?}", A::NAME, points[aimed]);
    };
    let nearest = by_trying_each(points, ray).unwrap_or(hit.t);
    let own = points[hit.point as usize].intersect(ray).expect("what is reported is met");
    // Points that crowd within their own ε have no order along the ray.
    let within = |point: usize| f64::from(points[point].epsilon) / ray.d.as_dvec3().length();
    let slack = within(aimed);
    let is_nearest = f64::from(hit.t - nearest) <= slack;
    assert!(is_nearest, "{} {ray:?} in {scene_is:?}: {hit:?} is not the nearest, {nearest}", A::NAME);
    // It may be told at the place of one met before it, its own ε short of where it is, but for the rounding of that place.
    let is_there =
        f64::from((hit.t - own).abs()) <= within(hit.point as usize).max(slack) + f64::from(hit.t * f32::EPSILON);
    assert!(is_there, "{} {ray:?} in {scene_is:?}: {hit:?} is at {own}", A::NAME);
    if points.len() == 1 {
        assert_eq!(hit.point, 0);
    }
}

fn every_aimed_ray_finds_its_point<A: Accel>() {
    let mut random = Random(7);
    let (mut aimed, mut past) = (0, 0);
    for scale in [1e-4, 1e-2, 1.0, 1e2, 1e4] {
        for offset in [0.0, 1.0, 1e3, 1e5] {
            for setting in [Setting::Alone, Setting::Room, Setting::Anchored] {
                for count in [1, 7] {
                    let what = (setting, scale, offset, count);
                    let json = lights_at(&mut random, setting, scale, offset, count);
                    let scene: Scene<A> = scene_on(&json, WITH);
                    let points = &scene.geometry.delta_points;
                    assert_eq!(points.len(), count);
                    let eye = scene.camera.generate_ray([0, 0], [0.5; 2], [0.5; 2]).ray.o;
                    let farthest =
                        points.iter().fold(eye.abs().max_element(), |m, p| m.max(p.position.abs().max_element()));
                    let farthest = f64::from(farthest.max(1.0));
                    for _ in 0..4200 {
                        let target = random.below(count);
                        let p = points[target].position;
                        let o = origin(&mut random, p, eye, farthest);
                        let d = (p - o).normalize();
                        found(&scene, &Ray::new(o, d), target, &what);
                        // The segment whose end is the point itself.
                        found(&scene, &Ray::segment(o, p), target, &what);
                        aimed += 2;
                        // It is a point, not a ball: past all points by their ε and more, none is found.
                        let aside = d.any_orthonormal_vector() * (points[target].epsilon * 4.0);
                        let beside = Ray::segment(o, p + aside);
                        if by_trying_each(points, &beside).is_none() {
                            assert!(scene.accel.intersect_delta(&beside).is_none(), "{} {what:?}", A::NAME);
                            past += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(aimed >= 1_000_000 && past > aimed / 8, "{aimed} aimed, {past} past");
}

#[cfg(feature = "embree")]
#[test]
fn every_aimed_ray_finds_its_point_on_embree() {
    every_aimed_ray_finds_its_point::<EmbreeAccel>();
}

#[test]
fn every_aimed_ray_finds_its_point_on_the_bvh() {
    every_aimed_ray_finds_its_point::<BvhAccel>();
}

/// A room with a mirror ball and a lamp, and point and spot lights, one of them in the middle of the view and one on
/// the floor.
fn room(scale: f64) -> Value {
    let white = json!({ "type": "lambertian", "albedo": [0.7, 0.6, 0.5], "two_sided": true });
    let at = |p: [f64; 3]| p.map(|x| x * scale);
    let wall = |o: [f64; 3], z: DVec3| quad(&facing(DVec3::from(at(o)), z), [2.0 * scale, 2.0 * scale], white.clone());
    let intensity = scale * scale;
    json!({
        "camera": { "transform": { "from": at([0.0, 0.0, 3.5]), "at": at([0.0, 0.0, 0.0]) }, "vfov": 40,
                    "resolution": [16, 12] },
        "surfaces": [
            wall([0.0, -1.0, 0.0], DVec3::Y), wall([0.0, 1.0, 0.0], -DVec3::Y), wall([0.0, 0.0, -1.0], DVec3::Z),
            wall([-1.0, 0.0, 0.0], DVec3::X), wall([1.0, 0.0, 0.0], -DVec3::X),
            sphere(DVec3::new(-0.4, -0.6, 0.1) * scale, 0.35 * scale, false, json!({ "type": "mirror" })),
            quad(&facing(DVec3::new(0.3, 0.99, 0.0) * scale, -DVec3::Y), [0.3 * scale, 0.3 * scale],
                 json!({ "type": "diffuse light", "emit": 2 }))
        ],
        "lights": [
            { "type": "point", "position": at([0.0, 0.0, 0.0]), "intensity": intensity },
            { "type": "point", "position": at([0.5, -1.0, 0.2]), "intensity": intensity },
            { "type": "spot", "position": at([0.6, 0.7, 0.5]), "at": at([-0.2, -1.0, 0.0]), "intensity": 3.0 * intensity,
              "inner_angle": 15, "outer_angle": 35 }
        ]
    })
}

/// Queries of transport answer alike with and without the delta points' own index, however closely they pass them.
fn transport_does_not_see_them<A: Accel>() {
    let mut random = Random(9);
    for scale in [1e-4, 1.0, 1e4] {
        let json = room(scale);
        let with: Scene<A> = scene_on(&json, WITH);
        let without: Scene<A> = scene_on(&json, AccelOptions::default());
        let points = &with.geometry.delta_points;
        let (mut free, mut blocked) = (0, 0);
        for _ in 0..20_000 {
            let p = points[random.below(points.len())].position;
            let o = (random.cube() * 0.4).as_vec3a();
            for ray in [Ray::new(o, p - o), Ray::segment(o, p), Ray::new(p, o - p), Ray::segment(p, o)] {
                assert!(with.accel.intersect_delta(&ray).is_some(), "{} {ray:?}", A::NAME);
                assert!(without.accel.intersect_delta(&ray).is_none(), "{}: not asked for, yet built", A::NAME);
                assert_eq!(with.accel.intersect(&ray), without.accel.intersect(&ray), "{} {ray:?}", A::NAME);
                let mut answers = [[true; 2]; 2];
                with.accel.occluded_many(&[ray, ray], &mut answers[0]);
                without.accel.occluded_many(&[ray, ray], &mut answers[1]);
                let one = with.accel.occluded(&ray);
                assert_eq!(one, without.accel.occluded(&ray), "{} {ray:?}", A::NAME);
                assert_eq!(answers, [[one; 2]; 2], "{} {ray:?}", A::NAME);
            }
            let toward = Ray::segment(o, p);
            let hidden = with.accel.occluded(&toward);
            free += usize::from(!hidden);
            blocked += usize::from(hidden);
        }
        assert!(free > 10_000 && blocked > 100, "{}: {free} free, {blocked} blocked", A::NAME);

        // What stood in the way was never a point: with the room taken away nothing is met.
        let mut alone = json;
        alone["surfaces"] = json!([]);
        let alone: Scene<A> = scene_on(&alone, WITH);
        for point in &alone.geometry.delta_points {
            for _ in 0..5000 {
                let toward = Ray::segment(random.cube().as_vec3a(), point.position);
                assert!(alone.accel.intersect_delta(&toward).is_some(), "{}", A::NAME);
                assert!(alone.accel.intersect(&toward).is_none() && !alone.accel.occluded(&toward), "{}", A::NAME);
            }
        }
    }
}

#[cfg(feature = "embree")]
#[test]
fn transport_does_not_see_them_on_embree() {
    transport_does_not_see_them::<EmbreeAccel>();
}

#[test]
fn transport_does_not_see_them_on_the_bvh() {
    transport_does_not_see_them::<BvhAccel>();
}

fn images_are_the_same_bits<A: Accel>() {
    for scale in [1e-4, 1.0, 1e4] {
        let json = room(scale);
        let with: Scene<A> = scene_on(&json, WITH);
        let without: Scene<A> = scene_on(&json, AccelOptions::default());
        // Were the index not there, equal images would prove nothing.
        let center = with.geometry.delta_points[0].position;
        let aimed = Ray::segment(with.camera.generate_ray([0, 0], [0.5; 2], [0.5; 2]).ray.o, center);
        assert!(with.accel.intersect_delta(&aimed).is_some() && without.accel.intersect_delta(&aimed).is_none());
        for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
            let job = RenderJob {
                settings: Settings { seed: 3, ..settings(integrator, 8) },
                samples: 16,
                crop: Crop::full(with.camera.resolution()),
                threads: 2,
                pyramid: None,
            };
            let [a, b] = [render_job(&with, &job), render_job(&without, &job)];
            let bits = |image: &twinlight::film::Image| -> Vec<[u32; 3]> {
                image.rgb.iter().map(|p| p.map(f32::to_bits)).collect()
            };
            assert!(bits(&a.image) == bits(&b.image), "{} {integrator:?}: the images differ", A::NAME);
            assert_eq!(a.rays, b.rays, "{} {integrator:?}", A::NAME);
            let mean = a.image.mean();
            assert!(mean.iter().all(|m| (0.01..10.0).contains(m)), "{} {integrator:?}: mean {mean:?}", A::NAME);
        }
    }
}

#[cfg(feature = "embree")]
#[test]
fn images_are_the_same_bits_on_embree() {
    images_are_the_same_bits::<EmbreeAccel>();
}

#[test]
fn images_are_the_same_bits_on_the_bvh() {
    images_are_the_same_bits::<BvhAccel>();
}

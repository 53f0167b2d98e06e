//! Embree against closed forms and against the same code called directly.

use std::sync::Arc;

use super::device::Device;
use super::scene::{RayMask, SceneBuilder};
use super::user::UserGeometry;
use super::*;
use crate::geometry::{DeltaPoint, Quadric, QuadricKind};
use crate::math::{DAffine3, DMat3, DVec3};

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
    fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / 16_777_216.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform in the cube of ±1.
    fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

fn build(geometry: Geometry) -> EmbreeAccel {
    EmbreeAccel::build(Arc::new(geometry), AccelOptions { delta_points: true, ..AccelOptions::default() })
        .expect("Embree builds")
}

fn soup(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Geometry {
    let triangle_surface = vec![0; triangles.len()];
    Geometry { positions, triangles, triangle_surface, ..Geometry::default() }
}

fn one_triangle() -> EmbreeAccel {
    build(soup(vec![Vec3::new(0.0, 0.0, 2.0), Vec3::new(1.0, 0.0, 2.0), Vec3::new(0.0, 1.0, 2.0)], vec![[0, 1, 2]]))
}

/// Twelve triangles around ±1, sharing eight vertices, mapped to `center ± half`.
fn cube(center: Vec3, half: f32) -> Geometry {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    soup((0..8).map(|i| center + corner(i) * half).collect(), triangles)
}

fn random_quadrics(random: &mut Random, count: usize) -> Vec<Quadric> {
    (0..count)
        .map(|i| {
            let (x, y) = (random.cube().as_dvec3().normalize(), random.cube().as_dvec3());
            let z = x.cross(y).normalize();
            let scale = DVec3::splat(0.02) + 0.3 * random.cube().as_dvec3().abs();
            let linear = DMat3::from_cols(x, z.cross(x), z) * DMat3::from_diagonal(scale);
            let to_world = DAffine3::from_mat3_translation(linear, random.cube().as_dvec3());
            Quadric::new(if i % 2 == 0 { QuadricKind::Sphere } else { QuadricKind::Disk }, to_world, false)
        })
        .collect()
}

#[test]
fn a_triangle_is_hit_where_it_is() {
    let accel = one_triangle();
    let ray = Ray::new(Vec3::new(0.25, 0.5, 0.0), Vec3::new(0.0, 0.0, 0.5));
    let hit = accel.intersect(&ray).expect("aimed at it");
    assert_eq!(hit, Hit { t: 4.0, geometry: GeometryKind::Triangle, primitive: 0, u: 0.25, v: 0.5 });
    assert!(accel.occluded(&ray));
    for (tmin, tmax, met) in [(0.0, 3.999, false), (4.001, 9.0, false), (3.999, 4.001, true), (0.0, 4.0, true)] {
        let part = Ray { tmin, tmax, ..ray };
        assert_eq!(accel.intersect(&part).is_some(), met, "{tmin} … {tmax}");
        assert_eq!(accel.occluded(&part), met, "{tmin} … {tmax}");
    }
    // A negative start counts as zero: what lies behind the origin is not met.
    let past = Ray { o: Vec3::new(0.25, 0.5, 3.0), tmin: -9.0, ..ray };
    assert!(accel.intersect(&past).is_none() && !accel.occluded(&past));
    assert_eq!(accel.intersect(&Ray { tmin: -9.0, ..ray }).expect("aimed at it"), hit);
    let beside = Ray::new(Vec3::new(0.75, 0.5, 0.0), Vec3::Z);
    assert!(accel.intersect(&beside).is_none() && !accel.occluded(&beside));
}

#[test]
fn a_ray_that_starts_on_a_triangle_meets_it_at_zero() {
    let on = Ray::new(Vec3::new(0.25, 0.5, 2.0), Vec3::Z);
    assert_eq!(one_triangle().intersect(&on).map(|hit| hit.t), Some(0.0));
    assert!(one_triangle().occluded(&on));
}

#[test]
fn quadrics_are_met_as_their_own_code_meets_them() {
    let mut random = Random(1);
    let quadrics = random_quadrics(&mut random, 60);
    let accel = build(Geometry { quadrics: quadrics.clone(), quadric_surface: vec![0; 60], ..Geometry::default() });
    let (mut hits, mut grazing) = (0, 0);
    for i in 0..200_000 {
        let o = random.cube() * [1.0, 3.0, 30.0][i % 3];
        let target = &quadrics[random.below(quadrics.len())];
        // Random, or aimed at an outline, where a cut corner of the bounding box would show.
        let (aim, ray) = if i % 2 == 0 {
            let aim = random.cube();
            (false, Ray::new(o, aim - o))
        } else {
            let on = target.project(target.to_world.translation + random.cube().as_dvec3()).0;
            (true, Ray::new(o, on.as_vec3a() - o))
        };
        let direct = quadrics
            .iter()
            .enumerate()
            .filter_map(|(i, q)| q.intersect(&ray).map(|t| (t, i as u32)))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let met = accel.intersect(&ray);
        assert_eq!(met.map(|h| (h.t, h.primitive)), direct, "{ray:?}");
        assert!(met.is_none_or(|h| h.geometry == GeometryKind::Quadric));
        assert_eq!(accel.occluded(&ray), direct.is_some(), "{ray:?}");
        hits += usize::from(direct.is_some());
        grazing += usize::from(aim && direct.is_none());
    }
    assert!(hits > 100_000 && grazing > 100, "the cases are not what they should be: {hits} {grazing}");
}

#[test]
fn triangles_and_quadrics_stand_before_each_other() {
    let quadric = |z| Quadric::new(QuadricKind::Disk, DAffine3::from_translation(DVec3::new(0.0, 0.0, z)), false);
    let triangle = vec![Vec3::new(-9.0, -9.0, 2.0), Vec3::new(9.0, -9.0, 2.0), Vec3::new(0.0, 9.0, 2.0)];
    let accel = build(Geometry {
        quadrics: vec![quadric(3.0), quadric(1.0)],
        quadric_surface: vec![0; 2],
        ..soup(triangle, vec![[0, 1, 2]])
    });
    let first = |o, d| accel.intersect(&Ray::new(o, d)).map(|h| (h.geometry, h.primitive, h.t));
    assert_eq!(first(Vec3::ZERO, Vec3::Z), Some((GeometryKind::Quadric, 1, 1.0)));
    assert_eq!(first(Vec3::Z * 1.5, Vec3::Z), Some((GeometryKind::Triangle, 0, 0.5)));
    assert_eq!(first(Vec3::Z * 2.5, Vec3::Z), Some((GeometryKind::Quadric, 0, 0.5)));
    assert_eq!(first(Vec3::Z * 3.5, Vec3::Z), None);
}

/// A point `scale` around `offset`, other than `not` even where f32 cannot tell such points apart.
fn near(random: &mut Random, offset: Vec3, scale: f32, not: Vec3) -> Vec3 {
    let mut p = offset + random.cube() * scale;
    while p == not {
        let axis = random.below(3);
        let away = p[axis].to_bits().wrapping_add(1 + random.below(8) as u32);
        p[axis] = f32::from_bits(away);
    }
    p
}

#[test]
fn every_ray_aimed_at_a_delta_point_finds_it() {
    let mut random = Random(2);
    let (mut aimed, mut beside) = (0, 0);
    for scale in [1e-4, 1e-2, 1.0, 1e2, 1e4] {
        for offset in [0.0, 1.0, 1e3, 1e5] {
            for _ in 0..10 {
                let offset = random.cube().normalize() * offset;
                let p = near(&mut random, offset, scale, Vec3::NAN);
                let origins: Vec<_> = (0..5000).map(|_| near(&mut random, offset, scale, p)).collect();
                let reach = origins.iter().map(|o| (p - o).length()).fold(0.0, f32::max);
                let point = DeltaPoint::new(p, reach);
                let accel = build(Geometry { delta_points: vec![point], ..Geometry::default() });
                for o in origins {
                    let ray = Ray::new(o, (p - o).normalize());
                    let hit = accel.intersect_delta(&ray);
                    assert_eq!(hit.map(|h| h.point), Some(0), "scale {scale}, {p} from {o}");
                    // The segment's end is the point itself.
                    assert!(accel.intersect_delta(&Ray::segment(o, p)).is_some(), "scale {scale}, {p} from {o}");
                    aimed += 1;
                    // It is a point, not a ball: past it by 4ε, where f32 can express that, it is not found.
                    let aside = ray.d.cross(Vec3::X) + ray.d.cross(Vec3::Y);
                    let past = Ray::segment(o, p + aside.normalize_or_zero() * (point.epsilon * 4.0));
                    if (p - o).length() > 100.0 * point.epsilon && aside.length() > 0.1 {
                        assert!(accel.intersect_delta(&past).is_none(), "scale {scale}, {p} from {o}");
                        beside += 1;
                    }
                }
            }
        }
    }
    assert!(aimed == 1_000_000 && beside > 500_000, "{aimed} {beside}");
}

#[test]
fn no_transport_ray_meets_a_delta_point() {
    let p = Vec3::new(0.1, 0.2, 0.3);
    let delta_points = || vec![DeltaPoint::new(p, 10.0)];
    let accel = build(Geometry { delta_points: delta_points(), ..cube(Vec3::ZERO, 1.0) });
    let mut random = Random(3);
    for _ in 0..10_000 {
        let o = random.cube() * 0.9;
        let towards = Ray::segment(o, p);
        assert!(accel.intersect_delta(&towards).is_some());
        assert!(accel.intersect(&towards).is_none() && !accel.occluded(&towards));
        let mut blocked = [true];
        accel.occluded_many(&[towards], &mut blocked);
        assert_eq!(blocked, [false]);
        // The walls in turn do not block the query for delta points, nor answer it.
        assert!(accel.intersect_delta(&Ray::segment(o + Vec3::X * 3.0, p)).is_some());
        assert!(accel.intersect_delta(&Ray::new(p + Vec3::X, Vec3::X)).is_none());
    }
    let geometry = Arc::new(Geometry { delta_points: delta_points(), ..cube(Vec3::ZERO, 1.0) });
    let unasked = EmbreeAccel::build(geometry, AccelOptions::default()).expect("Embree builds");
    assert!(unasked.intersect_delta(&Ray::segment(Vec3::ZERO, p)).is_none(), "not asked for, yet built");
}

#[test]
fn occluded_many_answers_as_occluded_does() {
    let mut random = Random(4);
    let positions: Vec<_> = (0..200)
        .flat_map(|_| {
            let center = random.cube();
            [(); 3].map(|()| center + random.cube() * 0.2)
        })
        .collect();
    let triangles = (0..200).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let quadrics = random_quadrics(&mut random, 10);
    let targets = positions.clone();
    let accel = build(Geometry { quadrics, quadric_surface: vec![0; 10], ..soup(positions, triangles) });
    let mut counts = [0; 2];
    for batch in 0..40_000 {
        let o = random.cube();
        let rays: Vec<_> = (0..batch % 35)
            .map(|i| match random.below(10) {
                0 => Ray::new(o, Vec3::ZERO),
                1 => Ray::new(o, Vec3::new(f32::NAN, 0.0, 1.0)),
                // At vertices and along edges, where a ray is on the border between two answers.
                2..=4 => Ray::segment(o, targets[random.below(targets.len())] * if i % 2 == 0 { 1.0 } else { 1.001 }),
                5 => Ray::new(o, random.cube()),
                _ => Ray::segment(if batch % 2 == 0 { o } else { random.cube() }, random.cube()),
            })
            .collect();
        let singly: Vec<_> = rays.iter().map(|ray| accel.occluded(ray)).collect();
        let mut at_once: Vec<_> = singly.iter().map(|answer| !answer).collect();
        accel.occluded_many(&rays, &mut at_once);
        assert_eq!(at_once, singly, "{rays:?}");
        singly.iter().for_each(|&answer| counts[usize::from(answer)] += 1);
    }
    assert!(counts.iter().all(|&n| n > 100_000), "the cases are not what they should be: {counts:?}");
}

#[test]
fn an_empty_scene_is_built_and_never_hit() {
    let accel = build(Geometry::default());
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    assert!(accel.intersect(&ray).is_none() && !accel.occluded(&ray) && accel.intersect_delta(&ray).is_none());
    accel.occluded_many(&[], &mut []);
}

#[test]
fn rays_without_a_direction_hit_nothing() {
    let disk = Quadric::new(QuadricKind::Disk, DAffine3::IDENTITY, false);
    let accel = build(Geometry {
        quadrics: vec![disk],
        quadric_surface: vec![0],
        delta_points: vec![DeltaPoint::new(Vec3::ZERO, 10.0)],
        ..cube(Vec3::ZERO, 1.0)
    });
    for bad in [0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut d = if bad == 0.0 { Vec3::ZERO } else { Vec3::new(0.3, 0.2, 0.1) };
            d[axis] = bad;
            let mut o = Vec3::ZERO;
            let mut rays = vec![Ray::new(o, d)];
            if bad != 0.0 {
                o[axis] = bad;
                rays.push(Ray::new(o, Vec3::Z));
            }
            for ray in rays {
                assert!(accel.intersect(&ray).is_none(), "{ray:?}");
                assert!(accel.intersect_delta(&ray).is_none(), "{ray:?}");
                assert!(!accel.occluded(&ray), "{ray:?}");
                let mut blocked = [true; 3];
                let sound = Ray::new(Vec3::new(0.1, 0.1, 0.5), Vec3::X);
                accel.occluded_many(&[ray, sound, ray], &mut blocked);
                assert_eq!(blocked, [false, true, false], "{ray:?}");
            }
        }
    }
    let nowhere = Ray { tmin: 2.0, tmax: 1.0, ..Ray::new(Vec3::ZERO, Vec3::Z) };
    assert!(accel.intersect(&nowhere).is_none() && !accel.occluded(&nowhere));
}

#[test]
fn no_ray_leaves_a_closed_cube() {
    let mut random = Random(5);
    for (center, half) in [(Vec3::ZERO, 1.0), (Vec3::new(0.3, 7.0, -2.0), 0.7), (Vec3::splat(1e3), 1e-1)] {
        let geometry = cube(center, half);
        let (corners, triangles) = (geometry.positions.clone(), geometry.triangles.clone());
        let accel = build(geometry);
        let mut rays = Vec::new();
        for i in 0..333_334 {
            let o = center + random.cube() * (half * 0.999);
            let [a, b, c] = triangles[random.below(12)].map(|v| corners[v as usize]);
            let aim = match i % 4 {
                0 => random.cube() + o,
                1 => a,
                2 => a + (b - a) * random.unit(),
                // The diagonal that two triangles share.
                _ => c + (a - c) * random.unit(),
            };
            rays.push(Ray::new(o, aim - o));
        }
        let mut blocked = vec![false; rays.len()];
        accel.occluded_many(&rays, &mut blocked);
        for (ray, blocked) in rays.iter().zip(blocked) {
            assert!(accel.intersect(ray).is_some(), "a leak: {ray:?}");
            assert!(accel.occluded(ray) && blocked, "a leak of shadow rays: {ray:?}");
        }
    }
}

#[test]
fn an_index_out_of_range_is_an_error() {
    let geometry = soup(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2], [0, 1, 3]]);
    let error = EmbreeAccel::build(Arc::new(geometry), AccelOptions::default()).err().expect("vertex 3 of 3");
    assert!(error.message.contains("triangle 1") && error.message.contains('3'), "{error}");
}

/// A box that is met at 0.5 by rays that go down, and panics for all others.
struct Faulty;

impl UserGeometry for Faulty {
    fn len(&self) -> usize {
        1
    }

    fn bounds(&self, _: u32) -> (Vec3, Vec3) {
        (Vec3::splat(-1.0), Vec3::splat(1.0))
    }

    fn intersect(&self, _: u32, ray: &Ray) -> Option<UserHit> {
        assert!(ray.d.z < 0.0, "planted");
        Some(UserHit::at(0.5))
    }
}

fn faulty_scene() -> Scene {
    let device = Arc::new(Device::new(0).expect("Embree starts"));
    let mut builder = SceneBuilder::new(&device).expect("room for a scene");
    builder.attach_user(Faulty, 0, RayMask::TRANSPORT).expect("room for a geometry");
    builder.commit(RayMask::TRANSPORT, RayMask::TRANSPORT).expect("one box")
}

#[test]
fn rays_without_a_direction_do_not_even_reach_a_geometrys_code() {
    let scene = faulty_scene();
    for d in
        [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::new(0.0, f32::NAN, -1.0), Vec3::new(f32::INFINITY, 0.0, -1.0)]
    {
        let ray = Ray::new(Vec3::ZERO, d);
        assert!(scene.intersect(&ray).is_none() && !scene.occluded(&ray), "{d}");
        let mut blocked = [true; 8];
        scene.occluded8(&[ray; 8], &mut blocked);
        assert_eq!(blocked, [false; 8], "{d}");
    }
}

#[test]
fn a_panic_in_a_callback_reaches_the_caller_past_embree() {
    let scene = faulty_scene();
    assert!(scene.intersect(&Ray::new(Vec3::Z * 2.0, -Vec3::Z)).is_some_and(|h| h.t == 0.5));
    let query = std::panic::AssertUnwindSafe(|| scene.intersect(&Ray::new(Vec3::Z * -2.0, Vec3::Z)).is_some());
    let payload = std::panic::catch_unwind(query).expect_err("planted");
    assert_eq!(payload.downcast_ref::<&str>(), Some(&"planted"));
}

#[test]
fn geometries_are_seen_only_by_rays_of_their_mask() {
    let device = Arc::new(Device::new(0).expect("Embree starts"));
    let geometry = Arc::new(cube(Vec3::ZERO, 1.0));
    for (geometry_mask, ray_mask, meets) in [
        (RayMask::OPAQUE, RayMask::DELTA, false),
        (RayMask::DELTA, RayMask::DELTA, true),
        (RayMask::DELTA, RayMask::TRANSPORT, false),
        (RayMask::OPAQUE, RayMask::TRANSPORT, true),
        (RayMask::CUT_OUT, RayMask::TRANSPORT, true),
        (RayMask::CUT_OUT, RayMask::OPAQUE, false),
        (RayMask::OPAQUE, RayMask::CUT_OUT, false),
    ] {
        let mut builder = SceneBuilder::new(&device).expect("room for a scene");
        builder.attach_triangles(&geometry, None, 0, geometry_mask).expect("a sound cube");
        let scene = builder.commit(ray_mask, ray_mask).expect("a small scene");
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let mut eight = [false; 8];
        scene.occluded8(&[ray; 8], &mut eight);
        let met = [scene.intersect(&ray).is_some(), scene.occluded(&ray), eight[7]];
        assert_eq!(met, [meets; 3], "{geometry_mask:?} {ray_mask:?}");
    }
}

#[test]
fn errors_carry_embrees_own_words() {
    let device = Device::new(0).expect("Embree starts");
    // SAFETY: an unknown geometry type is an error that Embree reports, not undefined.
    let geometry = unsafe { embree4_sys::rtcNewGeometry(device.handle(), 12345) };
    assert!(geometry.is_null());
    let error = device.check("make this").expect_err("an unknown type");
    assert!(error.message.starts_with("Embree could not make this: "), "{error}");
    assert!(error.message.contains("invalid geometry type"), "{error}");
    device.check("go on").expect("the error is reported once");
}

#[test]
fn the_description_names_version_and_instruction_set() {
    let description = build(Geometry::default()).describe();
    let words: Vec<_> = description.split(' ').collect();
    assert!(matches!(words[..], ["embree", version, _] if version.starts_with("4.")), "{description}");
}

/// Rays through boxes of which three in four are planks, so that half of all triangles are slivers: with slivers apart, and all
/// of them Embree's (docs/PERFORMANCE.md).
#[test]
#[ignore = "measures speed"]
fn rates_with_slivers() {
    for boxes in [20, 2000, 40_000] {
        let (mut random, size) = (Random(7), 0.5 / (boxes as f32).cbrt());
        let mut geometry = Geometry { slivers: true, ..Geometry::default() };
        for i in 0..boxes {
            let x = random.cube().normalize();
            let y = x.cross(random.cube()).normalize();
            let (z, at) = (x.cross(y), random.cube() * 0.9);
            let size = if i % 4 == 0 { Vec3::splat(size) } else { Vec3::new(6.0, 0.2, 0.2) * size };
            let base = geometry.positions.len() as u32;
            let one = cube(Vec3::ZERO, 0.5);
            geometry.positions.extend(one.positions.iter().map(|p| {
                let p = *p * size;
                at + x * p.x + y * p.y + z * p.z
            }));
            geometry.triangles.extend(one.triangles.iter().map(|t| t.map(|v| base + v)));
        }
        geometry.triangle_surface = vec![0; geometry.triangles.len()];
        let thin = (0..geometry.triangles.len() as u32).filter(|&i| is_sliver(geometry.corners(i))).count();
        let of = geometry.triangles.len();
        let all_embrees = Geometry {
            positions: geometry.positions.clone(),
            triangles: geometry.triangles.clone(),
            triangle_surface: geometry.triangle_surface.clone(),
            ..Geometry::default()
        };
        let accels = [build(all_embrees), build(geometry)];
        let rays: Vec<Ray> = (0..300_000).map(|_| Ray::segment(random.cube(), random.cube())).collect();
        let ratio = |query: &dyn Fn(&EmbreeAccel, &Ray) -> bool| {
            let mut ratios = [0; 7].map(|_| {
                let [plain, apart] = [0, 1].map(|k| {
                    let start = std::time::Instant::now();
                    let met = rays.iter().filter(|ray| query(&accels[k], ray)).count();
                    (start.elapsed().as_secs_f64(), met)
                });
                // A few rays along edges may differ.
                assert!(plain.1.abs_diff(apart.1) < 30, "{} {}", plain.1, apart.1);
                plain.0 / apart.0
            });
            ratios.sort_by(f64::total_cmp);
            ratios[3]
        };
        let nearest = ratio(&|accel, ray| accel.intersect(ray).is_some());
        let occluded = ratio(&|accel, ray| accel.occluded(ray));
        println!("{of} triangles, {thin} slivers: nearest {nearest:.2}, occluded {occluded:.2} of the rate without");
    }
}

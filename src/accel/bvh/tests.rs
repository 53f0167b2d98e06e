//! The backend against closed meshes, brute force and closed forms.

use std::sync::Arc;

use super::*;
use crate::geometry::{DeltaPoint, Quadric, QuadricKind};
use crate::math::{DAffine3, DVec3};

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 * 2.0_f32.powi(-24)
    }

    fn index(&mut self, n: usize) -> usize {
        ((self.uniform() * n as f32) as usize).min(n - 1)
    }

    /// Uniform in the cube [−1,1)³.
    fn in_cube(&mut self) -> Vec3 {
        Vec3::new(self.uniform(), self.uniform(), self.uniform()) * 2.0 - 1.0
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.in_cube();
            if v.length_squared() > 1e-4 && v.length_squared() <= 1.0 {
                return v.normalize();
            }
        }
    }
}

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Geometry {
    let triangle_surface = vec![0; triangles.len()];
    Geometry { positions, triangles, triangle_surface, ..Geometry::default() }
}

fn build(geometry: Geometry) -> BvhAccel {
    BvhAccel::build(Arc::new(geometry), AccelOptions { delta_points: true, ..AccelOptions::default() })
        .expect("small scenes build")
}

/// The cube [−1,1]³ under a map.
fn cube(map: impl Fn(Vec3) -> Vec3) -> Geometry {
    let positions =
        (0..8).map(|i| map(Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2 & 1) as f32) * 2.0 - 1.0)).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    mesh(positions, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// The unit sphere, `n` stacks and `2n` slices: 4n(n − 1) triangles.
fn sphere(n: u32) -> Geometry {
    let slices = 2 * n;
    let mut positions = vec![Vec3::Z, -Vec3::Z];
    for stack in 1..n {
        for slice in 0..slices {
            let theta = std::f64::consts::PI * f64::from(stack) / f64::from(n);
            let phi = std::f64::consts::TAU * f64::from(slice) / f64::from(slices);
            let p = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            positions.push(p.as_vec3a());
        }
    }
    let at = |stack: u32, slice: u32| match stack {
        0 => 0,
        s if s == n => 1,
        s => 2 + (s - 1) * slices + slice % slices,
    };
    let mut triangles = Vec::new();
    for stack in 0..n {
        for slice in 0..slices {
            let [a, b] = [at(stack, slice), at(stack, slice + 1)];
            let [c, d] = [at(stack + 1, slice), at(stack + 1, slice + 1)];
            if stack > 0 {
                triangles.push([a, c, b]);
            }
            if stack + 1 < n {
                triangles.push([b, c, d]);
            }
        }
    }
    mesh(positions, triangles)
}

/// Rays from inside at vertices, at points of edges and anywhere; the number that get out.
fn leaks(geometry: Geometry, rays: usize, mut origin: impl FnMut(&mut Random) -> Vec3) -> usize {
    let accel = build(geometry);
    let g = Arc::clone(&accel.geometry);
    let mut random = Random(7);
    (0..rays)
        .filter(|i| {
            let o = origin(&mut random);
            let [a, b, c] = g.corners(random.index(g.triangles.len()) as u32);
            let target = match i % 5 {
                0 => a,
                1 => a.lerp(b, random.uniform()),
                2 => (b + c) * 0.5,
                _ => o + random.direction(),
            };
            let d = if i % 2 == 0 { target - o } else { (target - o).normalize() };
            let ray = Ray::new(o, d);
            let hit = accel.intersect(&ray);
            assert_eq!(hit.is_some(), accel.occluded(&ray), "{ray:?}");
            hit.is_none()
        })
        .count()
}

#[test]
fn no_ray_leaves_a_closed_cube() {
    assert_eq!(leaks(cube(|p| p), 1_000_000, |r| r.in_cube() * 0.999), 0);
}

#[test]
fn no_ray_from_the_centre_leaves_a_closed_cube() {
    // Edges and diagonals lie in coordinate planes and at equal components: the permutation's ties.
    assert_eq!(leaks(cube(|p| p), 100_000, |_| Vec3::ZERO), 0);
}

#[test]
fn no_ray_leaves_a_turned_stretched_or_shifted_cube() {
    let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1);
    assert_eq!(leaks(cube(|p| turn * p), 300_000, |r| turn * (r.in_cube() * 0.99)), 0);
    let thin = Vec3::new(1.0, 1e-3, 100.0);
    assert_eq!(leaks(cube(|p| p * thin), 300_000, |r| r.in_cube() * 0.99 * thin), 0);
    let far = Vec3::new(1e5, -1e5, 3e4);
    assert_eq!(leaks(cube(|p| p + far), 300_000, |r| r.in_cube() * 0.9 + far), 0);
    for scale in [1e-6, 1e6] {
        assert_eq!(leaks(cube(|p| p * scale), 100_000, |r| r.in_cube() * 0.99 * scale), 0, "{scale}");
    }
}

#[test]
fn no_ray_leaves_a_tessellated_sphere() {
    let geometry = sphere(50);
    assert_eq!(geometry.triangles.len(), 9_800);
    assert_eq!(leaks(geometry, 1_000_000, |r| r.in_cube() * 0.57), 0);
}

/// Möller and Trumbore (1997) in f64: `(t, u, v)` of the plane point, inside or not.
fn plane_point([a, b, c]: [Vec3; 3], ray: &Ray) -> (f64, f64, f64) {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let (e1, e2, d) = (b - a, c - a, ray.d.as_dvec3());
    let p = d.cross(e2);
    let det = e1.dot(p);
    let s = ray.o.as_dvec3() - a;
    let q = s.cross(e1);
    (e2.dot(q) / det, s.dot(p) / det, d.dot(q) / det)
}

#[test]
fn a_soup_is_met_where_brute_force_meets_it() {
    let mut random = Random(3);
    for (count, size) in [(1, 1.0), (3, 1.0), (5, 1.0), (700, 0.2), (4_000, 0.05)] {
        let mut positions = Vec::new();
        for _ in 0..count {
            let p = random.in_cube();
            positions.extend([p, p + random.in_cube() * size, p + random.in_cube() * size]);
        }
        let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let accel = build(mesh(positions, triangles));
        let mut hits = 0;
        for _ in 0..2_000_000 / (count + 500) {
            let mut ray = Ray::new(random.in_cube() * 1.5, random.direction() * (0.1 + 3.0 * random.uniform()));
            ray.tmin = if random.uniform() < 0.3 { 0.3 * random.uniform() } else { 0.0 };
            ray.tmax = if random.uniform() < 0.3 { random.uniform() } else { f32::INFINITY };
            // Decided but for rays that pass too close to an edge or an end for f32 to say.
            let mut nearest: Option<(f64, u32)> = None;
            let mut close_call = false;
            for i in 0..count as u32 {
                let (t, u, v) = plane_point(accel.geometry.corners(i), &ray);
                let margin = u.min(v).min(1.0 - u - v);
                let ends = (t - f64::from(ray.tmin)).min(f64::from(ray.tmax) - t);
                close_call |= t.is_finite() && margin.min(ends).abs() < 1e-3 && margin > -1e-3 && ends > -1e-3;
                if margin >= 0.0 && ends >= 0.0 && nearest.is_none_or(|(best, _)| t < best) {
                    nearest = Some((t, i));
                }
            }
            let hit = accel.intersect(&ray);
            assert_eq!(hit.is_some(), accel.occluded(&ray), "{ray:?}");
            if close_call {
                continue;
            }
            assert_eq!(hit.is_some(), nearest.is_some(), "{ray:?}");
            if let (Some(hit), Some((t, _))) = (hit, nearest) {
                hits += 1;
                let (own, u, v) = plane_point(accel.geometry.corners(hit.primitive), &ray);
                assert!((f64::from(hit.t) - t).abs() < 1e-5 + 1e-4 * t, "{} {t}", hit.t);
                assert!((own - t).abs() < 1e-5 + 1e-4 * t, "the nearest triangle, {own} {t}");
                assert!((f64::from(hit.u) - u).abs() < 2e-3 && (f64::from(hit.v) - v).abs() < 2e-3, "{hit:?} {u} {v}");
            }
        }
        assert!(hits > 20, "{count}: {hits} hits say little");
    }
}

#[test]
fn barycentrics_belong_to_the_second_and_third_corner_on_both_faces() {
    let accel = build(mesh(vec![Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0], vec![[0, 1, 2]]));
    for z in [2.0, -2.0] {
        let hit = accel.intersect(&Ray::new(Vec3::new(1.0, 0.5, z), Vec3::Z * -z)).expect("aimed inside");
        assert_eq!((hit.t, hit.u, hit.v, hit.primitive), (1.0, 0.25, 0.125, 0));
    }
}

#[test]
fn the_segments_ends_count() {
    let accel = build(mesh(vec![Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0], vec![[0, 1, 2]]));
    let at = |z: f32, tmin, tmax| accel.intersect(&Ray { o: Vec3::new(1.0, 1.0, z), d: -Vec3::Z, tmin, tmax });
    assert_eq!(at(0.0, 0.0, f32::INFINITY).map(|h| h.t.to_bits()), Some(0), "t = 0, not −0");
    assert_eq!(at(1.0, 0.0, 1.0).map(|h| h.t), Some(1.0));
    assert_eq!(at(1.0, 1.0, 2.0).map(|h| h.t), Some(1.0));
    assert!(at(1.0, 0.0, 1.0 - 0.5 * f32::EPSILON).is_none());
    assert!(at(1.0, 1.0 + f32::EPSILON, 2.0).is_none());
    assert!(at(-1.0, 0.0, f32::INFINITY).is_none(), "behind");
}

#[test]
fn rays_without_a_direction_hit_nothing() {
    let mut geometry = cube(|p| p);
    let m = DAffine3::from_scale(DVec3::splat(0.5));
    geometry.quadrics.push(Quadric::new(QuadricKind::Sphere, m, false));
    geometry.quadric_surface.push(0);
    geometry.delta_points.push(DeltaPoint::new(Vec3::ZERO, 1.0));
    let accel = build(geometry);
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let bad = [
        Ray::new(Vec3::ZERO, Vec3::ZERO),
        Ray::new(Vec3::ZERO, Vec3::new(nan, 0.0, 1.0)),
        Ray::new(Vec3::ZERO, Vec3::new(1.0, nan, nan)),
        Ray::new(Vec3::ZERO, Vec3::new(1.0, inf, 0.0)),
        Ray::new(Vec3::new(0.0, nan, 0.0), Vec3::X),
        Ray { tmin: nan, ..Ray::new(Vec3::ZERO, Vec3::X) },
        Ray { tmax: nan, ..Ray::new(Vec3::ZERO, Vec3::X) },
        Ray { tmin: 2.0, tmax: 0.5, ..Ray::new(Vec3::ZERO, Vec3::X) },
    ];
    for ray in bad {
        assert!(accel.intersect(&ray).is_none() && !accel.occluded(&ray), "{ray:?}");
        assert!(accel.intersect_delta(&ray).is_none(), "{ray:?}");
    }
    assert!(accel.intersect(&Ray::new(Vec3::ZERO, Vec3::X)).is_some());
}

#[test]
fn an_empty_scene_is_empty() {
    let accel = build(Geometry::default());
    let ray = Ray::new(Vec3::ZERO, Vec3::X);
    assert!(accel.intersect(&ray).is_none() && !accel.occluded(&ray) && accel.intersect_delta(&ray).is_none());
}

#[test]
fn non_finite_triangles_are_left_out_and_do_not_disturb_the_others() {
    let mut geometry = cube(|p| p);
    geometry.positions.extend([Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY)]);
    geometry.triangles.splice(0..0, [[0, 1, 8], [9, 2, 3]]);
    geometry.triangle_surface.extend([0, 0]);
    let accel = build(geometry);
    let mut random = Random(2);
    for _ in 0..50_000 {
        let hit = accel.intersect(&Ray::new(random.in_cube() * 0.9, random.direction())).expect("closed");
        assert!(hit.primitive >= 2 && hit.t.is_finite());
    }
}

#[test]
fn coincident_triangles_build_and_answer() {
    // Equal boxes give the builder nothing to sort by: the tree may be deep, the stack must hold it.
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let accel = build(mesh(positions, vec![[0, 1, 2]; 20_000]));
    let hit = accel.intersect(&Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z)).expect("all of them are there");
    assert_eq!(hit.t, 1.0);
}

fn random_quadrics(random: &mut Random, count: usize) -> Vec<Quadric> {
    (0..count)
        .map(|i| {
            let turn = glam::DQuat::from_rotation_arc(DVec3::Z, random.direction().as_dvec3().normalize());
            let stretch = (random.in_cube().as_dvec3() + 1.2) * 0.3;
            let m = DAffine3::from_scale_rotation_translation(stretch, turn, random.in_cube().as_dvec3() * 3.0);
            Quadric::new(if i % 2 == 0 { QuadricKind::Sphere } else { QuadricKind::Disk }, m, false)
        })
        .collect()
}

#[test]
fn quadrics_and_triangles_are_met_as_by_brute_force() {
    let mut random = Random(11);
    let mut geometry = sphere(8);
    geometry.quadrics = random_quadrics(&mut random, 60);
    geometry.quadric_surface = vec![1; 60];
    let all = build(geometry);
    let g = &all.geometry;
    let only_triangles = build(mesh(g.positions.clone(), g.triangles.clone()));
    let mut counts = [0; 2];
    for _ in 0..200_000 {
        let mut ray = Ray::new(random.in_cube() * 3.0, random.direction());
        if random.uniform() < 0.3 {
            ray.tmax = 4.0 * random.uniform();
        }
        let triangle = only_triangles.intersect(&ray);
        // The same test on the same shortened segments; the order in which they are met must not matter.
        let mut want = triangle.map(|h| (h.t, GeometryKind::Triangle, h.primitive));
        for (i, q) in g.quadrics.iter().enumerate() {
            let tmax = want.map_or(ray.tmax, |w| w.0);
            if let Some(t) = q.intersect(&Ray { tmax, ..ray }) {
                if want.is_none_or(|w| t < w.0) {
                    want = Some((t, GeometryKind::Quadric, i as u32));
                }
            }
        }
        let got = all.intersect(&ray).map(|h| (h.t, h.geometry, h.primitive));
        assert_eq!(got, want, "{ray:?}");
        assert_eq!(all.occluded(&ray), want.is_some());
        if let Some(w) = want {
            counts[usize::from(w.1 == GeometryKind::Quadric)] += 1;
        }
    }
    assert!(counts.iter().all(|&c| c > 4_000), "{counts:?}");
}

#[test]
fn every_ray_aimed_at_a_delta_point_finds_it() {
    let mut random = Random(5);
    let mut misses = 0;
    for i in 0..100_000 {
        let scale = 10.0_f32.powf(random.uniform() * 8.0 - 4.0);
        let offset = random.in_cube() * if i % 3 == 0 { 0.0 } else { 10.0_f32.powf(random.uniform() * 5.0) };
        let p = offset + random.in_cube() * scale;
        let o = offset + random.in_cube() * scale;
        if p == o {
            continue;
        }
        let reach = (p - o).length();
        let point = DeltaPoint::new(p, o.abs().max_element() + reach);
        let accel = build(Geometry { delta_points: vec![point], ..Geometry::default() });
        let rays = [Ray::new(o, (p - o).normalize()), Ray::segment(o, p)];
        misses += rays.iter().filter(|ray| accel.intersect_delta(ray).is_none()).count();
        assert!(rays.iter().all(|ray| accel.intersect(ray).is_none() && !accel.occluded(ray)), "transport sees it");
    }
    assert_eq!(misses, 0);
}

#[test]
fn delta_points_are_told_apart_and_built_only_when_asked_for() {
    let mut random = Random(6);
    let delta_points: Vec<_> = (0..200).map(|_| DeltaPoint::new(random.in_cube(), 4.0)).collect();
    let geometry = Arc::new(Geometry { delta_points, ..Geometry::default() });
    let with = BvhAccel::build(Arc::clone(&geometry), AccelOptions { delta_points: true, ..AccelOptions::default() })
        .expect("builds");
    let without = BvhAccel::build(Arc::clone(&geometry), AccelOptions::default()).expect("builds");
    for (i, point) in geometry.delta_points.iter().enumerate() {
        for _ in 0..50 {
            let o = random.in_cube();
            let ray = Ray::new(o, (point.position - o).normalize());
            let brute = (geometry.delta_points.iter().zip(0..))
                .filter_map(|(p, i)| p.intersect(&ray).map(|t| (t, i)))
                .min_by(|a, b| a.partial_cmp(b).expect("finite"));
            let got = with.intersect_delta(&ray).map(|h| (h.t, h.point));
            assert_eq!(got, brute, "point {i}");
            assert!(got.is_some());
            assert!(without.intersect_delta(&ray).is_none());
        }
    }
}

#[test]
fn the_build_is_deterministic() {
    let [a, b] = [build(sphere(20)), build(sphere(20))];
    assert_eq!(format!("{:?}", a.opaque.blocks), format!("{:?}", b.opaque.blocks));
    assert_eq!(a.opaque.triangles.dump(), b.opaque.triangles.dump());
}

/// Rates on closed spheres, one thread: `cargo test --release --lib bvh::tests::rates -- --ignored --nocapture`.
#[test]
#[ignore = "measures speed"]
fn rates() {
    for (name, geometry) in [("cube, 12", cube(|p| p)), ("sphere, 9 800", sphere(50)), ("sphere, 263k", sphere(257))] {
        let clock = std::time::Instant::now();
        let accel = build(geometry);
        let built = clock.elapsed();
        let mut random = Random(1);
        let n = 2_000_000;
        let rays: Vec<Ray> =
            (0..n).map(|_| Ray { tmax: 1e3, ..Ray::new(random.in_cube() * 0.57, random.direction()) }).collect();
        let rate = |f: &dyn Fn(&Ray) -> bool| {
            let clock = std::time::Instant::now();
            let hits = rays.iter().filter(|r| f(r)).count();
            assert_eq!(hits, n);
            n as f64 / clock.elapsed().as_secs_f64() * 1e-6
        };
        let nearest = rate(&|r| accel.intersect(r).is_some());
        let any = rate(&|r| accel.occluded(r));
        println!("{name}: built in {built:?}; nearest {nearest:.2}, any {any:.2} Mrays/s (incoherent, one thread)");
    }
}

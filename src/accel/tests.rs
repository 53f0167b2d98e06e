//! What every backend has to answer about surfaces that are partly opaque.

use super::bvh::BvhAccel;
#[cfg(feature = "embree")]
use super::embree::EmbreeAccel;
use super::*;
use crate::geometry::{GeometryKind, Quadric, QuadricKind};
use crate::math::{DAffine3, DVec3, Vec3};

/// A column of sheets z = 1 … 8, each two triangles, with a ball in each gap: surface 2k is the sheet z = k + 1, 2k + 1 the
/// ball over it.
fn column(cut_outs: &[bool]) -> Geometry {
    let mut geometry = Geometry { cut_outs: cut_outs.to_vec(), ..Geometry::default() };
    for k in 0..8 {
        let z = k as f32 + 1.0;
        let first = geometry.positions.len() as u32;
        geometry
            .positions
            .extend([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z)));
        geometry.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        geometry.triangle_surface.extend([2 * k; 2]);
        let place = DAffine3::from_translation(DVec3::new(0.0, 0.0, f64::from(k) + 1.5));
        let ball = place * DAffine3::from_scale(DVec3::splat(0.25));
        geometry.quadrics.push(Quadric::new(QuadricKind::Sphere, ball, false));
        geometry.quadric_surface.push(2 * k + 1);
    }
    geometry
}

fn surface(geometry: &Geometry, hit: &Hit) -> u32 {
    match hit.geometry {
        GeometryKind::Triangle => geometry.triangle_surface[hit.primitive as usize],
        GeometryKind::Quadric => geometry.quadric_surface[hit.primitive as usize],
    }
}

fn check<A: Accel>() {
    let patterns: [Vec<bool>; 5] = [
        Vec::new(),
        (0..16).map(|i| i == 5).collect(),
        (0..16).map(|i| i == 4).collect(),
        (0..16).map(|i| i % 3 == 0).collect(),
        vec![true; 16],
    ];
    for cut_outs in patterns {
        let geometry = Arc::new(column(&cut_outs));
        let accel = A::build(Arc::clone(&geometry), AccelOptions::default()).expect("a small scene builds");
        let is_cut_out = |s: u32| cut_outs.get(s as usize).is_some_and(|c| *c);
        for start in 0..16 {
            // Upwards from just below a surface, beside the balls' axes so that both triangles are met in turn.
            let (k, ball) = (start / 2, start % 2);
            let x = if start % 4 < 2 { 0.05 } else { -0.05 };
            let o = Vec3::new(x, 0.02, k as f32 + if ball == 1 { 1.2 } else { 0.95 });
            for end in start..16 {
                let z = (end / 2) as f32 + if end % 2 == 1 { 1.5 } else { 1.05 };
                let ray = Ray::segment(o, Vec3::new(x, 0.02, z));
                // Surfaces stand along the ray in the order of their numbers.
                let met = |wanted: &dyn Fn(u32) -> bool| (start..=end).find(|s| wanted(*s));
                let told = |hit: Option<Hit>| hit.map(|hit| surface(&geometry, &hit));
                let case = (A::NAME, &cut_outs, start, end);
                assert_eq!(told(accel.intersect(&ray)), met(&|_| true), "{case:?}");
                assert_eq!(told(accel.intersect_cut_out(&ray)), met(&is_cut_out), "{case:?}");
                let blocked = met(&|s| !is_cut_out(s)).is_some();
                assert_eq!(accel.occluded(&ray), blocked, "{case:?}");
                let mut many = [!blocked; 9];
                accel.occluded_many(&[ray; 9], &mut many);
                assert_eq!(many, [blocked; 9], "{case:?}");
            }
        }
    }
}

#[test]
fn occlusion_is_by_what_is_opaque_and_cut_outs_are_found_alone() {
    check::<BvhAccel>();
    #[cfg(feature = "embree")]
    check::<EmbreeAccel>();
}

/// Rays from anywhere, aimed at corners, edges, faces and past them: what is found among the cut-outs alone is what a
/// scene of nothing else has.
#[test]
fn cut_outs_are_found_by_rays_from_everywhere() {
    fn check<A: Accel>() {
        let mut state = 1_u32;
        let mut uniform = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            let x = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
            ((x >> 22) ^ x) as f32 / 4_294_967_296.0
        };
        for cut_out in [0, 4, 5, 9] {
            let cut_outs: Vec<bool> = (0..16).map(|i| i == cut_out || (cut_out == 9 && i == 2)).collect();
            let geometry = column(&cut_outs);
            let mut alone = Geometry { positions: geometry.positions.clone(), ..Geometry::default() };
            for (t, s) in
                geometry.triangles.iter().zip(&geometry.triangle_surface).filter(|(_, s)| cut_outs[**s as usize])
            {
                alone.triangles.push(*t);
                alone.triangle_surface.push(*s);
            }
            for (q, s) in
                geometry.quadrics.iter().zip(&geometry.quadric_surface).filter(|(_, s)| cut_outs[**s as usize])
            {
                alone.quadrics.push(*q);
                alone.quadric_surface.push(*s);
            }
            let (geometry, alone) = (Arc::new(geometry), Arc::new(alone));
            let options = AccelOptions::default();
            let accel = A::build(Arc::clone(&geometry), options).expect("a small scene builds");
            let only = A::build(Arc::clone(&alone), options).expect("a small scene builds");
            let mut hits = 0;
            for i in 0..20_000 {
                let far = [1.0, 30.0, 1e4][i % 3];
                let mut o = (Vec3::new(uniform(), uniform(), uniform()) * 2.0 - 1.0) * far + Vec3::Z * 4.0;
                let k = (uniform() * 8.0) as usize;
                let corner = geometry.positions[4 * k + i % 4];
                let to = match i % 5 {
                    0 => corner,
                    1 => (corner + geometry.positions[4 * k + (i + 1) % 4]) * 0.5,
                    2 => corner * uniform() * 1.1,
                    3 => Vec3::new(corner.x, corner.y * uniform(), corner.z),
                    _ => {
                        // Along an axis, with zeros of either sign.
                        o = Vec3::new(corner.x * uniform(), corner.y * uniform(), o.z);
                        Vec3::new(o.x, o.y, -o.z)
                    }
                };
                let ray = if i % 7 == 0 { Ray::segment(o, to) } else { Ray::new(o, (to - o).normalize()) };
                let told = |geometry: &Geometry, hit: Option<Hit>| hit.map(|hit| (surface(geometry, &hit), hit.t));
                let (found, wanted) = (accel.intersect_cut_out(&ray), only.intersect(&ray));
                assert_eq!(told(&geometry, found), told(&alone, wanted), "{}, {ray:?}", A::NAME);
                hits += usize::from(wanted.is_some());
            }
            assert!(hits > 500, "{hits} hits prove little");
        }
    }
    check::<BvhAccel>();
    #[cfg(feature = "embree")]
    check::<EmbreeAccel>();
}

/// What a ray meets at zero, it does not meet again past it: of either kind of triangle.
fn check_past<A: Accel>() {
    for height in [1.0, 1e-3] {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(0.5, height, 0.0)];
        let slivers = crate::geometry::is_sliver([positions[0], positions[1], positions[2]]);
        let triangles = vec![[0, 1, 2]];
        let geometry = Geometry { positions, triangles, triangle_surface: vec![0], slivers, ..Geometry::default() };
        let accel = A::build(Arc::new(geometry), AccelOptions::default()).expect("a triangle builds");
        let ray = Ray::new(Vec3::new(0.5, 0.25 * height, 0.0), Vec3::new(0.1, 0.2, 1.0));
        let hit = accel.intersect(&ray).expect("starts on it");
        assert_eq!(hit.t, 0.0);
        assert!(accel.intersect(&Ray { tmin: crate::math::past(hit.t), ..ray }).is_none(), "{}: {height}", A::NAME);
    }
}

#[test]
fn past_what_is_met_at_zero_it_is_not_met() {
    check_past::<BvhAccel>();
    #[cfg(feature = "embree")]
    check_past::<EmbreeAccel>();
}

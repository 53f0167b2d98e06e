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

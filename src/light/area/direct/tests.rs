//! Next-event estimation's points: the density of what is sampled is the density when asked for, and its integral over the
//! surface is one.

use super::*;
use crate::geometry::Quadric;
use crate::light::area::Emission;
use crate::math::{DAffine3, Rgb};

const EMISSION: Emission = Emission { radiance: Rgb::ONE, two_sided: false };

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> (Geometry, AreaLight) {
    let n = triangles.len();
    let geometry = Geometry { positions, triangle_surface: vec![0; n], triangles, ..Geometry::default() };
    let light = AreaLight::from_triangles(&geometry, 0..n as u32, EMISSION, 0).expect("has an area");
    (geometry, light)
}

fn quadric(kind: QuadricKind, map: DAffine3) -> (Geometry, AreaLight) {
    let geometry =
        Geometry { quadrics: vec![Quadric::new(kind, map, false)], quadric_surface: vec![0], ..Geometry::default() };
    let light = AreaLight::from_quadric(&geometry, 0, EMISSION, 0).expect("has an area");
    (geometry, light)
}

/// Lights around the origin, each with whether near receivers see it by solid angle.
fn lights() -> Vec<(&'static str, (Geometry, AreaLight), bool)> {
    let turn = DAffine3::from_axis_angle(DVec3::new(1.0, 0.5, -2.0).normalize(), 1.1);
    let at = |x: f64, y: f64, z: f64| turn.transform_point3(DVec3::new(x, y, z)).as_vec3a();
    let quad = |skew: f64| {
        let corners =
            vec![at(-0.5, -0.3, 0.0), at(0.5, -0.3, 0.0), at(0.5 + skew, 0.3, 0.0), at(-0.5 + skew, 0.3, 0.0)];
        mesh(corners, vec![[0, 1, 2], [0, 2, 3]])
    };
    let pyramid =
        vec![at(0.0, 0.0, 0.3), at(0.4, 0.4, 0.0), at(-0.4, 0.4, 0.0), at(-0.4, -0.4, 0.0), at(0.4, -0.4, 0.0)];
    let ball = DAffine3::from_translation(DVec3::new(0.05, 0.0, 0.0)) * turn * DAffine3::from_scale(DVec3::splat(0.4));
    let egg = turn * DAffine3::from_scale(DVec3::new(0.4, 0.3, 0.5));
    vec![
        ("rectangle", quad(0.0), true),
        ("parallelogram", quad(0.2), false),
        ("triangle", mesh(vec![at(-0.5, -0.3, 0.1), at(0.5, -0.3, 0.0), at(0.0, 0.4, 0.0)], vec![[0, 1, 2]]), true),
        ("pyramid", mesh(pyramid, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]), true),
        ("sphere", quadric(QuadricKind::Sphere, ball), true),
        ("ellipsoid", quadric(QuadricKind::Sphere, egg), false),
        ("disk", quadric(QuadricKind::Disk, egg), false),
    ]
}

fn grid(n: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..n * n).map(move |i| [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32))
}

#[test]
fn densities_are_those_of_what_is_sampled_and_integrate_to_one() {
    for (what, (geometry, light), by_solid_angle) in lights() {
        let mut seen_near = 0;
        for from in [
            Vec3::new(0.2, 0.5, 0.3),
            Vec3::new(-0.4, -0.1, -0.4),
            Vec3::new(1.0, -2.0, 4.0),
            Vec3::new(30.0, 20.0, 10.0),
        ] {
            for part in 0..light.parts() {
                let near = match &light.emitter {
                    Emitter::Parallelogram { .. } => light.rectangle_from(from).is_some(),
                    Emitter::Triangles { triangles, .. } => {
                        triangle_from(&geometry, from, triangles.start + part).is_some()
                    }
                    Emitter::Quadric { .. } => light.cone_from(from).is_some(),
                };
                assert!(by_solid_angle || !near, "{what}");
                seen_near += u32::from(near);
                for u in grid(16) {
                    let Some((at, pdf)) = light.sample_direct(&geometry, from, part, u) else { continue };
                    assert_eq!(light.part_of(&at), part, "{what}");
                    let again = light.pdf_direct(&geometry, from, &at);
                    assert!((again.0 / pdf.0 - 1.0).abs() < 1e-6, "{what} from {from}: {pdf:?} {again:?}");
                    let edge = LightPoint::Surface(at).edge_from(from).expect("apart");
                    if near {
                        // What every sample says of the solid angle is the same: that is uniformity.
                        let omega = edge.cos / (edge.d2 * pdf.0);
                        let first = light.sample_direct(&geometry, from, part, [0.4, 0.6]).expect("seen");
                        let other = LightPoint::Surface(first.0).edge_from(from).expect("apart");
                        let other = other.cos / (other.d2 * first.1.0);
                        assert!((omega / other - 1.0).abs() < 1e-9, "{what} from {from}: {omega} {other}");
                    }
                }
            }
            // ∫ pdf dA over the surface, drawn uniformly by area: parts are chosen by area there.
            let n = 256;
            let mut sum = 0.0;
            for (i, u) in (0..).zip(grid(n)) {
                let part = (f64::from(i) * 0.618_033_988_749_895).fract();
                let (at, pdf) = light.sample_point(&geometry, part, u).expect("a point");
                let area = match &light.emitter {
                    Emitter::Triangles { .. } => triangle_area(geometry.corners(at.primitive())),
                    _ => 1.0 / pdf.0,
                };
                // A sphere's far side is not sampled from outside: its density there belongs to no path.
                let seen =
                    !matches!(light.emitter, Emitter::Quadric { ball: Some(_), .. }) || at.ng.dot(from - at.p()) > 0.0;
                sum += if seen { light.pdf_direct(&geometry, from, &at).0 * area } else { 0.0 };
            }
            let mean = sum / f64::from(n * n);
            // From behind a parallelogram nothing is sampled, and everything is impossible.
            let whole = if light.is_behind(from) { 0.0 } else { 1.0 };
            assert_eq!(
                light.sample_direct(&geometry, from, 0, [0.4, 0.6]).is_none(),
                whole == 0.0,
                "{what} from {from}"
            );
            assert!((mean - whole).abs() < 5e-3, "{what} from {from}: ∫ pdf = {mean}");
        }
        assert_eq!(seen_near > 0, by_solid_angle, "{what}");
    }
}

/// From inside a sphere and from its surface, wherever rounding put the receiver, all of it is seen, and sampled.
#[test]
fn from_inside_a_sphere_its_area_is_sampled() {
    let (geometry, light) = quadric(QuadricKind::Sphere, DAffine3::from_scale(DVec3::splat(0.5)));
    let on_it = grid(16).map(|u| warp::uniform_sphere(u) * 0.5);
    for from in on_it.chain([Vec3::new(0.1, 0.2, 0.0)]) {
        let (at, pdf) = light.sample_direct(&geometry, from, 0, [0.3, 0.7]).expect("a point");
        assert!((pdf.0 - 1.0 / light.area).abs() < 1e-6, "{from}");
        assert_eq!(light.pdf_direct(&geometry, from, &at), pdf);
    }
}

/// Thin lamps, turned anyhow: a point that is sampled has the normal of the point that a ray hits there, and so all densities and
/// cosines of both ways to find it are one. The edges' product in f32 would be off by ε · length/height.
#[test]
fn what_is_sampled_of_a_thin_lamp_has_the_normal_of_what_is_hit() {
    let mut worst: f64 = 0.0;
    for (i, height) in [0.1, 1e-2, 1e-3].into_iter().cycle().take(300).enumerate() {
        let turn = DAffine3::from_axis_angle(DVec3::new(1.0, 0.5, -2.0).normalize(), 0.37 * i as f64);
        let turn = turn * DAffine3::from_axis_angle(DVec3::new(-0.3, 1.0, 0.4).normalize(), 0.61 * i as f64);
        let corners = [[-0.5, 0.0], [0.5, 0.0], [0.5, height], [-0.5, height]];
        let corners = corners.map(|[x, y]| turn.transform_point3(DVec3::new(x, y, 0.2)).as_vec3a());
        let (mut geometry, light) = mesh(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
        geometry.slivers = true;
        if !matches!(light.emitter, Emitter::Parallelogram { .. }) {
            continue;
        }
        for u in grid(4) {
            let Some((sampled, _)) = light.sample_point(&geometry, 0.0, u) else { continue };
            // The halves meet at u = v, where either may be hit.
            let [x, y] = u;
            if x == y {
                continue;
            }
            let hit = if x > y { geometry.triangle_point(0, x - y, y) } else { geometry.triangle_point(1, x, y - x) };
            assert!((hit.p() - sampled.p()).length() < 1e-6);
            worst = worst.max((hit.ng - sampled.ng).length().into());
        }
    }
    assert!(worst == 0.0, "{worst}");
}

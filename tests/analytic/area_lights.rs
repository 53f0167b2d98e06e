//! Irradiance from area lights of every shape, by hitting them, by next-event estimation, and by both weighted.

use std::f64::consts::{PI, TAU};

use serde_json::{Value, json};
use twinlight::accel::{Accel, AccelOptions, bvh::BvhAccel};
use twinlight::bsdf::Bsdf;
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::{DAffine3, DMat3, DVec3, Rgb};
use twinlight::sampling::Coins;
use twinlight::scene::Scene;

use crate::common::{
    Bounds, Budget, DefaultAccel, Random, View, assert_closed, diffuse, expect_colored, facing, images, matrix, quad,
    scene, scene_json, scene_on, settings, shining, sphere, technique,
};

const ALBEDO: [f64; 3] = [0.8, 0.5, 0.25];
const RADIANCE: [f64; 3] = [1.0, 2.0, 3.0];

/// Twice the vector irradiance of a polygon of unit radiance at the origin: `Σ Θᵢ Γᵢ`, with the angle that each edge
/// subtends and the unit normal of its plane through the origin (Lambert 1760; Arvo 1994, "The Irradiance Jacobian
/// for Partially Occluded Polyhedral Sources", (2)).
fn lambert(corners: &[DVec3]) -> DVec3 {
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let normal = a.cross(b);
        normal.normalize() * normal.length().atan2(a.dot(b))
    };
    (0..corners.len()).map(edge).sum()
}

/// `E/(πL)` on a plane through the origin with normal `n`, of a polygon above it.
pub fn form_factor(corners: &[DVec3], n: DVec3) -> f64 {
    lambert(corners).dot(n).abs() / TAU
}

/// Demands that a point of a diffuse plane reflects `ρ L · factor`, by each technique alone and all together.
///
/// The receiver lies in the plane z = 0 around the origin, all of it moved by `pose`.
fn receives(what: &str, pose: &DAffine3, lights: Vec<Value>, factor: f64, bound: f64, seed: u64) {
    // Nearly along the plane, so that no light comes in between; through so small an angle that the irradiance is
    // the point's own.
    let view = View { from: DVec3::new(0.1, -2.0, 0.3), at: DVec3::ZERO, up: DVec3::Z, vfov: 0.01, resolution: [1, 1] };
    let mut surfaces = lights;
    surfaces.push(quad(pose, [0.02; 2], diffuse(ALBEDO.to_vec())));
    let scene = scene(&scene_json(view.moved(pose).json(), surfaces, vec![]));
    let expected = expect_colored(&[factor], [0, 1, 2].map(|c| ALBEDO[c] * RADIANCE[c]));
    for (name, settings) in [
        ("(0,3)", technique(0, 3)),
        ("(1,2)", technique(1, 2)),
        ("path", settings(Integrator::Path, 1)),
        ("bdpt", Settings { light_paths: 2, connections: 2, ..settings(Integrator::Bdpt, 1) }),
    ] {
        // Hitting the light is a matter of yes or no, with the form factor as its probability.
        // The bidirectional integrator makes these images bit by bit as the path tracer does where no light path
        // finds the pixel, at a higher price.
        let (samples, bound) = if name == "bdpt" { (2048, 4.0 * bound) } else { (16384, bound) };
        let images = images(&scene, settings, Budget::new(samples, seed));
        assert_closed(&format!("{what}, {name}"), &images, &expected, Bounds::of_mean(bound));
    }
}

/// A mesh of these corners and faces that shines, in the receiver's space moved by `pose`.
fn shining_mesh(pose: &DAffine3, corners: &[DVec3], faces: &[Vec<usize>]) -> Value {
    let positions: Vec<[f64; 3]> = corners.iter().map(|p| p.to_array()).collect();
    json!({
        "type": "mesh", "positions": positions, "indices": faces, "transform": matrix(pose),
        "material": shining(RADIANCE.to_vec())
    })
}

#[test]
fn a_disk_above_a_point_on_and_off_its_axis() {
    let mut random = Random(11);
    for (n, (radius, h, d)) in [(2.0, 0.7, 0.0), (0.3, 1.0, 0.0), (0.8, 0.6, 1.1)].into_iter().enumerate() {
        let pose = random.pose(1.0);
        let m = pose * facing(DVec3::new(d, 0.0, h), -DVec3::Z);
        let disk = json!({
            "type": "disk", "radius": radius, "transform": matrix(&m), "material": shining(RADIANCE.to_vec())
        });
        // On the axis R²/(R²+h²); off it (Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-12).
        let (r2, h2, d2) = (radius * radius, h * h, d * d);
        let root = ((d2 + h2 + r2).powi(2) - 4.0_f64 * r2 * d2).sqrt();
        let factor = 0.5 * (1.0 - (d2 + h2 - r2) / root);
        if d == 0.0 {
            assert!((factor - r2 / (r2 + h2)).abs() < 1e-12);
        }
        let bound = if radius < 0.4 { 0.01 } else { 0.005 };
        receives(
            &format!("disk R = {radius}, h = {h}, off axis {d}"),
            &pose,
            vec![disk],
            factor,
            bound,
            200 + n as u64,
        );
    }
}

#[test]
fn a_quad_and_polygons_by_lamberts_formula() {
    let square = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
    let factor = form_factor(&square, DVec3::Z);
    assert!((factor - 0.554_126).abs() < 5e-7, "{factor}");
    let down = facing(DVec3::Z, -DVec3::Z);
    // The frame's tangents need not be the axes: the square is then turned about its own normal.
    let turned =
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| down.transform_point3(DVec3::new(x, y, 0.0)));
    assert!((form_factor(&turned, DVec3::Z) - factor).abs() < 1e-12);
    let centred = quad(&down, [2.0, 2.0], shining(RADIANCE.to_vec()));
    receives("centred 2×2 quad", &DAffine3::IDENTITY, vec![centred], factor, 0.005, 210);

    let mut random = Random(12);
    for (n, corners) in [3, 5, 7].into_iter().enumerate() {
        let pose = random.pose(1.0);
        // A convex polygon in a random plane well above the receiver, wound so that it faces it.
        let center = DVec3::new(random.between(-0.6, 0.6), random.between(-0.2, 0.6), random.between(0.9, 1.3));
        let tilt = (random.direction() * 0.6 - center.normalize()).normalize();
        let frame = facing(center, tilt);
        let (a, b) = (random.between(0.5, 0.9), random.between(0.5, 0.9));
        let polygon: Vec<DVec3> = (0..corners)
            .map(|i| {
                let (s, c) = (TAU * (i as f64 + random.between(0.0, 0.6)) / corners as f64).sin_cos();
                frame.transform_point3(DVec3::new(a * c, b * s, 0.0))
            })
            .collect();
        assert!(tilt.dot(center) < 0.0 && polygon.iter().all(|p| p.z > 0.05), "the polygon must be seen whole");
        let faces: Vec<Vec<usize>> = (1..corners - 1).map(|i| vec![0, i, i + 1]).collect();
        let light = shining_mesh(&pose, &polygon, &faces);
        let factor = form_factor(&polygon, DVec3::Z);
        receives(
            &format!("polygon of {corners} corners, E/πL = {factor:.4}"),
            &pose,
            vec![light],
            factor,
            0.005,
            211 + n as u64,
        );
    }
}

#[test]
fn many_triangles_are_the_same_light_as_two() {
    let pose = Random(13).pose(1.0);
    let frame = facing(DVec3::new(0.2, 0.3, 0.9), DVec3::new(-0.3, -0.2, -1.0));
    let at = |x: f64, y: f64| frame.transform_point3(DVec3::new(1.2 * x - 0.6, 0.8 * y - 0.4, 0.0));
    let corners = [at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let factor = form_factor(&corners, DVec3::Z);
    let two = shining_mesh(&pose, &corners, &[vec![0, 1, 2, 3]]);
    receives("two triangles", &pose, vec![two], factor, 0.005, 220);
    // Cells of very different sizes, so that the choice by area counts.
    let (grid, faces) = cells(9, 7, at);
    let many = shining_mesh(&pose, &grid, &faces);
    receives("126 triangles", &pose, vec![many], factor, 0.005, 221);
    // And two lights that are one light's halves.
    let halves = [0.0, 0.5].map(|x| {
        shining_mesh(&pose, &[at(x, 0.0), at(x + 0.5, 0.0), at(x + 0.5, 1.0), at(x, 1.0)], &[vec![0, 1, 2, 3]])
    });
    receives("two lights", &pose, halves.to_vec(), factor, 0.005, 222);
}

/// A patch in `nx` × `ny` cells that grow along both sides: corners, and faces of four of them each.
fn cells(nx: usize, ny: usize, at: impl Fn(f64, f64) -> DVec3) -> (Vec<DVec3>, Vec<Vec<usize>>) {
    let stretch = |i: usize, n: usize| (i as f64 / n as f64).powi(2);
    let corners = (0..=ny).flat_map(|j| (0..=nx).map(move |i| (i, j))).map(|(i, j)| at(stretch(i, nx), stretch(j, ny)));
    let corner = |i: usize, j: usize| j * (nx + 1) + i;
    let faces = (0..ny)
        .flat_map(|j| (0..nx).map(move |i| (i, j)))
        .map(|(i, j)| vec![corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)]);
    (corners.collect(), faces.collect())
}

/// A million triangles, the smallest half a millionth of the largest.
#[test]
#[ignore = "deep"]
fn a_million_triangles_are_the_same_light_as_two() {
    let pose = Random(13).pose(1.0);
    let frame = facing(DVec3::new(0.2, 0.3, 0.9), DVec3::new(-0.3, -0.2, -1.0));
    let at = |x: f64, y: f64| frame.transform_point3(DVec3::new(1.2 * x - 0.6, 0.8 * y - 0.4, 0.0));
    let factor = form_factor(&[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)], DVec3::Z);
    let (corners, faces) = cells(1000, 500, at);
    receives("a million triangles", &pose, vec![shining_mesh(&pose, &corners, &faces)], factor, 0.005, 223);
}

#[test]
fn a_sphere_above_the_horizon() {
    let mut random = Random(14);
    for (n, (center, radius)) in
        [(DVec3::new(0.4, 0.5, 1.2), 0.6), (DVec3::new(0.0, 0.0, 3.0), 2.0), (DVec3::new(-0.5, 1.0, 0.6), 0.3)]
            .into_iter()
            .enumerate()
    {
        let pose = random.pose(1.0);
        let d = center.length();
        let factor = (radius / d).powi(2) * center.z / d;
        let light = sphere(pose.transform_point3(center), radius, false, shining(RADIANCE.to_vec()));
        let bound = if radius < 0.4 { 0.015 } else { 0.0075 };
        receives(&format!("sphere R = {radius} at {center}"), &pose, vec![light], factor, bound, 230 + n as u64);
    }
}

#[test]
fn inside_a_sphere_light() {
    // The camera must be inside, too, 2.02 from the receiver.
    let pose = Random(15).pose(1.0);
    let light = sphere(pose.transform_point3(DVec3::new(0.5, -0.8, 0.6)), 3.0, true, shining(RADIANCE.to_vec()));
    receives("inside a sphere light", &pose, vec![light], 1.0, 0.005, 240);
}

/// The outline of an ellipsoid `M·(unit sphere) + c` as seen from the origin, which is what its irradiance depends on:
/// in the unit sphere's space the circle in which the polar plane of the origin cuts the sphere.
fn outline(m: &DAffine3, n: usize) -> Vec<DVec3> {
    let eye = m.inverse().transform_point3(DVec3::ZERO);
    let d = eye.length();
    let frame = facing(eye / (d * d), eye);
    let radius = (1.0 - 1.0 / (d * d)).sqrt();
    (0..n)
        .map(|i| {
            let (s, c) = (TAU * i as f64 / n as f64).sin_cos();
            m.transform_point3(frame.transform_point3(DVec3::new(radius * c, radius * s, 0.0)))
        })
        .collect()
}

/// The map's image of the unit sphere in `nu` meridians and half as many parallels.
fn tessellated(map: &DAffine3, nu: usize) -> (Vec<DVec3>, Vec<Vec<usize>>) {
    let nv = nu / 2;
    // At the radius that gives each parallel's polygon the circle's area, so that the outline is right to second order.
    let swell = ((TAU / nu as f64) / (TAU / nu as f64).sin()).sqrt();
    let corner = |i: usize, j: usize| {
        let ((s, c), (sv, cv)) = ((TAU * i as f64 / nu as f64).sin_cos(), (PI * j as f64 / nv as f64).sin_cos());
        map.transform_point3(DVec3::new(sv * c, sv * s, cv) * swell)
    };
    let corners: Vec<DVec3> = (0..=nv).flat_map(|j| (0..nu).map(move |i| (i, j))).map(|(i, j)| corner(i, j)).collect();
    let at = |i: usize, j: usize| j * nu + i % nu;
    let faces: Vec<Vec<usize>> = (0..nv)
        .flat_map(|j| (0..nu).map(move |i| (i, j)))
        .map(|(i, j)| match j {
            0 => vec![at(i, 0), at(i, 1), at(i + 1, 1)],
            _ if j + 1 == nv => vec![at(i, j), at(i, j + 1), at(i + 1, j)],
            _ => vec![at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)],
        })
        .collect();
    (corners, faces)
}

#[test]
fn an_ellipsoid_and_its_tessellation() {
    let pose = Random(16).pose(1.0);
    let stretched = DAffine3 {
        matrix3: DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.9)
            * DMat3::from_diagonal(DVec3::new(0.25, 0.7, 0.45)),
        translation: DVec3::new(0.3, 0.4, 1.2),
    };
    let rim = outline(&stretched, 20_000);
    assert!(rim.iter().all(|p| p.z > 0.1), "all above the horizon");
    let factor = form_factor(&rim, DVec3::Z);
    let ellipsoid = json!({
        "type": "sphere", "transform": matrix(&(pose * stretched)), "material": shining(RADIANCE.to_vec())
    });
    receives("ellipsoid", &pose, vec![ellipsoid], factor, 0.005, 250);

    let (corners, faces) = tessellated(&stretched, 128);
    let mesh = shining_mesh(&pose, &corners, &faces);
    receives("tessellated ellipsoid", &pose, vec![mesh], factor, 0.0075, 251);
}

/// Shadow segments that a light's own surface blocks, of those from the receiver to points that face it.
fn hidden_by_itself<A: Accel>(json: &Value, random: &mut Random) -> usize {
    let scene: Scene<A> = scene_on(json, AccelOptions::default());
    let ray = scene.camera.generate_ray([0, 0], [0.5; 2], [0.5; 2]).ray;
    let mut varying = Bsdf::Black;
    let arrival = scene.arrive(ray, &mut Coins::new(0), &mut 0, &mut varying).expect("the receiver");
    let (at, light) = (&arrival.at, &scene.lights[0]);
    let mut hidden = 0;
    for _ in 0..4000 {
        let [part, u, v] = [0; 3].map(|_| (random.uniform() as f32).min(1.0 - f32::EPSILON / 2.0));
        let part = ((part * light.parts() as f32) as u32).min(light.parts() - 1);
        let Some(y) = light.sample_direct(&scene.geometry, at.p(), part, 0.0, [u, v]) else { continue };
        let Some(edge) = y.point.edge_from(at.p()) else { continue };
        let wi = edge.wi;
        // Beyond grazing angles by rounding it would be the receiver or the light's back.
        let faces = wi.dot(at.ng) > 1e-3 && edge.cos > 1e-3;
        if faces && light.emitted(&y.point, -wi) != Rgb::ZERO {
            hidden += usize::from(scene.accel.occluded(&y.point.shadow_ray(at)));
        }
    }
    hidden
}

/// A convex light never hides itself from what it faces, wherever in render space it stands and however small its
/// triangles are: a segment's end must clear the surface as the traversal finds it from the segment's other end.
#[test]
fn no_light_hides_itself() {
    let mut random = Random(17);
    for n in 0..60 {
        let pose = random.pose(1.0);
        let size = f64::powf(10.0, random.between(-2.0, 0.3));
        let center = DVec3::new(random.between(-0.3, 0.3), random.between(-0.3, 0.3), size + random.between(0.1, 1.5));
        let axis = (random.direction() * 0.7 - DVec3::Z).normalize();
        let frame = facing(center, axis);
        let squashed =
            DAffine3 { matrix3: frame.matrix3 * DMat3::from_diagonal(DVec3::new(0.5, 1.0, 0.7) * size), ..frame };
        let light = match n % 4 {
            0 => json!({
                "type": "disk", "radius": size, "transform": matrix(&(pose * frame)), "material": shining(1.0)
            }),
            1 => quad(&(pose * frame), [size, 2.0 * size], shining(1.0)),
            2 => json!({ "type": "sphere", "transform": matrix(&(pose * squashed)), "material": shining(1.0) }),
            _ => {
                let (corners, faces) = tessellated(&squashed, if n % 8 == 3 { 16 } else { 96 });
                shining_mesh(&pose, &corners, &faces)
            }
        };
        let from = DVec3::new(0.1, -2.0, 0.3) * 1e-3;
        let view = View { from, at: DVec3::ZERO, up: DVec3::Z, vfov: 0.01, resolution: [1, 1] };
        let surfaces = vec![quad(&pose, [1e-3; 2], diffuse(0.5)), light];
        let json = scene_json(view.moved(&pose).json(), surfaces, vec![]);
        assert_eq!(hidden_by_itself::<DefaultAccel>(&json, &mut random), 0, "light {n}: {json}");
        assert_eq!(hidden_by_itself::<BvhAccel>(&json, &mut random), 0, "light {n}, BVH: {json}");
    }
}

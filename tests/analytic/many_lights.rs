//! Many lights at once, of very different power, some facing away and some below the horizon: next-event estimation chooses
//! among them by what each may send to the receiver, and all of them together are the sum of their closed forms.

use std::f64::consts::PI;

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::{DAffine3, DVec3};

use super::area_lights::form_factor;
use crate::common::{
    Bounds, Budget, Random, View, assert_closed, diffuse, facing, images, point, quad, scene, scene_json, settings,
    shining, sphere, technique,
};

const ALBEDO: [f64; 3] = [0.8, 0.5, 0.25];

/// Lights over a receiver at the origin with normal z, and what they make it reflect.
struct Lamps {
    surfaces: Vec<Value>,
    lights: Vec<Value>,
    radiance: [f64; 3],
}

/// One light in each cell of a dome, none as large as to hide another. `kinds` says which there are; their strengths spread over
/// this many orders of magnitude.
fn lamps(random: &mut Random, pose: &DAffine3, kinds: &[&str], orders: f64) -> Lamps {
    let mut out = Lamps { surfaces: Vec::new(), lights: Vec::new(), radiance: [0.0; 3] };
    for cell in 0..64 {
        let (elevation, azimuth) = ((18.0 + 8.0 * f64::from(cell / 8)).to_radians(), f64::from(cell % 8) * PI / 4.0);
        let to = DVec3::new(elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin());
        let distance = f64::powf(10.0, random.between(-0.3, 0.4));
        let p = to * distance;
        // What each sends to the receiver is alike but for the strength.
        let strength = distance * distance * f64::powf(10.0, random.between(-orders, 0.0));
        let color = [0, 1, 2].map(|_| strength * random.between(0.5, 1.0));
        let mut receive = |irradiance: f64| {
            for c in 0..3 {
                out.radiance[c] += ALBEDO[c] * color[c] * irradiance / PI;
            }
        };
        match kinds[cell as usize % kinds.len()] {
            "point" => {
                receive(to.z / (distance * distance));
                out.lights
                    .push(json!({ "type": "point", "position": point(pose.transform_point3(p)), "intensity": color }));
            }
            "spot" => {
                // Aimed beside the receiver, which is in the inner cone.
                let at = pose.transform_point3(DVec3::new(0.05, 0.02, 0.0) * distance);
                receive(to.z / (distance * distance));
                out.lights.push(json!({
                    "type": "spot", "position": point(pose.transform_point3(p)), "at": point(at), "intensity": color,
                    "inner_angle": 10, "outer_angle": 20
                }));
            }
            "past" => {
                // A spot that shines past the receiver, and a point light below its horizon.
                let direction = pose.transform_vector3(to.cross(DVec3::Z).normalize());
                out.lights.push(json!({
                    "type": "spot", "position": point(pose.transform_point3(p)), "direction": point(direction),
                    "intensity": color, "inner_angle": 30, "outer_angle": 60
                }));
                let below = pose.transform_point3(DVec3::new(p.x, p.y, -p.z));
                out.lights.push(json!({ "type": "point", "position": point(below), "intensity": color }));
            }
            "ball" => {
                // E = πL (R/d)² cosθ.
                let radius = 0.05 * distance;
                let l = color.map(|c| c / (radius * radius));
                receive(PI * to.z / (distance * distance));
                out.surfaces.push(sphere(pose.transform_point3(p), radius, false, shining(l.to_vec())));
            }
            kind => {
                let away = kind == "away";
                let frame = facing(p, (if away { to } else { -to } + random.direction() * 0.4).normalize());
                let [a, b] = [0.09, 0.06].map(|s| 0.5 * s * distance);
                let corners =
                    [(-a, -b), (a, -b), (a, b), (-a, b)].map(|(x, y)| frame.transform_point3(DVec3::new(x, y, 0.0)));
                let area = 4.0 * a * b;
                if !away {
                    receive(PI * form_factor(&corners, DVec3::Z) / area);
                }
                let mut material = shining(color.map(|c| c / area).to_vec());
                if kind == "both sides" {
                    material["two_sided"] = json!(true);
                }
                out.surfaces.push(quad(&(*pose * frame), [2.0 * a, 2.0 * b], material));
            }
        }
    }
    out
}

/// Demands that the receiver reflects the sum of the closed forms, by each of the techniques.
fn sums_up(what: &str, kinds: &[&str], orders: f64, sun: bool, techniques: &[(&str, Settings)], seed: u64) {
    let mut random = Random(seed);
    let pose = random.pose(1.0);
    let Lamps { mut surfaces, mut lights, mut radiance } = lamps(&mut random, &pose, kinds, orders);
    if sun {
        // Between the cells, above all lamps.
        let to = DVec3::new(0.11, 0.05, 1.0).normalize();
        let direction = pose.transform_vector3(-to);
        let irradiance = [4.0, 5.0, 6.0];
        lights.push(json!({ "type": "directional", "direction": point(direction), "irradiance": irradiance }));
        (0..3).for_each(|c| radiance[c] += ALBEDO[c] * irradiance[c] * to.z / PI);
    }
    let view = View { from: DVec3::new(0.1, -2.0, 0.3), at: DVec3::ZERO, up: DVec3::Z, vfov: 0.01, resolution: [1, 1] };
    surfaces.push(quad(&pose, [0.02; 2], diffuse(ALBEDO.to_vec())));
    let scene = scene(&scene_json(view.moved(&pose).json(), surfaces, lights));
    for (name, settings) in techniques {
        let images = images(&scene, *settings, Budget::new(1 << 15, seed));
        assert_closed(&format!("{what}, {name}"), &images, &radiance, Bounds::of_mean(0.005));
    }
}

#[test]
fn point_and_spot_lights_by_the_dozen() {
    let by = [("(1,2)", technique(1, 2)), ("path", settings(Integrator::Path, 1))];
    sums_up("deltas", &["point", "spot", "past"], 6.0, false, &by, 900);
    sums_up("deltas alike", &["point", "spot", "past"], 0.3, false, &by, 902);
    sums_up("deltas and a sun", &["point", "spot", "past"], 1.0, true, &by, 903);
}

#[test]
fn lamps_of_all_kinds_by_the_dozen() {
    let by =
        [("(1,2)", technique(1, 2)), ("path", settings(Integrator::Path, 1)), ("bdpt", settings(Integrator::Bdpt, 1))];
    let kinds = &["quad", "point", "away", "spot", "ball", "both sides", "past"];
    sums_up("lamps", kinds, 6.0, false, &by, 901);
    sums_up("lamps alike and a sun", kinds, 0.3, true, &by, 904);
}

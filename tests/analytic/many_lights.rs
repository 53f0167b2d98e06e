//! Many lights at once, of very different power, some facing away and some below the horizon: next-event estimation chooses
//! among them by what each may send to the receiver, and all of them together are the sum of their closed forms.

use std::f64::consts::PI;

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;

use super::area_lights::form_factor;
use crate::common::{
    Bounds, Budget, Random, View, assert_closed, diffuse, facing, images, point, quad, scene, scene_json, settings,
    shining, technique,
};

const ALBEDO: [f64; 3] = [0.8, 0.5, 0.25];

/// Lights over a receiver at the origin with normal z, and what they make it reflect.
struct Lamps {
    surfaces: Vec<Value>,
    lights: Vec<Value>,
    radiance: [f64; 3],
}

/// One light in each cell of a dome, so that none hides another. `kinds` says which there are; powers spread over six
/// orders of magnitude.
fn lamps(random: &mut Random, pose: &twinlight::math::DAffine3, kinds: &[&str]) -> Lamps {
    let mut out = Lamps { surfaces: Vec::new(), lights: Vec::new(), radiance: [0.0; 3] };
    for cell in 0..64 {
        let (elevation, azimuth) = ((18.0 + 8.0 * f64::from(cell / 8)).to_radians(), f64::from(cell % 8) * PI / 4.0);
        let to = DVec3::new(elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin());
        let distance = f64::powf(10.0, random.between(-0.3, 0.4));
        let p = to * distance;
        let strength = f64::powf(10.0, random.between(-4.0, 2.0));
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
            kind => {
                let away = kind == "away";
                let frame = facing(p, (if away { to } else { -to } + random.direction() * 0.4).normalize());
                let [a, b] = [0.15, 0.1].map(|s| 0.5 * s * distance);
                let corners =
                    [(-a, -b), (a, -b), (a, b), (-a, b)].map(|(x, y)| frame.transform_point3(DVec3::new(x, y, 0.0)));
                if !away {
                    receive(PI * form_factor(&corners, DVec3::Z));
                }
                out.surfaces.push(quad(&(*pose * frame), [2.0 * a, 2.0 * b], shining(color.to_vec())));
            }
        }
    }
    out
}

/// `noise` is the bound for the techniques together; one technique has more of it or less.
fn sums_up(what: &str, kinds: &[&str], techniques: &[(&str, Settings)], seed: u64) {
    let mut random = Random(seed);
    let pose = random.pose(1.0);
    let Lamps { mut surfaces, lights, radiance } = lamps(&mut random, &pose, kinds);
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
    sums_up("deltas", &["point", "spot", "past"], &by, 900);
}

#[test]
fn lamps_of_all_kinds_by_the_dozen() {
    let by =
        [("(1,2)", technique(1, 2)), ("path", settings(Integrator::Path, 1)), ("bdpt", settings(Integrator::Bdpt, 1))];
    sums_up("lamps", &["quad", "point", "away", "spot", "past"], &by, 901);
}

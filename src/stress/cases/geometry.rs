//! Sizes, places, bad triangles, cameras.

use serde_json::{Value, json};

use super::super::{Case, Expected};
use super::room::{BACK, CEILING, FLOOR, LAMP, Room, X, Y, alone, ball, diffuse, quad, shining};

pub fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    sizes(&mut all);
    triangles(&mut all);
    gaps(&mut all);
    cameras(&mut all);
    all
}

/// The undisturbed room's image.
fn as_room() -> Expected {
    Expected::SameAs { scene: Room::new().json(), times: 1.0 }
}

fn sizes(all: &mut Vec<Case>) {
    let plain = Room::new().json();
    for power in [-20, 20] {
        let factor = f64::from(power).exp2();
        let scene = Room::new().posed(&[json!({ "scale": factor })]).json();
        let expected = Expected::SameBits { scene: plain.clone(), times: 1.0 };
        all.push(Case::new(format!("scale 2^{power}"), "all lengths times a power of two", scene, expected).closed());
    }
    for scale in [1e-6, 1e6] {
        let scene = Room::new().posed(&[json!({ "scale": scale })]).json();
        all.push(Case::new(format!("scale {scale:e}"), "all lengths scaled", scene, as_room()).closed().within(2e-3));
    }
    // Vertices as a file of f32 holds them, far from the origin; compared with the same vertices brought back.
    let offset = 1e5;
    let meshed = |away: f64| {
        let mut room = Room::new();
        let quantised = |x: f64| f64::from((x + offset) as f32) - offset + away;
        for index in [FLOOR, CEILING, BACK, LAMP] {
            let (y, z) = match index {
                FLOOR => (Some(-1.0), None),
                CEILING => (Some(1.0), None),
                LAMP => (Some(0.9), None),
                _ => (None, Some(-1.0)),
            };
            let half = if index == LAMP { 0.3 } else { 1.0 };
            let corner = |a: f64, b: f64| match (y, z) {
                (Some(y), _) => [a, y, -b * y.signum()],
                (_, z) => [a, b, z.unwrap_or(0.0)],
            };
            let corners = [corner(-half, -half), corner(half, -half), corner(half, half), corner(-half, half)];
            let mut material = room.surfaces[index]["material"].clone();
            if index == LAMP {
                material = shining(4.0);
            }
            room.surfaces[index] = json!({
                "type": "mesh", "material": material, "indices": [[0, 1, 2, 3]], "transform": [],
                "positions": corners.map(|p| p.map(quantised))
            });
        }
        for thing in room.surfaces.iter_mut().chain([&mut room.camera]) {
            let chain = thing["transform"].as_array_mut().expect("a chain");
            if !chain.is_empty() {
                chain.push(json!({ "translate": [away, away, away] }));
            }
        }
        room.json()
    };
    let expected = Expected::SameAs { scene: meshed(0.0), times: 1.0 };
    let what = "all vertices 1e5 away, rounded to f32 there; compared with the same rounded vertices brought back";
    all.push(Case::new("translation 1e5", what, meshed(offset), expected).within(2e-3));
}

/// The back wall as a mesh of these corners and faces.
fn back_wall(positions: &[[f64; 3]], faces: &[Vec<usize>]) -> Value {
    json!({ "type": "mesh", "positions": positions, "indices": faces, "material": diffuse(0.6), "transform": [] })
}

fn triangles(all: &mut Vec<Case>) {
    // A fan from one corner to points that crowd toward another: the last needles are 10⁻⁹ wide.
    let steps = 40;
    let mut positions = vec![[-1.0, -1.0, -1.0], [1.0, -1.0, -1.0]];
    positions.extend((0..=steps).map(|i| [1.0 - 2.0 * (f64::from(i) / f64::from(steps)).powi(6), 1.0, -1.0]));
    let faces: Vec<Vec<usize>> = (1..positions.len() - 1).map(|i| vec![0, i, i + 1]).collect();
    let room = Room::new().replacing(BACK, back_wall(&positions, &faces));
    let what = "a wall of needles, down to 10⁻⁹ wide";
    all.push(Case::new("needles", what, room.clone().json(), as_room()).closed().within(5e-3));
    // Out of the axes' planes, where f32 knows no plane exactly.
    let turn = [json!({ "axis": [0.3, 0.7, -0.2], "angle": 33 })];
    let expected = Expected::SameAs { scene: Room::new().posed(&turn).json(), times: 1.0 };
    let what = "the same in a room that is turned";
    all.push(Case::new("needles, turned", what, room.posed(&turn).json(), expected).closed().within(5e-3));
    // A grid of ever smaller triangles.
    let n = 24;
    let at = |i: usize| if i == 0 { -1.0 } else { -1.0 + 2.0 * 0.5_f64.powi((n - i) as i32) };
    let positions: Vec<[f64; 3]> = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j), -1.0])).collect();
    let faces: Vec<Vec<usize>> = (0..n)
        .flat_map(|j| (0..n).map(move |i| j * (n + 1) + i))
        .map(|k| vec![k, k + 1, k + n + 2, k + n + 1])
        .collect();
    let scene = Room::new().replacing(BACK, back_wall(&positions, &faces)).json();
    all.push(
        Case::new("tiny triangles", "a wall of triangles down to 2⁻²³ wide", scene, as_room()).closed().within(5e-3),
    );

    let nothing = json!({
        "type": "mesh", "material": diffuse(0.5), "indices": [[0, 1, 2], [3, 4, 5], [0, 0, 3]],
        "positions": [[0, 0, 0], [0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.3, 0, 0], [0.3, 0, 0], [0.3, 0.5, 0]]
    });
    let scene = Room::new().with(vec![nothing]).json();
    let expected = Expected::SameBits { scene: Room::new().json(), times: 1.0 };
    all.push(Case::new("no area", "triangles without area, which are left out", scene, expected).closed());

    let floor = Room::new().surfaces[FLOOR].clone();
    let scene = Room::new().with(vec![floor]).json();
    all.push(Case::new("duplicate wall", "the floor twice", scene, as_room()).closed().within(5e-3));
    let overlap = quad([1.3, 0.9], -90.0, X, [0.2, -1.0, 0.3], diffuse(0.7));
    let scene = Room::new().with(vec![overlap]).json();
    all.push(Case::new("coplanar", "a second floor in the plane of the first", scene, as_room()).closed().within(5e-3));
    let lamp = Room::new().surfaces[LAMP].clone();
    let scene = Room::new().with(vec![lamp]).json();
    let what = "the lamp twice: its double is left out";
    all.push(Case::new("duplicate lamp", what, scene, as_room()).closed().within(5e-3));
    let mut doubled = Room::new().surfaces[LAMP].clone();
    let corners = [[-0.35, -0.3, 0.0], [0.35, -0.3, 0.0], [0.35, 0.3, 0.0], [-0.35, 0.3, 0.0]];
    let parts =
        [("type", json!("mesh")), ("positions", json!(corners)), ("indices", json!([[0, 1, 2], [0, 2, 3], [2, 0, 1]]))];
    doubled.as_object_mut().expect("a surface").remove("size");
    parts.into_iter().for_each(|(key, value)| doubled[key] = value);
    let scene = Room::new().replacing(LAMP, doubled).json();
    let what = "a lamp of three triangles of which two are one";
    all.push(Case::new("duplicate triangle", what, scene, as_room()).closed().samples(16).within(0.01));
    let what = "within a ball of 448 triangles, down to slivers at its poles, that shines and reflects: a furnace";
    let furnace = Case::new("watertight", what, alone(vec![furnace()], vec![]).json(), Expected::Mean(1.9375));
    all.push(Case { bounces: 4, ..furnace }.closed().from_camera().samples(8).within(0.01));
}

/// A ball of triangles about the camera that faces inwards, emits 1 and reflects half.
fn furnace() -> Value {
    let (rings, steps) = (15, 16);
    let point = |ring: i32, step: i32| {
        // Most rings crowd at the poles.
        let latitude = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        let latitude = latitude - 0.49 * (2.0 * latitude).sin();
        let longitude = std::f64::consts::TAU * (f64::from(step) + 0.37 * f64::from(ring)) / f64::from(steps);
        let ((s, c), (sl, cl)) = (latitude.sin_cos(), longitude.sin_cos());
        [0.8 * s * cl, 0.8 * c, 0.8 * s * sl]
    };
    let mut positions = vec![[0.0, 0.8, 0.0], [0.0, -0.8, 0.0]];
    positions.extend((1..rings).flat_map(|ring| (0..steps).map(move |step| point(ring, step))));
    let at = |ring: i32, step: i32| match ring {
        0 => 0,
        r if r == rings => 1,
        r => 2 + (r - 1) * steps + step % steps,
    };
    let faces: Vec<[i32; 3]> = (0..rings)
        .flat_map(|ring| (0..steps).map(move |step| (ring, step)))
        .flat_map(|(r, s)| [[at(r, s), at(r + 1, s + 1), at(r + 1, s)], [at(r, s), at(r, s + 1), at(r + 1, s + 1)]])
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    let material = json!({ "type": "lambertian", "albedo": 0.5, "emit": 1 });
    // Wound outwards: the side that counts is the inner one.
    json!({ "type": "mesh", "positions": positions, "indices": faces, "material": material, "flip_normals": true })
}

/// Multiples of 16 ulps of the wall's coordinate.
const GAPS: [f64; 4] = [16.0 / (1u32 << 23) as f64, 1e-5, 1e-4, 1e-3];

fn gaps(all: &mut Vec<Case>) {
    let lamp = |y: f64| quad([0.7, 0.6], 90.0, X, [0.05, y, -0.1], shining(4.0));
    for gap in GAPS {
        let flush = Room::new().lit_by(vec![lamp(1.0 - gap)]).json();
        let expected = Expected::SameAs { scene: Room::new().lit_by(vec![lamp(1.0 - 2e-3)]).json(), times: 1.0 };
        let what = "a lamp flush with the ceiling, against one a five-hundredth of the room below it";
        all.push(Case::new(format!("lamp flush, gap {gap:.1e}"), what, flush, expected).closed().within(0.02));
        let behind = Room::new().lit_by(vec![lamp(1.0 + gap)]).json();
        let what = "a lamp behind the ceiling: no light comes through";
        all.push(Case::new(format!("lamp behind, gap {gap:.1e}"), what, behind, Expected::Nothing).closed());
        // A sheet in front of the lamp.
        let sheet = json!({ "type": "lambertian", "albedo": 0, "two_sided": true });
        let covered = Room::new().with(vec![quad([2.0, 2.0], 90.0, X, [0.0, 0.9 - gap, 0.0], sheet)]).json();
        let what = "a lamp behind a black sheet: no light comes through";
        all.push(Case::new(format!("lamp covered, gap {gap:.1e}"), what, covered, Expected::Nothing).closed());
    }
}

fn cameras(all: &mut Vec<Case>) {
    let around = |radius: f64, material: Value, inwards: bool| {
        let mut ball = ball([0.0; 3], radius, material);
        ball["flip_normals"] = json!(inwards);
        ball
    };
    let sky = json!({ "type": "constant", "radiance": 1 });
    let dark = alone(vec![around(0.2, diffuse(0.8), false)], vec![sky.clone()]).json();
    all.push(Case::new("inside a solid", "the camera in an opaque ball", dark, Expected::Nothing).closed());
    let glass = around(0.2, json!({ "type": "dielectric", "ior": 1.5 }), false);
    let glass = alone(vec![glass], vec![sky.clone()]).json();
    let what = "the camera in a ball of glass under an even sky: n² as bright";
    all.push(Case { bounces: 64, ..Case::new("inside glass", what, glass, Expected::Mean(2.25)).from_camera() });
    let lamp = alone(vec![around(0.2, shining(2.0), true)], vec![]).json();
    let what = "the camera in a ball that shines inwards";
    all.push(Case::new("inside a light", what, lamp.clone(), Expected::Mean(2.0)).closed().samples(64).within(0.02));
    for (vfov, what) in
        [(0.001, "a view of a thousandth of a degree"), (179.9, "a view of nearly half of all directions")]
    {
        let mut scene = lamp.clone();
        scene["camera"]["vfov"] = json!(vfov);
        all.push(Case::new(format!("vfov {vfov}"), what, scene, Expected::Mean(2.0)).closed().from_camera());
    }
    for [width, height] in [[1, 1], [1, 64], [64, 1]] {
        let sized = |times: u32| {
            let mut room = Room::new();
            room.camera["resolution"] = json!([times * width, times * height]);
            room.json()
        };
        let expected = Expected::SameAs { scene: sized(2), times: 1.0 };
        let name = format!("image {width}×{height}");
        let what = "an image of few pixels, against one of four times as many";
        let case = Case::new(name.clone(), what, sized(1), expected).closed().within(0.03);
        // Few light paths land in a view of one pixel's width, fewer in one that is 64 times as wide as high.
        match [width, height] {
            [1, 1] => all.push(case.samples(512)),
            [1, 64] => {
                let light = Case { name: format!("{name}, light"), ..case.clone() };
                all.extend([case.from_camera().samples(16), light.by_light().samples(512)]);
            }
            _ => all.push(case.from_camera().samples(16)),
        }
    }
    // One degree's thousandth above the plane: what is seen lies 57 units away.
    let mut grazing =
        alone(vec![quad([400.0; 2], -90.0, X, [0.0; 3], json!({ "type": "lambertian", "albedo": 0.5 }))], vec![sky]);
    let slope = 0.001_f64.to_radians().tan();
    grazing.camera = json!({
        "transform": [{ "from": [0, 1e-3, 0], "at": [0, 1e-3 - slope, -1], "up": [0, 1, 0] }],
        "resolution": [4, 4], "vfov": 0.0005
    });
    let what = "a plane under an even sky, seen at 89.999° from its normal: its albedo";
    all.push(Case::new("grazing", what, grazing.json(), Expected::Mean(0.5)).from_camera().samples(64).within(3e-3));
    let far = quad([2.0; 2], 0.0, Y, [0.0, 0.0, -1e8], shining(1.0));
    let mut far = alone(vec![far], vec![]);
    far.camera["vfov"] = json!(1e-6);
    let what = "a lamp of two units 10⁸ away, in a view of a millionth of a degree";
    all.push(Case::new("far away", what, far.json(), Expected::Mean(1.0)).from_camera());
}

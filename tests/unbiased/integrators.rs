//! Path tracing, light tracing and bidirectional path tracing make the same image, bounce by bounce, of random scenes.
//!
//! Path classes left out, because one side cannot sample them: the emitter seen in a mirror or through glass has no
//! light-traced counterpart (`light` is compared only where the camera sees diffuse surfaces), and a delta light's
//! caustic none by path tracing (scenes with glass have area lights only).

use serde_json::{Value, json};
use twinlight::compare::stats::Interval;
use twinlight::film::Image;
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;

use crate::common::{
    Bounds, Budget, Random, View, assert_same, combined, diffuse, facing, images_by_edges, matrix, pooled_ratio, quad,
    scene, scene_json, settings, shining, shining_diffuse, sphere, validation_row,
};

/// The lights that random scenes have, one kind each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Quad,
    Sphere,
    Disk,
    Mesh,
    Point,
    Spot,
    Several,
}

const KINDS: [Kind; 7] = [Kind::Quad, Kind::Sphere, Kind::Disk, Kind::Mesh, Kind::Point, Kind::Spot, Kind::Several];

fn color(random: &mut Random, low: f64, high: f64) -> Vec<f64> {
    (0..3).map(|_| random.between(low, high)).collect()
}

/// Lights below the ceiling of the room, facing down more or less; area lights `size` times their usual size.
fn light(kind: Kind, size: f64, random: &mut Random, surfaces: &mut Vec<Value>, lights: &mut Vec<Value>) {
    let p = DVec3::new(random.between(-0.5, 0.5), random.between(0.5, 0.75), random.between(-0.4, 0.4));
    let down = (random.direction() * 0.5 - DVec3::Y).normalize();
    let frame = facing(p, down);
    match kind {
        Kind::Quad => surfaces.push(quad(&frame, [0.5 * size, 0.3 * size], shining(color(random, 5.0, 10.0)))),
        // These reflect as well.
        Kind::Sphere => surfaces.push(sphere(p, 0.15 * size, false, shining_diffuse(color(random, 4.0, 8.0), 0.5))),
        Kind::Disk => surfaces.push(json!({
            "type": "disk", "radius": 0.25 * size, "transform": matrix(&frame),
            "material": shining_diffuse(color(random, 5.0, 10.0), 0.3)
        })),
        Kind::Mesh => {
            // A pyramid without a base: its faces see different parts of the room.
            let corner = |x: f64, y: f64, z: f64| frame.transform_point3(size * DVec3::new(x, y, z)).to_array();
            surfaces.push(json!({
                "type": "mesh", "material": shining(color(random, 5.0, 10.0)),
                "positions": [corner(0.0, 0.0, 0.15), corner(0.25, 0.2, 0.0), corner(-0.2, 0.2, 0.0), corner(-0.2, -0.25, 0.0),
                              corner(0.2, -0.2, 0.0)],
                "indices": [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]
            }));
        }
        Kind::Point => lights.push(json!({
            "type": "point", "position": [p.x, p.y, p.z], "intensity": color(random, 0.5, 1.0)
        })),
        Kind::Spot => lights.push(json!({
            "type": "spot", "position": [p.x, p.y, p.z], "direction": [down.x, down.y, down.z],
            "intensity": color(random, 2.0, 4.0), "inner_angle": random.between(10.0, 30.0),
            "outer_angle": random.between(40.0, 70.0), "falloff": random.between(0.2, 2.0)
        })),
        Kind::Several => {
            for kind in [Kind::Quad, Kind::Point, Kind::Sphere, Kind::Spot] {
                light(kind, size, random, surfaces, lights);
            }
        }
    }
}

/// A room of random size and colours in a random pose, things in it, lights of one kind. With `specular`, a glass ball
/// and a mirror stand about as well, under larger lights: the path tracer finds caustics by hitting them.
fn random_scene(kind: Kind, seed: u64, specular: bool) -> Value {
    let mut random = Random(seed);
    let mut surfaces = Vec::new();
    let mut lights = Vec::new();
    light(kind, if specular { 1.6 } else { 1.0 }, &mut random, &mut surfaces, &mut lights);
    let half = DVec3::new(random.between(0.9, 1.2), 1.0, random.between(0.9, 1.2));
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for side in [1.0, -1.0] {
            // Larger than the room: walls cross at its edges.
            let frame = facing(-axis * side * half, axis * side);
            surfaces.push(quad(&frame, [2.6; 2], diffuse(color(&mut random, 0.2, 0.8))));
        }
    }
    for _ in 0..3 {
        let p = DVec3::new(random.between(-0.6, 0.6), random.between(-0.8, 0.0), random.between(-0.7, 0.2));
        let r = random.between(0.1, 0.25);
        surfaces.push(sphere(p, r, false, diffuse(color(&mut random, 0.2, 0.8))));
        let p = DVec3::new(random.between(-0.6, 0.6), random.between(-0.8, 0.0), random.between(-0.7, 0.2));
        let frame = facing(p, random.direction());
        let size = [random.between(0.2, 0.5), random.between(0.2, 0.5)];
        surfaces.push(quad(&frame, size, json!({ "type": "lambertian", "albedo": 0.6, "two_sided": true })));
    }
    if specular {
        let x = random.between(-0.5, 0.5);
        surfaces.push(sphere(DVec3::new(x, -0.6, 0.3), 0.3, false, json!({ "type": "dielectric", "ior": 1.5 })));
        let frame = facing(DVec3::new(-x, -0.2, -0.75), DVec3::new(random.between(-0.4, 0.4), 0.2, 1.0));
        surfaces.push(quad(&frame, [0.8, 0.9], json!({ "type": "mirror", "albedo": 0.8 })));
    }
    let view = View {
        from: DVec3::new(random.between(-0.5, 0.5), random.between(-0.2, 0.4), 0.8),
        at: DVec3::new(0.0, random.between(-0.4, 0.0), -0.5),
        up: DVec3::Y,
        vfov: random.between(55.0, 85.0),
        resolution: [2, 2],
    };
    // All of it elsewhere: transforms are applied in order, each on the left.
    let pose = random.pose(1.0);
    let moved = |value: &mut Value| {
        let own = value["transform"].take();
        value["transform"] = if own.is_null() { json!([matrix(&pose)]) } else { json!([own, matrix(&pose)]) };
    };
    surfaces.iter_mut().for_each(moved);
    for light in &mut lights {
        for (key, direction) in [("position", false), ("direction", true)] {
            if let Some(v) = light.get(key).and_then(Value::as_array) {
                let v = DVec3::from_slice(&v.iter().filter_map(Value::as_f64).collect::<Vec<_>>());
                let v = if direction { pose.transform_vector3(v) } else { pose.transform_point3(v) };
                light[key] = json!([v.x, v.y, v.z]);
            }
        }
    }
    scene_json(view.moved(&pose).json(), surfaces, lights)
}

const EDGES: u32 = 4;

/// What is demanded of the common bias of all scenes at once.
#[derive(Clone, Copy)]
struct Pooled {
    /// Of the paths of each length by themselves.
    length: f64,
    /// Of all lengths together.
    whole: f64,
}

/// Compares two integrators over scenes, length by length; then all scenes at once.
fn agree(
    what: &str,
    scenes: &[(Kind, Value)],
    integrators: [Integrator; 2],
    samples: [u32; 2],
    bounds: Bounds,
    pooled: Pooled,
    seed: u64,
) {
    let limits = |integrator| Settings { ..settings(integrator, EDGES - 1) };
    let mut pairs: Vec<Vec<(Vec<Image>, Vec<Image>)>> = vec![Vec::new(); EDGES as usize];
    let mut whole = Vec::new();
    for (n, (kind, json)) in scenes.iter().enumerate() {
        let scene = scene(json);
        let delta = matches!(kind, Kind::Point | Kind::Spot);
        let [a, b] = [0, 1].map(|i| {
            let budget = Budget::new(samples[i], seed + 2 * n as u64 + i as u64);
            images_by_edges(&scene, limits(integrators[i]), budget, EDGES)
        });
        let sum = |of: &[Vec<Image>]| -> Vec<Image> {
            let longer = |sum: Vec<Image>, images: &Vec<Image>| -> Vec<Image> {
                sum.iter().zip(images).map(|(a, b)| combined(a, b, 1.0)).collect()
            };
            of[1..].iter().fold(of[0].clone(), longer)
        };
        whole.push((sum(&a), sum(&b)));
        for (k, (a, b)) in a.into_iter().zip(b).enumerate() {
            // The light itself, seen or not seen, is one edge: a delta light is never seen, another may be out of view.
            if b.iter().all(|image| image.mean() == [0.0; 3]) {
                assert!(k == 0, "{what}, scene {n}, {kind:?}: no light after {k} bounces");
                assert!(a.iter().all(|image| image.mean() == [0.0; 3]), "{what}, scene {n}: one sees light, one none");
                continue;
            }
            assert!(k > 0 || !delta, "{what}: a delta light is seen");
            let label = format!("{what}, scene {n}, {kind:?}, {} edges", k + 1);
            assert_same(&label, &a, &b, bounds);
            pairs[k].push((a, b));
        }
    }
    let judge = |label: &str, pairs: &[(Vec<Image>, Vec<Image>)], bound: f64| {
        let label = format!("{what}, {} scenes, {label}", pairs.len());
        let bias = pooled_ratio(pairs);
        let interval = bias.confidence_interval(0.99);
        let Interval { low, high } = interval;
        validation_row(file!(), &label, 1.0 + bias.mean(), 1.0, [low, high], bound, f64::NAN);
        // The level at which single tests are judged, too.
        let evidence = bias.confidence_interval(1.0 - 1e-4);
        assert!(evidence.contains(0.0), "{label}: a common bias in {evidence:?}");
        assert!(interval.within(bound), "{label}: {interval:?} is not proven inside ±{bound}");
    };
    for (k, pairs) in pairs.iter().enumerate().filter(|(_, pairs)| pairs.len() > 1) {
        judge(&format!("{} edges", k + 1), pairs, pooled.length);
    }
    judge("all lengths", &whole, pooled.whole);
}

fn scenes(count: usize, seed: u64, specular: bool) -> Vec<(Kind, Value)> {
    let area = |kind: &Kind| !matches!(kind, Kind::Point | Kind::Spot | Kind::Several);
    KINDS
        .into_iter()
        .filter(|kind| !specular || area(kind))
        .cycle()
        .take(count)
        .enumerate()
        .map(|(n, kind)| (kind, random_scene(kind, seed + n as u64, specular)))
        .collect()
}

/// Wide for each scene by itself, for its bounces are few samples' worth: what is sharp is the common bias of all. The
/// deep test below asks for more.
fn fast() -> Bounds {
    Bounds::new([2, 2], 0.8, 0.2)
}

#[test]
fn diffuse_scenes_by_path_and_bdpt() {
    let scenes = scenes(7, 7000, false);
    let pooled = Pooled { length: 0.02, whole: 0.005 };
    agree("path = bdpt", &scenes, [Integrator::Path, Integrator::Bdpt], [1 << 11, 1 << 10], fast(), pooled, 700);
}

#[test]
fn diffuse_scenes_by_light_and_path() {
    let scenes = scenes(7, 7100, false);
    let pooled = Pooled { length: 0.015, whole: 0.005 };
    agree("light = path", &scenes, [Integrator::Light, Integrator::Path], [1 << 13, 1 << 11], fast(), pooled, 730);
}

#[test]
fn glass_and_mirrors_by_path_and_bdpt() {
    let scenes = scenes(4, 7200, true);
    let pooled = Pooled { length: 0.02, whole: 0.005 };
    agree(
        "specular, path = bdpt",
        &scenes,
        [Integrator::Path, Integrator::Bdpt],
        [1 << 15, 1 << 12],
        fast(),
        pooled,
        760,
    );
}

const DEEP: Pooled = Pooled { length: 0.003, whole: 0.003 };

/// Closely for each scene by itself, and for the common bias of all.
fn deep() -> Bounds {
    Bounds::new([2, 2], 0.1, 0.03)
}

#[test]
#[ignore = "deep"]
fn many_diffuse_scenes_by_path_and_bdpt() {
    let scenes = scenes(14, 8000, false);
    agree("path = bdpt", &scenes, [Integrator::Path, Integrator::Bdpt], [1 << 16, 1 << 15], deep(), DEEP, 800);
}

#[test]
#[ignore = "deep"]
fn many_diffuse_scenes_by_light_and_bdpt() {
    let scenes = scenes(14, 8100, false);
    agree("light = bdpt", &scenes, [Integrator::Light, Integrator::Bdpt], [1 << 17, 1 << 14], deep(), DEEP, 1000);
}

/// The path tracer finds caustics by chance: with them every comparison is noisier.
#[test]
#[ignore = "deep"]
fn many_scenes_with_glass_and_mirrors() {
    let (scenes, bounds) = (scenes(8, 8200, true), Bounds::new([2, 2], 0.6, 0.12));
    let both = [Integrator::Path, Integrator::Bdpt];
    let pooled = Pooled { length: 0.01, whole: 0.003 };
    agree("specular, path = bdpt", &scenes, both, [1 << 16, 1 << 15], bounds, pooled, 1200);
}

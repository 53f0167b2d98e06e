//! Far and huge things in a scene: what is near keeps its precision, its lights their place and their brightness.

mod common;

use common::{DefaultAccel, render_once, scene_on, settings};
use serde_json::{Value, json};
use twinlight::accel::bvh::BvhAccel;
use twinlight::accel::{Accel, AccelOptions};
use twinlight::import::scene_from_str;
use twinlight::integrator::Integrator;
use twinlight::scene::{Prepared, Scene, prepare};

const ALL: [Integrator; 3] = [Integrator::Path, Integrator::Light, Integrator::Bdpt];

fn white() -> Value {
    json!({"type": "lambertian", "albedo": 0.73, "two_sided": true})
}

fn black() -> Value {
    json!({"type": "lambertian", "albedo": 0})
}

/// A floor, a wall, a glass ball, a small lamp and its shade, a spot light; and what is added.
fn near(more: Vec<Value>, pose: &[Value]) -> Value {
    let posed = |own: Vec<Value>| [own, pose.to_vec()].concat();
    let mut surfaces = vec![
        json!({"type": "quad", "size": 8, "material": white(), "transform": posed(vec![json!({"rotate": [-90, 1, 0, 0]})])}),
        json!({"type": "quad", "size": 8, "material": white(), "transform": posed(vec![json!({"translate": [0, 0, -1.5]})])}),
        json!({"type": "sphere", "radius": 0.4, "material": {"type": "dielectric", "ior": 1.5},
               "transform": posed(vec![json!({"translate": [0.6, 0.4, 0.3]})])}),
        json!({"type": "sphere", "radius": 0.12, "material": {"type": "diffuse light", "emit": [60, 50, 35]},
               "transform": posed(vec![json!({"translate": [-0.8, 1.5, 0]})])}),
        json!({"type": "quad", "size": 0.8, "material": {"type": "lambertian", "albedo": 0.05, "two_sided": true},
               "transform": posed(vec![json!({"rotate": [-90, 1, 0, 0]}), json!({"translate": [-0.8, 1.3, 0]})])}),
        json!({"type": "delta point", "transform": posed(vec![json!({"rotate": [-70, 1, 0, 0]}), json!({"translate": [0.6, 2.5, 0.8]})]),
               "material": {"type": "spot light", "emit": 12, "inner_angle": 10, "outer_angle": 16}}),
    ];
    surfaces.extend(more);
    json!({
        "camera": {"transform": posed(vec![json!({"from": [0, 1.0, 4.2], "at": [0, 0.75, 0], "up": [0, 1, 0]})]),
                   "resolution": [16, 12], "vfov": 40},
        "surfaces": surfaces
    })
}

fn means<A: Accel>(file: &Value, samples: u32) -> [f64; 3] {
    let scene: Scene<A> = scene_on(file, AccelOptions::default());
    ALL.map(|integrator| {
        let mean = render_once(&scene, settings(integrator, 6), samples, None).image.mean();
        mean.iter().sum::<f64>() / 3.0
    })
}

/// A lone object, a planet, and a sky, all of it 10⁷ away.
fn far_things() -> [(&'static str, Value); 3] {
    let ball = |radius: f64, z: f64| json!({"type": "sphere", "radius": radius, "material": black(), "transform": {"translate": [0, 0, z]}});
    [("a ball", ball(1.0, -1e7)), ("a planet", ball(1e6, -1e7)), ("a sky", ball(1e7, 0.0))]
}

fn far_things_disturb_nothing<A: Accel>() {
    let plain = means::<A>(&near(vec![], &[]), 64);
    for (what, thing) in far_things() {
        let with = means::<A>(&near(vec![thing], &[]), 64);
        for ((integrator, with), plain) in ALL.iter().zip(with).zip(plain) {
            assert!(
                (with / plain - 1.0).abs() < 1e-4,
                "{}, {what}, {integrator:?}: {with}, and {plain} without",
                A::NAME
            );
        }
    }
}

#[test]
fn what_is_near_looks_as_without_what_is_far() {
    far_things_disturb_nothing::<DefaultAccel>();
    far_things_disturb_nothing::<BvhAccel>();
}

fn prepared(file: &Value) -> Prepared {
    let desc =
        scene_from_str(&file.to_string(), "test.json", std::path::Path::new("")).unwrap_or_else(|e| panic!("{e}"));
    prepare(&desc).unwrap_or_else(|e| panic!("{e}"))
}

/// The origin of render space goes with the scene, to the bit where the scene is scaled by a power of two.
#[test]
fn the_origin_follows_the_scene() {
    for more in [vec![], vec![far_things()[0].1.clone()]] {
        let plain = prepared(&near(more.clone(), &[]));
        let scaled = |thing: &Value| {
            let mut thing = thing.clone();
            let chain = vec![thing["transform"].clone(), json!({"scale": 1024})];
            thing["transform"] = json!(chain);
            thing
        };
        let large = prepared(&near(more.iter().map(scaled).collect(), &[json!({"scale": 1024})]));
        assert_eq!(large.center, plain.center * 1024.0);
        assert_eq!((large.scale * 1024.0, large.near), (plain.scale, plain.near));
        assert_eq!(large.geometry.positions, plain.geometry.positions);
        assert!(plain.center.length() < 16.0, "{}", plain.center);
    }
    let away = prepared(&near(vec![], &[json!({"translate": [1e5, -1e5, 1e5]})]));
    let plain = prepared(&near(vec![], &[]));
    let moved = away.center - twinlight::math::DVec3::new(1e5, -1e5, 1e5);
    assert!((moved - plain.center).length() < 1e-6 && away.scale == plain.scale, "{moved} {}", plain.center);
}

/// A floor of some size under a point light 2.5 above it; all of it turned, if `turn`.
fn floor(size: f64, turn: bool, more: Vec<Value>) -> Value {
    let pose = if turn { vec![json!({"rotate": [30, 1, 0.3, 0.2]})] } else { vec![] };
    let posed = |own: Value| json!([vec![own], pose.clone()].concat());
    let mut surfaces = vec![
        json!({"type": "quad", "size": size, "material": white(), "transform": posed(json!({"rotate": [-90, 1, 0, 0]}))}),
        json!({"type": "delta point", "material": {"type": "point light", "emit": 12},
               "transform": posed(json!({"translate": [1.2, 2.5, 0.8]}))}),
    ];
    surfaces.extend(more);
    json!({
        "camera": {"transform": posed(json!({"from": [0, 1.0, 4.2], "at": [0, 0.0, 0], "up": [0, 1, 0]})),
                   "resolution": [16, 12], "vfov": 40},
        "surfaces": surfaces
    })
}

#[test]
fn a_light_over_a_floor_under_a_huge_sky_shines() {
    for turn in [false, true] {
        let plain = means::<DefaultAccel>(&floor(8.0, turn, vec![]), 64);
        let sky = json!({"type": "sphere", "radius": 1e7, "material": black()});
        let under = means::<DefaultAccel>(&floor(8.0, turn, vec![sky]), 64);
        for (plain, under) in plain.into_iter().zip(under) {
            assert!(plain > 0.05 && (under / plain - 1.0).abs() < 1e-4, "turned {turn}: {under}, and {plain} without");
        }
    }
}

/// A floor of which f32 knows the points to about half a unit, and the plane, where it is turned, no better than the light's
/// height above it: it is lit all the same, by all techniques, and the user is told.
#[test]
fn a_light_over_a_huge_floor_shines_on_it() {
    for turn in [false, true] {
        let plain = means::<DefaultAccel>(&floor(1000.0, turn, vec![]), 1024);
        let prepared = prepared(&floor(1e7, turn, vec![]));
        let warnings: Vec<String> = prepared.warnings.iter().map(ToString::to_string).collect();
        if turn {
            let [warning] = warnings.as_slice() else { panic!("{warnings:?}") };
            let expected = "light 0 is taken as standing on the surface test.json:1:";
            assert!(warning.contains(expected) && warning.contains("/surfaces/0: it is 2."), "{warning}");
        } else {
            assert!(warnings.is_empty(), "{warnings:?}");
        }
        let scene: Scene<DefaultAccel> =
            Scene::build(prepared, AccelOptions::default()).unwrap_or_else(|e| panic!("{e}"));
        for (integrator, plain) in ALL.into_iter().zip(plain) {
            let huge = render_once(&scene, settings(integrator, 6), 1024, None).image.mean()[0];
            // Points are half a unit apart, the light's height and the camera's are known to a quarter: `path` and `bdpt` are up to
            // 8 % off. `light` is up to 12 % off, of which it has not been found out whether that is all of the cause.
            let bound = if integrator == Integrator::Light { 0.25 } else { 0.1 };
            assert!(
                (huge / plain - 1.0).abs() < bound,
                "turned {turn}, {integrator:?}: {huge}, and {plain} of a smaller floor"
            );
        }
    }
}

/// A lamp that is tiny in its scene is seen, and lights what is beside it, without overflow.
#[test]
fn a_lamp_tiny_in_its_scene_fits_the_film() {
    let lamp = |sky: f64| {
        json!({
            "camera": {"transform": {"from": [0, 0.5, 3], "at": [0, 0.5, 0], "up": [0, 1, 0]}, "resolution": [8, 8], "vfov": 30},
            "surfaces": [
                {"type": "sphere", "radius": 0.2, "material": {"type": "diffuse light", "emit": 60}, "transform": {"translate": [0, 0.5, 0]}},
                {"type": "quad", "size": 4, "material": white(), "transform": {"rotate": [-90, 1, 0, 0]}},
                {"type": "sphere", "radius": sky, "material": black()}]
        })
    };
    let plain = means::<DefaultAccel>(&lamp(1e2), 64);
    for sky in [1e7, 1e9] {
        for (huge, plain) in means::<DefaultAccel>(&lamp(sky), 64).into_iter().zip(plain) {
            assert!((huge / plain - 1.0).abs() < 1e-3, "{sky}: {huge} {plain}");
        }
    }
}

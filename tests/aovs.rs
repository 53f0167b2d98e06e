//! Auxiliary images: known values of known scenes, parts that sum to the picture, a variance that is the variance, and the
//! same bits for any number of threads.

mod common;

use serde_json::{Value, json};
use twinlight::accel::AccelOptions;
use twinlight::film::{Channel, Image, Samples};
use twinlight::integrator::{Crop, Integrator, Settings};
use twinlight::math::{DAffine3, DVec3};
use twinlight::render::{Aov, AovJob, Extras, RenderJob, Rendered, render_with};
use twinlight::sampling::SamplerKind;

use common::{DefaultAccel, diffuse, facing, prepared, quad, scene, scene_json, settings, shining, sphere};

const GEOMETRY: [Aov; 7] =
    [Aov::Albedo, Aov::Normal, Aov::ShadingNormal, Aov::Depth, Aov::Primitive, Aov::Material, Aov::SampleCount];

fn floats<'c>(channels: &'c [Channel], name: &str) -> &'c [f32] {
    match channels.iter().find(|c| c.name == name).map(|c| &c.samples) {
        Some(Samples::Float(v)) => v,
        other => panic!("{name}: {other:?}"),
    }
}

fn ids<'c>(channels: &'c [Channel], name: &str) -> &'c [u32] {
    match channels.iter().find(|c| c.name == name).map(|c| &c.samples) {
        Some(Samples::Uint(v)) => v,
        other => panic!("{name}: {other:?}"),
    }
}

fn of_scene(json: &Value, wanted: &[Aov], threads: usize) -> Vec<Channel> {
    let prepared = prepared(json);
    let scale = prepared.scale;
    let options = AccelOptions { delta_points: true, ..AccelOptions::default() };
    let scene = twinlight::scene::Scene::<DefaultAccel>::build(prepared, options).unwrap_or_else(|e| panic!("{e}"));
    let crop = Crop::full(scene.camera.resolution());
    let materials = [0, 1, 2, 3, 4];
    let settings = Settings { seed: 3, ..Settings::default() };
    let job = AovJob { settings, samples: 20, crop, threads, wanted, scale, materials: &materials };
    job.of_scene(&scene).unwrap_or_else(|e| panic!("{e}"))
}

/// Straight down: a tilted quad on the left of a floor, nothing beyond its edge, a light here and there.
fn still_life() -> Value {
    let camera = json!({
        "type": "orthographic", "height": 10, "resolution": [4, 1], "transform": { "from": [20, 0, 30], "at": [20, 0, 0] }
    });
    let tilted = facing(DVec3::new(5.0, 0.0, 4.0), DVec3::new(-0.6, 0.0, 0.8));
    let light = |x: f64, z: f64| json!({ "type": "point", "position": [x, 1.0, z], "intensity": 1 });
    scene_json(
        camera,
        vec![
            quad(&tilted, [37.5, 37.5], diffuse(vec![0.5, 0.25, 0.125])),
            quad(
                &DAffine3::from_translation(DVec3::new(25.0, 0.0, 2.0)),
                [10.0, 20.0],
                json!({ "type": "mirror", "albedo": 0.9 }),
            ),
        ],
        vec![light(15.0, 25.0), light(25.0, 1.0), light(25.0, -1.0), light(60.0, 3.0)],
    )
}

#[test]
fn first_surfaces_are_what_they_are_known_to_be() {
    // Columns 0 and 1 see the slope z = 4 + ¾ (x − 5), up to where it ends at x = 20; 2 the mirror, 3 nothing.
    let aovs = of_scene(&still_life(), &GEOMETRY, 1);
    let close = |name: &str, expected: [f32; 4]| {
        for (got, want) in floats(&aovs, name).iter().zip(expected) {
            assert!(got == &want || (got - want).abs() < 1e-5 * want.abs().max(1.0), "{name}: {got}, not {want}");
        }
    };
    close("albedo.R", [0.5, 0.5, 0.9, 0.0]);
    close("albedo.B", [0.125, 0.125, 0.9, 0.0]);
    close("normal.X", [-0.6, -0.6, 0.0, 0.0]);
    close("normal.Z", [0.8, 0.8, 1.0, 0.0]);
    close("shading_normal.Z", [0.8, 0.8, 1.0, 0.0]);
    close("samples.count", [20.0; 4]);
    let depth = floats(&aovs, "depth.Z");
    // A pixel's mean; the samples are stratified.
    assert!((depth[0] - 26.0).abs() < 0.4, "{depth:?}");
    assert!((depth[2] - 28.0).abs() < 1e-4 && depth[3] == f32::INFINITY, "{depth:?}");
    // From far away the film stands closer than the camera does: depths are the camera's.
    let mut far = still_life();
    far["camera"]["transform"] = json!({ "from": [20, 0, 10_030], "at": [20, 0, 0] });
    let far = of_scene(&far, &[Aov::Depth], 1);
    let far = floats(&far, "depth.Z")[2];
    assert!((far - 10_028.0).abs() < 0.01, "{far}");
    assert_eq!(ids(&aovs, "material.id"), [1, 1, 2, 0]);
    let primitive = ids(&aovs, "primitive.id");
    assert!((1..=2).contains(&primitive[0]) && (3..=4).contains(&primitive[2]) && primitive[3] == 0, "{primitive:?}");
}

#[test]
fn lights_are_seen_where_they_stand() {
    let aovs = of_scene(&still_life(), &[Aov::Lights], 1);
    // The first hangs before the slope; of two in one pixel the nearer shows, below the mirror; the last is out of view.
    let id = ids(&aovs, "lights.id");
    assert_eq!(id.len(), 4);
    assert_eq!((id[0] + id[1], id[2], id[3]), (1, 2, 0), "{id:?}");
    let visible = floats(&aovs, "lights.visible");
    assert_eq!((visible[0] + visible[1], visible[2], visible[3]), (1.0, 0.0, 0.0), "{visible:?}");
}

/// A point lies in one pixel, whichever the picture's filter would give its light to.
#[test]
fn lights_stand_in_the_pixel_that_contains_them() {
    let pixel = |filter: Value, x: f64| {
        let mut json = still_life();
        json["camera"]["filter"] = filter;
        json["camera"]["resolution"] = json!([16, 4]);
        json["camera"]["height"] = json!(10);
        json["lights"] = json!([{ "type": "point", "position": [x, 1.0, 40], "intensity": 1 }]);
        json["camera"]["transform"] = json!({ "from": [20, 0, 50], "at": [20, 0, 0] });
        let aovs = of_scene(&json, &[Aov::Lights], 1);
        assert_eq!(floats(&aovs, "lights.visible").iter().sum::<f32>(), 1.0);
        ids(&aovs, "lights.id").iter().position(|id| *id == 1).expect("the light is in view")
    };
    for filter in [json!({ "type": "box" }), json!({ "type": "gaussian" }), json!({ "type": "box", "radius": 3 })] {
        // Pixels are 2.5 wide and high, and 0 begins at 0: the second row, columns 0, 7 and 15.
        for (x, column) in [(0.1, 0), (2.4, 0), (17.6, 7), (19.9, 7), (37.6, 15), (39.9, 15)] {
            assert_eq!(pixel(filter.clone(), x), 16 + column, "{filter}, x = {x}");
        }
    }
}

/// Windows are looked through for both identifiers.
#[test]
fn primitive_and_material_are_those_of_one_surface() {
    let mut json = still_life();
    let window =
        quad(&DAffine3::from_translation(DVec3::new(20.0, 0.0, 22.0)), [40.0, 20.0], json!({ "type": "null" }));
    let surfaces = json["surfaces"].as_array_mut().expect("surfaces");
    surfaces.insert(0, window);
    // In the last column a ball, behind the window as well.
    surfaces.push(sphere(DVec3::new(35.0, 0.0, 3.0), 2.0, false, diffuse(0.5)));
    let aovs = of_scene(&json, &GEOMETRY, 1);
    assert_eq!(ids(&aovs, "material.id"), [2, 2, 3, 4]);
    let primitive = ids(&aovs, "primitive.id");
    assert!((3..=4).contains(&primitive[0]) && (5..=6).contains(&primitive[2]), "{primitive:?}");
    assert_eq!(primitive[3], 7);
}

/// A box with a lamp, a ball, glass and a point light, out of focus and filtered.
fn room() -> Value {
    room_as_bright_as(1.0)
}

/// The same with all emission multiplied.
fn room_as_bright_as(brightness: f64) -> Value {
    let camera = json!({
        "vfov": 50, "resolution": [13, 9], "aperture": 0.1, "fdist": 2, "filter": { "type": "gaussian" },
        "transform": { "from": [0.2, 0.4, 2.6], "at": [0, 0.1, 0] }
    });
    scene_json(
        camera,
        vec![
            quad(&facing(DVec3::new(0.0, -1.0, 0.0), DVec3::Y), [4.0; 2], diffuse(0.7)),
            quad(&facing(DVec3::new(0.0, 0.0, -1.5), DVec3::Z), [4.0; 2], diffuse(vec![0.7, 0.3, 0.2])),
            quad(&facing(DVec3::new(0.3, 1.0, 0.0), -DVec3::Y), [1.2; 2], shining(4.0 * brightness)),
            quad(&facing(DVec3::new(-0.3, 0.3, -1.4), DVec3::Z), [0.6; 2], shining(2.0 * brightness)),
            sphere(DVec3::new(-0.5, -0.6, 0.2), 0.4, false, json!({ "type": "dielectric", "ior": 1.5 })),
        ],
        vec![json!({ "type": "point", "position": [-0.4, 0.8, 0.5], "intensity": 0.3 * brightness })],
    )
}

fn picture(settings: Settings, samples: u32, threads: usize, pyramid: Option<u32>) -> Rendered {
    let scene = scene(&room());
    let job = RenderJob { settings, samples, crop: Crop::full(scene.camera.resolution()), threads, pyramid };
    render_with(&scene, &job, Extras { variance: true }, &|_| true).unwrap_or_else(|e| panic!("{e}"))
}

fn of_picture(rendered: &Rendered, wanted: &[Aov]) -> Vec<Channel> {
    let crop = Crop { x0: 0, y0: 0, x1: rendered.image.width, y1: rendered.image.height };
    let settings = Settings::default();
    AovJob { settings, samples: 1, crop, threads: 1, wanted, scale: 1.0, materials: &[] }.of_picture(rendered, 6)
}

#[test]
fn parts_sum_to_the_picture() {
    // Five bounces: paths of at most six edges.
    let rendered = picture(settings(Integrator::Bdpt, 5), 16, 1, Some(6));
    let aovs = of_picture(&rendered, &[Aov::Direct, Aov::PerDepth]);
    for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
        let layer = |l: &str| floats(&aovs, &format!("{l}.{name}"));
        let whole: Vec<f32> = rendered.image.rgb.iter().map(|p| p[i]).collect();
        let sums = [
            vec!["emission", "direct", "indirect"],
            (1..=6).map(|n| ["depth1", "depth2", "depth3", "depth4", "depth5", "depth6"][n - 1]).collect(),
        ];
        for layers in sums {
            for (pixel, whole) in whole.iter().enumerate() {
                let sum: f32 = layers.iter().map(|l| layer(l)[pixel]).sum();
                assert!((sum - whole).abs() <= 1e-5 * whole, "{layers:?}, pixel {pixel}: {sum}, not {whole}");
            }
            assert!(layers.iter().all(|l| layer(l).iter().any(|x| *x > 0.0)), "{layers:?}: one is black");
        }
        assert_eq!(layer("direct"), layer("depth2"));
    }
}

#[test]
fn the_variance_is_that_of_independent_renders() {
    let runs = 60;
    for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
        let render = |seed| {
            let settings = Settings { sampler: SamplerKind::Independent, seed, ..settings(integrator, 2) };
            picture(settings, 32, 1, None)
        };
        let all: Vec<Rendered> = (0..runs).map(render).collect();
        let grey = |image: &Image, i: usize| f64::from(image.rgb[i][0]);
        let (mut estimated, mut seen) = (0.0, 0.0);
        for i in 0..all[0].image.rgb.len() {
            let mean = all.iter().map(|r| grey(&r.image, i)).sum::<f64>() / runs as f64;
            let spread = all.iter().map(|r| (grey(&r.image, i) - mean).powi(2)).sum::<f64>() / (runs - 1) as f64;
            let claimed = all.iter().filter_map(|r| r.variance.as_ref()).map(|v| grey(v, i)).sum::<f64>() / runs as f64;
            // Relative to the pixel's brightness, so that no pixel is all that counts.
            estimated += claimed / (mean * mean + 1e-9);
            seen += spread / (mean * mean + 1e-9);
        }
        let ratio = estimated / seen;
        eprintln!("{integrator:?}: variance estimated over seen {ratio:.3}");
        assert!((0.85..1.15).contains(&ratio), "{integrator:?}: {ratio}");
    }
}

/// The variance is as exact as the picture: emission × 2ᵏ multiplies it by 2²ᵏ, bit by bit.
#[test]
fn emission_times_a_power_of_two_multiplies_the_variance_by_its_square() {
    for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
        let variance = |k: i32| {
            let scene = scene(&room_as_bright_as(f64::powi(2.0, k)));
            let crop = Crop::full(scene.camera.resolution());
            let job = RenderJob { settings: settings(integrator, 4), samples: 8, crop, threads: 1, pyramid: None };
            let rendered = render_with(&scene, &job, Extras { variance: true }, &|_| true).unwrap();
            rendered.variance.expect("the variance was asked for").rgb
        };
        let plain = variance(0);
        assert!(plain.iter().flatten().any(|x| *x > 0.0));
        for k in [-40, -3, 1, 40] {
            let expected: Vec<[f32; 3]> = plain.iter().map(|p| p.map(|x| x * f32::exp2(2.0 * k as f32))).collect();
            assert_eq!(variance(k), expected, "{integrator:?}, 2^{k}");
        }
    }
}

#[test]
fn auxiliary_images_are_the_same_for_any_number_of_threads_and_cost_the_picture_nothing() {
    let wanted = [GEOMETRY.as_slice(), &[Aov::Lights]].concat();
    assert_eq!(of_scene(&room(), &wanted, 1), of_scene(&room(), &wanted, 3));
    let settings = settings(Integrator::Bdpt, 4);
    let (one, three) = (picture(settings, 70, 1, Some(6)), picture(settings, 70, 3, Some(6)));
    let wanted = [Aov::Direct, Aov::PerDepth, Aov::Variance];
    assert_eq!(of_picture(&one, &wanted), of_picture(&three, &wanted));
    let plain = common::render_once(&scene(&room()), settings, 70, None).image;
    assert_eq!(one.image, plain);
}

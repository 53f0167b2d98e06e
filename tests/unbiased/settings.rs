//! What may be chosen freely (weights, numbers of paths, roulette, point set, crop, accelerator) leaves the mean alone.

use serde_json::{Value, json};
use twinlight::accel::{AccelOptions, bvh::BvhAccel};
use twinlight::film::Image;
use twinlight::integrator::{Crop, Integrator, Settings, SplatConfidence};
use twinlight::math::DVec3;
use twinlight::render::RenderJob;
use twinlight::sampling::SamplerKind;
use twinlight::scene::desc::Heuristic;

use crate::common::{
    Bounds, Budget, SceneOnDefault, View, assert_same, diffuse, facing, images, quad, render_job, scene, scene_json,
    scene_on, settings, shining, sphere,
};

/// A room with a small lamp, a point light, a glass and a mirror ball: every kind of technique has something to do.
fn room(resolution: [u32; 2]) -> Value {
    let view =
        View { from: DVec3::new(0.1, 0.1, 2.8), at: DVec3::new(0.0, -0.1, 0.0), up: DVec3::Y, vfov: 42.0, resolution };
    let wall = |z: DVec3, albedo: Value| quad(&facing(-z, z), [2.0; 2], diffuse(albedo));
    scene_json(
        view.json(),
        vec![
            wall(DVec3::Y, json!(0.7)),
            wall(-DVec3::Y, json!(0.7)),
            wall(DVec3::X, json!([0.6, 0.1, 0.1])),
            wall(-DVec3::X, json!([0.1, 0.5, 0.1])),
            wall(DVec3::Z, json!(0.7)),
            quad(&facing(DVec3::new(0.0, 0.95, 0.0), -DVec3::Y), [1.2, 0.9], shining(vec![5.0, 4.0, 3.0])),
            sphere(DVec3::new(0.45, -0.6, 0.2), 0.35, false, json!({ "type": "dielectric", "ior": 1.5 })),
            sphere(DVec3::new(-0.4, -0.6, -0.3), 0.35, false, json!({ "type": "mirror", "albedo": 0.8 })),
        ],
        vec![],
    )
}

const BOUNCES: u32 = 3;

/// The bounds of a comparison of two sets of images of the room.
fn bounds() -> Bounds {
    Bounds::new([2, 2], 0.05, 0.015)
}

fn base() -> Settings {
    Settings { roulette: false, ..settings(Integrator::Bdpt, BOUNCES) }
}

fn reference(scene: &SceneOnDefault) -> Vec<Image> {
    images(scene, base(), Budget::new(1 << 13, 641))
}

#[test]
fn weights_and_counts_of_paths_share_one_mean() {
    let scene = scene(&room([2, 2]));
    let reference = reference(&scene);
    let mut cases = Vec::new();
    for heuristic in [Heuristic::Balance, Heuristic::Uniform] {
        cases.push((format!("{heuristic:?}"), Settings { heuristic, ..base() }));
    }
    for (light_paths, connections) in [(0, 0), (1, 0), (4, 0), (4, 2)] {
        let what = format!("{light_paths} light paths, {connections} connections");
        cases.push((what, Settings { light_paths, connections, ..base() }));
    }
    let (heuristic, light_paths, connections) = (Heuristic::Balance, 3, 2);
    cases.push(("balance, 3, 2".into(), Settings { heuristic, light_paths, connections, ..base() }));
    cases.push(("roulette".into(), Settings { roulette: true, ..base() }));
    cases.push(("independent numbers".into(), Settings { sampler: SamplerKind::Independent, ..base() }));
    cases.push(("path".into(), Settings { integrator: Integrator::Path, ..base() }));
    cases.push(("path, roulette".into(), Settings { integrator: Integrator::Path, roulette: true, ..base() }));
    for (n, (what, settings)) in cases.into_iter().enumerate() {
        let samples = if settings.light_paths > 2 { 1 << 10 } else { 1 << 11 };
        let images = images(&scene, settings, Budget::new(samples, 642 + n as u64));
        assert_same(&what, &images, &reference, bounds());
    }
}

/// What `auto` may choose, and what it chooses.
#[test]
fn what_auto_chooses_leaves_the_mean() {
    let scene = scene(&room([2, 2]));
    let reference = reference(&scene);
    let splat_confidence = SplatConfidence::new([0.01, 0.002, 0.6, 0.7, 0.3, 0.95]);
    let all = Settings { splat_confidence, light_one_in: 2, light_paths: 2, roulette: true, ..base() };
    for (n, (what, settings)) in [
        ("light subpaths for one sample in 4", Settings { light_one_in: 4, ..base() }),
        ("splats distrusted", Settings { splat_confidence, ..base() }),
        ("all of them", all),
    ]
    .into_iter()
    .enumerate()
    {
        let images = images(&scene, settings, Budget::new(1 << 11, 671 + n as u64));
        assert_same(what, &images, &reference, bounds());
    }
    // More pixels, for in few there is nothing to learn: and something is learnt.
    let scene = crate::common::scene(&room([16, 16]));
    let auto = Settings { integrator: Integrator::Auto, roulette: true, ..base() };
    let crop = Crop::full([16, 16]);
    let job = RenderJob { settings: auto, samples: 8, crop, threads: 1, pyramid: None };
    let plan = render_job(&scene, &job).plan.expect("a plan");
    assert!(plan.exact.is_none() && plan.thresholds.is_some() && plan.findings.len() == 8, "{plan:?}");
    let images_of_auto = images(&scene, auto, Budget::new(1 << 6, 681));
    assert_same("auto", &images_of_auto, &images(&scene, base(), Budget::new(1 << 7, 682)), bounds());
}

/// Long paths without a limit that matters: roulette alone ends them.
#[test]
fn roulette_leaves_long_paths_their_light() {
    let scene = scene(&crate::gap_box(vec![], true, vec![]));
    for (n, integrator) in [Integrator::Path, Integrator::Light, Integrator::Bdpt].into_iter().enumerate() {
        let samples = if integrator == Integrator::Light { 1 << 14 } else { 1 << 11 };
        let with = images(&scene, settings(integrator, 20), Budget::new(samples, 661 + n as u64));
        let without = Settings { roulette: false, ..settings(integrator, 20) };
        let without = images(&scene, without, Budget::new(samples / 2, 664 + n as u64));
        assert_same(&format!("roulette, {integrator:?}"), &with, &without, Bounds::new([2, 2], 0.05, 0.02));
    }
}

#[test]
fn a_crop_has_the_mean_of_its_part_of_the_full_image() {
    let scene = scene(&room([8, 8]));
    let crop = Crop { x0: 3, y0: 2, x1: 7, y1: 6 };
    for (n, integrator) in [Integrator::Light, Integrator::Bdpt].into_iter().enumerate() {
        let settings = Settings { roulette: false, ..settings(integrator, 3) };
        let part: Vec<Image> = images(&scene, settings, Budget::new(if n == 0 { 1024 } else { 256 }, 671 + n as u64))
            .iter()
            .map(|full| {
                let mut part = Image::new(crop.width(), crop.height());
                for (i, pixel) in part.rgb.iter_mut().enumerate() {
                    *pixel = full.get(crop.x0 + i as u32 % crop.width(), crop.y0 + i as u32 / crop.width());
                }
                part
            })
            .collect();
        let budget = Budget::new(if n == 0 { 4096 } else { 1024 }, 681 + n as u64);
        let cropped: Vec<Image> = (0..u64::from(budget.runs))
            .map(|run| {
                let settings = Settings { seed: budget.seed + run, ..settings };
                render_job(&scene, &RenderJob { settings, samples: budget.samples, crop, threads: 1, pyramid: None })
                    .image
            })
            .collect();
        let bounds = if n == 0 { Bounds::new([2, 2], 0.08, 0.03) } else { Bounds::new([2, 2], 0.05, 0.02) };
        assert_same(&format!("crop, {integrator:?}"), &cropped, &part, bounds);
    }
}

#[test]
fn both_accelerators_show_the_same_scene() {
    let json = room([2, 2]);
    let bvh = scene_on::<BvhAccel>(&json, AccelOptions::default());
    let default = scene(&json);
    let a = images(&bvh, base(), Budget::new(1 << 12, 691));
    let b = images(&default, base(), Budget::new(1 << 12, 692));
    assert_same("BVH against the default accelerator", &a, &b, bounds());
}

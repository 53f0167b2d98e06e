//! One sample again: bit for bit what the render made of it, with every step told; and the gate before the film, which
//! names the sample that anything not finite came from.

mod common;

use std::path::Path;
use std::sync::Arc;

use serde_json::json;
use twinlight::accel::AccelOptions;
use twinlight::accel::bvh::BvhAccel;
use twinlight::bsdf::Bsdf;
use twinlight::import::scene_from_str;
use twinlight::integrator::trace::{Made, Step};
use twinlight::integrator::{Contribution, Crop, Integrator, PixelSample, Recorder, SampleLoop, Settings};
use twinlight::math::{Rgb, Vec3};
use twinlight::render::{RenderJob, Rendered, render};
use twinlight::scene::desc::{Heuristic, Texels, TextureDesc};
use twinlight::scene::{Prepared, Scene, prepare};

use common::{SceneOnDefault, diffuse, everything, facing, quad, scene, settings};

const INTEGRATORS: [Integrator; 3] = [Integrator::Path, Integrator::Light, Integrator::Bdpt];

/// A sample, plainly and with its steps.
fn both(scene: &SceneOnDefault, settings: Settings, sample: PixelSample) -> (Recorder, Recorder<true>) {
    let crop = Crop::full(scene.camera.resolution());
    let (mut plain, mut traced) = (Recorder::new(crop, true), Recorder::traced(crop));
    SampleLoop::new(scene, settings).sample(sample, &mut plain);
    SampleLoop::new(scene, settings).sample(sample, &mut traced);
    (plain, traced)
}

fn bits(c: &Contribution) -> ([u32; 3], u32, [u32; 2]) {
    (c.value.to_array().map(f32::to_bits), c.pixel, [c.technique.s, c.technique.t])
}

/// The paths made that light goes along.
fn made(steps: &[Step]) -> Vec<&Made> {
    let made = steps.iter().filter_map(|step| if let Step::Made(made) = step { Some(made) } else { None });
    made.filter(|m| m.visible > 0.0 && m.values.is_some()).collect()
}

#[test]
fn a_replay_has_the_samples_bits_and_tells_what_made_them() {
    let scene = scene(&everything());
    let [width, height] = scene.camera.resolution();
    let bdpt = settings(Integrator::Bdpt, 6);
    let all = INTEGRATORS.map(|i| settings(i, 6)).into_iter().chain([
        Settings { light_paths: 2, connections: 2, heuristic: Heuristic::Balance, ..bdpt },
        Settings { weighted: false, ..bdpt },
        Settings { max_bounces: 1, ..bdpt },
    ]);
    for settings in all {
        let (mut paths, mut light) = (0, 0.0);
        for index in 0..4 * width * height {
            let pixel = [index % width, index / width % height];
            let (plain, traced) = both(&scene, settings, PixelSample { pixel, index: index / (width * height) });
            assert_eq!(plain.radiance().to_array().map(f32::to_bits), traced.radiance().to_array().map(f32::to_bits));
            let all = |r: &[Contribution]| r.iter().map(bits).collect::<Vec<_>>();
            assert_eq!(all(plain.by_technique()), all(traced.by_technique()));
            assert_eq!(all(plain.splats()), all(traced.splats()));
            assert_eq!(plain.rays, traced.rays);

            // Each contribution is a path that is told, in order, as value × weight × what passes.
            let told = made(traced.steps());
            assert_eq!(told.len(), plain.by_technique().len(), "{settings:?} {pixel:?}: {:?}", traced.steps());
            for (made, got) in told.iter().zip(plain.by_technique()) {
                assert_eq!(made.technique, got.technique);
                let own = pixel[1] * width + pixel[0];
                assert_eq!(made.seen.map_or(own, |([x, y], _)| y * width + x), got.pixel);
                let [unweighted, weighted] = made.values.expect("told with values");
                let off = (weighted * made.visible - got.value).abs().max_element();
                assert!(off <= 1e-6 * got.value.max_element(), "{made:?} {got:?}");
                let weight = made.weight();
                assert!((0.0..1.000_001).contains(&weight) || unweighted.max_element() == 0.0, "{made:?}");
                assert!(settings.weighted || (weight - 1.0).abs() < 1e-6, "{made:?}");
                paths += 1;
                light += f64::from(got.value.max_element());
            }
        }
        assert!(paths > 500 && light > 0.0, "{settings:?}: {paths} paths");
    }
}

/// Throughputs, densities and lengths that a replay tells are those of one walk: each vertex follows from the one before.
#[test]
fn the_steps_of_a_replay_belong_together() {
    let scene = scene(&everything());
    let [width, height] = scene.camera.resolution();
    for integrator in INTEGRATORS {
        let mut edges = 0;
        for index in 0..4 * width * height {
            let pixel = [index % width, index / width % height];
            let sample = PixelSample { pixel, index: index / (width * height) };
            let (_, traced) = both(&scene, settings(integrator, 6), sample);
            let mut last: Option<(Vec3, Rgb, Option<Vec3>)> = None;
            for step in traced.steps() {
                match step {
                    Step::Camera { .. } | Step::Light { .. } => last = None,
                    Step::Scattered { toward, weight, .. } => {
                        let (p, beta, _) = last.expect("a vertex that scatters");
                        last = Some((p, beta * *weight, Some(*toward)));
                    }
                    Step::Survived(q) => last = last.map(|(p, beta, toward)| (p, beta / *q, toward)),
                    Step::Arrived(at) => {
                        if let Some((p, beta, Some(toward))) = last {
                            let edge = at.at.p() - p;
                            assert!((edge.normalize() - toward).length() < 1e-3 || edge.length() < 1e-3);
                            assert!((at.wo + toward).length() < 1e-6);
                            assert!((f64::from(edge.length_squared()) / at.d2 - 1.0).abs() < 1e-4, "{at:?}");
                            assert!((at.beta - beta).abs().max_element() <= 1e-6 * beta.max_element(), "{at:?} {beta}");
                            edges += 1;
                        }
                        last = Some((at.at.p(), at.beta, None));
                    }
                    _ => {}
                }
            }
        }
        assert!(edges > 300, "{integrator:?}: {edges}");
    }
}

/// A room with a texture, a mesh with normals and a plain wall, to be spoilt.
fn room() -> serde_json::Value {
    let mut textured =
        quad(&facing(twinlight::math::DVec3::new(0.0, -1.0, 0.0), twinlight::math::DVec3::Y), [3.0; 2], diffuse(0.7));
    textured["material"]["albedo"] = json!({"type": "checker", "scale": 3.0, "even": 0.5, "odd": 0.8});
    json!({
        "camera": {"transform": {"from": [0, 0, 2.5], "at": [0, -0.2, 0]}, "vfov": 50, "resolution": [16, 12]},
        "surfaces": [
            textured,
            {"type": "triangle", "positions": [[-1, -1, -1], [1, -1, -1], [0, 1, -1]],
             "normals": [[-0.2, 0, 1], [0.2, 0, 1], [0, 0.2, 1]], "material": {"type": "lambertian", "albedo": 0.6}},
            {"type": "quad", "size": 1.0, "transform": [{"rotate": [90, 1, 0, 0]}, {"translate": [0, 1, 0]}],
             "material": {"type": "lambertian", "albedo": 0.3, "emit": 4}},
        ]
    })
}

/// What a scene file cannot hold, put into a scene that is read already.
type Spoil = fn(&mut Prepared);

fn spoilt(name: &str, spoil: Spoil) -> Prepared {
    let mut desc = scene_from_str(&room().to_string(), "room.json", Path::new("")).expect("a valid scene");
    if name == "texture" {
        // One texel of four.
        let texels = Texels {
            file: "spoilt.png".to_owned(),
            width: 2,
            height: 2,
            rgb: Arc::new(vec![[0.5; 3], [f32::NAN; 3], [0.6; 3], [0.7; 3]]),
        };
        let (wrap, filter) = (twinlight::scene::desc::Wrap::Repeat, twinlight::scene::desc::Filter::Nearest);
        desc.textures =
            vec![TextureDesc::Image { texels: Arc::new(texels), scale: 1.0, wrap, filter }; desc.textures.len()];
    }
    let mut prepared = prepare(&desc).expect("preparable");
    spoil(&mut prepared);
    prepared
}

fn rendered(scene: &Scene<BvhAccel>, settings: Settings, threads: usize) -> Rendered {
    let crop = Crop::full(scene.camera.resolution());
    render(scene, &RenderJob { settings, samples: 8, crop, threads, pyramid: None }, &|_| true).expect("renders")
}

#[test]
fn what_is_not_finite_is_named_replayed_and_kept_out_of_the_image() {
    let nothing: Spoil = |_| {};
    fn walls(p: &mut Prepared, spoilt: Rgb) {
        for surface in &mut p.surfaces {
            if let Bsdf::Lambertian { albedo, .. } = &mut surface.bsdf {
                // Neither the lamp nor what textures stand for.
                if albedo.x == 0.6 {
                    *albedo = spoilt;
                }
            }
        }
    }
    let albedo: Spoil = |p| walls(p, Rgb::new(0.5, f32::NAN, 0.5));
    let infinite: Spoil = |p| walls(p, Rgb::splat(f32::INFINITY));
    for (name, spoil) in [("texture", nothing), ("a BSDF's NaN", albedo), ("a BSDF's infinity", infinite)] {
        let scene: Scene<BvhAccel> = Scene::build(spoilt(name, spoil), AccelOptions::default()).expect("buildable");
        for integrator in INTEGRATORS {
            let settings = Settings { seed: 5, ..settings(integrator, 4) };
            let one = rendered(&scene, settings, 1);
            assert!(one.rejected > 0, "{name}, {integrator:?}: nothing is rejected");
            assert!(one.image.rgb.iter().flatten().all(|x| x.is_finite()), "{name}, {integrator:?}");
            assert!(one.image.mean()[0] > 0.0, "{name}, {integrator:?}: a black image");
            // Named alike whatever the threads.
            let two = rendered(&scene, settings, 2);
            assert_eq!((one.rejected, &one.rejected_first), (two.rejected, &two.rejected_first));
            assert!(!one.rejected_first.is_empty());
            for r in &one.rejected_first {
                let mut recorder = Recorder::traced(Crop::full(scene.camera.resolution()));
                let sample = PixelSample { pixel: r.pixel, index: r.sample };
                SampleLoop::new(&scene, settings).sample(sample, &mut recorder);
                assert!(recorder.rejected().1.contains(r), "{name}, {integrator:?}: {r:?} is not found again");
                let of_it = recorder.steps().iter().any(|step| {
                    matches!(step, Step::Made(m) if m.technique == r.technique
                        && m.values.is_some_and(|[_, weighted]| !(weighted * m.visible).is_finite()))
                });
                assert!(of_it, "{name}, {integrator:?}: the replay does not tell of {r:?}");
            }
        }
    }
}

/// Corners and normals that are no numbers: no panic, nothing not finite in the image, the rest of the room as it was.
#[test]
fn a_spoilt_mesh_does_no_harm() {
    let corner: Spoil = |p| p.geometry.positions[5].x = f32::NAN;
    let far: Spoil = |p| p.geometry.positions[5].x = f32::INFINITY;
    let normal: Spoil = |p| p.geometry.normals.iter_mut().for_each(|n| n.y = f32::NAN);
    for (name, spoil) in [("corner", corner), ("infinite corner", far), ("normal", normal)] {
        for integrator in INTEGRATORS {
            let bvh: Scene<BvhAccel> = Scene::build(spoilt(name, spoil), AccelOptions::default()).expect("buildable");
            let crop = Crop::full(bvh.camera.resolution());
            let job = RenderJob { settings: settings(integrator, 4), samples: 8, crop, threads: 1, pyramid: None };
            let default: SceneOnDefault =
                Scene::build(spoilt(name, spoil), AccelOptions::default()).expect("buildable");
            for image in
                [render(&bvh, &job, &|_| true), render(&default, &job, &|_| true)].map(|r| r.expect("renders").image)
            {
                assert!(image.rgb.iter().flatten().all(|x| x.is_finite()), "{name}, {integrator:?}");
                assert!(image.mean()[0] > 0.01, "{name}, {integrator:?}: the room is dark");
            }
        }
    }
}

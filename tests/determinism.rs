//! The image is a function of the scene, the settings and the seed, to the last bit: not of threads, not of what is
//! built beside the scene.

mod common;

use serde_json::json;
use twinlight::accel::AccelOptions;
use twinlight::integrator::{Crop, Integrator, Settings};
use twinlight::math::Vec3;
use twinlight::render::RenderJob;
use twinlight::scene::Scene;

use common::{DefaultAccel, everything, render_job, render_once, scene, scene_on, settings};

const INTEGRATORS: [Integrator; 4] = [Integrator::Path, Integrator::Light, Integrator::Bdpt, Integrator::Auto];

#[test]
fn any_number_of_threads_makes_the_same_image() {
    let mut blurred = everything();
    blurred["camera"]["aperture"] = json!(0.1);
    blurred["camera"]["fdist"] = json!(2.5);
    blurred["camera"]["filter"] = json!({ "type": "gaussian" });
    let scenes = [everything(), blurred].map(|json| scene(&json));
    for (scene, integrator) in scenes.iter().flat_map(|scene| INTEGRATORS.map(|i| (scene, i))) {
        // More samples than one task takes, so that a pixel's sum has parts.
        let job = |threads| RenderJob {
            settings: settings(integrator, 8),
            samples: 70,
            crop: Crop::full(scene.camera.resolution()),
            threads,
            pyramid: None,
        };
        let one = render_job(scene, &job(1));
        assert!(one.image.mean().iter().all(|m| *m > 0.0), "{integrator:?}: a black image proves nothing");
        for threads in [2, 5] {
            let many = render_job(scene, &job(threads));
            assert_eq!(one.image, many.image, "{integrator:?}: {threads} threads");
            assert_eq!(one.rays, many.rays, "{integrator:?}: {threads} threads");
        }
    }
}

#[test]
fn the_same_seed_repeats_and_another_does_not() {
    let scene = scene(&everything());
    for integrator in INTEGRATORS {
        let image = |seed| render_once(&scene, Settings { seed, ..settings(integrator, 6) }, 4, None).image;
        let first = image(7);
        assert_eq!(first, image(7), "{integrator:?}");
        for seed in [8, 7 + (1 << 32), 0] {
            let other = image(seed);
            let equal = first.rgb.iter().zip(&other.rgb).filter(|(a, b)| a == b && **a != [0.0; 3]).count();
            // Where all light is direct and constant, pixels may agree; an image may not.
            assert!(equal < first.rgb.len() / 20, "{integrator:?}: seed {seed} repeats {equal} pixels of seed 7");
        }
    }
}

#[test]
fn the_delta_points_own_index_changes_nothing() {
    let json = everything();
    let without: Scene<DefaultAccel> = scene_on(&json, AccelOptions { delta_points: false, ..AccelOptions::default() });
    let with: Scene<DefaultAccel> = scene_on(&json, AccelOptions { delta_points: true, ..AccelOptions::default() });
    // The index is there: a ray aimed at a light finds it in the one scene and not in the other.
    use twinlight::accel::Accel;
    use twinlight::math::Ray;
    let target = with.geometry.delta_points[0].position;
    let from = target + Vec3::new(0.1, -0.3, 0.2);
    assert!(with.accel.intersect_delta(&Ray::new(from, target - from)).is_some());
    assert!(without.accel.intersect_delta(&Ray::new(from, target - from)).is_none());
    for integrator in INTEGRATORS {
        let image = |scene| render_once(scene, settings(integrator, 6), 16, None);
        let (a, b) = (image(&without), image(&with));
        assert_eq!(a.image, b.image, "{integrator:?}");
        assert_eq!(a.rays, b.rays, "{integrator:?}");
    }
}

/// One technique rendered alone is that technique's part of a render of all, but for the order of f32 sums: nothing but the
/// recording depends on which are asked for.
#[test]
fn a_technique_alone_is_its_part_of_all() {
    let scene = scene(&everything());
    for weighted in [true, false] {
        let all = Settings { weighted, ..settings(Integrator::Bdpt, 4) };
        let parts = render_once(&scene, all, 4, Some(5)).techniques;
        assert!(parts.len() >= 15, "only {} techniques contribute", parts.len());
        for (&technique, part) in &parts {
            let alone = render_once(&scene, Settings { only: Some(technique), ..all }, 4, None).image;
            // A pixel's own contributions are summed in f32 within a sample before they are rounded to quanta.
            for (a, b) in alone.rgb.iter().flatten().zip(part.rgb.iter().flatten()) {
                assert!(
                    (a - b).abs() <= 2e-6 * b.abs(),
                    "{technique:?}, weighted: {weighted}: {a} alone, {b} among all"
                );
            }
        }
    }
}

/// What `auto` does to a sample depends on no other: a crop has the full image's bits, and few samples are the first of many.
#[test]
fn a_crop_has_the_bits_of_the_full_image() {
    let scene = scene(&everything());
    let crop = Crop { x0: 3, y0: 2, x1: 9, y1: 8 };
    for integrator in INTEGRATORS {
        for samples in [1, 2, 3, 4, 5, 11] {
            let job = |crop, threads| RenderJob {
                settings: Settings { roulette: true, ..settings(integrator, 8) },
                samples,
                crop,
                threads,
                pyramid: None,
            };
            let full = render_job(&scene, &job(Crop::full(scene.camera.resolution()), 1)).image;
            let part = render_job(&scene, &job(crop, 3)).image;
            for (i, pixel) in part.rgb.iter().enumerate() {
                let (x, y) = (crop.x0 + i as u32 % crop.width(), crop.y0 + i as u32 / crop.width());
                assert_eq!(*pixel, full.get(x, y), "{integrator:?}, {samples} samples, pixel {x},{y}");
            }
        }
    }
}

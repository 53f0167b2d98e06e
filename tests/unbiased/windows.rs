//! Index-matched windows block connections and change no radiance: with one in the way, what one technique made, the
//! others must make.

use serde_json::{Value, json};
use twinlight::film::Image;
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;

use crate::common::{Bounds, Budget, assert_same, facing, images, images_by_edges, quad, scene, settings, sphere};
use crate::gap_box;

fn window() -> Value {
    json!({ "type": "null" })
}

/// Where a window may stand in the box, and what it is to keep apart.
fn windows() -> [(&'static str, Vec<Value>); 4] {
    let before_light = quad(&facing(DVec3::new(0.0, 0.97, 0.0), DVec3::Y), [2.4; 2], window());
    // As small as the view allows: it must not come between surfaces and lights.
    let before_camera = quad(&facing(DVec3::new(0.05, 0.1, 0.74), DVec3::Z), [0.022; 2], window());
    let middle = quad(&facing(DVec3::new(0.0, 0.3, 0.0), DVec3::new(0.1, 1.0, 0.2)), [4.0; 2], window());
    [
        ("before the light", vec![before_light.clone()]),
        ("before the camera", vec![before_camera.clone()]),
        ("in the middle", vec![middle.clone()]),
        ("everywhere", vec![before_light, before_camera, middle]),
    ]
}

fn is_black(images: &[Image]) -> bool {
    images.iter().all(|image| image.rgb.iter().all(|p| *p == [0.0; 3]))
}

/// Under an area light s = 0 needs no connection: nothing is ever lost, wherever the windows stand.
#[test]
fn windows_change_nothing_under_an_area_light() {
    let plain = scene(&gap_box(vec![], true, vec![]));
    let limited = |integrator| Settings { roulette: false, ..settings(integrator, 3) };
    let reference = images(&plain, limited(Integrator::Path), Budget::new(1 << 14, 621));
    for (n, (place, surfaces)) in windows().into_iter().enumerate() {
        let with = scene(&gap_box(surfaces, true, vec![]));
        for integrator in [Integrator::Path, Integrator::Bdpt] {
            let images = images(&with, limited(integrator), Budget::new(1 << 13, 622 + n as u64));
            let what = format!("windows {place}, {integrator:?}");
            assert_same(&what, &images, &reference, Bounds::new([2, 2], 0.04, 0.015));
        }
    }
}

/// Under a delta light every path needs a connection across an edge without a window. By the number of edges (the
/// first leaves the light, the last reaches the camera), these survive:
///
/// | windows           | path (s = 1)  | light (t = 1) | bdpt                               |
/// |-------------------|---------------|---------------|------------------------------------|
/// | around the light  | none          | all           | all: s ≥ 2                         |
/// | before the camera | all           | none          | all: t ≥ 2                         |
/// | both              | none          | none          | from 3 edges on: s ≥ 2 and t ≥ 2   |
#[test]
fn windows_under_a_point_light_leave_what_can_still_be_connected() {
    // Behind the camera, so that no surface is seen through the light's window.
    let position = DVec3::new(0.2, 0.5, 0.95);
    let light = json!({ "type": "point", "position": [position.x, position.y, position.z], "intensity": 1.0 });
    let around_light = sphere(position, 0.1, false, window());
    let [_, (_, before_camera), ..] = windows();
    let edges = 4;
    let plain = scene(&gap_box(vec![], false, vec![light.clone()]));
    let reference = images_by_edges(&plain, settings(Integrator::Path, 3), Budget::new(1 << 14, 631), edges);
    let both = [vec![around_light.clone()], before_camera.clone()].concat();
    let cases = [
        ("around the light", vec![around_light], [false, true, true]),
        ("before the camera", before_camera, [true, false, true]),
        ("around the light and before the camera", both, [false, false, true]),
    ];
    for (n, (place, surfaces, survives)) in cases.into_iter().enumerate() {
        let with = scene(&gap_box(surfaces, false, vec![light.clone()]));
        let integrators = [Integrator::Path, Integrator::Light, Integrator::Bdpt];
        for (integrator, survives) in integrators.into_iter().zip(survives) {
            let settings = Settings { roulette: false, ..settings(integrator, 3) };
            let samples = if integrator == Integrator::Light { 1 << 15 } else { 1 << 13 };
            let found = images_by_edges(&with, settings, Budget::new(samples, 632 + n as u64), edges);
            assert!(is_black(&found[0]), "a delta light is not seen directly");
            for k in 1..edges as usize {
                let what = format!("windows {place}, {integrator:?}, {} edges", k + 1);
                if !survives || n == 2 && k == 1 {
                    assert!(is_black(&found[k]), "{what}: no technique can make these paths, and yet there is light");
                    continue;
                }
                let bound = [0.01, 0.015, 0.04, 0.08][k];
                assert_same(&what, &found[k], &reference[k], Bounds::new([2, 2], 4.0 * bound, bound));
            }
        }
    }
}

//! Light tracing onto the film: a uniform wall is uniform up to the image's last row, column and corner pixel.

use serde_json::json;
use twinlight::film::Image;
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::{DAffine3, DVec3};

use crate::common::{
    Bounds, Budget, View, assert_closed, diffuse, expect_colored, images, quad, scene, scene_json, settings, shining,
    shining_diffuse, sphere, technique,
};

/// Wide and of unequal sides, and turned, so that rows and columns cannot be taken for each other.
fn view() -> View {
    View {
        from: DVec3::new(0.05, -0.1, 1.0),
        at: DVec3::new(0.0, 0.05, 0.0),
        up: DVec3::new(0.2, 1.0, 0.0),
        vfov: 85.0,
        resolution: [6, 4],
    }
}

/// Demands the radiance in every pixel, its mean to `mean`, and the same of the pixels along the image's edge and in its
/// corners, where a splat that is cast to the wrong pixel goes missing or counts twice.
pub fn is_uniform(what: &str, images: &[Image], radiance: f64, mean: f64) {
    let (w, h) = (images[0].width, images[0].height);
    let tiles = (w * h) as usize;
    let bounds = Bounds::new([w, h], 0.03, mean);
    assert_closed(what, images, &expect_colored(&vec![radiance; tiles], [1.0; 3]), bounds);
    let edge = |x: u32, y: u32| x == 0 || y == 0 || x == w - 1 || y == h - 1;
    let corner = |x: u32, y: u32| (x == 0 || x == w - 1) && (y == 0 || y == h - 1);
    let pooled = |keep: &dyn Fn(u32, u32) -> bool| -> Vec<Image> {
        let pixels: Vec<_> = (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).filter(|&(x, y)| keep(x, y)).collect();
        let mean = |image: &Image| {
            let sum: f64 = pixels.iter().map(|&(x, y)| f64::from(image.get(x, y)[0])).sum();
            (sum / pixels.len() as f64) as f32
        };
        images.iter().map(|image| Image { width: 1, height: 1, rgb: vec![[mean(image); 3]] }).collect()
    };
    for (name, images, bound) in [("edge", pooled(&edge), 0.005), ("corners", pooled(&corner), 0.01)] {
        assert_closed(&format!("{what}, {name}"), &images, &[radiance; 3], Bounds::of_mean(bound));
    }
}

#[test]
fn a_shining_wall_by_light_tracing() {
    let view = view();
    // Something to connect to, behind the camera, so that light subpaths are worth their while.
    let surfaces = vec![
        quad(&DAffine3::IDENTITY, [4.2, 3.2], shining(1.5)),
        quad(&DAffine3::from_translation(DVec3::new(0.0, 0.0, 2.0)), [0.1; 2], diffuse(0.5)),
    ];
    let scene = scene(&scene_json(view.json(), surfaces, vec![]));
    for (n, (name, settings)) in
        [("light", settings(Integrator::Light, 0)), ("(1,1)", technique(1, 1))].into_iter().enumerate()
    {
        let images = images(&scene, settings, Budget::new(4096, 500 + n as u64));
        is_uniform(&format!("shining wall, {name}"), &images, 1.5, 0.002);
    }
}

#[test]
fn a_wall_lit_from_the_middle_of_a_sphere_by_light_tracing() {
    // From the centre of a sphere with a point light beside the camera's back: every point of the wall is alike.
    let view = View { from: DVec3::ZERO, at: DVec3::new(0.3, 0.1, -1.0), ..view() };
    let walls = sphere(DVec3::ZERO, 1.0, true, diffuse(0.5));
    let light = json!({ "type": "point", "position": [0, 0, 0], "intensity": std::f64::consts::PI });
    let lit = scene(&scene_json(view.json(), vec![walls], vec![light]));
    let images_lit = images(&lit, technique(2, 1), Budget::new(8192, 510));
    is_uniform("lit sphere, (2,1)", &images_lit, 0.5, 0.002);

    let walls = sphere(DVec3::ZERO, 1.0, true, shining_diffuse(1.0, 0.5));
    let furnace = scene(&scene_json(view.json(), vec![walls], vec![]));
    let settings = Settings { roulette: false, ..settings(Integrator::Light, 3) };
    let images = images(&furnace, settings, Budget::new(4096, 520));
    is_uniform("furnace, light, three bounces", &images, 1.0 + 0.5 + 0.25 + 0.125, 0.004);
}

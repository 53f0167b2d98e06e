//! Cameras and pixel filters against closed forms: a wall that is uniform to the image's edge, the blur of a lens, what
//! parallel rays see, and what a filter makes of an edge.

use std::f64::consts::PI;

use serde_json::{Value, json};
use twinlight::film::Image;
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::{DAffine3, DVec3};

use super::uniform_wall::is_uniform;
use crate::common::{
    Bounds, Budget, View, assert_closed, diffuse, expect_colored, facing, images, matrix, quad, render_once, scene,
    scene_json, settings, shining, technique,
};

/// A camera with more keys, or others in their place.
fn with(camera: &Value, keys: &Value) -> Value {
    let mut camera = camera.clone();
    if let (Some(camera), Some(keys)) = (camera.as_object_mut(), keys.as_object()) {
        if keys.contains_key("type") {
            camera.remove("vfov");
        }
        camera.extend(keys.clone());
    }
    camera
}

fn lens(aperture: f64, fdist: f64) -> Value {
    json!({ "aperture": aperture, "fdist": fdist })
}

fn parallel(height: f64) -> Value {
    json!({ "type": "orthographic", "height": height })
}

fn filter(kind: &str, radius: f64) -> Value {
    json!({ "filter": { "type": kind, "radius": radius } })
}

/// Something to connect to, behind the camera, so that light subpaths are worth their while.
fn behind() -> Value {
    quad(&DAffine3::from_translation(DVec3::new(0.0, 0.0, 5.0)), [0.1; 2], diffuse(0.5))
}

/// A shining wall, wider than the film with its filters, through one camera: uniform by splats and exact by camera rays.
fn sees_a_uniform_wall(what: &str, projection: Value, filter: Value, seed: u64) {
    let view = View {
        from: DVec3::new(0.05, -0.1, 1.0),
        at: DVec3::new(0.0, 0.05, 0.0),
        up: DVec3::new(0.2, 1.0, 0.0),
        vfov: 85.0,
        resolution: [3, 2],
    };
    let wall = quad(&DAffine3::IDENTITY, [5.4, 4.6], shining(1.5));
    let camera = with(&with(&view.json(), &projection), &filter);
    let scene = scene(&scene_json(camera, vec![wall, behind()], vec![]));
    let images = images(&scene, technique(1, 1), Budget::new(1 << 14, seed));
    is_uniform(what, &images, 1.5, 0.004);
    // Camera rays all count fully, whatever they are drawn from: not even noise.
    let exact = render_once(&scene, settings(Integrator::Path, 0), 64, None).image;
    assert!(exact.rgb.iter().flatten().all(|x| *x == 1.5), "{what}: {exact:?}");
}

#[test]
fn a_lens_with_a_gaussian_filter_sees_a_uniform_wall() {
    sees_a_uniform_wall("thin lens, Gaussian", lens(0.3, 0.7), filter("gaussian", 0.6), 530);
}

#[test]
fn parallel_rays_with_a_tent_filter_see_a_uniform_wall() {
    sees_a_uniform_wall("orthographic, tent", parallel(1.9), filter("tent", 0.6), 531);
}

#[test]
fn a_pinhole_with_a_wide_box_filter_sees_a_uniform_wall() {
    sees_a_uniform_wall("pinhole, wide box", json!({}), filter("box", 0.6), 532);
}

/// The mean, and the second moment about the centre over the mean, of square images of this side.
fn moments(images: &[Image], side: f64) -> Vec<Image> {
    let one = |image: &Image| {
        let n = f64::from(image.width);
        let (mut sum, mut second) = (0.0, 0.0);
        for y in 0..image.height {
            for x in 0..image.width {
                let at = |i: u32| ((f64::from(i) + 0.5) / n - 0.5) * side;
                let value = f64::from(image.get(x, y)[0]);
                sum += value;
                second += value * (at(x).powi(2) + at(y).powi(2));
            }
        }
        Image { width: 1, height: 1, rgb: vec![[(sum / (n * n)) as f32, (second / sum) as f32, 1.0]] }
    };
    images.iter().map(one).collect()
}

/// A small shining disk on the axis at distance z is imaged onto the plane in focus, at distance f, by each point of
/// the lens as a disk scaled by f/z, shifted by (1 − f/z) times that point: as a whole, the disk's image convolved with
/// the circle of confusion, of radius a|1 − f/z|. Energy L·A·(f/z)², second moment (c² + (ρf/z)²)/2; pixels add side²/6.
#[test]
fn a_disk_out_of_focus_has_its_circle_of_confusion() {
    let (aperture, radius, radiance) = (0.25, 0.1, 3.0);
    for (n, (f, z)) in [(1.0_f64, 2.0_f64), (2.0, 1.2), (1.5, 1.5)].into_iter().enumerate() {
        let confusion = aperture * (1.0 - f / z).abs();
        let image = radius * f / z;
        // The film holds the whole of it.
        let side = 2.2 * (confusion + image);
        let pixels = 32;
        let camera = json!({
            "vfov": 2.0 * (0.5 * side / f).atan().to_degrees(), "resolution": [pixels, pixels], "aperture": aperture,
            "fdist": f, "transform": { "from": [0, 0, z], "at": [0, 0, 0], "up": [0.3, 1, 0] }
        });
        let disk = json!({ "type": "disk", "radius": radius, "material": shining(radiance) });
        let scene = scene(&scene_json(camera, vec![disk, behind()], vec![]));
        let mean = radiance * PI * image * image / (side * side);
        let second = (confusion * confusion + image * image) / 2.0 + (side / f64::from(pixels)).powi(2) / 6.0;
        for (m, integrator) in [Integrator::Path, Integrator::Light, Integrator::Bdpt].into_iter().enumerate() {
            let images = images(&scene, settings(integrator, 0), Budget::new(32, 540 + 10 * n as u64 + m as u64));
            let what = format!("disk at {z}, focus at {f}, {integrator:?}");
            // Pixels add exactly that to a smooth image's moment; to a sharp disk's, nearly.
            let bounds = Bounds { rounding: 5e-4, ..Bounds::of_mean(0.015) };
            assert_closed(&what, &moments(&images, side), &[mean, second, 1.0], bounds);
        }
    }
}

#[test]
fn in_focus_or_at_aperture_zero_the_lens_is_a_pinhole() {
    // A plane in focus is seen by every point of the lens as by its centre: left of the middle 1, right of it 3.
    let half = |x: f64, l: f64| quad(&DAffine3::from_translation(DVec3::new(x, 0.0, 0.0)), [4.0, 8.0], shining(l));
    let camera = json!({
        "vfov": 60, "resolution": [6, 2], "transform": { "from": [0.2, 0, 1.3], "at": [0.2, 0, 0], "up": [0, 1, 0] }
    });
    let film = 2.0 * 3.0 * 1.3 * (30.0_f64).to_radians().tan();
    let split = (0.5 - 0.2 / film) * 6.0; // The place of x = 0 on the film, in pixels.
    let row: Vec<f64> = (0..6).map(|i| 3.0 - 2.0 * (split - f64::from(i)).clamp(0.0, 1.0)).collect();
    let surfaces = vec![half(-2.0, 1.0), half(2.0, 3.0), behind()];
    let scene = |keys: &Value| scene(&scene_json(with(&camera, keys), surfaces.clone(), vec![]));
    let sharp = scene(&lens(0.4, 1.3));
    let images = images(&sharp, settings(Integrator::Path, 0), Budget::new(256, 571));
    let expected = expect_colored(&[row.clone(), row].concat(), [1.0; 3]);
    assert_closed("plane in focus", &images, &expected, Bounds::new([6, 2], 0.01, 0.005));

    let path = Settings { seed: 3, ..settings(Integrator::Path, 0) };
    let pinhole = render_once(&scene(&json!({})), path, 64, None).image;
    let narrow = render_once(&scene(&lens(1e-7, 0.4)), path, 64, None).image;
    let wide = render_once(&scene(&lens(0.2, 0.4)), path, 64, None).image;
    let off = |a: &Image| {
        let pairs = a.rgb.iter().flatten().zip(pinhole.rgb.iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    // One sample of a pixel may fall to the other side of the edge.
    assert!(off(&narrow) <= 2.0 / 64.0, "{}", off(&narrow));
    assert!(off(&wide) > 0.1, "a plane out of focus must blur: {}", off(&wide));
}

/// Straight down onto a plane under a point light at height h: L = ρ I h / (π (h² + x² + y²)^{3/2}), the same however
/// far away the camera is.
#[test]
fn parallel_rays_see_a_cosine_lit_plane() {
    let (rho, intensity, h, side, n) = (0.6, 2.0, 0.7, 1.8, 4);
    let radiance = |x: f64, y: f64| rho * intensity * h / (PI * (h * h + x * x + y * y).powf(1.5));
    let plane = quad(&DAffine3::IDENTITY, [3.2; 2], diffuse(rho));
    let light = json!({ "type": "point", "position": [0.2, -0.1, h], "intensity": intensity });
    for (m, (distance, kind, radius)) in [(2.0, "box", 0.5), (3e5, "tent", 1.0)].into_iter().enumerate() {
        let keys = json!({
            "type": "orthographic", "height": side, "resolution": [n, n],
            "transform": { "from": [0, 0, distance], "at": [0, 0, 0], "up": [0, 1, 0] }
        });
        let camera = with(&keys, &filter(kind, radius));
        let scene = scene(&scene_json(camera, vec![plane.clone()], vec![light.clone()]));
        let pixel = side / f64::from(n);
        let mut expected = Vec::new();
        for row in 0..n {
            for column in 0..n {
                // The midpoint rule over the filter.
                let (k, mut sum, mut weights) = (80, 0.0, 0.0);
                for i in 0..k * k {
                    let at = |i: i32| ((f64::from(i) + 0.5) / f64::from(k) * 2.0 - 1.0) * radius;
                    let (dx, dy) = (at(i % k), at(i / k));
                    let weight = |d: f64| if kind == "tent" { radius - d.abs() } else { 1.0 };
                    let x = (f64::from(column) + 0.5 + dx) * pixel - 0.5 * side;
                    let y = 0.5 * side - (f64::from(row) + 0.5 + dy) * pixel;
                    sum += weight(dx) * weight(dy) * radiance(x - 0.2, y + 0.1);
                    weights += weight(dx) * weight(dy);
                }
                expected.push(sum / weights);
            }
        }
        let expected = expect_colored(&expected, [1.0; 3]);
        let cases = [
            ("(1,2)", technique(1, 2), 64),
            ("(2,1)", technique(2, 1), 1 << 12),
            ("bdpt", settings(Integrator::Bdpt, 1), 1 << 9),
        ];
        for (i, (name, settings, samples)) in cases.into_iter().enumerate() {
            let images = images(&scene, settings, Budget::new(samples, 580 + 4 * m as u64 + i as u64));
            let bounds = Bounds { rounding: 1e-4, ..Bounds::new([4, 4], 0.04, 0.01) };
            assert_closed(&format!("cosine-lit plane from {distance}, {name}"), &images, &expected, bounds);
        }
    }
}

/// The share of a filter that lies below x: ∫ from −∞.
fn share(kind: &str, radius: f64, x: f64) -> f64 {
    let x = (x / radius).clamp(-1.0, 1.0);
    match kind {
        "box" => 0.5 * (1.0 + x),
        "tent" => 0.5 + x - 0.5 * x * x.abs(),
        // A normal distribution of standard deviation 1/3, cut off at 1.
        _ => {
            let mass = |to: f64| {
                let step = (to + 1.0) / 4000.0;
                (0..4000).map(|i| (-4.5 * (-1.0 + (f64::from(i) + 0.5) * step).powi(2)).exp()).sum::<f64>() * step
            };
            mass(x) / mass(1.0)
        }
    }
}

/// The image of a straight edge is the filter's integral, by camera rays and by splats alike.
#[test]
fn an_edge_is_the_filters_integral() {
    let (w, edge) = (6, 2.8);
    // Pixels of unit size: the film's column x is the world's x.
    let camera = json!({
        "type": "orthographic", "height": 1, "resolution": [w, 1],
        "transform": { "from": [3, 0, 1], "at": [3, 0, 0], "up": [0, 1, 0] }
    });
    for (n, (kind, radius)) in [("box", 0.5), ("box", 1.3), ("tent", 1.0), ("gaussian", 1.5)].into_iter().enumerate() {
        let lit = |low: f64, high: f64, l: f64| {
            let frame = facing(DVec3::new(0.5 * (low + high), 0.0, 0.0), DVec3::Z);
            json!({
                "type": "quad", "size": [1, 1], "material": shining(l),
                "transform": [{ "scale": [high - low, 2.0 * radius + 0.02, 1.0] }, matrix(&DAffine3::from_translation(frame.translation))]
            })
        };
        let surfaces = vec![lit(-radius, edge, 2.0), lit(edge, 6.0 + radius, 1.0), behind()];
        let scene = scene(&scene_json(with(&camera, &filter(kind, radius)), surfaces, vec![]));
        let expected: Vec<f64> = (0..w).map(|i| 1.0 + share(kind, radius, edge - f64::from(i) - 0.5)).collect();
        let expected = expect_colored(&expected, [1.0; 3]);
        for (m, (name, settings, samples)) in
            [("path", settings(Integrator::Path, 0), 1 << 10), ("(1,1)", technique(1, 1), 1 << 13)]
                .into_iter()
                .enumerate()
        {
            let images = images(&scene, settings, Budget::new(samples, 590 + 2 * n as u64 + m as u64));
            assert_closed(
                &format!("edge, {kind} {radius}, {name}"),
                &images,
                &expected,
                Bounds::new([6, 1], 0.03, 0.01),
            );
        }
    }
}

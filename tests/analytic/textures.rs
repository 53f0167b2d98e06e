//! Textures where the radiance is known: a textured integrating sphere, blends, cut-out sheets, bent normals.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use serde_json::{Value, json};
use twinlight::bsdf::Bsdf;
use twinlight::film::Image;
use twinlight::geometry::SurfacePoint;
use twinlight::integrator::Integrator;
use twinlight::math::{DAffine3, DVec3, Frame};
use twinlight::output::{Metadata, write_image};
use twinlight::sampling::Coins;

use crate::common::{
    Bounds, Budget, Random, View, assert_closed, diffuse, expect_colored, facing, images, matrix, point, quad, scene,
    scene_json, settings, sphere,
};

const INTEGRATORS: [Integrator; 3] = [Integrator::Path, Integrator::Light, Integrator::Bdpt];

/// From beside the centre of the unit sphere.
fn inside() -> View {
    let (from, at) = (DVec3::new(0.3, 0.2, -0.4), DVec3::new(-0.5, 0.1, 0.6));
    View { from, at, up: DVec3::Y, vfov: 100.0, resolution: [2, 2] }
}

/// An EXR of these texels, as a scene names it.
fn file(name: &str, width: u32, rgb: Vec<[f32; 3]>) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("textures");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    let image = Image { width, height: rgb.len() as u32 / width, rgb };
    write_image(&path, &image, &Metadata::default(), 0.0).unwrap();
    path.to_str().unwrap().to_owned()
}

fn samples(integrator: Integrator) -> u32 {
    match integrator {
        Integrator::Path => 1 << 12,
        Integrator::Light => 1 << 14,
        Integrator::Bdpt | Integrator::Auto => 1 << 10,
    }
}

/// Between any two points of a sphere the form factor is the same, 1/A: each is lit by the mean radiance G over the
/// sphere, L(x) = E(x) + ρ(x) G, and so G = Ē/(1 − ρ̄), whatever the patterns of E and ρ.
#[test]
fn the_textured_integrating_sphere() {
    // Four columns of a quarter turn each by two rows: eighths of the area.
    let texels: Vec<[f32; 3]> = (0..8).map(|i| [0.25 * i as f32, if i < 4 { 1.0 } else { 0.0 }, 0.5]).collect();
    let emit =
        json!({ "type": "image", "filename": file("eighths.exr", 4, texels.clone()), "filter": "nearest", "scale": 2 });
    let (even, odd) = ([0.6, 0.3, 0.5], [0.2, 0.5, 0.5]);
    let albedo = json!({ "type": "checker", "scale": 1, "even": even, "odd": odd });
    let view = inside();
    let walls = sphere(DVec3::ZERO, 1.0, true, json!({ "type": "lambertian", "albedo": albedo, "emit": emit }));
    let scene = scene(&scene_json(view.json(), vec![walls], vec![]));
    let emitted = |p: DVec3, c: usize| {
        let column = (p.y.atan2(p.x) / TAU).rem_euclid(1.0) * 4.0;
        let row = usize::from(p.z < 0.0);
        2.0 * f64::from(texels[row * 4 + column as usize][c])
    };
    let reflected = |p: DVec3, c: usize| if p.x * p.y * p.z < 0.0 { odd[c] } else { even[c] };
    let by_channel = [0, 1, 2].map(|c| {
        let mean = texels.iter().map(|t| 2.0 * f64::from(t[c])).sum::<f64>() / 8.0;
        let g = mean / (1.0 - 0.5 * (even[c] + odd[c]));
        view.tile_means([2, 2], 256, |d| {
            let b = view.from.dot(d);
            let p = view.from + d * (-b + (b * b - view.from.length_squared() + 1.0).sqrt());
            emitted(p, c) + reflected(p, c) * g
        })
    });
    let expected: Vec<f64> = (0..4).flat_map(|tile| [0, 1, 2].map(|c| by_channel[c][tile])).collect();
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        let fewer = if integrator == Integrator::Light { 1 } else { 2 };
        let budget = Budget::new(samples(integrator) / fewer, 400 + n as u64);
        let images = images(&scene, settings(integrator, 64), budget);
        // The midpoint rule misses the pattern's edges by about a 256th of a pixel's width.
        let bounds = Bounds { rounding: 1e-3, ..Bounds::new([2, 2], 0.02, 0.01) };
        assert_closed(&format!("textured integrating sphere, {integrator:?}"), &images, &expected, bounds);
    }
}

/// With a point light at the centre, L = ρ̄ I/(πR²(1 − ρ̄)) for the blend's mean albedo.
#[test]
fn a_blend_reflects_what_its_parts_do_in_the_mean() {
    let view = inside();
    let light = json!({ "type": "point", "position": point(DVec3::ZERO), "intensity": PI });
    let blend = |a: Value, b: Value, amount: f64| json!({ "type": "blend", "a": a, "b": b, "amount": amount });
    // 0.75·0.3 + 0.25·0.7, the first by way of another blend, the second of one that is all its first part.
    let material = blend(blend(diffuse(0.1), diffuse(0.5), 0.5), blend(diffuse(0.7), diffuse(0.0), 0.0), 0.25);
    let scene = scene(&scene_json(view.json(), vec![sphere(DVec3::ZERO, 1.0, true, material)], vec![light]));
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        let fewer = if integrator == Integrator::Bdpt { 1 } else { 2 };
        let budget = Budget::new(samples(integrator) / fewer, 410 + n as u64);
        let images = images(&scene, settings(integrator, 64), budget);
        let expected = expect_colored(&[0.4 / 0.6; 4], [1.0; 3]);
        assert_closed(&format!("blend, {integrator:?}"), &images, &expected, Bounds::new([2, 2], 0.03, 0.01));
    }
}

/// A shining furnace whose wall is now a mirror, now diffuse: E/(1 − ρ̄). A delta lobe and another at one surface.
#[test]
fn a_blend_of_mirror_and_diffuse_in_a_furnace() {
    let view = inside();
    let material = json!({ "type": "blend", "a": { "type": "mirror", "albedo": 0.6 }, "b": diffuse(0.2), "amount": 0.5,
                           "emit": [1.0, 0.5, 2.0] });
    let scene = scene(&scene_json(view.json(), vec![sphere(DVec3::ZERO, 1.0, true, material)], vec![]));
    // A mirror seen directly is for the techniques that start at the camera.
    for (n, integrator) in [Integrator::Path, Integrator::Bdpt].into_iter().enumerate() {
        let images = images(&scene, settings(integrator, 64), Budget::new(samples(integrator), 420 + n as u64));
        let expected = expect_colored(&[1.0 / 0.6; 4], [1.0, 0.5, 2.0]);
        let what = format!("blend of mirror and diffuse, {integrator:?}");
        assert_closed(&what, &images, &expected, Bounds::new([2, 2], 0.02, 0.005));
    }
}

/// The plane z = 0 lit by a point light, seen from above.
fn above() -> View {
    let (from, at) = (DVec3::new(0.1, -0.6, 1.4), DVec3::new(0.05, 0.02, 0.0));
    View { from, at, up: DVec3::Y, vfov: 20.0, resolution: [2, 2] }
}

const LIGHT: DVec3 = DVec3::new(0.4, 0.3, 1.0);
const INTENSITY: f64 = 3.0;

/// ρ I cosθ_s/(π r²) at the plane, with the cosine to a shading normal.
fn lit(view: &View, albedo: f64, normal: DVec3) -> Vec<f64> {
    view.tile_means([2, 2], 64, |d| {
        let p = view.from - d * (view.from.z / d.z);
        let l = LIGHT - p;
        albedo * INTENSITY * l.normalize().dot(normal).max(0.0) / (PI * l.length_squared())
    })
}

fn point_light(position: DVec3) -> Value {
    json!({ "type": "point", "position": point(position), "intensity": INTENSITY })
}

#[test]
fn sheets_take_away_their_opacity_by_every_integrator() {
    let view = View { vfov: 60.0, ..above() };
    let sheet = |z: f64, opacity: Value| {
        let mut sheet = quad(&facing(DVec3::new(0.0, 0.0, z), DVec3::new(0.1, 0.0, 1.0)), [6.0; 2], diffuse(0.0));
        sheet["opacity"] = opacity;
        sheet
    };
    // Both lie between plane and light, and between plane and camera: 0.5 · 0.75 of either. The second is a texture, a
    // checker so fine and even that its parts are the same.
    let surfaces = |sheets: Vec<Value>| [vec![quad(&DAffine3::IDENTITY, [4.0; 2], diffuse(0.8))], sheets].concat();
    let sheets = vec![
        sheet(0.45, json!(0.5)),
        sheet(
            0.6,
            json!({ "type": "checker", "scale": 40, "even": 0.25, "odd": { "type": "constant", "color": [0, 0.25, 0.5] } }),
        ),
    ];
    let scene = scene(&scene_json(view.json(), surfaces(sheets), vec![point_light(LIGHT)]));
    let expected: Vec<f64> = lit(&view, 0.8, DVec3::Z).into_iter().map(|l| l * f64::powi(0.5 * 0.75, 2)).collect();
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        let images = images(&scene, settings(integrator, 4), Budget::new(samples(integrator), 430 + n as u64));
        let what = format!("sheets, {integrator:?}");
        assert_closed(&what, &images, &expect_colored(&expected, [1.0; 3]), Bounds::new([2, 2], 0.05, 0.025));
    }
}

/// Light from infinity through a black shell that is half there, and out of it again to the camera: a diffuse ball under a
/// sky and a sun has a quarter of what it would have. Shadow rays toward infinity have no end.
#[test]
fn a_shell_around_all_quarters_light_from_infinity() {
    let (sky, sun) = ([1.0, 0.5, 2.0], [4.0, 1.0, 3.0]);
    let view = View { from: DVec3::Z * 1.9, at: DVec3::ZERO, up: DVec3::Y, vfov: 40.0, resolution: [2, 2] };
    let toward = DVec3::new(0.3, 0.2, 1.0).normalize();
    let mut shell = sphere(DVec3::ZERO, 1.3, false, diffuse(0.0));
    shell["opacity"] = json!(0.5);
    let lights = vec![
        json!({ "type": "constant", "radiance": sky }),
        json!({ "type": "directional", "direction": point(-toward), "irradiance": sun }),
    ];
    let scene = scene(&scene_json(view.json(), vec![sphere(DVec3::ZERO, 1.0, false, diffuse(0.6)), shell], lights));
    let by_channel = [0, 1, 2].map(|c| {
        view.tile_means([2, 2], 64, |d| {
            let b = d.dot(view.from);
            let n = view.from + d * (-b - (b * b - view.from.length_squared() + 1.0).sqrt());
            0.25 * 0.6 * (sky[c] + sun[c] / PI * n.dot(toward).max(0.0))
        })
    });
    let expected: Vec<f64> = (0..4).flat_map(|tile| [0, 1, 2].map(|c| by_channel[c][tile])).collect();
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        // Light tracing is not aimed at the view.
        let (more, tile, mean) = match integrator {
            Integrator::Path => (2, 0.05, 0.025),
            Integrator::Light => (4, 0.12, 0.04),
            Integrator::Bdpt | Integrator::Auto => (4, 0.05, 0.025),
        };
        let budget = Budget::new(more * samples(integrator), 435 + n as u64);
        let images = images(&scene, settings(integrator, 4), budget);
        let bounds = Bounds::new([2, 2], tile, mean);
        assert_closed(&format!("a shell around all, {integrator:?}"), &images, &expected, bounds);
    }
}

/// A lamp seen through a sheet: technique s = 0, and the light's own start for the others.
#[test]
fn a_sheet_before_a_lamp_halves_it() {
    let view = above();
    let lamp = quad(&DAffine3::IDENTITY, [4.0; 2], json!({ "type": "diffuse light", "emit": [1.0, 2.0, 3.0] }));
    let mut sheet = quad(&facing(DVec3::new(0.0, 0.0, 0.5), DVec3::Z), [4.0; 2], diffuse(0.0));
    sheet["opacity"] = json!(0.5);
    let scene = scene(&scene_json(view.json(), vec![lamp, sheet], vec![]));
    for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
        let images = images(&scene, settings(integrator, 2), Budget::new(1 << 14, 440 + n as u64));
        let what = format!("a sheet before a lamp, {integrator:?}");
        assert_closed(&what, &images, &expect_colored(&[0.5; 4], [1.0, 2.0, 3.0]), Bounds::new([2, 2], 0.03, 0.01));
    }
}

/// A map of one normal everywhere: the plane of that normal, by every integrator, in any pose, the side turned or not.
#[test]
fn a_mapped_normal_shades_as_its_plane_would() {
    let local = DVec3::new(0.3, -0.2, 0.8).normalize();
    let stored = (local + DVec3::ONE) * 0.5;
    let map = json!({ "type": "constant", "color": [stored.x, stored.y, stored.z] });
    let mut random = Random(5);
    for (case, flip) in [false, true].into_iter().enumerate() {
        let view = above();
        // Turned over, its normal is −z and its back is up: carried to face up again by half a turn about x, v runs down.
        let (frame, normal) = if flip {
            (DAffine3::from_rotation_x(PI), DVec3::new(local.x, -local.y, local.z))
        } else {
            (DAffine3::IDENTITY, local)
        };
        let pose = random.pose(0.3);
        let mut plane = quad(&(pose * frame), [4.0; 2], diffuse(0.8));
        plane["normal_map"] = map.clone();
        plane["flip_normals"] = json!(flip);
        let light = point_light(pose.transform_point3(LIGHT));
        let scene = scene(&scene_json(view.moved(&pose).json(), vec![plane], vec![light]));
        let expected = expect_colored(&lit(&view, 0.8, normal), [1.0; 3]);
        for (n, integrator) in INTEGRATORS.into_iter().enumerate() {
            let budget = Budget::new(samples(integrator), 450 + 3 * case as u64 + n as u64);
            let images = images(&scene, settings(integrator, 1), budget);
            let what = format!("mapped normal, flipped {flip}, {integrator:?}");
            assert_closed(&what, &images, &expected, Bounds::new([2, 2], 0.03, 0.015));
        }
    }
}

/// A ramp of displacements tilts the plane: slope s along u over a width w is the normal (−s/w, 0, 1). In any scale.
#[test]
fn a_bumped_ramp_shades_as_the_tilted_plane_would() {
    let texels: Vec<[f32; 3]> = (0..32).flat_map(|y| (0..32).map(move |x| [(x + 2 * y) as f32 / 32.0; 3])).collect();
    let ramp = file("ramp.exr", 32, texels);
    // Rows run from the top: a unit of u is x/32 → 1, a unit of v is −2.
    let normal = |height: f64, size: f64| DVec3::new(-height / size, 2.0 * height / size, 1.0).normalize();
    for (n, (scale, integrator)) in
        [(1.0, Integrator::Path), (1024.0, Integrator::Light), (1e-3, Integrator::Bdpt)].into_iter().enumerate()
    {
        let view = above();
        let larger = DAffine3::from_scale(DVec3::splat(scale));
        let mut plane = json!({ "type": "quad", "size": 4, "transform": matrix(&larger), "material": diffuse(0.8) });
        plane["bump_map"] = json!({ "type": "image", "filename": ramp, "scale": scale, "wrap": "clamp" });
        let light =
            json!({ "type": "point", "position": point(LIGHT * scale), "intensity": INTENSITY * scale * scale });
        let scene = scene(&scene_json(view.moved(&larger).json(), vec![plane], vec![light]));
        let expected = expect_colored(&lit(&view, 0.8, normal(1.0, 4.0)), [1.0; 3]);
        let images = images(&scene, settings(integrator, 1), Budget::new(samples(integrator), 460 + n as u64));
        // Differences of 32-bit texels over half a texel hold four digits.
        let bounds = Bounds { rounding: 1e-4, ..Bounds::new([2, 2], 0.03, 0.015) };
        assert_closed(&format!("bumped ramp at scale {scale}, {integrator:?}"), &images, &expected, bounds);
    }
}

/// What a surface turns out to be where the camera looks.
fn model(surface: Value) -> (Bsdf, SurfacePoint) {
    let view = View { from: DVec3::new(0.1, 0.2, 2.0), at: DVec3::new(0.1, 0.2, 0.0), vfov: 20.0, ..inside() };
    let scene = scene(&scene_json(view.json(), vec![surface], vec![point_light(DVec3::Z * 4.0)]));
    let ray = scene.camera.generate_ray([0, 0], [0.5; 2], [0.5; 2]).ray;
    let mut varying = Bsdf::Black;
    let arrival = scene.arrive(ray, &mut Coins::new(0), &mut 0, &mut varying).expect("a surface");
    (*arrival.bsdf, arrival.at)
}

/// A texture that is the same everywhere is the number it holds, in every model.
#[test]
fn constant_textures_are_their_values() {
    let texture = |x: f64| json!({ "type": "constant", "color": x });
    for (kind, parameters) in [
        ("lambertian", vec![("albedo", 0.25)]),
        ("metal", vec![("albedo", 0.75), ("roughness", 0.25)]),
        ("dielectric", vec![("transmittance", 0.5), ("roughness", 0.125)]),
        ("conductor", vec![("eta", 0.5), ("k", 3.0), ("roughness", 0.5)]),
        ("beckmann", vec![("albedo", 0.5)]),
        ("plastic", vec![("albedo", 0.5), ("roughness", 0.25)]),
        ("plastic", vec![("albedo", 0.5), ("roughness", 0.0)]),
        ("oren-nayar", vec![("albedo", 0.5), ("sigma", 0.5)]),
        ("phong", vec![("albedo", 0.5), ("exponent", 8.0)]),
        ("blinnphong", vec![("albedo", 0.5), ("exponent", 8.0)]),
    ] {
        let with = |value: &dyn Fn(f64) -> Value| {
            let mut material = json!({ "type": kind });
            parameters.iter().for_each(|(key, x)| material[*key] = value(*x));
            model(quad(&DAffine3::IDENTITY, [2.0; 2], material)).0
        };
        assert_eq!(with(&texture), with(&|x| json!(x)), "{kind} {parameters:?}");
    }
}

/// The first of two roughnesses is along the direction in which u grows, wherever the surface is turned.
#[test]
fn anisotropy_follows_the_surface() {
    for kind in ["conductor", "dielectric"] {
        for angle in [0.0, 0.4, 2.0, 4.0] {
            let pose = DAffine3::from_rotation_z(angle);
            let mut material = json!({ "type": kind, "roughness": [0.1, 0.4] });
            if kind == "conductor" {
                material["albedo"] = json!(0.5);
            }
            let (bsdf, at) = model(quad(&pose, [2.0, 1.5], material));
            let roughness = match bsdf {
                Bsdf::Conductor(c) => c.roughness,
                Bsdf::RoughDielectric(d) => d.roughness,
                other => panic!("{other:?}"),
            };
            let frame = Frame::from_normal(at.ns);
            let [c, s] = roughness.tangent;
            let (along, wanted) = (frame.x * c + frame.y * s, (pose.matrix3 * DVec3::X).as_vec3a());
            assert!((along - wanted).length() < 1e-5, "{kind}, turned by {angle}: {along}, not {wanted}");
            assert_eq!(roughness.alpha, [0.1, 0.4]);
        }
    }
}

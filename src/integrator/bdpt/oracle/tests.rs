//! A box with every kind of light and surface: a million of its paths.

use rayon::prelude::*;

use super::*;
use crate::accel::bvh::BvhAccel;
use crate::math::DMat3;
use crate::scene::desc::{InfiniteLightDesc, InfiniteLightKind, Place};
use crate::scene::prepare;

/// An open box with area lights, one of them a mesh, a spot and a point light, a sky and a sun, a mirror, something that shines within
/// glass, a glass sphere, a frosted one, lacquer, a curved mesh, a window, a cut-out screen, a blend of mirror and diffuse,
/// and a wall of bent normals.
const SCENE: &str = r#"{
 "camera": {"transform": {"from": [0, 0, 3.2], "at": [0, 0, 0], "up": [0, 1, 0]}, "resolution": [32, 24], @},
 "materials": [
  {"name": "white", "type": "lambertian", "albedo": [0.8, 0.7, 0.6], "two_sided": true},
  {"name": "glow", "type": "lambertian", "albedo": 0.4, "two_sided": true, "emit": [0.2, 0.1, 0.3]},
  {"name": "glass", "type": "dielectric", "ior": 1.6},
  {"name": "mirror", "type": "mirror", "albedo": 0.9},
  {"name": "frosted", "type": "dielectric", "ior": 1.4, "roughness": 0.3},
  {"name": "lacquer", "type": "plastic", "albedo": [0.6, 0.3, 0.2], "roughness": 0, "two_sided": true},
  {"name": "window", "type": "null"},
  {"name": "worn", "type": "blend", "a": "white", "b": {"type": "mirror", "albedo": 0.8},
   "amount": {"type": "checker", "scale": 9, "even": 0.05, "odd": 0.15}},
  {"name": "lamp", "type": "diffuse light", "emit": [6, 5, 4]}
 ],
 "surfaces": [
  {"type": "quad", "size": 4, "transform": {"translate": [0, 0, -1.5]}, "material": "white",
   "normal_map": {"type": "checker", "scale": 5, "even": [0.65, 0.45, 0.95], "odd": [0.4, 0.6, 0.95]}},
  {"type": "quad", "size": 4, "transform": [{"rotate": [-90, 1, 0, 0]}, {"translate": [0, -1.2, 0]}], "material": "glow"},
  {"type": "quad", "size": 4, "transform": [{"rotate": [90, 1, 0, 0]}, {"translate": [0, 1.4, 0]}], "material": "white"},
  {"type": "quad", "size": 4, "transform": [{"rotate": [90, 0, 1, 0]}, {"translate": [-1.6, 0, 0]}], "material": "mirror"},
  {"type": "quad", "size": 4, "transform": [{"rotate": [-90, 0, 1, 0]}, {"translate": [1.6, 0, 0]}], "material": "worn"},
  {"type": "sphere", "radius": 0.5, "transform": {"translate": [0.5, -0.4, 0.3]}, "material": "glass"},
  {"type": "sphere", "radius": 0.2, "transform": {"translate": [0.5, -0.4, 0.3]}, "material": "glow"},
  {"type": "sphere", "radius": 0.3, "transform": {"translate": [-0.6, -0.7, 0.5]}, "material": "frosted"},
  {"type": "quad", "size": 1, "transform": [{"rotate": [40, 0, 1, 0]}, {"translate": [-0.3, 0.7, -0.9]}], "material": "lacquer"},
  {"type": "quad", "size": 0.9, "transform": [{"rotate": [30, 1, 0, 0]}, {"translate": [0.7, 0.5, 0.5]}], "material": "white",
   "opacity": {"type": "checker", "scale": 15, "even": 0.7, "odd": 0.2}},
  {"type": "quad", "size": 1.2, "transform": {"translate": [-0.6, 0.2, 0.4]}, "material": "window"},
  {"type": "triangle", "positions": [[-1.2, -1, -0.8], [0, -0.8, -1], [-0.6, 0.4, -0.9]],
   "normals": [[-0.4, 0, 1], [0.5, 0.1, 1], [0, 0.5, 1]], "material": "white"},
  {"type": "disk", "radius": 0.4, "transform": [{"rotate": [90, 1, 0, 0]}, {"translate": [0.3, 1.3, 0.2]}], "material": "lamp"},
  {"type": "sphere", "radius": 0.2, "transform": {"translate": [-0.9, 0.9, -0.6]}, "material": "lamp"},
  {"type": "mesh", "positions": [[0, 0, 0.15], [0.25, 0.2, 0], [-0.2, 0.2, 0], [-0.2, -0.25, 0], [0.2, -0.2, 0]],
   "indices": [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]], "transform": {"translate": [1.1, 0.3, -1.1]}, "material": "lamp"}
 ],
 "lights": [
  {"type": "point", "position": [0.9, 0.8, 0.7], "intensity": [2, 3, 4]},
  {"type": "directional", "direction": [0.3, -0.5, -1], "irradiance": [0.3, 0.2, 0.1]},
  {"type": "constant", "radiance": [0.02, 0.03, 0.04]},
  {"type": "spot", "position": [-0.5, 1.1, 0.9], "at": [0, -1, 0], "intensity": 9, "inner_angle": 20, "outer_angle": 45}
 ]
}"#;

/// The cameras that the box is seen through.
const PINHOLE: &str = r#""vfov": 50"#;
const THIN_LENS: &str = r#""vfov": 50, "fdist": 2.5, "aperture": 0.3, "filter": {"type": "gaussian"}"#;
const ORTHOGRAPHIC: &str = r#""type": "orthographic", "height": 2.4, "filter": {"type": "tent"}"#;

/// That box, prepared, on the pure-Rust BVH.
fn scene(camera: &str) -> Scene<BvhAccel> {
    let mut desc = crate::import::scene_from_str(&SCENE.replace('@', camera), "oracle.json", std::path::Path::new("."))
        .expect("valid scene");
    // A coarse sky, some of it black, with texels between which the density varies a hundredfold.
    let texel = |i: u32| {
        if i % 5 == 0 { [0.0; 3] } else { [0.002, 0.02, 0.2].map(|x| x * (0.1 + f64::from(i * 7 % 11)) as f32) }
    };
    let texels = (0..32).map(texel).collect();
    let transform = DMat3::from_rotation_z(0.7) * DMat3::from_rotation_x(0.3);
    let kind = InfiniteLightKind::Image { size: [8, 4], texels, transform };
    desc.infinite_lights.push(InfiniteLightDesc { kind, at: Place::default() });
    Scene::build(prepare(&desc).expect("preparable"), Default::default()).expect("buildable")
}

#[test]
fn weights_partition_unity_and_every_technique_measures_the_same() {
    let (mut paths, mut blocked) = (0, 0);
    let even = SplatConfidence::default();
    let uneven = SplatConfidence::new([0.01, 0.002, 0.6, 0.7, 0.3, 0.95]);
    for (camera, heuristic, light_paths, connections, light_one_in, splat_confidence, tries) in [
        (PINHOLE, Heuristic::Power, 1, 1, 1, even, 2_000_000),
        (PINHOLE, Heuristic::Power, 3, 2, 1, even, 500_000),
        (PINHOLE, Heuristic::Power, 1, 1, 1, uneven, 500_000),
        (PINHOLE, Heuristic::Power, 2, 1, 4, uneven, 200_000),
        (PINHOLE, Heuristic::Balance, 2, 1, 1, even, 500_000),
        (PINHOLE, Heuristic::Balance, 1, 1, 2, uneven, 200_000),
        (PINHOLE, Heuristic::Uniform, 1, 1, 1, even, 200_000),
        (THIN_LENS, Heuristic::Power, 2, 1, 1, even, 200_000),
        (THIN_LENS, Heuristic::Balance, 1, 1, 1, even, 100_000),
        (ORTHOGRAPHIC, Heuristic::Power, 2, 1, 1, even, 200_000),
        (ORTHOGRAPHIC, Heuristic::Balance, 1, 1, 1, even, 100_000),
    ] {
        let scene = scene(camera);
        let settings =
            Settings { heuristic, light_paths, connections, light_one_in, splat_confidence, ..Settings::default() };
        let judge = Judge::new(&scene, settings);
        let seen = (0..tries).into_par_iter().map(|i| Seen::path(&judge, i)).reduce(Seen::default, Seen::merge);
        println!(
            "{camera}: {heuristic:?} {light_paths}/{connections} of 1/{light_one_in}, {splat_confidence:?}: {} paths ({} with delta vertices, {} of them a mixture's, {} through \
             a cut-out), {} techniques; worst Σw−1 \
             {:.1e}, weight {:.1e}, identity {:.1e}; {} beyond 1e-4 next to delta vertices, by at most {:.1e}, where the condition is at \
             most {:.1e}; their ratio at most {:.2}",
            seen.paths,
            seen.with_delta,
            seen.mixtures,
            seen.thinned,
            seen.techniques,
            seen.worst_sum,
            seen.worst_weight,
            seen.worst_identity,
            seen.tail,
            seen.worst_tail,
            seen.worst_condition,
            seen.worst_ratio
        );
        assert!(seen.structural.count == 0, "{}", seen.structural);
        if let Some(failure) = seen.failure {
            panic!("{failure}");
        }
        assert!(seen.with_delta > seen.paths / 20 && seen.techniques > 2 * seen.paths, "{seen:?}");
        // How many there are is a matter of how many edges are short or grazing, 2 to 4 in a thousand of the techniques at
        // delta vertices; the condition above is what holds each of them.
        assert!(seen.tail * 200 < seen.techniques_with_delta, "{seen:?}");
        assert!(seen.mixtures > seen.paths / 200 && seen.thinned > seen.paths / 100, "{seen:?}");
        paths += seen.paths;
        blocked += seen.blocked;
    }
    assert!(paths >= 1_000_000, "only {paths} paths");
    // A rounding can lead an edge past another surface's silhouette on one way and into it on the other.
    println!("{blocked} of {paths} paths have an edge that rounding blocks");
    assert!(blocked * 100_000 < paths, "{blocked} of {paths} paths have an edge that is not seen along");
}

/// What `twinlight stress` judges by.
#[test]
fn a_nan_is_the_worst_of_all() {
    let seen = |worst_sum: f64| Seen { worst_sum, ..Seen::default() };
    for sums in [[0.5, f64::NAN, 0.1], [f64::NAN, 0.5, 0.1], [0.1, 0.5, f64::NAN]] {
        assert!(sums.map(seen).into_iter().reduce(Seen::merge).unwrap().worst_sum.is_nan());
    }
    assert_eq!([0.1, 0.5, 0.2].map(seen).into_iter().reduce(Seen::merge).unwrap().worst_sum, 0.5);
}

#[test]
fn subpaths_that_are_not_traced_are_not_connected_to() {
    let scene = scene(PINHOLE);
    for (light_paths, connections) in [(0, 1), (1, 3)] {
        let judge = Judge::new(&scene, Settings { light_paths, connections, ..Settings::default() });
        let seen = (0..50_000).into_par_iter().map(|i| Seen::path(&judge, i)).reduce(Seen::default, Seen::merge);
        assert!(seen.paths > 1000 && seen.failure.is_none() && seen.structural.count == 0, "{seen:?}");
    }
}

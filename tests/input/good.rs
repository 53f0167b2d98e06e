//! Good input, some of it easily taken for bad.

use twinlight::import::load_scene;
use twinlight::math::DVec3;
use twinlight::scene::desc::{
    EmpiricalModel, Facets, FilterDesc, FilterKind, FresnelDesc, Heuristic, IntegratorKind, MaterialKind, Param, Place,
    Projection, SamplerKind, ShapeDesc, SpotProfile,
};

use super::{mesh_of, read, shared};

/// Their squares are 0 or infinite, they are not.
#[test]
fn tiny_and_huge_directions_are_directions() {
    for length in ["1e-200", "1e200", "5e-324"] {
        let axis = format!("[0, {length}, 0]");
        let scene = format!(
            r#"{{"camera": {{"transform": {{"up": {axis}}}}}, "lights": [
                {{"type": "directional", "direction": {axis}, "irradiance": 1}},
                {{"type": "spot", "position": 0, "direction": {axis}, "intensity": 1, "inner_angle": 1, "outer_angle": 2}}],
                "surfaces": [{{"type": "quad", "material": {{"type": "mirror"}}, "transform": {{"axis": {axis}, "angle": 90}}}}]}}"#
        );
        let scene = read(&scene).unwrap_or_else(|e| panic!("{length}: {e}"));
        assert_eq!(scene.camera.transform.matrix3.y_axis, DVec3::Y);
        let turned = scene.surfaces[0].transform.matrix3 * DVec3::Z;
        assert_eq!(turned, DVec3::X, "{length}");
    }
}

#[test]
fn a_whole_scene() {
    let text = r#"{
  "camera": {"transform": [{"from": [0, 0, 4], "at": [0, 0, 0]}, {"translate": [0, 1, 0]}], "resolution": [32, 16]},
  "integrator": {"type": "path", "max_bounces": 5, "russian_roulette": false, "heuristic": "balance"},
  "sampler": {"type": "independent", "seed": 7, "samples": 16},
  "background": {"type": "constant", "color": [0, 0, 0]},
  "materials": [
    {"name": "glowing", "type": "lambertian", "albedo": 0.5, "two_sided": true, "emit": [1, 2, 3]},
    {"name": "glass", "type": "dielectric", "ior": 1, "roughness": 0},
    {"name": "chrome", "type": "metal"}
  ],
  "surfaces": [
    {"type": "quad", "size": [2, 3], "transform": {"axis": [1, 0, 0], "angle": 90}, "material": "glowing"},
    {"type": "sphere", "material": "glass", "flip_normals": true},
    {"type": "disk", "radius": 2, "material": "chrome"},
    {"type": "triangle", "positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "material": {"type": "null"}},
    {"type": "mesh", "positions": [0, 1, [2, 3, 4], 3], "indices": [[0, 1, 2, 3], [3, 2, 1]], "material": "glass"},
    {"type": "delta point", "transform": {"translate": 1}, "material": {"type": "point light", "emit": 4}}
  ],
  "lights": [{"type": "spot", "position": [1, 2, 3], "at": [1, 2, 0], "intensity": 2, "inner_angle": 10, "outer_angle": 20}]
}"#;
    let scene = read(text).unwrap();
    assert_eq!(scene.camera.transform.translation.to_array(), [0.0, 1.0, 4.0]);
    assert_eq!((scene.camera.resolution, scene.samples), ([32, 16], 16));
    assert_eq!(scene.camera.projection, Projection::Perspective { vfov: 90.0, fdist: 1.0, aperture: 0.0 });
    assert_eq!(scene.camera.filter, FilterDesc { kind: FilterKind::Box, radius: 0.5 });
    assert_eq!((scene.integrator.kind, scene.integrator.max_bounces), (IntegratorKind::Path, 5));
    assert_eq!((scene.integrator.russian_roulette, scene.integrator.heuristic), (false, Heuristic::Balance));
    assert_eq!((scene.sampler.kind, scene.sampler.seed), (SamplerKind::Independent, 7));
    assert_eq!(scene.materials[0].emit, Param::Value([1.0, 2.0, 3.0]));
    let roughness = [Param::Value(0.0); 2];
    assert_eq!(
        scene.materials[1].kind,
        MaterialKind::Dielectric { ior: 1.0, transmittance: Param::Value([1.0; 3]), roughness }
    );
    assert_eq!(scene.materials[2].kind, MaterialKind::Mirror { albedo: Param::Value([1.0; 3]) });
    // A quad turned by +90° about x faces down, exactly.
    let down = scene.surfaces[0].transform.matrix3 * DVec3::Z;
    assert_eq!(down.to_array(), [0.0, -1.0, 0.0]);
    assert_eq!(mesh_of(&scene.surfaces[3].shape).triangles, [[0, 1, 2]]);
    let mesh = mesh_of(&scene.surfaces[4].shape);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 1]]);
    assert_eq!(mesh.positions[1..3], [[1.0; 3], [2.0, 3.0, 4.0]]);
    let spot = &scene.surfaces[6];
    let axis = spot.transform.matrix3 * -DVec3::Z;
    assert!((axis - -DVec3::Z).length() < 1e-15, "{axis}");
    assert!((spot.transform.matrix3.determinant() - 1.0).abs() < 1e-15);
    assert_eq!(
        scene.materials[spot.material].kind,
        MaterialKind::SpotLight {
            intensity: [2.0; 3],
            inner_angle: 10.0,
            outer_angle: 20.0,
            profile: SpotProfile::Cosine { falloff: 0.5 }
        }
    );
    assert_eq!(spot.at, Place { file: "s.json".to_owned(), line: 19, column: 14, pointer: "/lights/0".to_owned() });
    assert!(scene.surfaces.iter().all(|s| s.at.line > 0) && scene.materials.iter().all(|m| m.at.line > 0));
    assert_eq!((scene.camera.at.line, scene.camera.at.pointer.as_str()), (2, "/camera"));
    assert!(scene.notes.is_empty());
}

#[test]
fn a_point_light_is_the_delta_point_it_stands_for() {
    let sugar = read(r#"{"camera": {}, "lights": [{"type": "point", "position": [1, 2, 3], "intensity": [4, 5, 6]}]}"#)
        .unwrap();
    let plain = read(
        r#"{"camera": {}, "surfaces": [{"type": "delta point", "transform": {"translate": [1, 2, 3]},
            "material": {"type": "point light", "emit": [4, 5, 6]}}]}"#,
    )
    .unwrap();
    for scene in [&sugar, &plain] {
        assert!(matches!(scene.surfaces[0].shape, ShapeDesc::DeltaPoint));
        assert_eq!(scene.materials[0].kind, MaterialKind::PointLight { intensity: [4.0, 5.0, 6.0] });
        assert_eq!(scene.materials[0].emit, Param::Value([0.0; 3]));
    }
    assert_eq!(sugar.surfaces[0].transform, plain.surfaces[0].transform);
}

#[test]
fn what_dirt_writes_is_read_with_notes() {
    let scene = read(
        r#"{"camera": {"resolution": [8, 8]}, "accelerator": {"type": "bbh"}, "image_samples": 4, "media": [{"name": "fog"}],
            "integrator": {"type": "path_tracer_mis", "max_bounces": 3}, "sampler": {"type": "halton"}}"#,
    )
    .unwrap();
    assert_eq!((scene.integrator.kind, scene.integrator.max_bounces), (IntegratorKind::Path, 3));
    assert_eq!((scene.sampler.kind, scene.samples), (SamplerKind::Sobol, 4));
    assert_eq!(
        scene.notes,
        [
            "s.json:1:51: /accelerator: the accelerator is ignored: it is chosen on the command line",
            "s.json:1:97: /media: the media are ignored: nothing may use them (participating media are not supported)",
            "s.json:2:36: /integrator/type: the integrator \"path_tracer_mis\" is read as \"path\"",
            "s.json:2:94: /sampler/type: the sampler \"halton\" is read as \"sobol\"",
        ]
    );
    let scene = read(r#"{"camera": {}, "image_samples": 4, "sampler": {"samples": 9}}"#).unwrap();
    assert_eq!(scene.samples, 9);
    assert_eq!(scene.notes, ["s.json:1:33: /image_samples: image_samples 4 is overruled by the sampler's samples"]);
}

#[test]
fn cornell_boxes_load() {
    let Some(folder) = shared("cornell") else { return };
    for (name, surfaces) in [("area", 6), ("glass", 6), ("point", 6), ("spot", 6), ("glossy", 6)] {
        let scene = load_scene(&folder.join(format!("cornell_{name}.json"))).unwrap();
        assert_eq!(scene.surfaces.len(), surfaces, "{name}");
        assert_eq!(scene.camera.resolution, [256, 256], "{name}");
        assert!(scene.notes.is_empty(), "{name}: {:?}", scene.notes);
    }
}

#[test]
fn models_of_reflection() {
    let scene = read(
        r#"{"camera": {}, "materials": [
            {"name": "gold", "type": "conductor", "eta": [0.14, 0.37, 1.44], "k": [3.98, 2.39, 1.6], "roughness": [0.1, 0.3]},
            {"name": "f0", "type": "conductor", "albedo": 0.9, "two_sided": true},
            {"name": "test", "type": "conductor", "albedo": 1, "fresnel": "none", "masking": "separable"},
            {"name": "old", "type": "beckmann", "albedo": [1, 0, 1], "roughness": 0},
            {"name": "brushed", "type": "metal", "albedo": 0.5, "roughness": 0.2},
            {"name": "chrome", "type": "metal", "roughness": 0},
            {"name": "frosted", "type": "dielectric", "roughness": 0.3},
            {"name": "varnish", "type": "plastic", "albedo": 0.5, "nonlinear": true},
            {"name": "pane", "type": "thin dielectric", "ior": 1.3},
            {"name": "p", "type": "phong", "albedo": 1, "exponent": 10, "emit": 3},
            {"name": "b", "type": "blinnphong", "albedo": 1, "exponent": 1e6},
            {"name": "clay", "type": "oren-nayar", "albedo": 0.6, "sigma": 0.35, "two_sided": true}
        ]}"#,
    )
    .unwrap();
    let conductor = |fresnel, roughness: [f64; 2], facets, separable_masking, two_sided| MaterialKind::Conductor {
        fresnel,
        roughness: roughness.map(Param::Value),
        facets,
        separable_masking,
        two_sided,
    };
    let (eta, k) = (Param::Value([0.14, 0.37, 1.44]), Param::Value([3.98, 2.39, 1.6]));
    let wanted = [
        conductor(FresnelDesc::Index { eta, k }, [0.1, 0.3], Facets::Ggx, false, false),
        conductor(FresnelDesc::Schlick { albedo: Param::Value([0.9; 3]) }, [0.1; 2], Facets::Ggx, false, true),
        conductor(FresnelDesc::Constant { albedo: Param::Value([1.0; 3]) }, [0.1; 2], Facets::Ggx, true, false),
        conductor(
            FresnelDesc::Schlick { albedo: Param::Value([1.0, 0.0, 1.0]) },
            [0.0; 2],
            Facets::Beckmann,
            false,
            false,
        ),
        conductor(FresnelDesc::Constant { albedo: Param::Value([0.5; 3]) }, [0.2; 2], Facets::Ggx, false, true),
        MaterialKind::Mirror { albedo: Param::Value([1.0; 3]) },
        MaterialKind::Dielectric { ior: 1.5, transmittance: Param::Value([1.0; 3]), roughness: [Param::Value(0.3); 2] },
        MaterialKind::Plastic {
            albedo: Param::Value([0.5; 3]),
            ior: 1.5,
            roughness: Param::Value(0.1),
            nonlinear: true,
            two_sided: false,
        },
        MaterialKind::ThinDielectric { ior: 1.3 },
        MaterialKind::Empirical {
            albedo: Param::Value([1.0; 3]),
            model: EmpiricalModel::Phong { exponent: Param::Value(10.0) },
            two_sided: false,
        },
        MaterialKind::Empirical {
            albedo: Param::Value([1.0; 3]),
            model: EmpiricalModel::BlinnPhong { exponent: Param::Value(1e6) },
            two_sided: false,
        },
        MaterialKind::Empirical {
            albedo: Param::Value([0.6; 3]),
            model: EmpiricalModel::OrenNayar { sigma: Param::Value(0.35) },
            two_sided: true,
        },
    ];
    assert_eq!(scene.materials.len(), wanted.len());
    for (found, wanted) in scene.materials.iter().zip(&wanted) {
        assert_eq!(&found.kind, wanted, "{:?}", found.name);
    }
    assert_eq!(scene.materials[9].emit, Param::Value([3.0; 3]));
}

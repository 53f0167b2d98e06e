//! `info`: what is in a scene, as text and as JSON.

use serde_json::json;

use super::Folder;

const SCENE: &str = r#"{
  "camera": {"transform": {"from": [10, 0, 8], "at": [10, 0, 0]}, "resolution": [40, 30]},
  "image_samples": 7, "integrator": {"type": "path", "max_bounces": 9}, "accelerator": {"type": "bvh"},
  "surfaces": [
    {"type": "quad", "size": [2, 4], "material": {"type": "diffuse light", "emit": [1, 2, 3]},
     "transform": {"translate": [10, 0, 0]}},
    {"type": "sphere", "radius": 1, "material": {"type": "dielectric"}, "transform": {"translate": [13, 0, 0]}},
    {"type": "disk", "radius": 1, "material": {"type": "null"}, "transform": {"translate": [7, 0, 0]}}
  ],
  "lights": [
    {"type": "point", "position": [10, 1, 0], "intensity": [1, 0.5, 0]},
    {"type": "spot", "position": [10, 1, 0], "direction": [0, -1, 0], "intensity": 1, "inner_angle": 60, "outer_angle": 60},
    {"type": "spot", "position": [10, 1, 0], "direction": [0, -1, 0], "intensity": 1, "inner_angle": 90, "outer_angle": 180,
     "profile": "angle"}
  ]
}"#;

#[test]
fn json_tells_what_is_in_a_scene() {
    let folder = Folder::new("info_json");
    folder.write("s.json", SCENE);
    let outcome = folder.ok(&["info", "s.json", "--json"]);
    assert_eq!(outcome.stderr, "");
    let json: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    // 4π I, π L A and 2π (1 − cos 60°) I. Lengths and powers are the file's, whatever render space is.
    let pi = std::f64::consts::PI;
    assert_eq!(
        json,
        json!({
            "scene": "s.json",
            "resolution": [40, 30],
            "samples": 7,
            "integrator": "path",
            "max_bounces": 9,
            "surfaces": 3,
            "triangles": 2,
            "vertices": 4,
            "quadrics": 2,
            "delta_points": 3,
            "accelerators": json["accelerators"],
            "memory": json["memory"],
            "lights": json["lights"],
            "center": [10.0, 0.0, 0.0],
            "scale": 0.125,
            "skipped": [
                "light subpaths and connections: there is no surface but mirrors, smooth glass and what reflects nothing",
                "intersection with point and spot lights: they have no size, so that no ray can hit them",
            ],
            "notes": ["s.json:3:88: /accelerator: the accelerator is ignored: it is chosen on the command line"],
        })
    );
    let lights = json["lights"].as_array().unwrap();
    let expected = [
        ("area", Some("parallelogram"), Some(8.0), [8.0 * pi, 16.0 * pi, 24.0 * pi]),
        ("point", None, None, [4.0 * pi, 2.0 * pi, 0.0]),
        ("spot", None, None, [pi; 3]),
        // 2π [1 − (sin 180° − sin 90°)/(π/2)].
        ("spot", None, None, [2.0 * pi + 4.0; 3]),
    ];
    assert_eq!(lights.len(), 4);
    for (light, (kind, shape, area, power)) in lights.iter().zip(expected) {
        assert_eq!((light["kind"].as_str(), light["shape"].as_str()), (Some(kind), shape), "{light}");
        assert_eq!(light["area"].as_f64(), area, "{light}");
        let said = light["power"].as_array().unwrap().iter().map(|p| p.as_f64().unwrap());
        assert!(said.zip(power).all(|(a, b)| (a - b).abs() < 1e-5 * b.max(1.0)), "{light}");
    }
    let keys = |i: usize| lights[i].as_object().unwrap().len();
    assert_eq!([keys(0), keys(1), keys(2), keys(3)], [4, 4, 8, 7]);
    let cone = |i: usize| ["inner_angle", "outer_angle", "profile", "falloff"].map(|key| lights[i][key].clone());
    assert_eq!(cone(2), [json!(60.0), json!(60.0), json!("cosine"), json!(0.5)]);
    assert_eq!(cone(3), [json!(90.0), json!(180.0), json!("angle"), json!(null)]);
    // What the build can intersect with, the default first, in the words of the images' metadata.
    let accelerators: Vec<&str> =
        json["accelerators"].as_array().unwrap().iter().map(|a| a.as_str().unwrap()).collect();
    folder.ok(&["render", "s.json", "-q", "--size", "2x2", "--spp", "1"]);
    assert_eq!(super::exr_header(&folder.path("s.exr")).0["twinlight:accel"], accelerators[0]);
    folder.ok(&["render", "s.json", "-q", "--size", "2x2", "--spp", "1", "--accel", "bvh"]);
    assert_eq!(super::exr_header(&folder.path("s.exr")).0["twinlight:accel"], accelerators[accelerators.len() - 1]);
    assert_eq!(accelerators.len(), if cfg!(feature = "embree") { 2 } else { 1 });
    std::fs::remove_file(folder.path("s.exr")).unwrap();
    assert_eq!(folder.names(), ["s.json"]);
}

#[test]
fn text_tells_the_same() {
    let folder = Folder::new("info_text");
    folder.write(
        "one.json",
        r#"{"camera": {"transform": {"translate": [1e6, -0.123456, 0]}}, "integrator": {"max_bounces": 1}, "surfaces": [
            {"type": "triangle", "positions": [[0, 0, 0], [1e3, 0, 0], [0, 1e6, 0]],
             "material": {"type": "diffuse light", "emit": 1e-7}}]}"#,
    );
    let text = folder.ok(&["info", "one.json"]).stdout;
    for line in [
        "auto with at most 1 bounce\n",
        "  geometry     1 surface: 1 triangle on 3 vertices\n",
        "    area (1 triangle, 5.000e8 square units), power 157.1 157.1 157.1 W\n",
    ] {
        assert!(text.contains(line), "{line}{text}");
    }
    folder.write("none.json", r#"{"camera": {}}"#);
    assert!(folder.ok(&["info", "none.json"]).stdout.contains("  geometry     0 surfaces\n"));
    folder.write("s.json", SCENE);
    let text = folder.ok(&["info", "s.json"]).stdout;
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[..4],
        [
            "s.json",
            "  image        40 × 30, 7 spp, path with at most 9 bounces",
            "  geometry     3 surfaces: 2 triangles on 4 vertices, 2 spheres or disks, 3 delta points",
            "  render space recentred on (10, 0, 0), scaled by 2^-3",
        ]
    );
    assert!(lines[4].starts_with("  accelerators ") && lines[4].ends_with("; the first is the default"), "{text}");
    assert!(lines[5].starts_with("  memory       about "), "{text}");
    assert_eq!(
        lines[6..],
        [
            "  lights       4",
            "    area (parallelogram, 8 square units), power 25.13 50.27 75.4 W",
            "    point, power 12.57 6.283 0 W",
            "    spot (cosine profile from 60° to 60°, falloff 0.5), power 3.142 3.142 3.142 W",
            "    spot (angle profile from 90° to 180°), power 10.28 10.28 10.28 W",
            "  skipped",
            "    light subpaths and connections: there is no surface but mirrors, smooth glass and what reflects nothing",
            "    intersection with point and spot lights: they have no size, so that no ray can hit them",
            "  note: s.json:3:88: /accelerator: the accelerator is ignored: it is chosen on the command line",
        ]
    );
}

#[test]
fn many_lights_are_cut_and_a_dark_scene_is_said_to_be() {
    let folder = Folder::new("info_many");
    let light = r#"{"type": "point", "position": [0, 0, 1], "intensity": 1}"#;
    folder.write("many.json", format!(r#"{{"camera": {{}}, "lights": [{}]}}"#, vec![light; 23].join(",")));
    let text = folder.ok(&["info", "many.json"]).stdout;
    assert!(text.contains("  lights       23\n") && text.contains("    … and 3 more\n"), "{text}");
    assert_eq!(text.matches("    point, power ").count(), 20);
    folder.write("dark.json", r#"{"camera": {}}"#);
    let text = folder.ok(&["info", "dark.json"]).stdout;
    assert!(text.contains("    all of the work: nothing in the scene shines\n"), "{text}");
    assert!(text.ends_with("  note: dark.json:1:12: /camera: nothing in the scene shines: the image will be black\n"));
}

#[test]
fn caustics_that_no_technique_finds_are_named() {
    const MISSING: &str = "caustics of point, spot and directional lights are missing where they are seen in mirrors or \
                           through smooth glass";
    let folder = Folder::new("info_missing");
    let (point, floor) = (
        r#"{"type": "point", "position": [0, 0, 1], "intensity": 1}"#,
        r#"{"type": "quad", "material": {"type": "lambertian", "albedo": 0.5}}"#,
    );
    let spot = r#"{"type": "spot", "position": [0, 0, 1], "at": [0, 0, 0], "intensity": 1, "inner_angle": 20,
                   "outer_angle": 30}"#;
    let sun = r#"{"type": "directional", "direction": [0, 0, -1], "irradiance": 1}"#;
    let lamp = r#"{"type": "disk", "material": {"type": "diffuse light", "emit": 1}}"#;
    let [mirror, glass] =
        ["mirror", "dielectric"].map(|kind| format!(r#"{{"type": "sphere", "material": {{"type": "{kind}"}}}}"#));
    for (lights, surfaces, missing) in [
        (point, [floor, &mirror].join(","), true),
        (spot, [floor, &glass].join(","), true),
        (sun, [floor, lamp, &mirror].join(","), true),
        // All light can be hit; no delta surface; nothing that a caustic would be seen on.
        ("", [floor, lamp, &mirror].join(","), false),
        (point, floor.to_owned(), false),
        (point, [lamp, &mirror].join(","), false),
    ] {
        folder.write("s.json", format!(r#"{{"camera": {{}}, "lights": [{lights}], "surfaces": [{surfaces}]}}"#));
        let text = folder.ok(&["info", "s.json"]).stdout;
        assert_eq!(text.ends_with(&format!("\n  note: {MISSING}\n")), missing, "{text}");
        let json: serde_json::Value = serde_json::from_str(&folder.ok(&["info", "s.json", "--json"]).stdout).unwrap();
        let notes = if missing { vec![MISSING] } else { vec![] };
        assert_eq!(json["notes"], serde_json::json!(notes), "{lights} {surfaces}");
    }
}

/// The words are for users: no names of the code's, and one line for each thing.
#[test]
fn what_is_skipped_is_said_in_words() {
    let folder = Folder::new("info_skipped");
    let scene = |lights: &str, surfaces: &str| {
        folder.write("s.json", format!(r#"{{"camera": {{}}, "lights": [{lights}], "surfaces": [{surfaces}]}}"#));
        let text = folder.ok(&["info", "s.json"]).stdout;
        let lines = text.split_once("  skipped\n").unwrap().1.lines();
        lines.map_while(|l| l.strip_prefix("    ")).map(str::to_owned).collect::<Vec<String>>()
    };
    let floor = r#"{"type": "quad", "material": {"type": "lambertian", "albedo": 0.5}}"#;
    let lamp = r#"{"type": "disk", "material": {"type": "diffuse light", "emit": 1}}"#;
    let point = r#"{"type": "point", "position": [0, 0, 1], "intensity": 1}"#;
    let windows = "looking through index-matched windows (`null` materials): there are none";
    assert_eq!(
        scene(point, floor),
        [
            "finding lights by chance (techniques 0,t): no light can be hit",
            "intersection with point and spot lights: they have no size, so that no ray can hit them",
            windows
        ]
    );
    assert_eq!(
        scene("", &[floor, lamp].join(",")),
        ["intersection with point and spot lights: there are none", windows]
    );
}

#[test]
fn failures_have_the_statuses_of_render() {
    let folder = Folder::new("info_failures");
    folder.write("bad.json", r#"{"camera": {"vfov": 180}}"#);
    folder.write("sheared.json", r#"{"camera": {"transform": {"y": [1, 1, 0]}}}"#);
    for (args, status, message) in [
        (&["info", "none.json"][..], 1, "twinlight: none.json: cannot read the scene file: No such file"),
        (&["info", "bad.json"], 65, "twinlight: bad.json:1:21: /camera/vfov: 180 is out of range"),
        (
            &["info", "sheared.json", "--json"],
            65,
            "twinlight: sheared.json:1:12: /camera: the camera's transform shears",
        ),
        (&["info"], 2, "error: the following required arguments were not provided"),
    ] {
        let outcome = folder.run(args);
        assert_eq!((outcome.status, outcome.stdout.as_str()), (Some(status), ""), "{outcome:?}");
        assert!(outcome.stderr.starts_with(message), "{outcome:?}");
    }
}

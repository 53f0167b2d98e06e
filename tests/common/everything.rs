//! A scene for tests that want all of the code to run.

use serde_json::{Value, json};
use twinlight::math::DVec3;

use super::{View, diffuse, facing, quad, scene_json, shining, sphere};

/// A bit of everything: two kinds of lights, glass, a mirror, diffuse surfaces, a cut-out blend; tiles that do not fill up.
pub fn everything() -> Value {
    let view = View {
        from: DVec3::new(0.2, 0.4, 2.6),
        at: DVec3::new(0.0, 0.1, 0.0),
        up: DVec3::Y,
        vfov: 50.0,
        resolution: [37, 21],
    };
    let blend = json!({ "type": "blend", "a": diffuse(0.8), "b": { "type": "mirror" }, "amount": 0.3 });
    let mut screen = quad(&facing(DVec3::new(-0.2, 0.3, 0.6), DVec3::Z), [0.5; 2], blend);
    screen["opacity"] = json!(0.6);
    scene_json(
        view.json(),
        vec![
            screen,
            quad(&facing(DVec3::new(0.0, -1.0, 0.0), DVec3::Y), [4.0; 2], diffuse(0.7)),
            quad(&facing(DVec3::new(0.0, 0.0, -1.5), DVec3::Z), [4.0; 2], diffuse(vec![0.7, 0.3, 0.2])),
            quad(&facing(DVec3::new(0.3, 1.5, 0.0), -DVec3::Y), [0.8; 2], shining(8.0)),
            sphere(DVec3::new(-0.5, -0.6, 0.2), 0.4, false, json!({ "type": "dielectric", "ior": 1.5 })),
            sphere(DVec3::new(0.6, -0.5, -0.4), 0.5, false, json!({ "type": "mirror", "albedo": 0.9 })),
        ],
        vec![
            json!({ "type": "point", "position": [-1.0, 1.0, 0.5], "intensity": 2.0 }),
            json!({
                "type": "spot", "position": [1.0, 1.2, 1.0], "at": [0, -1, 0], "intensity": 5.0,
                "inner_angle": 15, "outer_angle": 30
            }),
        ],
    )
}

//! Everything that is decided where a path arrives, in one room: every technique must see the same scene.

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::DVec3;
use twinlight::scene::desc::Heuristic;

use crate::common::{Bounds, Budget, assert_same, diffuse, facing, images, images_by_edges, quad, scene, settings};
use crate::gap_box;

/// A cut-out screen that also reflects, a bumpy, blended block and a wall with a map of its normals.
fn furniture() -> Vec<Value> {
    let checker =
        |scale: f64, even: Value, odd: Value| json!({ "type": "checker", "scale": scale, "even": even, "odd": odd });
    let mut screen = quad(
        &facing(DVec3::new(-0.2, 0.2, -0.2), DVec3::new(0.3, 0.6, 0.8)),
        [0.7, 0.5],
        json!({ "type": "lambertian", "albedo": checker(20.0, json!([0.9, 0.6, 0.1]), json!(0.3)), "two_sided": true }),
    );
    screen["opacity"] = checker(13.0, json!(0.8), json!(0.2));
    let blend = json!({ "type": "blend", "amount": checker(9.0, json!(0.3), json!(0.9)), "a": diffuse(0.2),
                        "b": { "type": "lambertian", "albedo": [0.2, 0.9, 0.5], "two_sided": true } });
    let mut bumpy =
        json!({ "type": "sphere", "radius": 0.25, "transform": { "translate": [0.3, -0.4, -0.3] }, "material": blend });
    bumpy["bump_map"] = json!({ "type": "marble", "scale": 12, "base": 0, "veins": 0.02 });
    let mut bent = quad(&facing(DVec3::new(0.0, -0.1, -0.7), DVec3::Z), [1.0; 2], diffuse(vec![0.8, 0.8, 0.4]));
    bent["normal_map"] = checker(8.0, json!([0.75, 0.4, 0.9]), json!([0.35, 0.65, 0.9]));
    vec![screen, bumpy, bent]
}

/// The ceiling shines; all integrators, and the heuristics, agree by length of path.
#[test]
fn integrators_agree_on_what_arrival_decides() {
    let scene = scene(&gap_box(furniture(), true, vec![]));
    let limited = |integrator| Settings { roulette: false, ..settings(integrator, 3) };
    let edges = 4;
    let reference = images_by_edges(&scene, limited(Integrator::Path), Budget::new(1 << 13, 701), edges);
    for (n, (settings, samples)) in [
        (limited(Integrator::Light), 1 << 14),
        (limited(Integrator::Bdpt), 1 << 12),
        (
            Settings { heuristic: Heuristic::Balance, light_paths: 2, connections: 2, ..limited(Integrator::Bdpt) },
            1 << 11,
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let found = images_by_edges(&scene, settings, Budget::new(samples, 702 + n as u64), edges);
        for k in 0..edges as usize {
            let what = format!("furniture, {:?}, {} edges", settings.integrator, k + 1);
            let bound = [0.015, 0.02, 0.03, 0.06][k];
            assert_same(&what, &found[k], &reference[k], Bounds::new([2, 2], 3.0 * bound, bound));
        }
    }
}

/// A surface of opacity 0 is not there, and counts for nothing: not for bounces, not for connections.
#[test]
fn what_is_clear_is_not_there() {
    let plain = scene(&gap_box(vec![], true, vec![]));
    let mut clear = quad(&facing(DVec3::new(0.0, 0.3, 0.0), DVec3::new(0.1, 1.0, 0.2)), [4.0; 2], diffuse(0.5));
    clear["opacity"] = json!(0.0);
    let with = scene(&gap_box(vec![clear], true, vec![]));
    for integrator in [Integrator::Path, Integrator::Light, Integrator::Bdpt] {
        let limited = Settings { roulette: false, ..settings(integrator, 1) };
        // The same random numbers; only rounding of the points where rays go on.
        let (a, b) = (images(&plain, limited, Budget::new(256, 710)), images(&with, limited, Budget::new(256, 710)));
        for (a, b) in a.iter().zip(&b) {
            for (p, q) in a.rgb.iter().zip(&b.rgb) {
                assert!((0..3).all(|c| (p[c] - q[c]).abs() <= 2e-3 * p[c].max(1e-3)), "{integrator:?}: {p:?} {q:?}");
            }
        }
    }
}

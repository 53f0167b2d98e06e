//! `twinlight stress`: its cases hold, and it tells where one does not.

use serde_json::json;
use twinlight::stress::{Case, Expected, Report, cases, run};

/// The samples per pixel and seed of `stress --quick`.
const QUICK: u32 = 4;

fn assert_holds(report: &Report) {
    let failed: Vec<String> = report.rows.iter().filter(|r| !r.faults.is_empty()).map(|r| r.line()).collect();
    assert!(failed.is_empty(), "{} of {} rows:\n{}", failed.len(), report.rows.len(), failed.join("\n"));
}

#[test]
fn cheap_cases_hold() {
    let cheap: Vec<Case> = cases(false).into_iter().filter(|c| c.effort == 1 && c.bounces <= 12).collect();
    assert!(cheap.len() > 30, "{}", cheap.len());
    let report = run(&cheap, QUICK, &mut |_| {});
    assert!(report.rows.len() >= 2 * cheap.len());
    assert_holds(&report);
}

#[test]
#[ignore = "deep"]
fn all_cases_hold() {
    assert_holds(&run(&cases(true), 4 * QUICK, &mut |row| println!("{}", row.line())));
}

/// A box that is open to the back, lit by a lamp.
fn room(radiance: f64) -> serde_json::Value {
    let wall = |turn: f64, center: [f64; 3]| {
        json!({ "type": "quad", "size": 2, "material": { "type": "lambertian", "albedo": 0.5, "two_sided": true },
                "transform": [{ "axis": [1, 0, 0], "angle": turn }, { "translate": center }] })
    };
    let lamp = json!({ "type": "quad", "size": 0.5, "material": { "type": "diffuse light", "emit": radiance },
                       "transform": [{ "axis": [1, 0, 0], "angle": 90 }, { "translate": [0, 0.9, 0] }] });
    json!({
        "camera": { "transform": { "from": [0, 0, 3], "at": [0, 0, 0] }, "resolution": [4, 4], "vfov": 30 },
        "surfaces": [wall(-90.0, [0.0, -1.0, 0.0]), wall(90.0, [0.0, 1.0, 0.0]), wall(0.0, [0.0, 0.0, -1.0]), lamp]
    })
}

/// What each verdict must find.
#[test]
fn what_is_wrong_is_told() {
    let same = |times: f64| Expected::SameAs { scene: room(1.0), times };
    let bits = |times: f64| Expected::SameBits { scene: room(1.0), times };
    let bad = json!({ "camera": {}, "surfaces": [{ "type": "quad", "material": "none" }] });
    for (case, fault) in [
        (Case::new("as it is", "", room(1.0), bits(1.0)), ""),
        (Case::new("twice as bright", "", room(2.0), bits(2.0)), ""),
        (Case::new("brighter", "", room(1.05), same(1.0)), "energy"),
        (Case::new("not the same bits", "", room(1.000_001), bits(1.0)), "not the same bits"),
        (Case::new("light", "", room(1.0), Expected::Nothing), "light where there is none"),
        (Case::new("mean", "", room(1.0), Expected::Mean(1e3)), "energy"),
        (Case::new("a little brighter", "", room(1.001), same(1.0)), "energy differs"),
        (Case::new("so it is said", "", room(1.001), same(1.0)).apart(1.1e-3, "it is brighter"), ""),
        (Case::new("open", "", room(1.0), same(1.0)).closed(), "leave the closed room"),
        (Case::new("bad", "", bad, Expected::Nothing), "material"),
    ] {
        let report = run(std::slice::from_ref(&case), QUICK, &mut |_| {});
        for row in &report.rows {
            let told = row.verdict();
            let as_wanted = if fault.is_empty() { told == "ok" } else { told.contains(fault) };
            assert!(as_wanted, "{}, {}, {}: {told}", case.name, row.integrator, row.accelerator);
        }
        assert_eq!(report.failures() > 0, !fault.is_empty(), "{}", case.name);
    }
}

//! `render --explain`: what `auto` has decided and why, in words and numbers; and the same for the statistics.

use std::fmt::Write;

use serde_json::{Value, json};

use super::figures;
use crate::integrator::auto::{Lane, PILOT, Plan, SCOUT};
use crate::integrator::{Integrator, LENGTHS, Settings};
use crate::scene::SceneNeeds;

/// A lane in words.
pub fn lane(lane: &Lane) -> String {
    let paths = match lane.light_paths {
        0 => return "path tracing, no light subpaths".to_owned(),
        1 => "1 light subpath".to_owned(),
        n => format!("{n} light subpaths"),
    };
    let every = match lane.one_in {
        1 => "each sample".to_owned(),
        n => format!("one sample in {n}"),
    };
    let connected = match lane.connections {
        0 => "not connected",
        1 if lane.light_paths == 1 => "connected",
        1 => "1 of them connected",
        _ => "connected",
    };
    format!("{paths} for {every}, {connected}")
}

/// The page.
pub fn page(settings: &Settings, plan: Option<&Plan>, needs: &SceneNeeds) -> String {
    let mut out = String::from("skipped, for nothing could come of it:\n");
    for line in needs.skipped() {
        let _ = writeln!(out, "  {line}");
    }
    let Some(plan) = plan else {
        let why = match settings.integrator {
            Integrator::Auto => format!("auto chooses after {PILOT} samples of each pixel, by bdpt"),
            other => format!("{} was asked for", super::settings::name(other)),
        };
        let _ = writeln!(out, "nothing was chosen: {why}");
        return out;
    };
    if let Some(why) = plan.exact {
        let _ = writeln!(out, "auto: {}, from the first sample on: {why}", lane(&plan.lane));
        return out;
    }
    let _ = writeln!(
        out,
        "auto: samples 0 to {} of each pixel are a pilot: bdpt, and part of the image. From those after the first {SCOUT}:\n  \
         variance of one sample over brightness² (mean over pixels), its cost in visibility rays, their product",
        PILOT - 1
    );
    for f in &plan.findings {
        let mark = if f.lane == plan.lane { "→" } else { " " };
        let _ = writeln!(
            out,
            "{mark} {:>9} {:>7.1} {:>9}  {}",
            figures(f.variance),
            f.cost,
            figures(f.variance * f.cost),
            lane(&f.lane)
        );
    }
    if plan.findings.iter().any(|f| f.variance.is_infinite()) {
        out.push_str("  (inf: what mirrors and smooth glass throw might be found too seldom by it, or never)\n");
    }
    let trust = (1..=LENGTHS as u32).map(|edges| figures(plan.survey.splat_confidence.on(edges)));
    let _ = writeln!(
        out,
        "splats count for so many times their number in the weights of paths of 1, 2, … edges: {}",
        trust.collect::<Vec<_>>().join(", ")
    );
    let _ = match plan.thresholds {
        Some(_) => writeln!(
            out,
            "visibility rays that could add less than {} of a pixel's brightness are traced by roulette",
            figures(plan.delta)
        ),
        None => writeln!(out, "every visibility ray is traced"),
    };
    out
}

/// The same for `--stats`.
pub fn json(plan: &Plan) -> Value {
    let counts =
        |lane: &Lane| json!({"light_paths": lane.light_paths, "connections": lane.connections, "one_in": lane.one_in});
    let findings = plan.findings.iter().map(|f| {
        let finite = |x: f64| x.is_finite().then_some(x);
        json!({"lane": counts(&f.lane), "variance": finite(f.variance), "cost": f.cost})
    });
    let trust = (1..=LENGTHS as u32).map(|edges| plan.survey.splat_confidence.on(edges));
    json!({
        "lane": counts(&plan.lane),
        "exact": plan.exact,
        "findings": findings.collect::<Vec<_>>(),
        "splat_confidence": trust.collect::<Vec<_>>(),
        "ray_roulette": plan.thresholds.as_ref().map(|_| plan.delta),
    })
}

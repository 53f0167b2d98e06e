//! The command line over the scene file: what is rendered in the end, and which options could not have been meant.
//!
//! An option that can do nothing is refused where the command line alone shows that its user expects something of it,
//! and noted where another's decision (the scene file's) or the mathematics makes it idle.

use super::Failure;
use super::args::{RenderArgs, Size};
use crate::integrator::{Integrator, PathClass, Settings, SplatConfidence, Technique};
use crate::light::Light;
use crate::scene::Prepared;
use crate::scene::desc::{Heuristic, IntegratorKind, SceneDesc};

/// Longest paths of a pyramid, in edges, where the command line names none.
const PYRAMID_EDGES: u32 = 6;

/// The command line overrides what the file says.
pub fn override_desc(desc: &mut SceneDesc, args: &RenderArgs) {
    if let Some(Size(size)) = args.size {
        desc.camera.resolution = size;
    }
    if let Some(spp) = args.spp {
        desc.samples = spp;
    }
    if let Some(seed) = args.seed {
        desc.sampler.seed = seed;
    }
    if let Some(sampler) = args.sampler {
        desc.sampler.kind = sampler.into();
    }
    if let Some(integrator) = args.integrator {
        desc.integrator.kind = integrator.into();
    }
    if let Some(bounces) = args.max_bounces {
        desc.integrator.max_bounces = bounces;
    }
    if let Some(heuristic) = args.heuristic {
        desc.integrator.heuristic = heuristic.into();
    }
    if args.no_roulette {
        desc.integrator.russian_roulette = false;
    }
}

/// An integrator's name on the command line.
pub fn name(integrator: Integrator) -> &'static str {
    match integrator {
        Integrator::Path => "path",
        Integrator::Light => "light",
        Integrator::Bdpt => "bdpt",
        Integrator::Auto => "auto",
    }
}

/// Longest paths of the pyramid, in edges, if one is asked for.
pub fn pyramid_edges(args: &RenderArgs) -> Option<u32> {
    args.pyramid.is_some().then(|| args.pyramid_edges.unwrap_or(PYRAMID_EDGES))
}

/// What to render by, from a description that the command line has overridden already.
///
/// # Errors
/// Options that contradict each other, that the integrator has no use for, or that leave it nothing to do.
pub fn settings(desc: &SceneDesc, args: &RenderArgs) -> Result<Settings, Failure> {
    let integrator = match integrator(desc) {
        // Whoever asks for subpaths or techniques by number asks for the estimator that has them all.
        Integrator::Auto if args.light_paths.or(args.connections).is_some() || args.technique.is_some() => {
            Integrator::Bdpt
        }
        other => other,
    };
    check_subpaths(integrator, args)?;
    // What is not done is told as 0, in the metadata too.
    let (light_paths, connections) = usual_subpaths(integrator);
    let light_paths = args.light_paths.unwrap_or(light_paths);
    let settings = Settings {
        integrator,
        max_bounces: desc.integrator.max_bounces,
        roulette: desc.integrator.russian_roulette,
        roulette_after: args.roulette_after,
        heuristic: desc.integrator.heuristic,
        light_paths,
        connections: args.connections.unwrap_or(connections).min(light_paths),
        light_one_in: 1,
        splat_confidence: SplatConfidence::default(),
        sampler: desc.sampler.kind,
        seed: desc.sampler.seed,
        weighted: !args.unweighted,
        only: args.technique.map(|t| t.0),
        class: PathClass::default(),
    };
    match settings.only {
        Some(t) => check_technique(t, &settings).map(|()| settings),
        None => Ok(settings),
    }
}

/// What the scene, or the command line over it, renders by.
pub fn integrator(desc: &SceneDesc) -> Integrator {
    integrator_of(desc.integrator.kind)
}

/// What renders when this is asked for.
pub fn integrator_of(kind: IntegratorKind) -> Integrator {
    match kind {
        IntegratorKind::Auto => Integrator::Auto,
        IntegratorKind::Bdpt => Integrator::Bdpt,
        IntegratorKind::Path => Integrator::Path,
        IntegratorKind::Light => Integrator::Light,
    }
}

/// Light subpaths per sample, and how many of them are connected, unless told otherwise.
pub fn usual_subpaths(integrator: Integrator) -> (u32, u32) {
    match integrator {
        Integrator::Path => (0, 0),
        Integrator::Light => (1, 0),
        Integrator::Bdpt | Integrator::Auto => (1, 1),
    }
}

/// The numbers of light subpaths and of connections, against the integrator and each other.
fn check_subpaths(integrator: Integrator, args: &RenderArgs) -> Result<(), Failure> {
    let refuse = |why: String| Err(Failure::usage(why));
    match (integrator, args.light_paths, args.connections) {
        (Integrator::Path, Some(n), _) => {
            refuse(format!("--light-paths {n}: the path integrator traces no light subpaths; use --integrator bdpt"))
        }
        (Integrator::Path | Integrator::Light, _, Some(n)) => {
            let name = name(integrator);
            refuse(format!("--connections {n}: the {name} integrator connects no subpaths; use --integrator bdpt"))
        }
        (Integrator::Light, Some(0), _) => {
            refuse("--light-paths 0 leaves the light tracer nothing to do: give at least 1".to_owned())
        }
        (Integrator::Bdpt, Some(paths), Some(n)) if n > paths => refuse(format!(
            "--connections {n} is more than --light-paths {paths}: a camera vertex connects to each light subpath once \
             at most; give --light-paths {n} or more"
        )),
        (Integrator::Bdpt, None, Some(n)) if n > 1 => refuse(format!(
            "--connections {n} is more than the one light subpath of each sample; give --light-paths {n} or more"
        )),
        _ => Ok(()),
    }
}

/// A technique that the settings leave no path to would give a black image without a word.
fn check_technique(t: Technique, settings: &Settings) -> Result<(), Failure> {
    let impossible = |why: String| Err(Failure::usage(format!("--technique {},{}: {why}", t.s, t.t)));
    let makes = match settings.integrator {
        Integrator::Path => t.s <= 1 && t.t >= 2,
        Integrator::Light => t.t == 1,
        Integrator::Bdpt | Integrator::Auto => true,
    };
    if !makes {
        let integrator = name(settings.integrator);
        return impossible(format!("the {integrator} integrator has no such technique; use bdpt"));
    }
    // A path of s + t vertices scatters at all but its two ends.
    let events = u64::from(t.s) + u64::from(t.t) - 2;
    let max_bounces = settings.max_bounces;
    if events > u64::from(max_bounces) {
        return impossible(format!(
            "its paths scatter {events} times and max_bounces is {max_bounces}; give --max-bounces {events} or more"
        ));
    }
    if settings.light_paths == 0 && (t.t == 1 || t.s >= 2) {
        return impossible("it takes light subpaths; give --light-paths 1 or more".into());
    }
    if settings.connections == 0 && t.s >= 2 && t.t >= 2 {
        return impossible("it takes connections; give --connections 1 or more".into());
    }
    Ok(())
}

/// Options that were given and change nothing, though nobody need be mistaken.
pub fn idle_options(settings: &Settings, args: &RenderArgs) -> Vec<String> {
    let mut notes = Vec::new();
    if settings.integrator == Integrator::Light {
        let why = "the light integrator has one technique for each path, whose weight is 1";
        for (given, option) in [(args.heuristic.is_some(), "--heuristic"), (args.unweighted, "--unweighted")] {
            if given {
                notes.push(format!("{option} changes nothing: {why}"));
            }
        }
    }
    if args.roulette_after.is_some() && !settings.roulette {
        notes.push("--roulette-after changes nothing: the scene turns roulette off".to_owned());
    }
    // A path of n edges scatters n − 1 times.
    let longest = settings.max_bounces.saturating_add(1);
    if let Some(edges) = args.pyramid_edges.filter(|edges| *edges > longest) {
        notes.push(format!(
            "--pyramid-edges {edges} is more than paths can have: max_bounces {} ends them at {longest}",
            settings.max_bounces
        ));
    }
    notes
}

/// Why a technique rendered alone finds nothing in a scene, if that can be told beforehand. A dark scene has a warning of
/// its own.
pub fn black_technique(settings: &Settings, prepared: &Prepared) -> Option<String> {
    let t = settings.only.filter(|_| prepared.needs.light)?;
    let has_area = |light: &Light| !light.is_delta() && !light.is_infinite();
    let why = match (t.s, t.t) {
        (0, _) if !prepared.needs.emitter_hits => {
            "paths can hit no light by chance: all are point, spot or directional lights"
        }
        (1, 1) => {
            if prepared.lights.iter().any(has_area) {
                return None;
            }
            "no light is a surface, which alone could be connected to the camera"
        }
        (1.., _) if !prepared.needs.connections => {
            "no surface can be connected to: all are mirrors, smooth glass or reflect nothing"
        }
        _ => return None,
    };
    Some(format!("--technique {},{}: the image will be black: {why}", t.s, t.t))
}

/// What is missing from the image because the integrator, with so many light subpaths, has no technique that finds it.
pub fn missing(integrator: Integrator, light_paths: u32, prepared: &Prepared) -> Vec<&'static str> {
    let needs = &prepared.needs;
    let caustics = needs.delta_lights && needs.delta_surfaces && needs.connections;
    match integrator {
        _ if !needs.light => Vec::new(),
        Integrator::Light => {
            let sky = |l: &Light| l.is_infinite() && !l.is_delta();
            let mut out = Vec::new();
            if needs.delta_surfaces {
                out.push(
                    "what is seen in mirrors or through smooth glass is missing: light subpaths cannot be joined to the \
                     camera there; use bdpt",
                );
            }
            if needs.windows {
                out.push(
                    "what is seen through windows (`null`) is missing: they block connections to the camera; use bdpt",
                );
            }
            if prepared.lights.iter().any(sky) {
                out.push("the sky itself is missing: the light integrator finds only what it lights; use bdpt");
            }
            out
        }
        Integrator::Path | Integrator::Bdpt if light_paths == 0 && caustics => vec![
            "caustics of point, spot and directional lights are missing: only light subpaths find them; use bdpt, which finds \
             those that are not seen in mirrors or through smooth glass",
        ],
        Integrator::Path => Vec::new(),
        Integrator::Bdpt | Integrator::Auto => needs.missing(),
    }
}

/// What makes the render another than a plain one, in words for the first line.
pub fn departures(settings: &Settings) -> Vec<String> {
    let Settings { integrator, only, weighted, heuristic, light_paths, connections, .. } = *settings;
    let mut parts = Vec::new();
    if let Some(t) = only {
        parts.push(format!("technique {},{} alone, {}", t.s, t.t, if weighted { "weighted" } else { "unweighted" }));
    }
    // What has no alternatives has no weights.
    if weighted && integrator != Integrator::Light && heuristic != Heuristic::Power {
        parts.push(format!("{heuristic:?} heuristic").to_lowercase());
    }
    if settings.max_bounces == 0 {
        parts.push("emitted light only".to_owned());
    }
    if (light_paths, connections) != usual_subpaths(integrator) {
        let paths = match light_paths {
            0 => "no light subpaths".to_owned(),
            n => super::count(n as usize, "light subpath per sample", "light subpaths per sample"),
        };
        let connected = integrator == Integrator::Bdpt && light_paths > 0;
        parts.push(if connected { format!("{paths} ({connections} connected)") } else { paths });
    }
    if !settings.roulette {
        parts.push("no roulette".to_owned());
    }
    parts
}

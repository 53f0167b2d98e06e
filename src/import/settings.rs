//! Integrator, sampler, sample count, and the parts of dirt's files that are read and ignored.

use super::context::{Context, Keys, Object};
use super::json::{Kind, Node};
use crate::scene::desc::{Heuristic, IntegratorDesc, IntegratorKind, SamplerDesc, SamplerKind};

/// Samples per pixel when the file names none.
const DEFAULT_SAMPLES: u32 = 64;

/// Most scattering events a file may ask for: more than any path survives, small enough for every counter.
const MAX_BOUNCES: u64 = 1_000_000;

/// Every integrator name that is read.
const INTEGRATORS: &[&str] = &[
    "auto",
    "bdpt",
    "path",
    "light",
    "path_tracer_mis",
    "path_tracer_nee",
    "path_tracer_mats",
    "path_tracer_mixture",
    "path_tracer_simple",
];

impl<'a> Context<'a> {
    /// The integrator and its limits.
    pub fn integrator(&mut self, scene: &Object<'a>) -> Option<IntegratorDesc> {
        let default = IntegratorDesc::default();
        let Some(node) = scene.get("integrator") else { return Some(default) };
        if node.kind() == Kind::String {
            return Some(IntegratorDesc { kind: self.integrator_kind(node)?, ..default });
        }
        let object = self.object(node, "an object or a string")?;
        let kind = object.get("type").map_or(Some(default.kind), |n| self.integrator_kind(n));
        self.check_keys(&object, &Keys::only(&["type", "max_bounces", "russian_roulette", "heuristic"]));
        let max_bounces =
            object.get("max_bounces").map_or(Some(default.max_bounces), |n| self.small_integer(n, 0, MAX_BOUNCES));
        let russian_roulette =
            object.get("russian_roulette").map_or(Some(default.russian_roulette), |n| self.boolean(n));
        let heuristic = object.get("heuristic").map_or(Some(default.heuristic), |n| {
            Some(match self.choice(n, "heuristic", &["power", "balance", "uniform"], &[])? {
                "balance" => Heuristic::Balance,
                "uniform" => Heuristic::Uniform,
                _ => Heuristic::Power,
            })
        });
        Some(IntegratorDesc {
            kind: kind?,
            max_bounces: max_bounces?,
            russian_roulette: russian_roulette?,
            heuristic: heuristic?,
        })
    }

    fn integrator_kind(&mut self, node: &Node<'a>) -> Option<IntegratorKind> {
        if let name @ ("\"normals\"" | "\"ao\"") = node.text {
            let aov = if name == "\"ao\"" { "depth" } else { "shading normal" };
            let message = format!(
                "{name} is no integrator here: auxiliary images (AOVs), such as the {aov}, come beside the picture (--aovs); \
                 allowed: {}",
                super::context::list(INTEGRATORS)
            );
            self.error(node, message);
            return None;
        }
        Some(match self.choice(node, "integrator", INTEGRATORS, &[])? {
            "auto" => IntegratorKind::Auto,
            "bdpt" => IntegratorKind::Bdpt,
            "path" => IntegratorKind::Path,
            "light" => IntegratorKind::Light,
            dirt => {
                self.note(node, &format!("the integrator {dirt:?} is read as \"path\""));
                IntegratorKind::Path
            }
        })
    }

    /// The sampler, and the samples per pixel that it or the scene asks for.
    pub fn sampler(&mut self, scene: &Object<'a>) -> Option<(SamplerDesc, u32)> {
        let default = SamplerDesc::default();
        let image_samples = scene.get("image_samples").map(|n| (n, self.sample_count(n)));
        let mut sampler = Some(default);
        let mut own_samples = None;
        if let Some(node) = scene.get("sampler") {
            let object = self.object(node, "an object")?;
            let kind = object.get("type").map_or(Some(default.kind), |n| self.sampler_kind(n));
            self.check_keys(&object, &Keys::only(&["type", "samples", "seed"]));
            own_samples = object.get("samples").map(|n| self.sample_count(n));
            let seed = object.get("seed").map_or(Some(default.seed), |n| self.integer(n, 0, u64::MAX));
            sampler = kind.zip(seed).map(|(kind, seed)| SamplerDesc { kind, seed });
        }
        let samples = match (own_samples, image_samples) {
            (Some(own), Some((node, image))) => {
                if own? != image? {
                    let message = format!("image_samples {} is overruled by the sampler's samples", node.text);
                    self.note(node, &message);
                }
                own
            }
            (Some(own), None) => own,
            (None, Some((_, image))) => image,
            (None, None) => Some(DEFAULT_SAMPLES),
        };
        Some((sampler?, samples?))
    }

    fn sampler_kind(&mut self, node: &Node<'a>) -> Option<SamplerKind> {
        const SAMPLERS: &[&str] = &["sobol", "independent", "stratified", "halton"];
        Some(match self.choice(node, "sampler", SAMPLERS, &[])? {
            "sobol" => SamplerKind::Sobol,
            "independent" => SamplerKind::Independent,
            dirt => {
                self.note(node, &format!("the sampler {dirt:?} is read as \"sobol\""));
                SamplerKind::Sobol
            }
        })
    }

    fn sample_count(&mut self, node: &Node<'a>) -> Option<u32> {
        self.small_integer(node, 1, u64::from(u32::MAX))
    }

    fn small_integer(&mut self, node: &Node<'a>, least: u64, most: u64) -> Option<u32> {
        self.integer(node, least, most).and_then(|x| u32::try_from(x).ok())
    }

    /// What is read and ignored, with a note.
    pub fn ignored(&mut self, scene: &Object<'a>) {
        if let Some(node) = scene.get("accelerator") {
            self.note(node, "the accelerator is ignored: it is chosen on the command line");
        }
        if let Some(node) = scene.get("media") {
            if self.array(node, "an array").is_some_and(|media| !media.is_empty()) {
                self.note(node, "the media are ignored: nothing may use them (participating media are not supported)");
            }
        }
    }
}

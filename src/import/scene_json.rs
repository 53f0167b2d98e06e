//! The native scene format: JSON text → [`SceneDesc`].
//!
//! A superset of the `dirt` teaching renderer's files. Each part of a scene has its reader in a module of its own; all
//! of them report what they find to one [`Context`] and carry on, so that a file's mistakes are shown together.

use std::path::Path;

use super::context::{Context, Keys, Object};
use super::fingerprint::fingerprint;
use super::json::Document;
use crate::scene::desc::{SceneDesc, SceneError};

const KEYS: Keys = Keys {
    allowed: &[
        "camera",
        "integrator",
        "sampler",
        "image_samples",
        "background",
        "textures",
        "materials",
        "surfaces",
        "lights",
    ],
    idle: &["accelerator", "media"],
    later: &[],
};

/// Reads a scene from JSON text; see [`super::scene_from_str`] and, for the limit, [`super::load_scene_within`].
pub(super) fn read(text: &str, file: &str, base_dir: &Path, memory: u64) -> Result<SceneDesc, SceneError> {
    let (document, root) = Document::parse(text, file).map_err(|d| SceneError { diagnostics: vec![d] })?;
    let root_place = document.place(root.offset, "");
    let mut context = Context::new(document, base_dir, memory);
    let scene = context.object(&root, "an object with a \"camera\"").and_then(|root| read_scene(&mut context, &root));
    let notes = context.finish()?;
    // Without diagnostics every part is there; saying so beats trusting it.
    let scene = scene.ok_or_else(|| SceneError::one(root_place, "the scene is incomplete"))?;
    let fingerprint = fingerprint(text, &scene);
    Ok(SceneDesc { notes, fingerprint, ..scene })
}

fn read_scene<'a>(context: &mut Context<'a>, root: &Object<'a>) -> Option<SceneDesc> {
    context.check_keys(root, &KEYS);
    let camera = context.camera(root);
    let integrator = context.integrator(root);
    let sampler = context.sampler(root);
    let mut infinite_lights = Vec::new();
    infinite_lights.extend(context.background(root));
    context.ignored(root);
    context.named_textures(root);
    let mut materials = context.materials(root);
    let mut surfaces = context.surfaces(root, &mut materials);
    context.lights(root, &mut materials, &mut surfaces, &mut infinite_lights);
    let (sampler, samples) = sampler?;
    Some(SceneDesc {
        camera: camera?,
        integrator: integrator?,
        sampler,
        samples,
        materials: materials.into_all()?,
        textures: std::mem::take(&mut context.textures).into_list(),
        surfaces,
        infinite_lights,
        notes: Vec::new(),
        fingerprint: 0,
    })
}

//! What must hold for any bytes: each target is a function that panics where it does not. libFuzzer calls them with bytes
//! of its own (`tests/fuzz/bins`), `tests/corpus.rs` with those that are kept in `tests/fuzz/corpus`.
#![allow(dead_code)] // Each of libFuzzer's programs has one target.

mod files;
mod generator;
mod materials;
mod scenes;

pub use files::{image, obj, ply, scene_json};
pub use scenes::scenes;

/// A target, and what it is called.
pub type Target = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: &[Target] =
    &[("scene_json", scene_json), ("obj", obj), ("ply", ply), ("image", image), ("scenes", scenes)];

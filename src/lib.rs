//! Twinlight: bidirectional path tracing with multiple importance sampling on the CPU.
//!
//! `ARCHITECTURE.md` is the map. A module imports only from those listed before it:
//! planted → math, pdf → sampling → geometry → texture → {accel, bsdf, light, camera, film} → scene → integrator → render → {stress, bench} → cli.

#[allow(unsafe_code)] // The one place that talks to Embree; every block there says why it is sound.
pub mod accel;
pub mod bench;
pub mod bsdf;
pub mod camera;
pub mod cli;
pub mod compare;
pub mod decode;
pub mod film;
pub mod geometry;
pub mod import;
pub mod integrator;
pub mod light;
pub mod math;
pub mod output;
pub mod pdf;
pub mod planted;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod stress;
pub mod texture;

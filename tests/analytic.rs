//! The integrators against closed forms: what a scene's radiance is known to be, they must find.
//!
//! Every expected value is computed in f64 and, where it varies, integrated over the pixel. See `common` for what
//! an assertion demands.

mod common;

#[path = "analytic/area_lights.rs"]
mod area_lights;
#[path = "analytic/cameras.rs"]
mod cameras;
#[path = "analytic/delta_lights.rs"]
mod delta_lights;
#[path = "analytic/enclosures.rs"]
mod enclosures;
#[path = "analytic/infinite_lights.rs"]
mod infinite_lights;
#[path = "analytic/many_lights.rs"]
mod many_lights;
#[path = "analytic/specular.rs"]
mod specular;
#[path = "analytic/textures.rs"]
mod textures;
#[path = "analytic/uniform_wall.rs"]
mod uniform_wall;

//! The camera of a scene as written, in render space.

use super::desc::{CameraDesc, FilterKind, Projection, SceneError};
use crate::camera::{Camera, Filter, ThinLens};
use crate::geometry::Geometry;
use crate::math::{DAffine3, DMat3, DVec3};

/// The camera in render space; `near` is the spread of what it is among.
pub(super) fn camera(desc: &CameraDesc, to_render: &DAffine3, near: f64) -> Result<Camera, SceneError> {
    let [width, height] = desc.resolution;
    let m = to_render.matrix3;
    let [sx, sy, sz] = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length);
    // The scene is about as large as 1, and what is near about as `near`: lengths far from both are mistakes, and leave f32.
    let least = (1024.0 * near).min(1.0) / LARGEST_LENGTH;
    let fits = |what: &str, size: f64, scale: f64, least: f64| {
        let scaled = size * scale;
        if (least..=LARGEST_LENGTH).contains(&scaled) {
            return Ok(());
        }
        let message = format!(
            "the camera's {what} {size} does not suit the size of the scene; allowed: {:e} to {:e}",
            least / scale,
            LARGEST_LENGTH / scale
        );
        Err(SceneError::one(desc.at.clone(), message))
    };
    let camera = match desc.projection {
        Projection::Perspective { vfov, aperture: 0.0, .. } => Camera::pinhole(to_render, vfov, width, height),
        Projection::Perspective { vfov, fdist, aperture } => {
            fits("fdist", fdist, sz, least)?;
            fits("aperture", aperture, sx.max(sy), 0.0)?;
            Camera::thin_lens(to_render, vfov, ThinLens { radius: aperture, focus: fdist }, width, height)
        }
        Projection::Orthographic { height: film } => {
            fits("height", film, sy, least)?;
            fits("width", film * f64::from(width) / f64::from(height), sx, least)?;
            Camera::orthographic(to_render, film, width, height)
        }
    };
    let radius = desc.filter.radius;
    Ok(camera.with_filter(match desc.filter.kind {
        FilterKind::Box => Filter::boxed(radius),
        FilterKind::Tent => Filter::Tent(radius as f32),
        FilterKind::Gaussian => Filter::Gaussian(radius as f32),
    }))
}

/// The largest length of a camera in render units, and the inverse of the smallest.
const LARGEST_LENGTH: f64 = 1e6;

/// Whether the axes of a map are not at right angles to each other (to 1e-4 of their lengths).
pub(super) fn shears(m: &DMat3) -> bool {
    let skew = |a: DVec3, b: DVec3| a.dot(b).abs() > 1e-4 * a.length() * b.length();
    skew(m.x_axis, m.y_axis) || skew(m.y_axis, m.z_axis) || skew(m.z_axis, m.x_axis)
}

/// How far from a delta point a ray that is aimed at it may start.
pub(super) fn reach(camera: &Camera, geometry: &Geometry) -> f32 {
    let mut farthest = camera.farthest_origin().max(1.0);
    for point in &geometry.delta_points {
        farthest = farthest.max(point.position.abs().max_element());
    }
    // The diagonal of the box of that half extent.
    2.0 * 3.0_f32.sqrt() * farthest
}

//! The pinhole camera in f64, for expected values integrated over pixels.

use serde_json::{Value, json};
use twinlight::math::{DAffine3, DVec3};

use super::point;

/// A camera as the scene file describes it, and where its rays go.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// The pinhole.
    pub from: DVec3,
    /// What it looks at.
    pub at: DVec3,
    /// Up.
    pub up: DVec3,
    /// Vertical angle of view, degrees.
    pub vfov: f64,
    /// Width and height in pixels.
    pub resolution: [u32; 2],
}

impl View {
    /// The camera of the scene file.
    pub fn json(&self) -> Value {
        json!({
            "transform": { "from": point(self.from), "at": point(self.at), "up": point(self.up) },
            "vfov": self.vfov,
            "resolution": self.resolution
        })
    }

    /// The same view carried along by a rigid motion of the scene.
    pub fn moved(&self, pose: &DAffine3) -> Self {
        Self {
            from: pose.transform_point3(self.from),
            at: pose.transform_point3(self.at),
            up: pose.transform_vector3(self.up),
            ..*self
        }
    }

    /// The film at unit distance: its top left corner from the pinhole, and a pixel's steps to the right and down.
    fn film(&self) -> (DVec3, DVec3, DVec3) {
        let back = (self.from - self.at).normalize();
        let right = self.up.cross(back).normalize();
        let up = back.cross(right);
        let [w, h] = self.resolution.map(f64::from);
        let half_height = (0.5 * self.vfov.to_radians()).tan();
        let half_width = half_height * w / h;
        (up * half_height - right * half_width - back, right * (2.0 * half_width / w), up * (-2.0 * half_height / h))
    }

    /// Means of a radiance over the tiles of a grid of `grid` columns and rows, by the midpoint rule with `n × n`
    /// points per pixel. `radiance` takes a ray's direction from the pinhole.
    pub fn tile_means(&self, grid: [u32; 2], n: u32, radiance: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let [w, h] = self.resolution;
        let [columns, rows] = grid;
        assert!(w % columns == 0 && h % rows == 0, "tiles of unequal size");
        let (tw, th) = (w / columns * n, h / rows * n);
        let (corner, right, down) = self.film();
        let mut means = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let mut sum = 0.0;
                for y in 0..th {
                    for x in 0..tw {
                        let at = |first: u32, i: u32| (f64::from(first + i) + 0.5) / f64::from(n);
                        let d = corner + right * at(column * tw, x) + down * at(row * th, y);
                        sum += radiance(d.normalize());
                    }
                }
                means.push(sum / f64::from(tw * th));
            }
        }
        means
    }
}

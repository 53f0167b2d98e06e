//! The pinhole camera: rays for camera subpaths, importance for light subpaths.
//!
//! A pixel's value is the mean radiance over its area on the film, so the density of a camera ray is counted per
//! pixel: uniform over the pixel, `p_ω = 1/(A_pixel cos³θ)` for directions that pass it [PBRT4 (5.2.1)], and the
//! importance that makes light tracing land on the same value is `We = p_ω / cosθ`.

use crate::math::{DAffine3, DVec3, Ray, Vec3};
use crate::pdf::SolidAnglePdf;

/// A pinhole camera in render space.
#[derive(Clone, Debug)]
pub struct Camera {
    position: Vec3,
    /// Unit axes: right, up, forward.
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Half extents of the film at unit distance.
    half_width: f32,
    half_height: f32,
    /// Full image size in pixels.
    width: u32,
    height: u32,
    /// 1 / area of a pixel at unit distance.
    inverse_pixel_area: f32,
}

/// A camera ray with its density.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// From the pinhole, unit direction.
    pub ray: Ray,
    /// Density of its direction among those of its pixel.
    pub pdf: SolidAnglePdf,
    /// Cosine to the optical axis.
    pub cos: f32,
}

/// The camera as a scene point sees it.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// Column and row of the pixel, from the top left.
    pub pixel: [u32; 2],
    /// Unit direction from the point to the pinhole.
    pub wi: Vec3,
    /// Density per solid angle at the camera with which the pixel's camera ray would go to the point. Equals
    /// `We cosθ`.
    pub pdf: SolidAnglePdf,
}

impl Camera {
    /// A camera at the origin of `to_render`, looking down its −z, y up, with the vertical angle of view `vfov` in
    /// degrees, in (0, 180).
    pub fn pinhole(to_render: &DAffine3, vfov: f64, width: u32, height: u32) -> Self {
        let m = to_render.matrix3;
        let half_height = (0.5 * vfov.to_radians()).tan();
        // A non-uniform scale of the camera stretches the film, not the rays' origins.
        let (right, up, forward) = (m * DVec3::X, m * DVec3::Y, m * -DVec3::Z);
        let half_width = half_height * f64::from(width) / f64::from(height);
        let (sx, sy, sz) = (right.length(), up.length(), forward.length());
        let (half_width, half_height) = (half_width * sx / sz, half_height * sy / sz);
        let pixel_area = 4.0 * half_width * half_height / (f64::from(width) * f64::from(height));
        Self {
            position: to_render.translation.as_vec3a(),
            right: (right / sx).as_vec3a(),
            up: (up / sy).as_vec3a(),
            forward: (forward / sz).as_vec3a(),
            half_width: half_width as f32,
            half_height: half_height as f32,
            width,
            height,
            inverse_pixel_area: (1.0 / pixel_area) as f32,
        }
    }

    /// Full image size in pixels, width and height.
    pub fn resolution(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The pinhole.
    #[inline]
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The unit optical axis.
    pub fn forward(&self) -> Vec3 {
        self.forward
    }

    /// The ray through the point `u` of a pixel, `u` in [0, 1)² from its top left.
    #[inline]
    pub fn generate_ray(&self, pixel: [u32; 2], u: [f32; 2]) -> CameraRay {
        // Offsets are added in f64: at column 60 000 an f32 has few bits left for the place within the pixel.
        let x = (f64::from(pixel[0]) + f64::from(u[0])) / f64::from(self.width) * 2.0 - 1.0;
        let y = 1.0 - (f64::from(pixel[1]) + f64::from(u[1])) / f64::from(self.height) * 2.0;
        let d = self.right * (x as f32 * self.half_width) + self.up * (y as f32 * self.half_height) + self.forward;
        let d = d.normalize();
        let cos = d.dot(self.forward);
        CameraRay { ray: Ray::new(self.position, d), pdf: self.pdf(cos), cos }
    }

    /// The pixel through which the pinhole sees `p`, or `None` outside the image.
    #[inline]
    pub fn sample_lens(&self, p: Vec3) -> Option<CameraSample> {
        let to = p - self.position;
        let depth = to.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let (x, y) = (to.dot(self.right) / depth, to.dot(self.up) / depth);
        let column = (0.5 + 0.5 * x / self.half_width) * self.width as f32;
        let row = (0.5 - 0.5 * y / self.half_height) * self.height as f32;
        // Compared before the cast: a cast alone would fold −0.5 into pixel 0.
        if !(column >= 0.0 && column < self.width as f32 && row >= 0.0 && row < self.height as f32) {
            return None;
        }
        let d = to.normalize();
        Some(CameraSample { pixel: [column as u32, row as u32], wi: -d, pdf: self.pdf(d.dot(self.forward)) })
    }

    /// `1/(A_pixel cos³θ)`: an area element on the film at unit distance subtends `cos³θ` of itself.
    #[inline]
    fn pdf(&self, cos: f32) -> SolidAnglePdf {
        SolidAnglePdf(self.inverse_pixel_area / (cos * cos * cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::pinhole(&DAffine3::from_translation(DVec3::new(0.5, -0.25, 2.0)), 70.0, 64, 48)
    }

    #[test]
    fn a_ray_is_seen_through_the_pixel_it_was_made_for() {
        let c = camera();
        for pixel in [[0, 0], [63, 0], [0, 47], [63, 47], [31, 20]] {
            for u in [[0.01, 0.01], [0.99, 0.99], [0.5, 0.3]] {
                let r = c.generate_ray(pixel, u);
                let s = c.sample_lens(r.ray.at(3.7)).expect("in view");
                assert_eq!(s.pixel, pixel);
                assert!((s.pdf.0 / r.pdf.0 - 1.0).abs() < 1e-5);
                assert!((s.wi + r.ray.d).length() < 1e-6);
            }
        }
    }

    #[test]
    fn just_outside_each_edge_there_is_no_pixel() {
        let c = camera();
        let (w, h) = (c.half_width, c.half_height);
        let at = |x: f32, y: f32| c.position + c.right * x + c.up * y + c.forward;
        for (x, y) in [(-w * 1.001, 0.0), (w * 1.001, 0.0), (0.0, h * 1.001), (0.0, -h * 1.001)] {
            assert!(c.sample_lens(at(x, y)).is_none());
        }
        assert!(c.sample_lens(c.position - c.forward).is_none());
        assert!(c.sample_lens(c.position).is_none());
    }

    #[test]
    fn a_pixels_density_integrates_to_one_over_its_directions() {
        // ∫ p_ω dω over the pixel = ∫ p_ω cos³θ dA, by the midpoint rule over the whole film: one per pixel.
        let c = camera();
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n * n {
            let (x, y) = (((i % n) as f32 + 0.5) / n as f32 * 2.0 - 1.0, ((i / n) as f32 + 0.5) / n as f32 * 2.0 - 1.0);
            let d = (c.right * (x * c.half_width) + c.up * (y * c.half_height) + c.forward).normalize();
            let cos = d.dot(c.forward);
            let s = c.sample_lens(c.position + d).expect("in view");
            sum += f64::from(s.pdf.0) * f64::from(cos).powi(3);
        }
        let area = 4.0 * f64::from(c.half_width) * f64::from(c.half_height);
        let total = sum * area / f64::from(n * n);
        assert!((total / (64.0 * 48.0) - 1.0).abs() < 1e-5, "{total}");
    }
}

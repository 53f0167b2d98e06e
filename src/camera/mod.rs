//! Cameras: rays for camera subpaths, importance for light subpaths.
//!
//! A pixel's value is the mean radiance over its filter on the film (and over the lens), so the density of a camera ray
//! is counted per pixel. The film lies in the plane in focus; a point `l` of the lens sees it at the directions
//! `p_ω = f/(A_pixel cos³θ)`, θ to the optical axis and `f` the pixel's filter there [PBRT4 (5.2.1)], and the importance
//! that makes light tracing land on the same value is `We = p_ω / cosθ`. The lens point's own density is common to all
//! techniques and cancels; parallel rays have a density per area across them instead of `p_ω` (docs/MIS.md, section 12).

mod filter;
#[cfg(test)]
mod tests;

pub use filter::Filter;

use crate::math::{DAffine3, DVec3, Ray, Vec3, distance_squared};
use crate::pdf::EdgePdf;
use crate::planted::{Bug, planted};
use crate::sampling::warp::concentric_disk;

/// A camera in render space.
#[derive(Clone, Debug)]
pub struct Camera {
    /// The pinhole, the lens's centre, or the film's for parallel rays.
    position: Vec3,
    /// Unit axes: right, up, forward.
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Half extents of the film: at unit distance, or in render units for parallel rays.
    half_width: f32,
    half_height: f32,
    /// Full image size in pixels.
    width: u32,
    height: u32,
    /// 1 / area of a pixel on that film.
    inverse_pixel_area: f32,
    projection: Projection,
    /// How far before its own place the film of parallel rays stands.
    closer: f32,
    filter: Filter,
}

/// How rays start.
#[derive(Clone, Copy, Debug)]
enum Projection {
    /// All from one point.
    Pinhole,
    /// From an ellipse (a disk, unless the camera is scaled unequally) of these half axes in render units; the plane in
    /// focus lies at distance 1/`inverse_focus`.
    ThinLens { radii: [f32; 2], inverse_focus: f32 },
    /// From the film, all in one direction.
    Orthographic,
}

/// A lens: a disk of no thickness that images one plane sharply.
#[derive(Clone, Copy, Debug)]
pub struct ThinLens {
    /// Its radius, in the camera's own units.
    pub radius: f64,
    /// Distance of the plane in focus, in the camera's own units.
    pub focus: f64,
}

/// A camera ray with its density.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// From the camera's end of the path, unit direction.
    pub ray: Ray,
    /// The density that the weights compare light subpaths with: of the rays of all pixels together.
    pub pdf: EdgePdf,
    /// Cosine to the optical axis.
    pub cos: f32,
    /// The numbers that chose the point of the lens, of cameras that have one.
    pub lens: [f32; 2],
}

/// The uniform numbers with which a point is connected to the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LensNumbers {
    /// For the point of the lens.
    pub lens: [f32; 2],
    /// For the pixel among those whose filters cover the place on the film.
    pub pixel: [f32; 2],
}

impl LensNumbers {
    /// For a camera that draws none.
    pub const IDLE: Self = Self { lens: [0.5; 2], pixel: [0.5; 2] };
}

/// The camera as a scene point sees it.
#[derive(Clone, Copy, Debug)]
pub struct CameraSample {
    /// Column and row of the pixel, from the top left.
    pub pixel: [u32; 2],
    /// The camera's end of the path.
    pub p: Vec3,
    /// Unit direction from the point to it.
    pub wi: Vec3,
    /// Squared distance to it; 1 for parallel rays, whose density does not fall off.
    pub d2: f64,
    /// Density at which the pixels' camera rays go to the point, over the probability of having chosen this pixel.
    /// Equals `We cosθ` over that probability.
    pub pdf: EdgePdf,
}

impl Camera {
    /// A camera at the origin of `to_render`, looking down its −z, y up, with the vertical angle of view `vfov` in
    /// degrees, in (0, 180), each pixel its own filter.
    pub fn pinhole(to_render: &DAffine3, vfov: f64, width: u32, height: u32) -> Self {
        let (mut camera, [sx, sy, sz]) = Self::posed(to_render, width, height);
        let half_height = (0.5 * vfov.to_radians()).tan();
        // A non-uniform scale of the camera stretches the film, not the rays' origins.
        camera.set_film(half_height * f64::from(width) / f64::from(height) * sx / sz, half_height * sy / sz);
        camera
    }

    /// The same with a lens in place of the pinhole.
    pub fn thin_lens(to_render: &DAffine3, vfov: f64, lens: ThinLens, width: u32, height: u32) -> Self {
        let mut camera = Self::pinhole(to_render, vfov, width, height);
        let [sx, sy, sz] = Self::posed(to_render, width, height).1;
        camera.projection = Projection::ThinLens {
            radii: [(lens.radius * sx) as f32, (lens.radius * sy) as f32],
            inverse_focus: (1.0 / (lens.focus * sz)) as f32,
        };
        camera
    }

    /// A camera of parallel rays down the −z of `to_render`, from its plane z = 0; its image is `film_height` high, in
    /// the camera's own units.
    pub fn orthographic(to_render: &DAffine3, film_height: f64, width: u32, height: u32) -> Self {
        let (mut camera, [sx, sy, _]) = Self::posed(to_render, width, height);
        let half_height = 0.5 * film_height;
        camera.set_film(half_height * f64::from(width) / f64::from(height) * sx, half_height * sy);
        camera.projection = Projection::Orthographic;
        // From far away f32 would lose the places of the rays: the film comes closer, still before all of the scene,
        // whose bounds lie within √3 of the origin.
        let forward = (to_render.matrix3 * -DVec3::Z).normalize();
        let distance = -to_render.translation.dot(forward);
        let closer = (distance - FARTHEST_FILM).max(0.0);
        camera.position = (to_render.translation + forward * closer).as_vec3a();
        camera.closer = closer as f32;
        camera
    }

    /// The same with another pixel filter.
    #[must_use]
    pub fn with_filter(self, filter: Filter) -> Self {
        Self { filter, ..self }
    }

    /// A pinhole camera without a film, and the scales of its axes.
    fn posed(to_render: &DAffine3, width: u32, height: u32) -> (Self, [f64; 3]) {
        let m = to_render.matrix3;
        let (right, up, forward) = (m * DVec3::X, m * DVec3::Y, m * -DVec3::Z);
        let scales @ [_, _, sz] = [right.length(), up.length(), forward.length()];
        // At right angles to the last bit, which a matrix written with few digits is not: directions are put together
        // from these axes and taken apart by dot products.
        let forward = forward / sz;
        let axis = (right - forward * right.dot(forward)).normalize();
        let camera = Self {
            position: to_render.translation.as_vec3a(),
            right: axis.as_vec3a(),
            up: (up - forward * up.dot(forward) - axis * up.dot(axis)).normalize().as_vec3a(),
            forward: forward.as_vec3a(),
            half_width: 1.0,
            half_height: 1.0,
            width,
            height,
            inverse_pixel_area: 1.0,
            projection: Projection::Pinhole,
            closer: 0.0,
            filter: Filter::Pixel,
        };
        (camera, scales)
    }

    fn set_film(&mut self, half_width: f64, half_height: f64) {
        let pixel_area = 4.0 * half_width * half_height / (f64::from(self.width) * f64::from(self.height));
        self.half_width = half_width as f32;
        self.half_height = half_height as f32;
        self.inverse_pixel_area = (1.0 / pixel_area) as f32;
    }

    /// Full image size in pixels, width and height.
    pub fn resolution(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Distance of `p` along the optical axis from the camera's place, for a ray that starts at `from`.
    pub fn depth(&self, from: Vec3, p: Vec3) -> f32 {
        (p - from).dot(self.forward) + self.closer
    }

    /// The unit optical axis.
    pub fn forward(&self) -> Vec3 {
        self.forward
    }

    /// The largest coordinate of any point that rays start from.
    pub fn farthest_origin(&self) -> f32 {
        let (x, y) = match self.projection {
            Projection::Pinhole => (0.0, 0.0),
            Projection::ThinLens { radii: [x, y], .. } => (x, y),
            Projection::Orthographic => (self.half_width, self.half_height),
        };
        (self.position.abs() + self.right.abs() * x + self.up.abs() * y).max_element()
    }

    /// Whether rays start from points of a lens, for which numbers have to be drawn.
    #[inline]
    pub fn has_lens(&self) -> bool {
        matches!(self.projection, Projection::ThinLens { .. })
    }

    /// Whether connecting a point to the camera takes numbers.
    #[inline]
    pub fn needs_numbers(&self) -> bool {
        self.has_lens() || self.filter != Filter::Pixel
    }

    /// d² of the first edge of a camera subpath, from `from` to `p`; 1 for parallel rays, whose density does not fall
    /// off.
    #[inline]
    pub fn edge_d2(&self, from: Vec3, p: Vec3) -> f64 {
        match self.projection {
            Projection::Orthographic => 1.0,
            _ => distance_squared(from, p),
        }
    }

    /// A ray of a pixel: `film` (in [0, 1)²) chooses the place within its filter (of the box of one pixel: from its top
    /// left), `lens` the point of the lens, if there is one.
    #[inline]
    pub fn generate_ray(&self, pixel: [u32; 2], film: [f32; 2], lens: [f32; 2]) -> CameraRay {
        // Offsets are added in f64: at column 60 000 an f32 has few bits left for the place within the pixel.
        let column = f64::from(pixel[0]) + self.filter.sample(film[0]);
        let row = f64::from(pixel[1]) + self.filter.sample(film[1]);
        let x = (column / f64::from(self.width) * 2.0 - 1.0) as f32 * self.half_width;
        let y = (1.0 - row / f64::from(self.height) * 2.0) as f32 * self.half_height;
        let (o, to) = match self.projection {
            Projection::Pinhole => (self.position, self.right * x + self.up * y + self.forward),
            Projection::ThinLens { inverse_focus, .. } => {
                let [lx, ly] = self.lens_point(lens);
                let (x, y) = (x - lx * inverse_focus, y - ly * inverse_focus);
                (self.position + self.right * lx + self.up * ly, self.right * x + self.up * y + self.forward)
            }
            Projection::Orthographic => (self.position + self.right * x + self.up * y, self.forward),
        };
        let d = to.normalize();
        let cos = d.dot(self.forward);
        let coverage = match self.filter {
            Filter::Pixel => 1.0,
            filter => filter.coverage(column, self.width) * filter.coverage(row, self.height),
        };
        CameraRay { ray: Ray::new(o, d), pdf: self.pdf(cos, coverage), cos, lens }
    }

    /// A point of the camera that may see `p`, and a pixel it sees it through; `None` outside the image.
    #[inline]
    pub fn sample_lens(&self, p: Vec3, numbers: &LensNumbers) -> Option<CameraSample> {
        let [lx, ly] = self.lens_point(numbers.lens);
        let o = match self.projection {
            Projection::ThinLens { .. } => self.position + self.right * lx + self.up * ly,
            _ => self.position,
        };
        let to = p - o;
        let depth = to.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let (x, y) = (to.dot(self.right), to.dot(self.up));
        let (x, y) = match self.projection {
            Projection::Pinhole => (x / depth, y / depth),
            // The line through both points, where it meets the plane in focus.
            Projection::ThinLens { inverse_focus, .. } => {
                (x / depth + lx * inverse_focus, y / depth + ly * inverse_focus)
            }
            Projection::Orthographic => (x, y),
        };
        let column = (0.5 + 0.5 * x / self.half_width) * self.width as f32;
        let row = (0.5 - 0.5 * y / self.half_height) * self.height as f32;
        let row = if planted(Bug::OneRowLow) { row + 1.0 } else { row };
        let (pixel, coverage) = match self.filter {
            // Compared before the cast: a cast alone would fold −0.5 into pixel 0.
            Filter::Pixel => {
                let inside = |x: f32, n: u32| match planted(Bug::TruncatedSplat) {
                    false => x >= 0.0 && x < n as f32,
                    true => (0..n as i32).contains(&(x as i32)),
                };
                if !(inside(column, self.width) && inside(row, self.height)) {
                    return None;
                }
                ([column as u32, row as u32], 1.0)
            }
            filter => {
                let (column, across) = filter.choose(f64::from(column), self.width, numbers.pixel[0])?;
                let (row, down) = filter.choose(f64::from(row), self.height, numbers.pixel[1])?;
                ([column, row], if planted(Bug::NoCoverage) { 1.0 } else { across * down })
            }
        };
        if let Projection::Orthographic = self.projection {
            let wi = -self.forward;
            return Some(CameraSample { pixel, p: p + wi * depth, wi, d2: 1.0, pdf: self.pdf(1.0, coverage) });
        }
        let d = to.normalize();
        let pdf = self.pdf(d.dot(self.forward), coverage);
        Some(CameraSample { pixel, p: o, wi: -d, d2: distance_squared(p, o), pdf })
    }

    /// A point of the lens, uniform in area, from its centre.
    #[inline]
    fn lens_point(&self, u: [f32; 2]) -> [f32; 2] {
        match self.projection {
            Projection::ThinLens { radii: [rx, ry], .. } => {
                let [x, y] = concentric_disk(u);
                [x * rx, y * ry]
            }
            _ => [0.0; 2],
        }
    }

    /// `coverage/(A_pixel cos³θ)`: an area element on the film at unit distance subtends `cos³θ` of itself. Parallel
    /// rays cross the film at right angles: `coverage/A_pixel`.
    #[inline]
    fn pdf(&self, cos: f32, coverage: f64) -> EdgePdf {
        match self.projection {
            Projection::Orthographic => EdgePdf(f64::from(self.inverse_pixel_area) * coverage),
            _ => EdgePdf(f64::from(self.inverse_pixel_area / (cos * cos * cos)) * coverage),
        }
    }
}

/// Where an orthographic camera's film stands at the farthest, in render units from the scene's centre.
const FARTHEST_FILM: f64 = 4.0;

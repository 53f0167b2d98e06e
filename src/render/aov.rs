//! Auxiliary images: what camera rays meet first, by which paths light arrives, how sure the picture is.
//!
//! They are made beside the picture, by rays of their own along those that the picture's camera subpaths start with:
//! asking for them changes no bit of it. Each pixel is computed on its own, in the order of its samples, so that they,
//! too, are the same for any number of threads.

use rayon::prelude::*;

use super::{RenderError, Rendered, pool};
use crate::accel::Accel;
use crate::bsdf::{Bsdf, Transport};
use crate::camera::{Filter, LensNumbers};
use crate::film::{Channel, Image};
use crate::geometry::GeometryKind;
use crate::integrator::path::{camera_ray, dimensions};
use crate::integrator::{Crop, Settings};
use crate::light::{DeltaPlace, Light, LightPoint};
use crate::math::{Ray, Rgb, Vec3};
use crate::sampling::{Coins, Sampler, Stream};
use crate::scene::Scene;

/// An auxiliary image, or a family of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// `albedo.{R,G,B}`: the fraction of light the first surface scatters toward the camera's ray; 0 where there is none.
    Albedo,
    /// `normal.{X,Y,Z}`: the geometric normal of the first surface, world axes, unit; 0 where there is none.
    Normal,
    /// `shading_normal.{X,Y,Z}`: the same of the shading normal.
    ShadingNormal,
    /// `depth.Z`: distance of the first surface along the optical axis, scene units; infinite where there is none.
    Depth,
    /// `primitive.id`: 1 + the index of the first primitive at the pixel's centre, triangles first, then quadrics; 0 where
    /// there is none. As with all images of first surfaces, index-matched windows are looked through, and a surface that
    /// is partly opaque is there or not by chance.
    Primitive,
    /// `material.id`: 1 + the index of the material of that primitive, in the order of the file.
    Material,
    /// `emission`, `direct`, `indirect`: light that scattered not at all, once, more often. They sum to the picture.
    Direct,
    /// `depth1` …: light by number of edges of its path.
    PerDepth,
    /// `variance.{R,G,B}`: estimated variance of the picture's pixel, were its samples independent.
    Variance,
    /// `samples.count`: camera samples of the pixel.
    SampleCount,
    /// `lights.id`: 1 + the index of the nearest delta point that lies in the pixel itself (whatever the picture's filter
    /// reaches), whatever is before it; `lights.visible`: the fraction of its light that is let through.
    Lights,
}

impl Aov {
    /// How many channels it has; `edges` are those of the longest paths that are told apart.
    pub fn channels(self, edges: u32) -> u64 {
        match self {
            Self::Depth | Self::Primitive | Self::Material | Self::SampleCount => 1,
            Self::Lights => 2,
            Self::Albedo | Self::Normal | Self::ShadingNormal | Self::Variance => 3,
            Self::Direct => 9,
            Self::PerDepth => 3 * u64::from(edges),
        }
    }

    /// Whether it shows what camera rays meet first.
    pub fn is_of_first_surface(self) -> bool {
        match self {
            Self::Albedo | Self::Normal | Self::ShadingNormal | Self::Depth | Self::Primitive | Self::Material => true,
            Self::Direct | Self::PerDepth | Self::Variance | Self::SampleCount | Self::Lights => false,
        }
    }
}

/// Working memory per pixel of the images of first surfaces, besides their channels: rows are joined when all are there.
pub const FIRST_SURFACE_BYTES: u64 = 2 * size_of::<Texel>() as u64;

/// Camera rays per pixel whose first surfaces are averaged, at the most.
const MOST_RAYS: u32 = 64;

const RGB: [&str; 3] = ["R", "G", "B"];
const XYZ: [&str; 3] = ["X", "Y", "Z"];

/// What the first surfaces are looked at with.
#[derive(Clone, Copy, Debug)]
pub struct AovJob<'a> {
    /// Sampler and seed of the picture.
    pub settings: Settings,
    /// Samples per pixel of the picture.
    pub samples: u32,
    /// Which pixels.
    pub crop: Crop,
    /// Worker threads; 0 for one per logical processor.
    pub threads: usize,
    /// Which images.
    pub wanted: &'a [Aov],
    /// Render units per scene unit.
    pub scale: f64,
    /// Material by surface (`scene::surface_materials`).
    pub materials: &'a [u32],
}

/// What is known of one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Texel {
    albedo: [f32; 3],
    ng: [f32; 3],
    ns: [f32; 3],
    depth: f32,
    primitive: u32,
    material: u32,
}

impl AovJob<'_> {
    fn wants(&self, any: &[Aov]) -> bool {
        any.iter().any(|aov| self.wanted.contains(aov))
    }

    /// The images that follow from the scene alone, in the order of `Aov`.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub fn of_scene<A: Accel>(&self, scene: &Scene<A>) -> Result<Vec<Channel>, RenderError> {
        let mut out = Vec::new();
        use Aov::{Albedo, Depth, Lights, Material, Normal, Primitive, SampleCount, ShadingNormal};
        if self.wanted.iter().any(|aov| aov.is_of_first_surface()) {
            let row = |y| (self.crop.x0..self.crop.x1).map(|x| self.texel(scene, [x, y])).collect::<Vec<_>>();
            let texels: Vec<Texel> = pool(self.threads)?
                .install(|| (self.crop.y0..self.crop.y1).into_par_iter().map(row).collect::<Vec<_>>())
                .concat();
            let mut triple = |aov, layer, names, of: fn(&Texel) -> [f32; 3]| {
                if self.wants(&[aov]) {
                    out.extend(Channel::triple(layer, names, &texels.iter().map(of).collect::<Vec<_>>()));
                }
            };
            triple(Albedo, "albedo", RGB, |t| t.albedo);
            triple(Normal, "normal", XYZ, |t| t.ng);
            triple(ShadingNormal, "shading_normal", XYZ, |t| t.ns);
            if self.wants(&[Depth]) {
                out.push(Channel::float("depth.Z", texels.iter().map(|t| t.depth)));
            }
            if self.wants(&[Primitive]) {
                out.push(Channel::uint("primitive.id", texels.iter().map(|t| t.primitive)));
            }
            if self.wants(&[Material]) {
                out.push(Channel::uint("material.id", texels.iter().map(|t| t.material)));
            }
        }
        if self.wants(&[SampleCount]) {
            let counts = (0..self.crop.pixels()).map(|_| self.samples as f32);
            out.push(Channel::float("samples.count", counts));
        }
        if self.wants(&[Lights]) {
            out.extend(self.lights(scene));
        }
        Ok(out)
    }

    /// The images that the picture's own samples make: `rendered` with techniques of up to `edges` edges, and variance,
    /// as far as they are wanted.
    pub fn of_picture(&self, rendered: &Rendered, edges: u32) -> Vec<Channel> {
        let mut out = Vec::new();
        let depth = |edges: u32| {
            let mut sum = vec![[0.0_f64; 3]; rendered.image.rgb.len()];
            for (_, image) in rendered.techniques.iter().filter(|(t, _)| t.s + t.t == edges + 1) {
                add(&mut sum, image);
            }
            sum
        };
        let narrow = |v: &[[f64; 3]]| v.iter().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>();
        if self.wants(&[Aov::Direct]) {
            let (emission, direct) = (depth(1), depth(2));
            let rest: Vec<[f32; 3]> = (rendered.image.rgb.iter().zip(&emission).zip(&direct))
                .map(|((all, e), d)| [0, 1, 2].map(|i| (f64::from(all[i]) - e[i] - d[i]).max(0.0) as f32))
                .collect();
            out.extend(Channel::triple("emission", RGB, &narrow(&emission)));
            out.extend(Channel::triple("direct", RGB, &narrow(&direct)));
            out.extend(Channel::triple("indirect", RGB, &rest));
        }
        if self.wants(&[Aov::PerDepth]) {
            for n in 1..=edges {
                out.extend(Channel::triple(&format!("depth{n}"), RGB, &narrow(&depth(n))));
            }
        }
        if let (true, Some(variance)) = (self.wants(&[Aov::Variance]), &rendered.variance) {
            out.extend(Channel::triple("variance", RGB, &variance.rgb));
        }
        out
    }

    /// The mean over a pixel's camera rays, those of the picture, of what they meet first.
    fn texel<A: Accel>(&self, scene: &Scene<A>, pixel: [u32; 2]) -> Texel {
        let [width, _] = scene.camera.resolution();
        let key = pixel[1] * width + pixel[0];
        let count = self.samples.clamp(1, MOST_RAYS);
        let (mut albedo, mut ng, mut ns) = (Rgb::ZERO, Vec3::ZERO, Vec3::ZERO);
        let (mut depth, mut hits) = (0.0_f64, 0_u32);
        let mut varying = Bsdf::Black;
        for index in 0..count {
            let mut sampler = Sampler::new(self.settings.sampler, self.settings.seed, key, Stream::Camera, index);
            let mut coins = sampler.coins();
            let ray = camera_ray(&scene.camera, pixel, &mut sampler).ray;
            let Some(arrival) = scene.arrive(ray, &mut coins, &mut 0, &mut varying) else { continue };
            let at = &arrival.at;
            hits += 1;
            ng += at.ng;
            ns += at.ns;
            depth += f64::from(scene.camera.depth(ray.o, at.p()));
            sampler.set_dimension(dimensions::DIRECTION);
            let (u, lobe) = (sampler.next_2d(), sampler.next_1d());
            // The mean of a sample's weight is the albedo, whatever the model.
            if let Some(s) = arrival.bsdf.sample(at, -ray.d, lobe, u, Transport::Radiance) {
                albedo += s.weight / s.eta_scale;
            }
        }
        let center = scene.camera.generate_ray(pixel, [0.5; 2], [0.5; 2]).ray;
        let triangles = scene.geometry.triangles.len() as u32;
        // One arrival for both identifiers, so that they belong to one surface.
        let seen = scene.arrive(center, &mut Coins::new(u64::from(key)), &mut 0, &mut varying);
        let primitive = seen.as_ref().map_or(0, |arrival| match arrival.geometry {
            GeometryKind::Triangle => arrival.at.primitive() + 1,
            GeometryKind::Quadric => triangles + arrival.at.primitive() + 1,
        });
        let surface = seen.map(|arrival| arrival.at.surface() as usize);
        Texel {
            albedo: (albedo / count as f32).to_array(),
            ng: ng.normalize_or_zero().to_array(),
            ns: ns.normalize_or_zero().to_array(),
            depth: if hits > 0 { (depth / f64::from(hits) / self.scale) as f32 } else { f32::INFINITY },
            primitive,
            material: surface.and_then(|s| self.materials.get(s)).map_or(0, |m| m + 1),
        }
    }

    /// Where the delta points are seen, as their user geometry answers: a ray aimed at each.
    fn lights<A: Accel>(&self, scene: &Scene<A>) -> [Channel; 2] {
        let crop = self.crop;
        let mut ids = vec![0; crop.pixels() as usize];
        let mut visible = vec![0.0; ids.len()];
        let mut nearest = vec![f32::INFINITY; ids.len()];
        // The pixel that the point lies in, however far the picture's filter reaches: that would be one of many.
        let camera = scene.camera.clone().with_filter(Filter::Pixel);
        for point in &scene.geometry.delta_points {
            let Some(lens) = camera.sample_lens(point.position, &LensNumbers::IDLE) else { continue };
            let aimed = Ray::segment(lens.p, point.position);
            let Some(hit) = scene.accel.intersect_delta(&aimed) else { continue };
            let distance = (point.position - lens.p).length();
            let [x, y] = lens.pixel;
            if !crop.contains(lens.pixel) {
                continue;
            }
            let i = (y - crop.y0) as usize * crop.width() as usize + (x - crop.x0) as usize;
            if distance < nearest[i] {
                nearest[i] = distance;
                ids[i] = hit.point + 1;
                // As light leaves it in the picture: a surface that the point stands on does not hide it.
                let at = scene.lights.iter().filter_map(Light::place).find(|place| place.p == point.position);
                let at = LightPoint::Delta(at.copied().unwrap_or(DeltaPlace::free(point.position)));
                let end = at.origin((lens.p - point.position).normalize_or_zero());
                visible[i] = scene.visibility(&Ray::segment(lens.p, end), &mut 0);
            }
        }
        [Channel::uint("lights.id", ids), Channel::float("lights.visible", visible)]
    }
}

fn add(sum: &mut [[f64; 3]], image: &Image) {
    for (s, p) in sum.iter_mut().zip(&image.rgb) {
        for (s, x) in s.iter_mut().zip(p) {
            *s += f64::from(*x);
        }
    }
}

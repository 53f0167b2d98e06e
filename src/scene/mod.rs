//! Scenes: as written (`desc`), and as rendered (`prepare`, `Scene`).

mod cameras;
pub mod desc;
mod detail;
mod duplicates;
mod flat;
mod material;
mod memory;
mod needs;
mod prepare;
mod space;
mod standing;
mod textures;

pub use detail::Details;
pub use memory::Memory;
pub use needs::SceneNeeds;
pub use prepare::{Prepared, Warning, prepare, surface_materials};

use std::sync::Arc;

use crate::accel::{Accel, AccelError, AccelOptions};
use crate::bsdf::Bsdf;
use crate::camera::Camera;
use crate::geometry::{Geometry, GeometryKind, Hit, SurfacePoint};
use crate::light::{Light, LightChoice, LightPoint, Receiver};
use crate::math::{Ray, Vec3, past};
use crate::pdf::LightPointPdf;
use crate::planted::{Bug, planted};
use crate::sampling::Coins;

/// What a surface is made of.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// How it scatters; of a surface in detail, one of the ways in which it may.
    pub bsdf: Bsdf,
    /// The light it is, if it shines.
    pub light: Option<u32>,
    /// What varies over it: an index into the scene's details, resolved where a path arrives.
    pub detail: Option<u32>,
}

/// A scene ready to render: immutable, indexed, shared by all threads. Everything is in render space.
#[derive(Debug)]
pub struct Scene<A> {
    /// Shapes.
    pub geometry: Arc<Geometry>,
    /// Intersection and occlusion.
    pub accel: A,
    /// By surface index.
    pub surfaces: Vec<Surface>,
    /// What varies over surfaces.
    pub details: Details,
    /// By light index.
    pub lights: Vec<Light>,
    /// The lights that a ray out of the scene hits.
    pub environments: Vec<u32>,
    /// Chooses among the lights; `None` in a dark scene.
    pub light_choice: Option<LightChoice>,
    /// What the brightest light may throw on a surface (`Light::brightness`): the film's quantum follows it.
    pub brightness: f32,
    /// The camera.
    pub camera: Camera,
    /// What the scene's content makes unnecessary.
    pub needs: SceneNeeds,
}

/// The first surface along a ray that is there and is not a window.
#[derive(Clone, Copy, Debug)]
pub struct Arrival<'a> {
    /// The kind of primitive it lies on.
    pub geometry: GeometryKind,
    /// Where.
    pub at: SurfacePoint,
    /// How the surface scatters, there.
    pub bsdf: &'a Bsdf,
    /// The light it is, if it shines.
    pub light: Option<u32>,
    /// Whether the ray came through an index-matched window, across which nothing can be connected.
    pub through_window: bool,
}

/// Where a ray leads.
#[derive(Clone, Copy, Debug)]
pub enum Reached<'a> {
    /// To a surface.
    Surface(Arrival<'a>),
    /// Out of the scene.
    Infinity {
        /// Whether it passed an index-matched window.
        through_window: bool,
    },
}

impl<A: Accel> Scene<A> {
    /// Builds the acceleration structure over a prepared scene.
    ///
    /// # Errors
    /// When the accelerator cannot be built.
    pub fn build(prepared: Prepared, options: AccelOptions) -> Result<Self, AccelError> {
        let Prepared { geometry, surfaces, details, mut lights, camera, needs, near, .. } = prepared;
        let geometry = Arc::new(geometry);
        let accel = A::build(Arc::clone(&geometry), options)?;
        for place in lights.iter_mut().filter_map(Light::place_mut) {
            standing::settle(&accel, &geometry, place);
        }
        let light_choice = LightChoice::new(&lights, &geometry);
        let brightness = lights.iter().map(|light| light.brightness(near)).fold(0.0, f32::max);
        let is_environment = |l: &Light| l.is_infinite() && !l.is_delta();
        let environments = (0..).zip(&lights).filter(|(_, l)| is_environment(l)).map(|(i, _)| i).collect();
        Ok(Self { geometry, accel, surfaces, details, lights, environments, light_choice, brightness, camera, needs })
    }

    /// Density with which next-event estimation at `receiver` chooses this point of light `id`, the choice of the light
    /// included.
    #[inline]
    pub fn pdf_direct(&self, receiver: &Receiver, id: u32, point: &LightPoint) -> LightPointPdf {
        let Some(choice) = &self.light_choice else { return LightPointPdf::IMPOSSIBLE };
        let light = &self.lights[id as usize];
        if planted(Bug::DirectByArea) {
            let pmf = choice.pmf_direct(receiver, id, light.part_of(point));
            return light.pdf_emission_position(&self.geometry, point) * pmf;
        }
        light.pdf_direct(&self.geometry, receiver.p, point) * choice.pmf_direct(receiver, id, light.part_of(point))
    }

    /// `follow` for those who want surfaces only: `None` out of the scene.
    #[inline]
    pub fn arrive<'a>(
        &'a self,
        ray: Ray,
        coins: &mut Coins,
        rays: &mut u64,
        varying: &'a mut Bsdf,
    ) -> Option<Arrival<'a>> {
        match self.follow(ray, coins, rays, varying) {
            Reached::Surface(arrival) => Some(arrival),
            Reached::Infinity { .. } => None,
        }
    }

    /// Follows a ray to the first surface that is there and is not a window, or out of the scene; the number of rays it
    /// took is added to `rays`. The sample's `coins` decide whether a surface that is partly opaque is there, and which
    /// part of a blend it is. The model of a surface that is not the same everywhere is put into `varying`; of others the
    /// arrival refers to the scene's.
    #[inline]
    pub fn follow<'a>(&'a self, mut ray: Ray, coins: &mut Coins, rays: &mut u64, varying: &'a mut Bsdf) -> Reached<'a> {
        let mut through_window = false;
        loop {
            *rays += 1;
            let Some(hit) = self.accel.intersect(&ray) else { return Reached::Infinity { through_window } };
            let mut at = self.geometry.surface_point(&ray, &hit);
            let surface = &self.surfaces[at.surface() as usize];
            let mut varies = false;
            if let Some(detail) = surface.detail {
                let Some(bsdf) = self.details.resolve(detail, &self.geometry, &hit, &mut at, coins) else {
                    ray = beyond(&ray, &hit, &at);
                    continue;
                };
                (varies, *varying) = (true, bsdf);
            }
            let is_window = |bsdf: &Bsdf| matches!(bsdf, Bsdf::Null);
            if self.needs.windows && is_window(if varies { varying } else { &surface.bsdf }) {
                through_window = !planted(Bug::WindowsConnect);
                ray = beyond(&ray, &hit, &at);
                continue;
            }
            let bsdf = if varies { &*varying } else { &surface.bsdf };
            return Reached::Surface(Arrival {
                geometry: hit.geometry,
                at,
                bsdf,
                light: surface.light,
                through_window,
            });
        }
    }

    /// The fraction of light that passes along a segment whose ends are already off their surfaces, or along a half-line
    /// toward a light at infinity: 0 or 1, but for surfaces that are partly opaque. The number of rays it took is added
    /// to `rays`.
    #[inline]
    pub fn visibility(&self, ray: &Ray, rays: &mut u64) -> f32 {
        *rays += 1;
        if self.accel.occluded(ray) {
            return 0.0;
        }
        if self.needs.opacity { self.transmittance(*ray, rays) } else { 1.0 }
    }

    /// The surface nearest along a segment, for replays.
    pub fn blocker(&self, ray: &Ray) -> Option<u32> {
        self.accel.intersect(ray).map(|hit| self.geometry.surface_of(&hit))
    }

    /// The product of 1 − opacity over the surfaces along a ray that nothing opaque blocks: the probability with which
    /// `follow` passes them.
    #[inline(never)]
    fn transmittance(&self, mut ray: Ray, rays: &mut u64) -> f32 {
        let end = ray.tmax.is_finite().then(|| ray.at(ray.tmax));
        let mut passed = 1.0;
        loop {
            *rays += 1;
            let Some(hit) = self.accel.intersect_cut_out(&ray) else { return passed };
            let at = self.geometry.surface_point(&ray, &hit);
            let Some(detail) = self.surfaces[at.surface() as usize].detail else { return 0.0 };
            passed *= (1.0 - self.details.opacity(detail, &at)).clamp(0.0, 1.0);
            if passed == 0.0 {
                return 0.0;
            }
            let next = beyond(&ray, &hit, &at);
            // What lies within the rounding of the segment's end ends it, along the ray or on this side of the surface: from
            // there the way to the end leads back through it, and through it again, without end.
            let before = |end: Vec3| {
                let left = end - next.at(next.tmin);
                left.dot(ray.d) <= 0.0 || left.dot(at.ng) * ray.d.dot(at.ng) <= 0.0
            };
            ray = match end {
                Some(end) if before(end) => return passed,
                Some(end) if next.tmin == 0.0 => Ray::segment(next.o, end),
                Some(_) => Ray { tmax: ray.tmax, ..next },
                None => next,
            };
        }
    }
}

/// The rest of a ray that goes through what it has hit. It starts off the surface, unless that is no further: where an
/// accelerator knows the plane of a needle less well than its points, the surface is met again from there, for ever.
#[inline]
fn beyond(ray: &Ray, hit: &Hit, at: &SurfacePoint) -> Ray {
    let next = at.origin(ray.d);
    if (next - ray.at(ray.tmin)).dot(ray.d) > 0.0 {
        return Ray::new(next, ray.d);
    }
    Ray { tmin: past(hit.t), tmax: f32::INFINITY, ..*ray }
}

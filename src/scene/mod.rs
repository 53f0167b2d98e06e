//! Scenes: as written (`desc`), and as rendered (`prepare`, `Scene`).

pub mod desc;
mod material;
mod needs;
mod prepare;

pub use needs::SceneNeeds;
pub use prepare::{Prepared, Warning, prepare, surface_materials};

use std::sync::Arc;

use crate::accel::{Accel, AccelError, AccelOptions};
use crate::bsdf::Bsdf;
use crate::camera::Camera;
use crate::geometry::{Geometry, SurfacePoint};
use crate::light::{Light, LightChoice};
use crate::math::Ray;

/// What a surface is made of.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// How it scatters.
    pub bsdf: Bsdf,
    /// The light it is, if it shines.
    pub light: Option<u32>,
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
    /// By light index.
    pub lights: Vec<Light>,
    /// The lights that a ray out of the scene hits.
    pub environments: Vec<u32>,
    /// Chooses among the lights; `None` in a dark scene.
    pub light_choice: Option<LightChoice>,
    /// The camera.
    pub camera: Camera,
    /// What the scene's content makes unnecessary.
    pub needs: SceneNeeds,
}

/// The first surface along a ray that is not a window.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Where.
    pub at: SurfacePoint,
    /// What it is made of.
    pub surface: Surface,
    /// Whether the ray came through an index-matched window, across which nothing can be connected.
    pub through_window: bool,
}

/// Where a ray leads.
#[derive(Clone, Copy, Debug)]
pub enum Reached {
    /// To a surface.
    Surface(Arrival),
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
        let Prepared { geometry, surfaces, lights, camera, needs, .. } = prepared;
        let geometry = Arc::new(geometry);
        let accel = A::build(Arc::clone(&geometry), options)?;
        let light_choice = LightChoice::new(&lights);
        let is_environment = |l: &Light| l.is_infinite() && !l.is_delta();
        let environments = (0..).zip(&lights).filter(|(_, l)| is_environment(l)).map(|(i, _)| i).collect();
        Ok(Self { geometry, accel, surfaces, lights, environments, light_choice, camera, needs })
    }

    /// Follows a ray to the first surface that is not a window, or to `None`; the number of rays it took is added to
    /// `rays`.
    #[inline]
    pub fn arrive(&self, ray: Ray, rays: &mut u64) -> Option<Arrival> {
        match self.follow(ray, rays) {
            Reached::Surface(arrival) => Some(arrival),
            Reached::Infinity { .. } => None,
        }
    }

    /// Follows a ray to the first surface that is not a window, or out of the scene; the number of rays it took is added
    /// to `rays`.
    #[inline]
    pub fn follow(&self, mut ray: Ray, rays: &mut u64) -> Reached {
        let mut through_window = false;
        loop {
            *rays += 1;
            let Some(hit) = self.accel.intersect(&ray) else { return Reached::Infinity { through_window } };
            let at = self.geometry.surface_point(&ray, &hit);
            let surface = self.surfaces[at.surface as usize];
            if self.needs.windows && surface.bsdf == Bsdf::Null {
                through_window = true;
                ray = Ray::new(at.origin(ray.d), ray.d);
                continue;
            }
            return Reached::Surface(Arrival { at, surface, through_window });
        }
    }
}

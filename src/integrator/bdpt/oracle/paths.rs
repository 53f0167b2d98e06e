//! The paths that are judged: real subpaths, joined at random.

use crate::accel::Accel;
use crate::bsdf::{Bsdf, Transport};
use crate::camera::{CameraSample, LensNumbers};
use crate::geometry::SurfacePoint;
use crate::light::LightPoint;
use crate::math::{Ray, Vec3, distance_squared};
use crate::sampling::{Sampler, SamplerKind, Stream};
use crate::scene::{Reached, Scene};

/// A vertex between the light and the camera.
#[derive(Clone, Copy, Debug)]
pub struct Inner {
    pub at: SurfacePoint,
    pub bsdf: Bsdf,
    /// The light it is, if it shines.
    pub light: Option<u32>,
    /// Whether the walk came to it through a window.
    pub through_window: bool,
    /// Whether the path goes on by a delta lobe: of a mixture, the one that the walk chose.
    pub delta: bool,
}

/// A full path: light vertex, inner vertices from light to camera, camera.
#[derive(Clone, Debug)]
pub struct FullPath {
    pub light: u32,
    pub start: LightPoint,
    pub inner: Vec<Inner>,
    /// The camera's end, where the camera walk started, and the numbers it was made with.
    pub camera: Vec3,
    pub numbers: LensNumbers,
    /// `windows[i]`: a window lies between vertex i and vertex i + 1.
    pub windows: Vec<bool>,
    /// The edge that no walk has gone along, by its first vertex; `None` where a light was hit.
    pub joined: Option<usize>,
}

impl FullPath {
    /// Where vertex `i` is; not asked for a light at infinity.
    pub fn point(&self, i: usize) -> Vec3 {
        match (i, &self.start) {
            (0, LightPoint::Surface(s)) => s.p(),
            (0, LightPoint::Delta(place)) => place.p,
            (0, LightPoint::Infinite(_)) => panic!("a point at infinity is nowhere"),
            (i, _) if i == self.inner.len() + 1 => self.camera,
            (i, _) => self.inner[i - 1].at.p(),
        }
    }

    /// Unit direction from vertex `i` to vertex `j`.
    pub fn direction(&self, i: usize, j: usize) -> Vec3 {
        match (i, j, &self.start) {
            (0, _, LightPoint::Infinite(toward)) => -*toward,
            (_, 0, LightPoint::Infinite(toward)) => *toward,
            _ => (self.point(j) - self.point(i)).normalize(),
        }
    }

    /// The camera as the last vertex before it sees it; `None` out of view.
    pub fn lens<A: Accel>(&self, scene: &Scene<A>) -> Option<CameraSample> {
        if self.inner.is_empty() && matches!(self.start, LightPoint::Infinite(_)) {
            return None;
        }
        scene.camera.sample_lens(self.point(self.inner.len()), &self.numbers)
    }

    /// Puts the camera's end where the lens says: parallel rays start opposite what they see.
    pub fn with_lens<A: Accel>(mut self, scene: &Scene<A>) -> Option<Self> {
        self.camera = self.lens(scene)?.p;
        Some(self)
    }

    /// Squared length of the edge between vertices `i` and `i + 1`; 1 where the density of an edge has no 1/d².
    pub fn distance_squared<A: Accel>(&self, scene: &Scene<A>, i: usize) -> f64 {
        if i == self.inner.len() {
            return scene.camera.edge_d2(self.camera, self.point(i));
        }
        let next = self.point(i + 1);
        if i == 0 { self.start.distance_squared(next) } else { distance_squared(self.point(i), next) }
    }

    /// What connections along the edges that were walked let through, from either end: by edge. Where it is
    /// nothing, techniques do not make the same paths; where the ends disagree, they do not measure the same.
    pub fn visibilities<A: Accel>(&self, scene: &Scene<A>) -> Vec<[f32; 2]> {
        let k = self.inner.len() + 1;
        let seen = |ray: &Ray| scene.visibility(ray, &mut 0);
        let at = |i: usize| &self.inner[i - 1].at;
        let toward =
            |i: usize, j: usize| seen(&Ray::segment(at(i).origin(at(j).p() - at(i).p()), at(j).segment_end(at(i).p())));
        let to_camera = |at: &SurfacePoint| seen(&Ray::segment(at.origin(self.direction(k - 1, k)), self.camera));
        let edge = |i: usize| match (i, &self.start) {
            // The camera's edge and the light's are looked along from one end alone.
            (0, LightPoint::Surface(at)) if k == 1 => [to_camera(at); 2],
            (0, start) => [seen(&start.shadow_ray(at(1))); 2],
            (i, _) if i + 1 == k => [to_camera(at(i)); 2],
            (i, _) => [toward(i, i + 1), toward(i + 1, i)],
        };
        (0..k).filter(|&i| self.joined != Some(i) && !self.windows[i]).map(edge).collect()
    }
}

/// The vertices of a walk and, if it left the scene, in which direction and whether through a window.
struct Walk {
    vertices: Vec<Inner>,
    escape: Option<(Vec3, bool)>,
}

/// Walks on from a ray, keeping every vertex.
fn walk<A: Accel>(scene: &Scene<A>, mut ray: Ray, transport: Transport, sampler: &mut Sampler, longest: usize) -> Walk {
    let mut out = Walk { vertices: Vec::new(), escape: None };
    let mut coins = sampler.coins();
    let mut varying = Bsdf::Black;
    while out.vertices.len() < longest {
        let arrival = match scene.follow(ray, &mut coins, &mut 0, &mut varying) {
            Reached::Surface(arrival) => arrival,
            Reached::Infinity { through_window } => {
                out.escape = Some((ray.d, through_window));
                break;
            }
        };
        let mut v = Inner {
            at: arrival.at,
            bsdf: *arrival.bsdf,
            light: arrival.light,
            through_window: arrival.through_window,
            delta: !arrival.bsdf.is_connectible(),
        };
        let (u, lobe) = (sampler.next_2d(), sampler.next_1d());
        let next = v.bsdf.sample(&v.at, -ray.d, lobe, u, transport);
        v.delta |= next.is_some_and(|s| s.delta);
        out.vertices.push(v);
        let Some(s) = next else { break };
        ray = Ray::new(v.at.origin(s.wi), s.wi);
    }
    out
}

/// The vertices of a random light and a random camera subpath, joined at a random pair.
pub fn random_path<A: Accel>(scene: &Scene<A>, index: u32) -> Option<FullPath> {
    let mut u = Sampler::new(SamplerKind::Independent, 77, 0, Stream::Light(0), index);
    let (light, _) = scene.light_choice.as_ref()?.sample_emission(u.next_f64());
    let emission =
        scene.lights[light as usize].sample_emission(&scene.geometry, u.next_f64(), u.next_2d(), u.next_2d())?;
    let ray = Ray::new(emission.origin, emission.w);
    let mut light_walk = walk(scene, ray, Transport::Importance, &mut u, 5).vertices;
    let pixel = scene.camera.resolution().map(|n| ((u.next_1d() * n as f32) as u32).min(n - 1));
    let film = u.next_2d();
    let numbers = if scene.camera.needs_numbers() {
        LensNumbers { lens: u.next_2d(), pixel: u.next_2d() }
    } else {
        LensNumbers::IDLE
    };
    let ray = scene.camera.generate_ray(pixel, film, numbers.lens).ray;
    let camera = ray.o;
    let Walk { vertices: mut camera_walk, escape } = walk(scene, ray, Transport::Radiance, &mut u, 5);
    if camera_walk.is_empty() {
        return None;
    }
    // A third of the paths end on an emitter that the camera walk hit.
    let by_chance = u.next_1d() < 0.33;
    if let (true, Some((toward, through_window))) = (by_chance, escape) {
        let environments = &scene.environments;
        if environments.is_empty() {
            return None;
        }
        let light = environments[(u.next_1d() * environments.len() as f32) as usize];
        let windows = [through_window].into_iter().chain(camera_walk.iter().rev().map(|v| v.through_window)).collect();
        let inner = camera_walk.into_iter().rev().collect();
        return FullPath { light, start: LightPoint::Infinite(toward), inner, windows, numbers, camera, joined: None }
            .with_lens(scene);
    }
    camera_walk.truncate(1 + (u.next_1d() * camera_walk.len() as f32) as usize);
    if by_chance {
        let hit = camera_walk.iter().position(|v| v.light.is_some())?;
        camera_walk.truncate(hit + 1);
        let end = camera_walk.pop()?;
        let mut windows: Vec<bool> = vec![end.through_window];
        windows.extend(camera_walk.iter().rev().map(|v| v.through_window));
        let inner = camera_walk.into_iter().rev().collect();
        let start = LightPoint::Surface(end.at);
        return FullPath { light: end.light?, start, inner, camera, numbers, windows, joined: None }.with_lens(scene);
    }
    light_walk.truncate((u.next_1d() * (light_walk.len() + 1) as f32) as usize);
    // The joined ends must be connectible, and are taken to see each other.
    if light_walk.last().is_some_and(|v| !v.bsdf.is_connectible()) || !camera_walk.last()?.bsdf.is_connectible() {
        return None;
    }
    // A connection goes by what of a mixture is no delta, whatever the walk would have done.
    light_walk.last_mut().into_iter().chain(camera_walk.last_mut()).for_each(|v| v.delta = false);
    let joined = Some(light_walk.len());
    let mut windows: Vec<bool> = light_walk.iter().map(|v| v.through_window).collect();
    windows.push(false);
    windows.extend(camera_walk.iter().rev().map(|v| v.through_window));
    let inner = light_walk.into_iter().chain(camera_walk.into_iter().rev()).collect();
    FullPath { light, start: emission.point, inner, camera, numbers, windows, joined }.with_lens(scene)
}

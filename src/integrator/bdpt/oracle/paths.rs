//! The paths that are judged: real subpaths of a box with every kind of light and surface, joined at random.

use crate::accel::bvh::BvhAccel;
use crate::bsdf::{Bsdf, Transport};
use crate::geometry::SurfacePoint;
use crate::light::LightPoint;
use crate::math::Ray;
use crate::sampling::{Sampler, SamplerKind, Stream};
use crate::scene::{Scene, prepare};

/// A vertex between the light and the camera.
#[derive(Clone, Copy, Debug)]
pub struct Inner {
    pub at: SurfacePoint,
    pub bsdf: Bsdf,
    /// The light it is, if it shines.
    pub light: Option<u32>,
    /// Whether the walk came to it through a window.
    pub through_window: bool,
}

/// A full path: light vertex, inner vertices from light to camera, camera.
#[derive(Clone, Debug)]
pub struct FullPath {
    pub light: u32,
    pub start: LightPoint,
    pub inner: Vec<Inner>,
    /// `windows[i]`: a window lies between vertex i and vertex i + 1.
    pub windows: Vec<bool>,
}

impl FullPath {
    /// Relative error that the rounding of stored points causes at delta vertices: that of a direction is ε over the
    /// edge's length; Snell's law, cosθt² = 1 − (1 − cosθo²)/η², hands it on to the other cosine as
    /// d cosθt/cosθt = cosθo d cosθo/(η² cosθt²).
    pub fn condition(&self, scene: &Scene<BvhAccel>) -> f64 {
        let mut points = vec![self.start.p()];
        points.extend(self.inner.iter().map(|v| v.at.p()));
        points.push(scene.camera.position());
        let mut sum = 0.0;
        for (i, v) in self.inner.iter().enumerate().filter(|(_, v)| !v.bsdf.is_connectible()) {
            for end in [points[i], points[i + 2]] {
                let edge = end - v.at.p();
                let cos = f64::from(edge.normalize().dot(v.at.ng).abs());
                sum += f64::from(f32::EPSILON) / (f64::from(edge.length()) * cos * cos);
            }
        }
        sum
    }
}

/// Walks on from a ray, keeping every vertex.
fn walk(
    scene: &Scene<BvhAccel>,
    mut ray: Ray,
    transport: Transport,
    sampler: &mut Sampler,
    longest: usize,
) -> Vec<Inner> {
    let mut out = Vec::new();
    let mut coins = sampler.coins();
    while out.len() < longest {
        let Some(arrival) = scene.arrive(ray, &mut coins, &mut 0) else { break };
        let v = Inner {
            at: arrival.at,
            bsdf: arrival.surface.bsdf,
            light: arrival.surface.light,
            through_window: arrival.through_window,
        };
        out.push(v);
        let (u, lobe) = (sampler.next_2d(), sampler.next_1d());
        let Some(s) = v.bsdf.sample(&v.at, -ray.d, lobe, u, transport) else { break };
        ray = Ray::new(v.at.origin(s.wi), s.wi);
    }
    out
}

/// A box with an area light, a spot and a point light, a mirror, a glass sphere, a curved mesh, a window, a blend of
/// mirror and diffuse, and a wall of bent normals.
const SCENE: &str = r#"{
 "camera": {"transform": {"from": [0, 0, 3.2], "at": [0, 0, 0], "up": [0, 1, 0]}, "resolution": [32, 24], "vfov": 50},
 "materials": [
  {"name": "white", "type": "lambertian", "albedo": [0.8, 0.7, 0.6], "two_sided": true},
  {"name": "glow", "type": "lambertian", "albedo": 0.4, "two_sided": true, "emit": [0.2, 0.1, 0.3]},
  {"name": "glass", "type": "dielectric", "ior": 1.6},
  {"name": "mirror", "type": "mirror", "albedo": 0.9},
  {"name": "window", "type": "null"},
  {"name": "worn", "type": "blend", "a": "white", "b": {"type": "mirror", "albedo": 0.8},
   "amount": {"type": "checker", "scale": 9, "even": 0.05, "odd": 0.15}},
  {"name": "lamp", "type": "diffuse light", "emit": [6, 5, 4]}
 ],
 "surfaces": [
  {"type": "quad", "size": 4, "transform": {"translate": [0, 0, -1.5]}, "material": "white",
   "normal_map": {"type": "checker", "scale": 5, "even": [0.65, 0.45, 0.95], "odd": [0.4, 0.6, 0.95]}},
  {"type": "quad", "size": 4, "transform": [{"rotate": [-90, 1, 0, 0]}, {"translate": [0, -1.2, 0]}], "material": "glow"},
  {"type": "quad", "size": 4, "transform": [{"rotate": [90, 1, 0, 0]}, {"translate": [0, 1.4, 0]}], "material": "white"},
  {"type": "quad", "size": 4, "transform": [{"rotate": [90, 0, 1, 0]}, {"translate": [-1.6, 0, 0]}], "material": "mirror"},
  {"type": "quad", "size": 4, "transform": [{"rotate": [-90, 0, 1, 0]}, {"translate": [1.6, 0, 0]}], "material": "worn"},
  {"type": "sphere", "radius": 0.5, "transform": {"translate": [0.5, -0.4, 0.3]}, "material": "glass"},
  {"type": "quad", "size": 1.2, "transform": {"translate": [-0.6, 0.2, 0.4]}, "material": "window"},
  {"type": "triangle", "positions": [[-1.2, -1, -0.8], [0, -0.8, -1], [-0.6, 0.4, -0.9]],
   "normals": [[-0.4, 0, 1], [0.5, 0.1, 1], [0, 0.5, 1]], "material": "white"},
  {"type": "disk", "radius": 0.4, "transform": [{"rotate": [90, 1, 0, 0]}, {"translate": [0.3, 1.3, 0.2]}], "material": "lamp"},
  {"type": "sphere", "radius": 0.2, "transform": {"translate": [-0.9, 0.9, -0.6]}, "material": "lamp"}
 ],
 "lights": [
  {"type": "point", "position": [0.9, 0.8, 0.7], "intensity": [2, 3, 4]},
  {"type": "spot", "position": [-0.5, 1.1, 0.9], "at": [0, -1, 0], "intensity": 9, "inner_angle": 20, "outer_angle": 45}
 ]
}"#;

/// That box, prepared, on the pure-Rust BVH.
pub fn scene() -> Scene<BvhAccel> {
    let desc = crate::import::scene_from_str(SCENE, "oracle.json", std::path::Path::new(".")).expect("valid scene");
    Scene::build(prepare(&desc).expect("preparable"), Default::default()).expect("buildable")
}

/// The vertices of a random light and a random camera subpath, joined at a random pair.
pub fn random_path(scene: &Scene<BvhAccel>, index: u32) -> Option<FullPath> {
    let mut u = Sampler::new(SamplerKind::Independent, 77, 0, Stream::Light(0), index);
    let (light, _) = scene.light_choice.as_ref()?.sample(u.next_f64());
    let emission =
        scene.lights[light as usize].sample_emission(&scene.geometry, u.next_f64(), u.next_2d(), u.next_2d())?;
    let ray = Ray::new(emission.point.origin(emission.w), emission.w);
    let mut light_walk = walk(scene, ray, Transport::Importance, &mut u, 5);
    let pixel = [(u.next_1d() * 32.0) as u32, (u.next_1d() * 24.0) as u32];
    let ray = scene.camera.generate_ray(pixel, u.next_2d()).ray;
    let mut camera_walk = walk(scene, ray, Transport::Radiance, &mut u, 5);
    if camera_walk.is_empty() {
        return None;
    }
    camera_walk.truncate(1 + (u.next_1d() * camera_walk.len() as f32) as usize);
    // A third of the paths end on an emitter that the camera walk hit.
    if u.next_1d() < 0.33 {
        let hit = camera_walk.iter().position(|v| v.light.is_some())?;
        camera_walk.truncate(hit + 1);
        let end = camera_walk.pop()?;
        let mut windows: Vec<bool> = vec![end.through_window];
        windows.extend(camera_walk.iter().rev().map(|v| v.through_window));
        let inner = camera_walk.into_iter().rev().collect();
        return Some(FullPath { light: end.light?, start: LightPoint::Surface(end.at), inner, windows });
    }
    light_walk.truncate((u.next_1d() * (light_walk.len() + 1) as f32) as usize);
    // The joined ends must be connectible, and are taken to see each other.
    if light_walk.last().is_some_and(|v| !v.bsdf.is_connectible()) || !camera_walk.last()?.bsdf.is_connectible() {
        return None;
    }
    let mut windows: Vec<bool> = light_walk.iter().map(|v| v.through_window).collect();
    windows.push(false);
    windows.extend(camera_walk.iter().rev().map(|v| v.through_window));
    let inner = light_walk.into_iter().chain(camera_walk.into_iter().rev()).collect();
    Some(FullPath { light, start: emission.point, inner, windows })
}

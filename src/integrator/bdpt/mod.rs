//! Bidirectional path tracing: every technique s ≥ 0, t ≥ 1, weighted by MIS.
//!
//! Per camera sample: `light_paths` light subpaths are traced first, each vertex connected to the camera (t = 1) and
//! kept; then one camera subpath is walked, each vertex being looked at for emission (s = 0), connected to a fresh
//! light sample (s = 1) and to the vertices of the first `connections` light subpaths (s ≥ 2).
//! (Veach 1997, ch. 10; the weights are derived in `docs/MIS.md`.)

mod connect;
mod mis;
pub mod oracle;
mod subpath;
mod vertex;

pub use mis::{LightStart, Mis, Partial};
pub use vertex::Vertex;

use super::{PixelSample, Recorder, Settings};
use crate::accel::Accel;
use crate::sampling::{Sampler, Stream};
use crate::scene::Scene;

/// The bidirectional estimator with its scratch memory.
#[derive(Debug)]
pub struct Bdpt {
    settings: Settings,
    mis: Mis,
    /// Light subpaths traced over all samples of a pass.
    light_paths_per_pass: f64,
    /// Light subpaths to trace for each camera sample: none where no vertex of theirs could be used.
    light_paths: u32,
    /// How many of them camera vertices connect to.
    connections: u32,
    /// Connectible vertices of the sample's light subpaths.
    light_vertices: Vec<Vertex>,
    /// End of those that camera vertices connect to.
    connectible_end: usize,
}

impl Bdpt {
    /// For a pass in which `light_paths_per_pass` light subpaths are traced.
    pub fn new<A: Accel>(scene: &Scene<A>, settings: Settings, light_paths_per_pass: f64) -> Self {
        // Without a surface to connect to, light subpaths could only show the lights themselves, which camera
        // subpaths do better (unweighted, they are what is asked for). What is not traced counts zero in the weights.
        let useful = scene.needs.light && (scene.needs.connections || !settings.weighted);
        let light_paths = if useful { settings.light_paths } else { 0 };
        let light_paths_per_pass = if useful { light_paths_per_pass } else { 0.0 };
        let connections = settings.connections.min(light_paths);
        let mis = Mis::new(settings.heuristic, settings.weighted, f64::from(connections), light_paths_per_pass);
        Self {
            settings,
            mis,
            light_paths_per_pass,
            light_paths,
            connections,
            light_vertices: Vec::new(),
            connectible_end: 0,
        }
    }

    /// Whether light subpaths are traced at all.
    pub fn traces_light(&self) -> bool {
        self.light_paths > 0
    }

    /// One camera sample with its light subpaths.
    pub fn sample<A: Accel, const T: bool>(
        &mut self,
        scene: &Scene<A>,
        sample: PixelSample,
        recorder: &mut Recorder<T>,
    ) {
        self.sample_light(scene, sample, recorder);
        let sampler = self.sampler(scene, sample, Stream::Camera);
        self.walk_camera(scene, sample.pixel, sampler, recorder);
    }

    /// The light subpaths of one camera sample: their splats are recorded, their vertices kept.
    pub fn sample_light<A: Accel, const T: bool>(
        &mut self,
        scene: &Scene<A>,
        sample: PixelSample,
        recorder: &mut Recorder<T>,
    ) {
        recorder.begin(sample.pixel, sample.index);
        self.light_vertices.clear();
        self.connectible_end = 0;
        for number in 0..self.light_paths {
            let sampler = self.sampler(scene, sample, Stream::Light(number));
            self.walk_light(scene, sampler, recorder);
            if number < self.connections {
                self.connectible_end = self.light_vertices.len();
            }
        }
    }

    /// The same estimator with every weight 1.
    #[cold]
    fn unweighted(&self) -> Self {
        let settings = Settings { weighted: false, ..self.settings };
        Self { settings, mis: self.mis.unweighted(), light_vertices: Vec::new(), connectible_end: 0, ..*self }
    }

    fn sampler<A: Accel>(&self, scene: &Scene<A>, sample: PixelSample, stream: Stream) -> Sampler {
        let pixel = sample.key(scene.camera.resolution());
        Sampler::new(self.settings.sampler, self.settings.seed, pixel, stream, sample.index)
    }
}

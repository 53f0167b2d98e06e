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
mod sums;
mod vertex;

pub use mis::{LightStart, Mis, Partial};
pub use sums::{CANDIDATES, Candidates, Sums};
pub use vertex::Vertex;

use std::sync::Arc;

use super::worth::Thresholds;
use super::{PixelSample, Recorder, Settings};
use crate::accel::Accel;
use crate::planted::{Bug, planted};
use crate::sampling::{Sampler, Stream, mix};
use crate::scene::Scene;

/// The bidirectional estimator with its scratch memory.
#[derive(Debug)]
pub struct Bdpt<S = f64> {
    settings: Settings,
    mis: Mis<S>,
    /// Light subpaths traced over all samples of a pass.
    light_paths_per_pass: f64,
    /// Light subpaths to trace for a camera sample that has any: none where no vertex of theirs could be used.
    light_paths: u32,
    /// How many of them camera vertices connect to.
    connections: u32,
    /// The same on average over all camera samples: the count that techniques s, t ≥ 2 have in the weights.
    connections_per_sample: f64,
    /// What visibility rays must be worth.
    thresholds: Option<Arc<Thresholds>>,
    /// Connectible vertices of the sample's light subpaths.
    light_vertices: Vec<Vertex<S>>,
    /// End of those that camera vertices connect to.
    connectible_end: usize,
}

impl Bdpt {
    /// For a pass in which `light_paths_per_pass` light subpaths are traced.
    pub fn new<A: Accel>(scene: &Scene<A>, settings: Settings, light_paths_per_pass: f64) -> Self {
        Self::with(scene, settings, light_paths_per_pass, |connections, light_paths| [connections, light_paths])
    }

    /// The same estimator with visibility rays traced by what they are worth.
    pub fn thrifty(self, thresholds: Option<Arc<Thresholds>>) -> Self {
        Self { thresholds, ..self }
    }
}

impl Bdpt<Candidates> {
    /// The estimator of `new`, which also carries the sums of weights that other counts would have: light subpaths and
    /// connections per camera sample.
    pub fn survey<A: Accel>(
        scene: &Scene<A>,
        settings: Settings,
        light_paths_per_pass: f64,
        others: [[f64; 2]; CANDIDATES - 1],
    ) -> Self {
        let pixels = light_paths_per_pass / f64::from(settings.light_paths);
        Self::with(scene, settings, light_paths_per_pass, |connections, light_paths| {
            let (mut c, mut l) = (Candidates::splat(connections), Candidates::splat(light_paths));
            for (i, [light_paths, connections]) in others.into_iter().enumerate() {
                (c.0[i + 1], l.0[i + 1]) = (connections, light_paths * pixels);
            }
            [c, l]
        })
    }
}

impl<S: Sums> Bdpt<S> {
    fn with<A: Accel>(
        scene: &Scene<A>,
        settings: Settings,
        light_paths_per_pass: f64,
        counts: impl FnOnce(f64, f64) -> [S; 2],
    ) -> Self {
        // Without a surface to connect to, light subpaths could only show the lights themselves, which camera
        // subpaths do better (unweighted, they are what is asked for). What is not traced counts zero in the weights.
        let useful = scene.needs.light && (scene.needs.connections || !settings.weighted);
        let light_paths = if useful { settings.light_paths } else { 0 };
        let light_paths_per_pass = if useful { light_paths_per_pass } else { 0.0 };
        let connections = settings.connections.min(light_paths);
        let one_in = if planted(Bug::SparseUncompensated) { 1 } else { settings.light_one_in };
        let connections_per_sample = f64::from(connections) / f64::from(one_in);
        let [in_weights, splats] = counts(connections_per_sample, light_paths_per_pass);
        Self {
            settings,
            mis: Mis::new(settings.heuristic, settings.weighted, in_weights, splats)
                .trusting(&settings.splat_confidence),
            light_paths_per_pass,
            light_paths,
            connections,
            connections_per_sample,
            thresholds: None,
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
        let Some(index) = self.light_index(scene, sample) else { return };
        for number in 0..self.light_paths {
            // Sequences that are walked at another pace are others.
            let stream = Stream::Light(number | (self.settings.light_one_in - 1) << 16);
            let sampler = self.sampler(scene, PixelSample { index, ..sample }, stream);
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
        Self {
            settings,
            mis: self.mis.unweighted(),
            thresholds: None,
            light_vertices: Vec::new(),
            connectible_end: 0,
            ..*self
        }
    }

    /// Number, among those that have light subpaths, of a camera sample that has. One in n of a pixel's samples has, at a
    /// phase that is the pixel's own: its expected share is 1/n whatever the number of samples.
    #[inline]
    fn light_index<A: Accel>(&self, scene: &Scene<A>, sample: PixelSample) -> Option<u32> {
        let one_in = self.settings.light_one_in;
        if one_in == 1 {
            return Some(sample.index);
        }
        let key = u64::from(sample.key(scene.camera.resolution()));
        let phase = (mix(self.settings.seed ^ mix(key)) % u64::from(one_in)) as u32;
        let place = sample.index.wrapping_add(phase);
        (place % one_in == 0).then_some(place / one_in)
    }

    fn sampler<A: Accel>(&self, scene: &Scene<A>, sample: PixelSample, stream: Stream) -> Sampler {
        let pixel = sample.key(scene.camera.resolution());
        Sampler::new(self.settings.sampler, self.settings.seed, pixel, stream, sample.index)
    }
}

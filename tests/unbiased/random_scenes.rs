//! Path tracing, light tracing and bidirectional path tracing make the same image of random scenes over everything the
//! format has: all lights, materials, textures, maps, windows, cut-outs, cameras, filters and settings, mixed.
//!
//! A path's class is the sequence of its vertices' kinds: a light that can be hit or not, scatterings by a lobe that is a
//! delta or not (of a mixture, the lobe that was used), windows between them, the camera. Two integrators are compared on
//! the classes that both can sample, and the one that makes more is held to them (`PathClass`). With x₀ on the light and
//! x_k the camera:
//!
//! | pair | classes left out |
//! |---|---|
//! | path = bdpt | a delta light and, at x₁, a delta scattering (its caustics) or a window between x₀ and x₁ |
//! | light = bdpt | a delta scattering at x_{k−1} (what is seen in mirrors and through glass), a window between x_{k−1} and x_k, an environment seen directly |
//! | light = path | all of these |
//!
//! What `bdpt` cannot sample either, a delta light's caustic seen in a mirror, is in no class of a pair. How much of the
//! images `bdpt` makes is left out is printed.
//!
//! All that is rendered is rendered anew for each pair, so that the p-values of whole images, one for each scene and pair,
//! are independent and, if nothing is wrong, uniform.
//!
//! Single pixels, channels and lengths of path are dark in places, lit by what one sample in thousands finds. Of such
//! sums of rare things Welch's test knows too little: a side that missed them has less mean and less variance at once, and
//! far p-values are smaller than they ought to be. So these tests are taken in two stages: what looks suspicious is rendered
//! anew with many more samples, and judged by the new images alone, at the level that all suspects together leave. What is
//! judged is independent of why it was chosen; a bias that is there is there again. What one side has hardly found at all
//! (the tail of a pixel's filter reaches a lamp, say) is no test: no number of it is a mean. How little that is of the images
//! is printed, and their means have it in.

#[path = "random_scenes/deck.rs"]
mod deck;
#[path = "random_scenes/family.rs"]
mod family;
#[path = "random_scenes/generator.rs"]
mod generator;
#[path = "random_scenes/materials.rs"]
mod materials;
#[path = "random_scenes/textures.rs"]
mod textures;

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde_json::json;
use twinlight::compare::stats::{Moments, Welch, ks_uniform};
use twinlight::integrator::{Crop, Integrator, PathClass, PixelSample, Recorder, SampleLoop, Settings};
use twinlight::math::{DVec3, Rgb};

use crate::common::{SceneOnDefault, View, diffuse, facing, quad, scene, scene_json, settings, sphere, validation_row};
use family::{Family, histogram, p_value};
use generator::{BOUNCES, RandomScene, random_scenes};

/// Edges of the longest paths.
const EDGES: usize = BOUNCES as usize + 1;

/// Independent renders of each side.
const RUNS: usize = 16;

const PIXELS: usize = 4;

/// Level of the tests for uniform p-values.
const KS_LEVEL: f64 = 1e-3;

/// A side has found a quantity when so many contributions were not black.
const FOUND: u32 = 64;

/// The share of the light that may lie in such numbers: 0.3 to 1.9 % are there with the fast test's samples, a third of that
/// with the deep one's. A technique that makes nothing of some length puts all there that it ought to make.
const MOST_UNTESTED: f64 = 0.05;

/// p-values below this make a suspect, which is rendered again with so many times the samples.
const SUSPICIOUS: f64 = 1e-5;
const MORE: u32 = 8;

/// One render, by number of edges less one and pixel.
#[derive(Default)]
struct Render {
    /// Mean radiance per channel.
    means: [[[f64; 3]; PIXELS]; EDGES],
    /// Contributions that were not black.
    counts: [[u32; PIXELS]; EDGES],
}

/// A pair of integrators, each with the class it is held to and its share of the samples.
struct Pair {
    name: &'static str,
    sides: [(Integrator, PathClass, u32); 2],
}

const ALL: PathClass = PathClass { of_path: false, of_light: false };
const OF_PATH: PathClass = PathClass { of_path: true, of_light: false };
const OF_LIGHT: PathClass = PathClass { of_path: false, of_light: true };

/// One side of a pair makes all that it can, the other what the first can as well. `bdpt` costs most and needs least.
const PAIRS: [Pair; 3] = [
    Pair { name: "path = bdpt", sides: [(Integrator::Path, ALL, 4), (Integrator::Bdpt, OF_PATH, 2)] },
    Pair { name: "light = bdpt", sides: [(Integrator::Light, ALL, 6), (Integrator::Bdpt, OF_LIGHT, 2)] },
    Pair { name: "light = path", sides: [(Integrator::Light, OF_PATH, 6), (Integrator::Path, OF_LIGHT, 3)] },
];

fn render(scene: &SceneOnDefault, settings: Settings, samples: u32) -> Render {
    let mut samplers = SampleLoop::new(scene, settings);
    let mut recorder = Recorder::new(Crop::full([2, 2]), true);
    let mut render = Render::default();
    for pixel in [[0, 0], [1, 0], [0, 1], [1, 1]] {
        for index in 0..samples {
            samplers.sample(PixelSample { pixel, index }, &mut recorder);
            for c in recorder.by_technique() {
                let (edges, pixel) = ((c.technique.s + c.technique.t - 1) as usize, c.pixel as usize);
                for (mean, value) in render.means[edges - 1][pixel].iter_mut().zip(c.value.to_array()) {
                    *mean += f64::from(value) / f64::from(samples);
                }
                render.counts[edges - 1][pixel] += u32::from(c.value != Rgb::ZERO);
            }
            recorder.clear();
        }
    }
    assert_eq!(recorder.rejected().0, 0, "non-finite contributions: {:?}", recorder.rejected().1);
    render
}

/// Sum over pixels and channels.
fn grey_of(pixels: &[[f64; 3]; PIXELS]) -> f64 {
    pixels.iter().flatten().sum()
}

/// The same of paths of all lengths.
fn grey(render: &Render) -> f64 {
    render.means.iter().map(grey_of).sum()
}

fn moments(side: &[Render], value: impl Fn(&Render) -> f64) -> Moments {
    side.iter().map(value).collect()
}

/// Independent renders of both sides of a pair.
fn render_pair(scene: &SceneOnDefault, settings: Settings, pair: &Pair, samples: u32, seed: u64) -> [Vec<Render>; 2] {
    [0, 1].map(|side| {
        let (integrator, class, share) = pair.sides[side];
        let run = |run| {
            let seed = seed + (side * RUNS + run) as u64;
            render(scene, Settings { integrator, class, seed, ..settings }, share * samples)
        };
        (0..RUNS).map(run).collect()
    })
}

/// The renders of a scene.
struct Rendered {
    /// By pair and side.
    pairs: Vec<[Vec<Render>; 2]>,
    /// What `bdpt` makes, held to nothing.
    whole: Moments,
}

/// Seeds of a scene's renders: far enough apart for all of its own.
fn seed_of(scene: usize, seed: u64) -> u64 {
    (seed + scene as u64) * 1000
}

impl Rendered {
    fn new(n: usize, random: &RandomScene, samples: u32, seed: u64) -> Self {
        let scene = scene(&random.json);
        let first = seed_of(n, seed);
        let pair = |i: usize| render_pair(&scene, random.settings, &PAIRS[i], samples, first + 100 * i as u64);
        let whole = |run| grey(&render(&scene, Settings { seed: first + 900 + run, ..random.settings }, samples));
        Self { pairs: (0..PAIRS.len()).map(pair).collect(), whole: (0..4).map(whole).collect() }
    }

    /// Mean and relative variance of what the *other* pairs have found: what a pair is measured by must not come from its
    /// own renders. A run that has missed something rare has too small a mean and too little variance at once.
    fn others(&self, pair: usize) -> (f64, f64) {
        let sides = self.pairs.iter().enumerate().filter(|(i, _)| *i != pair).flat_map(|(_, sides)| sides);
        let sides: Vec<Moments> = sides.map(|side| moments(side, grey)).collect();
        let mean = sides.iter().map(Moments::mean).sum::<f64>() / sides.len() as f64;
        (mean, sides.iter().map(|m| m.variance() / m.mean().powi(2)).sum())
    }
}

/// One number to compare.
#[derive(Clone, Copy, Debug)]
struct Quantity {
    pair: usize,
    scene: usize,
    edges: usize,
    pixel: usize,
    channel: usize,
}

impl Quantity {
    /// Whether both sides have found it.
    fn found(&self, sides: &[Vec<Render>; 2]) -> bool {
        sides.iter().all(|side| side.iter().map(|r| r.counts[self.edges][self.pixel]).sum::<u32>() >= FOUND)
    }

    fn p_value(&self, [a, b]: &[Vec<Render>; 2]) -> Option<f64> {
        let value = |r: &Render| r.means[self.edges][self.pixel][self.channel];
        let unit = moments(b, |r| grey_of(&r.means[self.edges])).mean() / (3 * PIXELS) as f64;
        p_value(&moments(a, value), &moments(b, value), unit)
    }
}

/// Single pixels and channels by length of path, in two stages.
fn single_tests(scenes: &[RandomScene], rendered: &[Rendered], samples: u32, seed: u64) {
    let mut tests = 0;
    let (mut light, mut untested) = ([0.0; PAIRS.len()], [0.0; PAIRS.len()]);
    // By scene and pair, which are rendered once for all of their suspects.
    let mut suspects: BTreeMap<(usize, usize), Vec<(Quantity, f64)>> = BTreeMap::new();
    for (scene, render) in rendered.iter().enumerate() {
        for (pair, sides) in render.pairs.iter().enumerate() {
            for i in 0..EDGES * PIXELS * 3 {
                let (edges, pixel, channel) = (i / (PIXELS * 3), i / 3 % PIXELS, i % 3);
                let quantity = Quantity { pair, scene, edges, pixel, channel };
                // Whoever has found more of it, in shares of the image.
                let mean = |side: &[Render]| moments(side, |r| r.means[edges][pixel][channel]).mean();
                let share = mean(&sides[0]).max(mean(&sides[1])) / moments(&sides[1], grey).mean();
                light[pair] += share;
                if !quantity.found(sides) {
                    untested[pair] += share;
                    continue;
                }
                if let Some(p) = quantity.p_value(sides) {
                    tests += 1;
                    // A NaN is suspicious.
                    if p.is_nan() || p < SUSPICIOUS {
                        suspects.entry((scene, pair)).or_default().push((quantity, p));
                    }
                }
            }
        }
    }
    for ((pair, untested), light) in PAIRS.iter().zip(untested).zip(light) {
        eprintln!(
            "{}: {:.4} % of the light in single numbers not found often enough",
            pair.name,
            100.0 * untested / light
        );
        // A technique that makes nothing of some length would put all that it ought to make here.
        assert!(untested < MOST_UNTESTED * light, "{}: too much that one side has hardly found", pair.name);
    }
    let count: usize = suspects.values().map(Vec::len).sum();
    eprintln!("{tests} single tests, {count} suspects in {} renders", suspects.len());
    let again: Vec<Vec<(Quantity, f64, Option<f64>)>> = suspects
        .par_iter()
        .map(|(&(n, pair), suspects)| {
            let RandomScene { json, settings, .. } = &scenes[n];
            let seed = seed_of(n, seed) + 500 + 100 * pair as u64;
            let sides = render_pair(&scene(json), *settings, &PAIRS[pair], MORE * samples, seed);
            suspects.iter().map(|&(quantity, p)| (quantity, p, quantity.p_value(&sides))).collect()
        })
        .collect();
    let mut family = Family::default();
    for (quantity, before, p) in again.into_iter().flatten() {
        let Quantity { pair, scene, edges, pixel, channel } = quantity;
        let place = format!("scene {scene}, {} edges, pixel {pixel}, channel {channel}", edges + 1);
        let again = p.map_or("nothing".to_owned(), |p| format!("p = {p:.1e}"));
        let label = format!("{}, {place}: p = {before:.1e}, and again {again}", PAIRS[pair].name);
        eprintln!("{label}");
        if let Some(p) = p {
            family.add(p, || label.clone());
        }
    }
    family.conclude("suspects");
}

/// Whole images: one p-value for each scene and pair, which must be uniform.
fn whole_images(rendered: &[Rendered]) {
    let uniform = |what: &str, p: &[f64]| {
        let ks = ks_uniform(p);
        eprintln!("{what}: {} p-values by tenths {}, uniform with p = {:.3}", p.len(), histogram(p), ks.p);
        assert!(ks.p >= KS_LEVEL, "{what}: the p-values are not uniform: {ks:?}");
    };
    let mut all = Vec::new();
    for (i, pair) in PAIRS.iter().enumerate() {
        let test = |(n, render): (usize, &Rendered)| {
            let [a, b] = &render.pairs[i];
            let b = moments(b, grey);
            let welch = Welch::new(&moments(a, grey), &b);
            let [difference, error] = [welch.difference, welch.error].map(|x| 100.0 * x / b.mean());
            eprintln!("{}, scene {n}: {difference:+.3} % ± {error:.3} %, p = {:.4}", pair.name, welch.p);
            welch.p
        };
        let p: Vec<f64> = rendered.iter().enumerate().map(test).collect();
        uniform(pair.name, &p);
        all.extend(p);
    }
    uniform("all pairs", &all);
}

/// Moments over runs of the weighted mean of a pair's differences over scenes, relative to the images' brightness. Scenes
/// count more, the less noise they have, down to the median's.
fn pooled(rendered: &[Rendered], scenes: &[usize], pair: usize, value: impl Fn(&Render) -> f64) -> Moments {
    let others: Vec<(f64, f64)> = rendered.iter().map(|r| r.others(pair)).collect();
    let mut noise: Vec<f64> = others.iter().map(|(_, noise)| *noise).collect();
    noise.sort_by(f64::total_cmp);
    let median = noise[noise.len() / 2];
    let weights: Vec<f64> = scenes.iter().map(|&n| 1.0 / (others[n].1 + median)).collect();
    let total: f64 = weights.iter().sum();
    let difference = |n: usize, run: usize| {
        let [a, b] = &rendered[n].pairs[pair];
        (value(&a[run]) - value(&b[run])) / others[n].0
    };
    (0..RUNS)
        .map(|run| scenes.iter().zip(&weights).map(|(&n, w)| w * difference(n, run)).sum::<f64>() / total)
        .collect()
}

/// Common biases of all scenes, by length of path and of those that share a feature.
fn common_biases(rendered: &[Rendered], by_feature: &[(&String, Vec<usize>)], bound: f64) {
    let all: Vec<usize> = (0..rendered.len()).collect();
    let zero = Moments::from_iter([0.0; RUNS]);
    let mut family = Family::default();
    let mut judge = |what: String, bias: &Moments, shown: bool| {
        let interval = bias.confidence_interval(0.99).scaled(100.0);
        if shown {
            eprintln!("{what}: common bias in {:+.3} … {:+.3} %", interval.low, interval.high);
        }
        if let Some(p) = p_value(bias, &zero, 0.0) {
            family.add(p, || format!("{what}, common bias in {interval:?} %"));
        }
    };
    for (i, pair) in PAIRS.iter().enumerate() {
        for edges in 0..EDGES {
            let what = format!("{}, {} edges, relative to the image", pair.name, edges + 1);
            judge(what, &pooled(rendered, &all, i, |r| grey_of(&r.means[edges])), true);
        }
        for (feature, scenes) in by_feature {
            let what = format!("{}, {} scenes with {feature}", pair.name, scenes.len());
            judge(what, &pooled(rendered, scenes, i, grey), feature.starts_with("light: "));
        }
    }
    family.conclude("common biases by length and by feature");
    for (i, pair) in PAIRS.iter().enumerate() {
        let left_out = rendered.iter().map(|r| 1.0 - moments(&r.pairs[i][1], grey).mean() / r.whole.mean());
        let left_out: Moments = left_out.collect();
        let bias = pooled(rendered, &all, i, grey);
        let (mean, p) = (bias.mean(), p_value(&bias, &zero, 0.0).unwrap_or(f64::NAN));
        let bias = bias.confidence_interval(0.99);
        let case = format!("{} over {} random scenes", pair.name, all.len());
        validation_row(file!(), &case, 1.0 + mean, 1.0, [bias.low, bias.high], bound, p);
        eprintln!(
            "{}, {} scenes: common bias in {:+.3} … {:+.3} %; of what bdpt makes {:.1} % are left out",
            pair.name,
            all.len(),
            100.0 * bias.low,
            100.0 * bias.high,
            100.0 * left_out.mean()
        );
        assert!(bias.within(bound), "{}: {bias:?} is not proven inside ±{bound}", pair.name);
    }
}

/// Compares the pairs over `count` scenes. Each feature has to occur so many times, and the common bias of each pair has
/// to be proven inside ±`bound`.
fn agree(count: usize, samples: u32, seed: u64, occurrences: usize, bound: f64) {
    let (scenes, features) = random_scenes(count, seed);
    let having = |feature: &String| (0..count).filter(|&n| scenes[n].features.contains(feature)).collect();
    let by_feature: Vec<(&String, Vec<usize>)> = features.iter().map(|feature| (feature, having(feature))).collect();
    for (feature, scenes) in &by_feature {
        eprintln!("{feature}: {} scenes", scenes.len());
        assert!(scenes.len() >= occurrences, "{feature}: in {} scenes only", scenes.len());
    }
    let rendered: Vec<Rendered> =
        scenes.par_iter().enumerate().map(|(n, random)| Rendered::new(n, random, samples, seed)).collect();
    whole_images(&rendered);
    common_biases(&rendered, &by_feature, bound);
    single_tests(&scenes, &rendered, samples, seed);
}

/// What is outside a class is left out to the last contribution, and nothing that is inside.
#[test]
fn classes_keep_out_what_one_side_cannot_make() {
    let view = View { from: DVec3::Z, at: DVec3::ZERO, up: DVec3::Y, vfov: 60.0, resolution: [2, 2] };
    let floor = quad(&facing(DVec3::new(0.0, -1.0, 0.0), DVec3::Y), [6.0; 2], diffuse(0.5));
    let wall = quad(&facing(DVec3::new(0.0, 0.0, -1.0), DVec3::Z), [6.0; 2], diffuse(0.5));
    let lamp = json!({ "type": "point", "position": [0.2, 0.8, -0.2], "intensity": 1 });
    let window = |at: DVec3| sphere(at, 0.15, false, json!({ "type": "null" }));
    for (what, surround, class, other) in [
        ("the light behind a window", DVec3::new(0.2, 0.8, -0.2), OF_PATH, OF_LIGHT),
        ("the camera behind a window", DVec3::Z, OF_LIGHT, OF_PATH),
    ] {
        let scene =
            scene(&scene_json(view.json(), vec![floor.clone(), wall.clone(), window(surround)], vec![lamp.clone()]));
        let bdpt = |class| grey(&render(&scene, Settings { class, ..settings(Integrator::Bdpt, BOUNCES) }, 64));
        assert_eq!(bdpt(class), 0.0, "{what}");
        assert!(bdpt(ALL) > 0.0, "{what}: nothing is left to be kept out");
        assert_eq!(bdpt(ALL), bdpt(other), "{what}: the other class holds all of it");
    }
}

#[test]
fn everything_by_path_light_and_bdpt() {
    agree(24, 1 << 8, 9000, 2, 0.03);
}

#[test]
#[ignore = "deep"]
fn two_hundred_scenes_by_path_light_and_bdpt() {
    agree(200, 3 << 8, 9100, 10, 0.003);
}

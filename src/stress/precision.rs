//! How far rounding takes a scene: the contributions and weights of `bdpt`'s own samples against f64.

use std::collections::BTreeMap;
use std::fmt::Write;

use rayon::prelude::*;
use serde_json::{Value, json};

use super::quantiles::{Errors, QUANTILES};
use crate::accel::Accel;
use crate::film::Accumulator;
use crate::integrator::bdpt::oracle::replay::{Compared, Judged, judge, settings};
use crate::integrator::bdpt::oracle::{Faults, Judge, worse};
use crate::integrator::trace::Step;
use crate::integrator::{Crop, PixelSample, Recorder, SampleLoop, Settings};
use crate::scene::Scene;

/// Longer paths share one row.
const LONGEST: u32 = 64;

/// Rows of pixels that are judged at once: what they find is summed in their order.
const ROWS: u32 = 64;

/// The paths of a scene, judged.
#[derive(Debug, Default)]
pub struct Precision {
    by_edges: BTreeMap<u32, Both>,
    by_decade: BTreeMap<i32, Both>,
    /// Paths whose condition has no bound.
    unbounded: u64,
    worst_unbounded: f64,
    worst_over_condition: [f64; 2],
    /// Over all paths: their values, how rounding changes these, the sizes of the changes.
    sums: [f64; 3],
    untold: u64,
    /// Contributions that were kept from the image: not finite, too large.
    left_out: [u64; 2],
    faults: Faults,
}

/// Errors of contributions with the weight 1, and of weights.
#[derive(Clone, Debug, Default)]
struct Both {
    contribution: Errors,
    weight: Errors,
}

impl Both {
    fn push(&mut self, path: &Compared) {
        self.contribution.push(path.contribution);
        self.weight.push(path.weight);
    }

    fn merge(&mut self, o: &Self) {
        self.contribution.merge(&o.contribution);
        self.weight.merge(&o.weight);
    }

    fn paths(&self) -> u64 {
        self.contribution.count()
    }
}

/// Bytes that the steps of a sample on each thread may take while they are judged, with paths that scatter at most so many
/// times: one step for each technique that makes a path, and those of the walks.
pub fn bytes_of_steps(max_bounces: u32) -> u64 {
    let edges = u64::from(max_bounces) + 1;
    let techniques = edges.saturating_mul(edges + 3) / 2;
    let steps = techniques.saturating_add(8 * edges);
    steps.saturating_mul(size_of::<Step>() as u64).saturating_mul(rayon::current_num_threads() as u64)
}

/// Makes `samples` samples of each pixel by `bdpt` and judges their paths; of the settings those that can be.
pub fn precision<A: Accel>(scene: &Scene<A>, given: Settings, samples: u32) -> Precision {
    let settings = settings(given);
    let [width, height] = scene.camera.resolution();
    let of_row = |y: u32| {
        let of_scene = Judge::new(scene, settings);
        let mut recorder = Recorder::traced(Crop::full([width, height])).within(Accumulator::largest(scene.brightness));
        let mut loops = SampleLoop::new(scene, settings);
        let (mut row, mut judged) = (Precision::default(), Judged::default());
        for x in 0..width {
            for index in 0..samples {
                let sample = PixelSample { pixel: [x, y], index };
                judge(&of_scene, &mut loops, sample, &mut recorder, &mut judged, &mut |path| row.push(path));
            }
        }
        (row.untold, row.faults) = (judged.untold, judged.faults);
        row.left_out = [recorder.rejected().0, recorder.overflows()];
        row
    };
    let mut all = Precision::default();
    for first in (0..height).step_by(ROWS as usize) {
        let rows: Vec<Precision> = (first..height.min(first + ROWS)).into_par_iter().map(of_row).collect();
        rows.into_iter().for_each(|row| all.merge(row));
    }
    all
}

/// A line of the tables.
struct Row {
    name: String,
    paths: u64,
    contribution: [f64; 4],
    weight: [f64; 4],
}

impl Row {
    fn new(name: String, both: &Both) -> Self {
        Self { name, paths: both.paths(), contribution: both.contribution.quantiles(), weight: both.weight.quantiles() }
    }
}

impl Precision {
    fn push(&mut self, path: &Compared) {
        let edges = (path.technique.s + path.technique.t - 1).min(LONGEST + 1);
        self.by_edges.entry(edges).or_default().push(path);
        let change = path.value * ((1.0 + path.contribution) * (1.0 + path.weight) - 1.0);
        self.add([path.value, change, change.abs()]);
        let errors = [path.contribution.abs(), path.weight.abs()];
        if path.condition.is_finite() {
            let decade = path.condition.log10().floor().max(-12.0) as i32;
            self.by_decade.entry(decade).or_default().push(path);
            for (worst, error) in self.worst_over_condition.iter_mut().zip(errors) {
                *worst = worse(*worst, error / path.condition);
            }
        } else {
            self.unbounded += 1;
            self.worst_unbounded = worse(self.worst_unbounded, worse(errors[0], errors[1]));
        }
    }

    fn add(&mut self, sums: [f64; 3]) {
        self.sums.iter_mut().zip(sums).for_each(|(sum, x)| *sum += x);
    }

    fn merge(&mut self, o: Self) {
        for (edges, both) in &o.by_edges {
            self.by_edges.entry(*edges).or_default().merge(both);
        }
        for (decade, both) in &o.by_decade {
            self.by_decade.entry(*decade).or_default().merge(both);
        }
        self.unbounded += o.unbounded;
        self.worst_unbounded = worse(self.worst_unbounded, o.worst_unbounded);
        for (worst, other) in self.worst_over_condition.iter_mut().zip(o.worst_over_condition) {
            *worst = worse(*worst, other);
        }
        self.add(o.sums);
        self.untold += o.untold;
        for (n, other) in self.left_out.iter_mut().zip(o.left_out) {
            *n += other;
        }
        self.faults = std::mem::take(&mut self.faults).merge(o.faults);
    }

    /// Paths that were judged.
    pub fn paths(&self) -> u64 {
        self.by_edges.values().map(Both::paths).sum()
    }

    /// Paths that could not be, such as those that see a surface edge-on.
    pub fn unjudged(&self) -> u64 {
        self.untold
    }

    /// What no rounding explains: the first, and how many there are.
    pub fn faults(&self) -> &Faults {
        &self.faults
    }

    /// The median relative errors of contributions and of weights, to 1 %.
    pub fn median(&self) -> [f64; 2] {
        let all = self.all();
        [all.contribution[0], all.weight[0]]
    }

    /// By how much rounding changes the image's sum, and the sum of the changes' sizes, both relative to the sum.
    pub fn image(&self) -> [f64; 2] {
        let [sum, changes, sizes] = self.sums;
        [changes / sum, sizes / sum]
    }

    fn all(&self) -> Row {
        let mut all = Both::default();
        self.by_edges.values().for_each(|both| all.merge(both));
        Row::new("all".to_owned(), &all)
    }

    fn rows(&self) -> Vec<Row> {
        let name = |edges: u32| if edges > LONGEST { format!(">{LONGEST}") } else { edges.to_string() };
        let mut rows: Vec<Row> = self.by_edges.iter().map(|(edges, both)| Row::new(name(*edges), both)).collect();
        rows.push(self.all());
        rows
    }

    /// How many paths have a condition without bound, and the largest error of theirs: where a density ends, at a spot's very rim
    /// or a filter's, and where a cosine is 0.
    pub fn unbounded(&self) -> (u64, f64) {
        (self.unbounded, self.worst_unbounded)
    }

    /// The largest error of a contribution and of a weight, over the path's condition where that has a bound.
    pub fn worst_over_condition(&self) -> [f64; 2] {
        self.worst_over_condition
    }

    /// The report for people.
    pub fn text(&self) -> String {
        let mut out = String::new();
        let line = |out: &mut String, text: String| {
            // Writing to a String cannot fail.
            let _ = writeln!(out, "{text}");
        };
        let [bad, large] = self.left_out;
        if bad + large > 0 {
            line(
                &mut out,
                format!(
                    "left out of the image: {bad} contributions that are not finite, {large} that overflow the film"
                ),
            );
        }
        if self.paths() == 0 {
            line(&mut out, format!("no paths found that carry light and can be judged; {} not judged", self.untold));
            if self.faults.count > 0 {
                line(&mut out, format!("fault: {}", self.faults));
            }
            return out;
        }
        line(&mut out, format!("{} paths against f64, {} more not judged", self.paths(), self.untold));
        line(
            &mut out,
            format!(
                "{:>5} {:>9}  {:<31}  {:<31}",
                "edges", "paths", "contribution, relative error", "weight, relative error"
            ),
        );
        let heads = "  median   99 %    99.9 %  largest";
        line(&mut out, format!("{:>15}{heads}{heads}", ""));
        let four = |x: [f64; 4]| x.map(|x| format!("{x:7.1e}")).join(" ");
        for row in self.rows() {
            line(
                &mut out,
                format!("{:>5} {:>9}  {}  {}", row.name, row.paths, four(row.contribution), four(row.weight)),
            );
        }
        let [sum, sizes] = self.image();
        line(&mut out, format!("the image: {sum:+.1e} of its sum; sizes of all changes {sizes:.1e}"));
        line(&mut out, "by the condition: what rounding the path's points to f32 does to its densities".to_owned());
        for (decade, both) in &self.by_decade {
            let row = Row::new(format!("1e{decade:<3} to 1e{:<3}", decade + 1), both);
            let (contribution, weight) = (four(row.contribution), four(row.weight));
            line(&mut out, format!("{} {:>3}  {contribution}  {weight}", row.name, row.paths));
        }
        let (unbounded, largest) = self.unbounded();
        if unbounded > 0 {
            line(
                &mut out,
                format!(
                    "where it has no bound, at a spot's or a filter's rim: {unbounded} paths, off by at most {largest:.1e}"
                ),
            );
        }
        if self.faults.count > 0 {
            line(&mut out, format!("fault: {}", self.faults));
        }
        let [contribution, weight] = self.worst_over_condition();
        line(
            &mut out,
            format!(
                "no contribution is off by more than {contribution:.2} times the condition, no weight by more than {weight:.2}"
            ),
        );
        out
    }

    /// The report for programs.
    pub fn json(&self) -> Value {
        let row = |row: &Row| json!({ "edges": row.name, "paths": row.paths, "contribution": row.contribution, "weight": row.weight });
        let decade = |(power, both): (&i32, &Both)| {
            let row = Row::new(String::new(), both);
            json!({ "power": power, "paths": row.paths, "contribution": row.contribution, "weight": row.weight })
        };
        // Of no paths there is no image.
        let [sum, sizes] = self.image().map(|x| x.is_finite().then_some(x));
        json!({
            "paths": self.paths(),
            "unjudged": self.untold,
            "non_finite": self.left_out[0],
            "overflows": self.left_out[1],
            "quantiles": QUANTILES,
            "rows": self.rows().iter().map(row).collect::<Vec<Value>>(),
            "image": { "sum": sum, "sizes": sizes },
            "decades": self.by_decade.iter().map(decade).collect::<Vec<Value>>(),
            "worst_over_condition": self.worst_over_condition(),
            "without_bound": { "paths": self.unbounded().0, "worst": self.unbounded().1 },
            "faults": { "count": self.faults.count, "first": self.faults.first.as_ref().map(ToString::to_string) },
        })
    }
}

//! How far rounding takes a scene: the contributions and weights of `bdpt`'s own samples against f64.

use std::fmt::Write;

use rayon::prelude::*;
use serde_json::{Value, json};

use crate::accel::Accel;
use crate::film::Accumulator;
use crate::integrator::bdpt::oracle::replay::{Compared, Judged, judge, settings};
use crate::integrator::bdpt::oracle::{Judge, worse};
use crate::integrator::{Crop, PixelSample, Recorder, SampleLoop, Settings};
use crate::scene::Scene;

/// Shares of the paths whose errors are told.
const QUANTILES: [f64; 4] = [0.5, 0.99, 0.999, 1.0];

/// Faults that are told of.
const FAULTS: usize = 5;

/// The paths of a scene, judged.
#[derive(Debug)]
pub struct Precision {
    paths: Vec<Compared>,
    untold: u64,
    /// Contributions that were kept from the image: not finite, too large.
    left_out: [u64; 2],
    faults: Vec<String>,
}

/// Makes `samples` samples of each pixel by `bdpt` and judges their paths; of the settings those that can be.
pub fn precision<A: Accel>(scene: &Scene<A>, given: Settings, samples: u32) -> Precision {
    let settings = settings(given);
    let [width, height] = scene.camera.resolution();
    let of_row = |y: u32| {
        let of_scene = Judge::new(scene, settings);
        let mut recorder = Recorder::traced(Crop::full([width, height])).within(Accumulator::largest(scene.brightness));
        let mut loops = SampleLoop::new(scene, settings);
        let mut out = Judged::default();
        for x in 0..width {
            for index in 0..samples {
                judge(&of_scene, &mut loops, PixelSample { pixel: [x, y], index }, &mut recorder, &mut out);
            }
        }
        (out, [recorder.rejected().0, recorder.overflows()])
    };
    let (rows, left_out): (Vec<Judged>, Vec<[u64; 2]>) = (0..height).into_par_iter().map(of_row).unzip();
    let left_out = left_out.into_iter().fold([0; 2], |[a, b], [c, d]| [a + c, b + d]);
    let untold = rows.iter().map(|row| row.untold).sum();
    let faults = rows.iter().filter_map(|row| row.fault.clone()).take(FAULTS).collect();
    Precision { paths: rows.into_iter().flat_map(|row| row.paths).collect(), untold, left_out, faults }
}

/// The errors at the quantiles; `errors` need not be sorted.
fn quantiles(mut errors: Vec<f64>) -> [f64; 4] {
    errors.sort_by(f64::total_cmp);
    let last = errors.len().saturating_sub(1);
    QUANTILES.map(|q| errors.get((q * last as f64).round() as usize).copied().unwrap_or(0.0))
}

/// Paths of like condition.
struct Decade {
    power: i32,
    paths: usize,
    contribution: [f64; 4],
    weight: [f64; 4],
}

/// A row of the table.
struct Row {
    edges: String,
    paths: usize,
    contribution: [f64; 4],
    weight: [f64; 4],
}

impl Precision {
    /// Paths that were judged.
    pub fn paths(&self) -> usize {
        self.paths.len()
    }

    /// Paths that could not be, such as those that see a surface edge-on.
    pub fn unjudged(&self) -> u64 {
        self.untold
    }

    /// What is wrong beyond rounding, as the judge tells it; the first of them.
    pub fn faults(&self) -> &[String] {
        &self.faults
    }

    /// The median relative errors of contributions and of weights.
    pub fn median(&self) -> [f64; 2] {
        let all = self.row(None);
        [all.contribution[0], all.weight[0]]
    }

    /// By how much rounding changes the image's sum, and the sum of the changes' sizes, both relative to the sum.
    pub fn image(&self) -> [f64; 2] {
        let sum: f64 = self.paths.iter().map(|p| p.value).sum();
        let change = |p: &Compared| p.value * ((1.0 + p.contribution) * (1.0 + p.weight) - 1.0);
        let changes: f64 = self.paths.iter().map(change).sum();
        let sizes: f64 = self.paths.iter().map(|p| change(p).abs()).sum();
        [changes / sum, sizes / sum]
    }

    fn row(&self, edges: Option<u32>) -> Row {
        let of = |p: &&Compared| edges.is_none_or(|n| p.technique.s + p.technique.t == n + 1);
        let errors = |error: fn(&Compared) -> f64| {
            let all: Vec<f64> = self.paths.iter().filter(of).map(|p| error(p).abs()).collect();
            (all.len(), quantiles(all))
        };
        let (paths, contribution) = errors(|p| p.contribution);
        let (_, weight) = errors(|p| p.weight);
        Row { edges: edges.map_or("all".to_owned(), |n| n.to_string()), paths, contribution, weight }
    }

    fn rows(&self) -> Vec<Row> {
        let longest = self.paths.iter().map(|p| p.technique.s + p.technique.t - 1).max().unwrap_or(0);
        let mut rows: Vec<Row> = (1..=longest).map(|n| self.row(Some(n))).filter(|row| row.paths > 0).collect();
        rows.push(self.row(None));
        rows
    }

    /// Paths by decades of their condition.
    fn decades(&self) -> Vec<Decade> {
        let decade = |p: &Compared| p.condition.log10().floor().max(-12.0) as i32;
        let mut all: Vec<i32> = self.bounded().map(decade).collect();
        all.sort_unstable();
        all.dedup();
        let of = |power: i32| {
            let paths = || self.bounded().filter(move |p| decade(p) == power);
            let quantiles = |error: fn(&Compared) -> f64| quantiles(paths().map(error).collect());
            Decade {
                power,
                paths: paths().count(),
                contribution: quantiles(|p| p.contribution.abs()),
                weight: quantiles(|p| p.weight.abs()),
            }
        };
        all.into_iter().map(of).collect()
    }

    /// Those whose condition has a bound.
    fn bounded(&self) -> impl Iterator<Item = &Compared> {
        self.paths.iter().filter(|p| p.condition.is_finite())
    }

    /// How many paths have a condition without bound, at a spot's very rim, and the largest error of theirs.
    pub fn unbounded(&self) -> (usize, f64) {
        let of = |p: &Compared| worse(p.contribution.abs(), p.weight.abs());
        let errors: Vec<f64> = self.paths.iter().filter(|p| !p.condition.is_finite()).map(of).collect();
        (errors.len(), errors.into_iter().fold(0.0, worse))
    }

    /// The largest error of a contribution and of a weight, over the path's condition where that has a bound.
    pub fn worst_over_condition(&self) -> [f64; 2] {
        let worst = |error: fn(&Compared) -> f64| self.bounded().map(|p| error(p).abs() / p.condition).fold(0.0, worse);
        [worst(|p| p.contribution), worst(|p| p.weight)]
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
        if self.paths.is_empty() {
            line(&mut out, format!("no paths found that carry light and can be judged; {} not judged", self.untold));
            for fault in &self.faults {
                line(&mut out, format!("fault: {fault}"));
            }
            return out;
        }
        line(&mut out, format!("{} paths against f64, {} more not judged", self.paths.len(), self.untold));
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
                format!("{:>5} {:>9}  {}  {}", row.edges, row.paths, four(row.contribution), four(row.weight)),
            );
        }
        let [sum, sizes] = self.image();
        line(&mut out, format!("the image: {sum:+.1e} of its sum; sizes of all changes {sizes:.1e}"));
        line(&mut out, "by the condition: what rounding the path's points to f32 does to its densities".to_owned());
        for d in self.decades() {
            let (low, high) = (d.power, d.power + 1);
            line(
                &mut out,
                format!("1e{low:<3} to 1e{high:<3} {:>3}  {}  {}", d.paths, four(d.contribution), four(d.weight)),
            );
        }
        let (unbounded, largest) = self.unbounded();
        if unbounded > 0 {
            line(
                &mut out,
                format!("at a spot's rim, where it has no bound: {unbounded} paths, off by at most {largest:.1e}"),
            );
        }
        for fault in &self.faults {
            line(&mut out, format!("fault: {fault}"));
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
        let row = |row: &Row| json!({ "edges": row.edges, "paths": row.paths, "contribution": row.contribution, "weight": row.weight });
        let decade = |d: &Decade| json!({ "power": d.power, "paths": d.paths, "contribution": d.contribution, "weight": d.weight });
        // Of no paths there is no image.
        let [sum, sizes] = self.image().map(|x| x.is_finite().then_some(x));
        json!({
            "paths": self.paths.len(),
            "unjudged": self.untold,
            "non_finite": self.left_out[0],
            "overflows": self.left_out[1],
            "quantiles": QUANTILES,
            "rows": self.rows().iter().map(row).collect::<Vec<Value>>(),
            "image": { "sum": sum, "sizes": sizes },
            "decades": self.decades().iter().map(decade).collect::<Vec<Value>>(),
            "worst_over_condition": self.worst_over_condition(),
            "without_bound": { "paths": self.unbounded().0, "worst": self.unbounded().1 },
            "faults": self.faults,
        })
    }
}

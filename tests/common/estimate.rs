//! The two-sided assertions.

use std::panic::Location;

use twinlight::compare::stats::{Moments, Welch, sidak, student_t_quantile, student_t_two_sided};
use twinlight::film::Image;

/// Level of a whole family of tests: the chance that one assertion fails for nothing when its seeds are drawn.
pub const ALPHA: f64 = 1e-4;

/// Confidence of the intervals that must lie inside the bounds.
const CONFIDENCE: f64 = 0.99;

/// Relative differences below this are rounding: a few dozen f32 operations make a contribution, and where the
/// sampling error vanishes (a point light seen through a small pixel) they are all there is to see.
pub const ROUNDING: f64 = 1e-5;

/// What to look at, and how small the difference must be proven to be.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Columns and rows of tiles.
    pub grid: [u32; 2],
    /// Bound of the bias in every tile, relative to the expected value there; with `assert_same` relative to the
    /// image's mean, for tiles may be dark.
    pub tile: f64,
    /// Bound of the bias of the whole image's mean, relative.
    pub mean: f64,
    /// Relative differences below this are not the estimator's: they are rounding, or the expected value's own error.
    pub rounding: f64,
}

impl Bounds {
    /// Bounds of the bias in each tile and of the mean.
    pub fn new(grid: [u32; 2], tile: f64, mean: f64) -> Self {
        Self { grid, tile, mean, rounding: ROUNDING }
    }

    /// A bound of the bias of the whole image's mean alone.
    pub fn of_mean(mean: f64) -> Self {
        Self::new([1, 1], mean, mean)
    }
}

/// Means over the tiles of a grid: channel fastest, then column, then row.
fn tile_means(image: &Image, [columns, rows]: [u32; 2]) -> Vec<f64> {
    assert!(image.width % columns == 0 && image.height % rows == 0, "tiles of unequal size");
    let (tw, th) = (image.width / columns, image.height / rows);
    let mut sums = vec![0.0; (columns * rows * 3) as usize];
    for y in 0..image.height {
        for x in 0..image.width {
            let first = ((y / th * columns + x / tw) * 3) as usize;
            for (sum, v) in sums[first..first + 3].iter_mut().zip(image.get(x, y)) {
                *sum += f64::from(v) / f64::from(tw * th);
            }
        }
    }
    sums
}

/// The moments of each tile's means over independent images.
fn tile_moments(images: &[Image], grid: [u32; 2]) -> Vec<Moments> {
    let mut moments = vec![Moments::default(); (grid[0] * grid[1] * 3) as usize];
    for image in images {
        for (m, x) in moments.iter_mut().zip(tile_means(image, grid)) {
            m.push(x);
        }
    }
    moments
}

/// Grey values per tile, times a colour.
pub fn expect_colored(grey: &[f64], color: [f64; 3]) -> Vec<f64> {
    grey.iter().flat_map(|g| color.map(|c| g * c)).collect()
}

/// What a family of tests has come to.
#[derive(Debug)]
struct Family {
    /// Smallest p-value.
    p: f64,
    /// The farthest end of an interval, relative.
    reach: f64,
    /// In words, what is wrong.
    faults: Vec<String>,
    /// Level of each test, and what is rounding.
    level: f64,
    rounding: f64,
    bound: f64,
    /// What came closest to its bound.
    closest: Closest,
}

/// One comparison: the two values, and the interval of their relative difference.
#[derive(Clone, Copy, Debug, Default)]
struct Closest {
    measured: f64,
    expected: f64,
    low: f64,
    high: f64,
}

/// Prints a row of the table that `scripts/test-deep` makes of all comparisons (docs/VALIDATION.md): `low` and `high` end
/// the 99 % interval of the relative difference of what was `measured` from what was `expected`, `p` is the smallest. The
/// row bears the name of the test, which a test's thread has.
#[allow(clippy::too_many_arguments)] // the columns of a table
pub fn validation_row(file: &str, case: &str, measured: f64, expected: f64, [low, high]: [f64; 2], bound: f64, p: f64) {
    let percent = |x: f64| format!("{:+.3}", 100.0 * x);
    let (low, high, bound) = (percent(low), percent(high), format!("{:.3}", 100.0 * bound));
    let test = std::thread::current().name().unwrap_or("").to_owned();
    // One string that begins a line: whatever else is printed at the same time stands before or after it.
    let row = format!(
        "\nvalidation\t{file}\t{test}\t{case}\t{measured:.6e}\t{expected:.6e}\t{low}\t{high}\t{bound}\t{p:.2e}\n"
    );
    let _ = std::io::Write::write_all(&mut std::io::stderr().lock(), row.as_bytes());
}

impl Family {
    fn new(tests: usize, bound: f64, rounding: f64) -> Self {
        let level = sidak(ALPHA, tests as u64);
        Self { p: 1.0, reach: 0.0, faults: Vec::new(), level, rounding, bound, closest: Closest::default() }
    }

    /// Judges the difference of two values with its standard error and degrees of freedom; `unit` is what relative means
    /// here.
    fn judge(&mut self, place: &str, [measured, expected]: [f64; 2], error: f64, dof: f64, unit: f64) {
        let difference = measured - expected;
        let excess = (difference.abs() - self.rounding * unit).max(0.0);
        let p = if error > 0.0 { student_t_two_sided(excess / error, dof) } else { f64::from(u8::from(excess == 0.0)) };
        let half = if error > 0.0 { student_t_quantile(0.5 + 0.5 * CONFIDENCE, dof) * error } else { 0.0 };
        let reach = (difference.abs() + half) / unit;
        if reach >= self.reach {
            self.closest =
                Closest { measured, expected, low: (difference - half) / unit, high: (difference + half) / unit };
        }
        self.p = self.p.min(p);
        self.reach = self.reach.max(reach);
        if p.is_nan() || p < self.level {
            self.faults.push(format!("{place}: off by {:+.4} %, p = {p:.2e}", 100.0 * difference / unit));
        }
        if reach.is_nan() || reach >= self.bound {
            let (bias, half) = (100.0 * difference / unit, 100.0 * half / unit);
            let bound = 100.0 * self.bound;
            self.faults.push(format!("{place}: bias {bias:+.4} % ± {half:.4} % is not proven inside ±{bound} %"));
        }
    }

    fn conclude(self, what: &str, scope: &str, file: &str) {
        let Closest { measured, expected, low, high } = self.closest;
        validation_row(file, &format!("{what}, {scope}"), measured, expected, [low, high], self.bound, self.p);
        assert!(self.faults.is_empty(), "{what}, {scope}:\n  {}", self.faults.join("\n  "));
    }
}

/// Demands that independent images have the expected values: `expected` per tile and channel (channel fastest).
#[track_caller]
pub fn assert_closed(what: &str, images: &[Image], expected: &[f64], bounds: Bounds) {
    let file = Location::caller().file();
    let tiles = (bounds.grid[0] * bounds.grid[1]) as usize;
    assert_eq!(expected.len(), 3 * tiles, "{what}: one expected value per tile and channel");
    let whole: Vec<f64> = (0..3).map(|c| expected.iter().skip(c).step_by(3).sum::<f64>() / tiles as f64).collect();
    for (scope, grid, expected, bound) in
        [("mean", [1, 1], whole.as_slice(), bounds.mean), ("tiles", bounds.grid, expected, bounds.tile)]
    {
        let mut family = Family::new(expected.len(), bound, bounds.rounding);
        for (i, (m, &e)) in tile_moments(images, grid).iter().zip(expected).enumerate() {
            let place = format!("tile {} channel {}", i / 3, i % 3);
            if e == 0.0 {
                if m.mean() != 0.0 {
                    family.faults.push(format!("{place}: {} where nothing is to be", m.mean()));
                }
                continue;
            }
            let error = (m.variance() / m.count() as f64).sqrt();
            family.judge(&place, [m.mean(), e], error, m.count() as f64 - 1.0, e);
        }
        family.conclude(what, scope, file);
        if tiles == 1 {
            break;
        }
    }
}

/// Demands that two sets of independent images have the same means, by Welch's test.
#[track_caller]
pub fn assert_same(what: &str, a: &[Image], b: &[Image], bounds: Bounds) {
    let file = Location::caller().file();
    let means = tile_moments(b, [1, 1]);
    for (scope, grid, bound) in [("mean", [1, 1], bounds.mean), ("tiles", bounds.grid, bounds.tile)] {
        let (ma, mb) = (tile_moments(a, grid), tile_moments(b, grid));
        let mut family = Family::new(ma.len(), bound, bounds.rounding);
        for (i, (x, y)) in ma.iter().zip(&mb).enumerate() {
            let unit = means[i % 3].mean();
            assert!(unit > 0.0, "{what}: channel {} is black; nothing is compared", i % 3);
            let place = format!("tile {} channel {}", i / 3, i % 3);
            let welch = Welch::new(x, y);
            family.judge(&place, [x.mean(), y.mean()], welch.error, welch.dof, unit);
        }
        family.conclude(what, scope, file);
        if bounds.grid == [1, 1] {
            break;
        }
    }
}

/// Moments over independent runs of the ratio of summed means of two lists of scenes, each normalised by its own mean:
/// pools many scenes into one sharp statement about a common bias. `pairs` holds the images of both sides per scene.
pub fn pooled_ratio(pairs: &[(Vec<Image>, Vec<Image>)]) -> Moments {
    let mut pooled = Moments::default();
    let runs = pairs.iter().map(|(a, b)| a.len().min(b.len())).min().unwrap_or(0);
    let grey = |image: &Image| image.mean().iter().sum::<f64>();
    // Normalised by a mean over all runs of the other side, which the run at hand hardly moves.
    let scale: Vec<f64> = pairs.iter().map(|(_, b)| b.iter().map(&grey).sum::<f64>() / b.len() as f64).collect();
    for run in 0..runs {
        let sum: f64 = pairs.iter().zip(&scale).map(|((a, b), s)| (grey(&a[run]) - grey(&b[run])) / s).sum();
        pooled.push(sum / pairs.len() as f64);
    }
    pooled
}

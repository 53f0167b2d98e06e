//! The statistics that the tests and the `compare` command share: is a difference real, and is it small enough?
//!
//! A test of "no difference" that is too noisy passes everything. So each one comes in a pair: Welch's test (is there
//! evidence of a difference?) and `Interval::within` (is there evidence that it is small?).

mod median;

pub use median::{Median, median_order};

use super::special::{erfc, gamma_q, incomplete_beta_with_complement};

/// Count, mean and variance of a stream of values, without cancellation (Welford 1962, "Note on a Method for
/// Calculating Corrected Sums of Squares and Products").
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    /// Sum of squared deviations from the mean.
    m2: f64,
}

impl Moments {
    /// Adds a value.
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let before = x - self.mean;
        self.mean += before / self.count as f64;
        self.m2 += before * (x - self.mean);
    }

    /// The moments of both streams together (Chan, Golub, LeVeque 1983, "Algorithms for Computing the Sample
    /// Variance", (2.1)).
    pub fn merged(self, other: Self) -> Self {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { other } else { self };
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let delta = other.mean - self.mean;
        Self {
            count: self.count + other.count,
            mean: self.mean + delta * m / (n + m),
            m2: self.m2 + other.m2 + delta * delta * n * m / (n + m),
        }
    }

    /// How many values there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; 0 of none.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The unbiased estimate of their variance; NaN of fewer than two.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.m2 / (self.count - 1) as f64 }
    }

    /// The squared standard error of the mean.
    fn variance_of_mean(&self) -> f64 {
        self.variance() / self.count as f64
    }

    /// The interval that covers the true mean with the given confidence (in (0, 1)), by Student's t.
    pub fn confidence_interval(&self, confidence: f64) -> Interval {
        let half = student_t_quantile(0.5 + 0.5 * confidence, self.count as f64 - 1.0) * self.variance_of_mean().sqrt();
        Interval { low: self.mean - half, high: self.mean + half }
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|x| moments.push(x));
        moments
    }
}

/// A closed interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The equivalence test: whether all of the interval lies strictly inside ±`bound`. For a confidence interval of
    /// a bias at confidence `1 − 2α` this is the two one-sided tests at level α (Schuirmann 1987, "A comparison of the
    /// two one-sided tests procedure and the power approach"). False for NaN: too few values prove nothing.
    pub fn within(&self, bound: f64) -> bool {
        self.low > -bound && self.high < bound
    }

    /// Whether a value lies in the interval.
    pub fn contains(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The interval of a multiple, for example of a relative bias: `interval.scaled(1.0 / reference)`.
    pub fn scaled(&self, factor: f64) -> Self {
        let (a, b) = (self.low * factor, self.high * factor);
        Self { low: a.min(b), high: a.max(b) }
    }
}

/// The comparison of two means whose variances may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Welch {
    /// The first mean minus the second.
    pub difference: f64,
    /// Standard error of the difference.
    pub error: f64,
    /// `difference / error`.
    pub t: f64,
    /// Degrees of freedom after Welch and Satterthwaite.
    pub dof: f64,
    /// Two-sided p-value of "the true means are equal".
    pub p: f64,
}

impl Welch {
    /// Welch's t-test (Welch 1947, "The generalization of 'Student's' problem when several different population
    /// variances are involved", Biometrika 34). Fewer than two values on a side give NaN. Without any variance, `p`
    /// is 1 for equal means and 0 for others.
    pub fn new(a: &Moments, b: &Moments) -> Self {
        let (va, vb) = (a.variance_of_mean(), b.variance_of_mean());
        let difference = a.mean - b.mean;
        let error = (va + vb).sqrt();
        if error == 0.0 {
            let t = if difference == 0.0 { 0.0 } else { f64::INFINITY.copysign(difference) };
            let p = if difference == 0.0 { 1.0 } else { 0.0 };
            return Self { difference, error, t, dof: (a.count + b.count) as f64 - 2.0, p };
        }
        // In shares of the whole, which neither overflow nor underflow.
        let (sa, sb) = (va / (va + vb), vb / (va + vb));
        let dof = 1.0 / (sa * sa / (a.count as f64 - 1.0) + sb * sb / (b.count as f64 - 1.0));
        let t = difference / error;
        Self { difference, error, t, dof, p: student_t_two_sided(t, dof) }
    }

    /// The interval that covers the true difference with the given confidence (in (0, 1)).
    pub fn confidence_interval(&self, confidence: f64) -> Interval {
        if self.error == 0.0 {
            return Interval { low: self.difference, high: self.difference };
        }
        let half = student_t_quantile(0.5 + 0.5 * confidence, self.dof) * self.error;
        Interval { low: self.difference - half, high: self.difference + half }
    }
}

/// `P(|T| ≥ |t|)` of Student's t with `dof > 0` degrees of freedom: `I_{ν/(ν+t²)}(ν/2, 1/2)` (Abramowitz and Stegun
/// 1964, 26.7.1). Infinite `dof` is the normal distribution.
pub fn student_t_two_sided(t: f64, dof: f64) -> f64 {
    if t.is_nan() || dof.is_nan() {
        return f64::NAN;
    }
    if t.is_infinite() {
        return 0.0;
    }
    if dof.is_infinite() {
        return erfc(t.abs() * std::f64::consts::FRAC_1_SQRT_2);
    }
    let r = t * (t / dof);
    incomplete_beta_with_complement(0.5 * dof, 0.5, 1.0 / (1.0 + r), if r.is_infinite() { 1.0 } else { r / (1.0 + r) })
}

/// `P(T ≤ t)` of Student's t.
pub fn student_t_cdf(t: f64, dof: f64) -> f64 {
    let tail = 0.5 * student_t_two_sided(t, dof);
    if t < 0.0 { tail } else { 1.0 - tail }
}

/// The `t` with `P(T ≤ t) = p`, for `p` in (0, 1), by bisection of the tail; NaN outside, and for `dof` not positive.
pub fn student_t_quantile(p: f64, dof: f64) -> f64 {
    if !(p > 0.0 && p < 1.0 && dof > 0.0) {
        return f64::NAN;
    }
    if dof.is_infinite() {
        return normal_quantile(p);
    }
    let tail = 2.0 * p.min(1.0 - p);
    let (mut low, mut high) = (0.0, 1.0);
    while student_t_two_sided(high, dof) > tail && high < 1e300 {
        (low, high) = (high, 2.0 * high);
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if student_t_two_sided(middle, dof) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    let t = 0.5 * (low + high);
    if p < 0.5 { -t } else { t }
}

/// `P(Z ≤ z)` of the standard normal distribution.
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// The `z` with `P(Z ≤ z) = p`, for `p` in (0, 1), to about 1e-16 relative (Wichura 1988, "Algorithm AS 241: The
/// Percentage Points of the Normal Distribution", PPND16); NaN outside.
pub fn normal_quantile(p: f64) -> f64 {
    if !(p > 0.0 && p < 1.0) {
        return f64::NAN;
    }
    let ratio = |numerator: &[f64; 8], denominator: &[f64; 8], r: f64| {
        let horner = |c: &[f64; 8]| c.iter().rev().fold(0.0, |sum, c| sum * r + c);
        horner(numerator) / horner(denominator)
    };
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        return q * ratio(&AS241[0], &AS241[1], 0.180_625 - q * q);
    }
    let r = (-p.min(1.0 - p).ln()).sqrt();
    let z = if r <= 5.0 { ratio(&AS241[2], &AS241[3], r - 1.6) } else { ratio(&AS241[4], &AS241[5], r - 5.0) };
    z.copysign(q)
}

/// The published coefficients a, b, c, d, e, f, in ascending powers.
#[allow(clippy::excessive_precision)] // As published.
const AS241: [[f64; 8]; 6] = [
    [
        3.387_132_872_796_366_608,
        133.141_667_891_784_377_45,
        1_971.590_950_306_551_442_7,
        13_731.693_765_509_461_125,
        45_921.953_931_549_871_457,
        67_265.770_927_008_700_853,
        33_430.575_583_588_128_105,
        2_509.080_928_730_122_672_7,
    ],
    [
        1.0,
        42.313_330_701_600_911_252,
        687.187_007_492_057_908_3,
        5_394.196_021_424_751_107_7,
        21_213.794_301_586_595_867,
        39_307.895_800_092_710_61,
        28_729.085_735_721_942_674,
        5_226.495_278_852_854_561,
    ],
    [
        1.423_437_110_749_683_577_34,
        4.630_337_846_156_545_295_9,
        5.769_497_221_460_691_405_5,
        3.647_848_324_763_204_605_04,
        1.270_458_252_452_368_382_58,
        0.241_780_725_177_450_611_77,
        0.022_723_844_989_269_184_583_3,
        7.745_450_142_783_414_076_4e-4,
    ],
    [
        1.0,
        2.053_191_626_637_758_821_87,
        1.676_384_830_183_803_849_4,
        0.689_767_334_985_100_004_55,
        0.148_103_976_427_480_074_59,
        0.015_198_666_563_616_457_196_6,
        5.475_938_084_995_344_946e-4,
        1.050_750_071_644_416_843_24e-9,
    ],
    [
        6.657_904_643_501_103_777_2,
        5.463_784_911_164_114_369_9,
        1.784_826_539_917_291_335_8,
        0.296_560_571_828_504_891_23,
        0.026_532_189_526_576_123_093,
        1.242_660_947_388_078_438_6e-3,
        2.711_555_568_743_487_578_15e-5,
        2.010_334_399_292_288_132_65e-7,
    ],
    [
        1.0,
        0.599_832_206_555_887_937_69,
        0.136_929_880_922_735_805_31,
        0.014_875_361_290_850_615_025,
        7.868_691_311_456_132_591e-4,
        1.846_318_317_510_054_681_8e-5,
        1.421_511_758_316_445_888_7e-7,
        2.044_263_103_389_939_785_64e-15,
    ],
];

/// `P(X ≥ statistic)` of the χ² distribution with `dof > 0` degrees of freedom.
pub fn chi_squared_p(statistic: f64, dof: f64) -> f64 {
    gamma_q(0.5 * dof, 0.5 * statistic.max(0.0))
}

/// The level of each of `tests` independent tests that keeps the chance of any false alarm at `alpha`:
/// `1 − (1 − α)^{1/m}` (Šidák 1967, "Rectangular Confidence Regions for the Means of Multivariate Normal
/// Distributions").
pub fn sidak(alpha: f64, tests: u64) -> f64 {
    -((-alpha).ln_1p() / tests as f64).exp_m1()
}

/// A Kolmogorov–Smirnov test against the uniform distribution on [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KolmogorovSmirnov {
    /// Largest distance between the empirical and the true distribution function.
    pub d: f64,
    /// p-value of "the values are uniform": Kolmogorov's limit at `(√n + 0.12 + 0.11/√n) D`, within about 0.005 of
    /// exact from n = 10 on (Stephens 1970, "Use of the Kolmogorov–Smirnov … Statistics", JRSS B 32).
    pub p: f64,
}

/// Tests whether values are uniform on [0, 1]. NaN for none, or when one is NaN.
pub fn ks_uniform(values: &[f64]) -> KolmogorovSmirnov {
    if values.is_empty() || values.iter().any(|x| x.is_nan()) {
        return KolmogorovSmirnov { d: f64::NAN, p: f64::NAN };
    }
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let d = (sorted.iter().enumerate()).fold(0.0_f64, |d, (i, x)| {
        let x = x.clamp(0.0, 1.0);
        d.max(x - i as f64 / n).max((i + 1) as f64 / n - x)
    });
    KolmogorovSmirnov { d, p: kolmogorov_q((n.sqrt() + 0.12 + 0.11 / n.sqrt()) * d) }
}

/// Kolmogorov's limiting `P(√n D ≥ λ)`.
fn kolmogorov_q(lambda: f64) -> f64 {
    if lambda <= 0.0 {
        return 1.0;
    }
    if lambda < 1.0 {
        // The same sum transformed by the theta function's identity, which converges where the other does not.
        let x = std::f64::consts::PI.powi(2) / (8.0 * lambda * lambda);
        let sum: f64 = (0..20).map(|k| (-f64::from(2 * k + 1).powi(2) * x).exp()).sum();
        return (1.0 - std::f64::consts::TAU.sqrt() / lambda * sum).clamp(0.0, 1.0);
    }
    let sum: f64 = (1..20)
        .map(|k| (if k % 2 == 1 { 2.0 } else { -2.0 }) * (-2.0 * f64::from(k * k) * lambda * lambda).exp())
        .sum();
    sum.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests;

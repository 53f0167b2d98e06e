//! The median and what is known about it from a sample, whatever the distribution.

use super::Interval;
use crate::compare::special::incomplete_beta;

/// The coverage that an interval of a median is given where there are values enough.
const WANTED: f64 = 0.95;

/// The median of a sample, with an interval for the median of what it was drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Median {
    /// The sample's own median: the middle value, or the mean of the two.
    pub median: f64,
    /// The interval between two order statistics.
    pub interval: Interval,
    /// The chance that the interval covers the true median, for independent values of any one continuous distribution;
    /// at least that for others.
    pub coverage: f64,
}

/// Which order statistics bound the median of so many values, and with what coverage: the `k`-th smallest and the
/// `k`-th largest, `k` from 1, cover it with `1 − 2 P(X < k)`, X binomial of `n` and ½ (David and Nagaraja 2003, "Order
/// Statistics", 3rd ed., §7.1). `k` is the largest with a coverage of 95 % or more, and 1 where not even the extremes
/// have that: five values cover it with 93.75 %.
///
/// Of one value, or none, it is the value itself with 0 %.
pub fn median_order(n: usize) -> (usize, f64) {
    if n < 2 {
        return (1, 0.0);
    }
    // P(X ≤ k − 1) = I_½(n − k + 1, k) (DLMF 8.17.5), rounded to what it is good for: 0.9375 shall be that.
    let coverage = |k: usize| ((1.0 - 2.0 * incomplete_beta((n - k + 1) as f64, k as f64, 0.5)) * 1e12).round() / 1e12;
    let k = (1..=n / 2).take_while(|k| coverage(*k) >= WANTED).last().unwrap_or(1);
    (k, coverage(k))
}

impl Median {
    /// The median of these values; infinite ones are ordered as any. `None` for no values, and where one is NaN.
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() || values.iter().any(|x| x.is_nan()) {
            return None;
        }
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let n = sorted.len();
        let (low, high) = (sorted[(n - 1) / 2], sorted[n / 2]);
        // Halved first, so that large values do not overflow; equal ones (infinities, too) stay what they are.
        let median = if low == high { low } else { 0.5 * low + 0.5 * high };
        let (k, coverage) = median_order(n);
        Some(Self { median, interval: Interval { low: sorted[k - 1], high: sorted[n - k] }, coverage })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As they follow from the binomial distribution of n and ½: 1 − 2 P(X < k), exact to ten values, rounded beyond.
    #[test]
    fn order_statistics_have_their_table_values() {
        for (n, k, percent) in [
            (2, 1, 50.0),
            (3, 1, 75.0),
            (4, 1, 87.5),
            (5, 1, 93.75),
            (6, 1, 96.875),
            (7, 1, 98.4375),
            (8, 1, 99.21875),
            (9, 2, 96.09375),
            (10, 2, 97.8515625),
            (12, 3, 96.142578125),
            (15, 4, 96.484375),
            (20, 6, 95.861),
            (25, 8, 95.671),
            (30, 10, 95.723),
            (50, 18, 96.716),
        ] {
            let (got, coverage) = median_order(n);
            assert_eq!(got, k, "{n} values");
            assert!((100.0 * coverage - percent).abs() < 6e-4, "{n} values: {coverage}");
        }
        assert_eq!((median_order(1), median_order(0)), ((1, 0.0), (1, 0.0)));
    }

    #[test]
    fn medians_of_any_order_and_of_infinities() {
        let of = |values: &[f64]| Median::of(values).expect("a median");
        let five = of(&[3.0, 1.0, 5.0, 2.0, 4.0]);
        assert_eq!((five.median, five.interval, five.coverage), (3.0, Interval { low: 1.0, high: 5.0 }, 0.9375));
        let ten: Vec<f64> = (1..=10).rev().map(f64::from).collect();
        let ten = of(&ten);
        assert_eq!((ten.median, ten.interval), (5.5, Interval { low: 2.0, high: 9.0 }));
        assert_eq!(of(&[f64::MAX, f64::MAX]).median, f64::MAX);
        assert_eq!(of(&[f64::NEG_INFINITY, 1.0, f64::NEG_INFINITY]).median, f64::NEG_INFINITY);
        assert_eq!(of(&[2.0]).interval, Interval { low: 2.0, high: 2.0 });
        assert_eq!((Median::of(&[]), Median::of(&[1.0, f64::NAN])), (None, None));
    }

    /// The interval covers the true median as often as it says, of a skewed distribution.
    #[test]
    fn intervals_cover() {
        let mut state = 9_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        for n in [3, 5, 10] {
            let trials = 20_000;
            // Exponential, whose median is ln 2.
            let hits = (0..trials).filter(|_| {
                let values: Vec<f64> = (0..n).map(|_| -uniform().ln()).collect();
                Median::of(&values).is_some_and(|m| m.interval.contains(std::f64::consts::LN_2))
            });
            let (share, said) = (hits.count() as f64 / f64::from(trials), median_order(n as usize).1);
            assert!((share - said).abs() < 0.012, "{n} values: {share}, said to be {said}");
        }
    }
}

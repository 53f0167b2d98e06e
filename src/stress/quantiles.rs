//! Quantiles of any number of errors in little memory.

use std::collections::BTreeMap;

use crate::integrator::bdpt::oracle::worse;

/// Shares of the errors that are told.
pub const QUANTILES: [f64; 4] = [0.5, 0.99, 0.999, 1.0];

/// Bins for each power of two: neighbours are 2 % apart.
const BINS: f64 = 32.0;

/// Smaller errors are counted with this one, of which doubles are not precise enough to tell.
const LEAST: f64 = 1e-17;

/// How often errors of a size occurred, in logarithmic bins; the largest is kept as it is.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    bins: BTreeMap<i32, u64>,
    count: u64,
    largest: f64,
}

impl Errors {
    /// One more, of which the size counts. A NaN is larger than all.
    pub fn push(&mut self, error: f64) {
        let error = error.abs();
        let bin = if error.is_nan() { i32::MAX } else { (error.max(LEAST).log2() * BINS).floor() as i32 };
        *self.bins.entry(bin).or_default() += 1;
        self.count += 1;
        self.largest = worse(self.largest, error);
    }

    /// Those of both.
    pub fn merge(&mut self, o: &Self) {
        for (bin, count) in &o.bins {
            *self.bins.entry(*bin).or_default() += count;
        }
        self.count += o.count;
        self.largest = worse(self.largest, o.largest);
    }

    /// How many there were.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The errors at `QUANTILES`: the middle of a bin, within 1.1 %, and the very largest.
    pub fn quantiles(&self) -> [f64; 4] {
        QUANTILES.map(|q| {
            let rank = (q * self.count.saturating_sub(1) as f64).round() as u64;
            let mut below = 0;
            let found = self.bins.iter().find(|(_, count)| {
                below += **count;
                below > rank
            });
            match found {
                Some((bin, _)) if q < 1.0 && *bin != i32::MAX => {
                    ((f64::from(*bin) + 0.5) / BINS).exp2().min(self.largest)
                }
                _ => self.largest,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_sorted_errors_to_two_percent() {
        let value = |i: u32| 1e-9 * 1.01_f64.powi(i as i32);
        let (mut all, mut odd) = (Errors::default(), Errors::default());
        for i in 0..2001 {
            if i % 2 == 0 { &mut all } else { &mut odd }.push(if i % 3 == 0 { -value(i) } else { value(i) });
        }
        all.merge(&odd);
        assert_eq!(all.count(), 2001);
        for (found, exact) in all.quantiles().into_iter().zip([1000, 1980, 1998, 2000].map(value)) {
            assert!((found / exact - 1.0).abs() < 0.012, "{found} {exact}");
        }
        // The largest is kept, but for how powers are rounded.
        assert!((all.quantiles()[3] / value(2000) - 1.0).abs() < 1e-12);
        assert_eq!(Errors::default().quantiles(), [0.0; 4]);
        all.push(f64::NAN);
        assert!(all.quantiles()[3].is_nan() && all.quantiles()[0].is_finite());
    }
}

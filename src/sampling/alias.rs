//! Discrete choice in constant time.

use crate::pdf::Pmf;

/// A discrete distribution sampled in O(1) (Walker 1974; Vose 1991, "A Linear Algorithm for Generating Random
/// Numbers with a Given Distribution").
#[derive(Clone, Debug)]
pub struct AliasTable {
    /// Probability of keeping a bin, and what to take otherwise.
    bins: Vec<(f32, u32)>,
    pmf: Vec<f32>,
}

impl AliasTable {
    /// Builds the table for weights that are finite, non-negative and not all zero; `None` otherwise.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        if weights.is_empty() || !total.is_finite() || total <= 0.0 || weights.iter().any(|w| *w < 0.0) {
            return None;
        }
        let n = weights.len();
        let mut scaled: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
        let mut bins = vec![(1.0, 0); n];
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            bins[s] = (scaled[s] as f32, l as u32);
            scaled[l] -= 1.0 - scaled[s];
            if scaled[l] < 1.0 {
                large.pop();
                small.push(l);
            }
        }
        // What is left differs from 1 by rounding only.
        for i in small.into_iter().chain(large) {
            bins[i] = (1.0, i as u32);
        }
        let pmf = weights.iter().map(|w| (w / total) as f32).collect();
        Some(Self { bins, pmf })
    }

    /// Number of outcomes.
    pub fn len(&self) -> usize {
        self.bins.len()
    }

    /// Whether there is nothing to choose from; never true for a table that was built.
    pub fn is_empty(&self) -> bool {
        self.bins.is_empty()
    }

    /// Chooses an outcome by one uniform number.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, Pmf) {
        let n = self.bins.len();
        if n == 1 {
            return (0, Pmf(1.0));
        }
        // In f64: with millions of bins an f32 has no bits left for the second decision.
        let x = f64::from(u) * n as f64;
        let i = (x as usize).min(n - 1);
        let (keep, alias) = self.bins[i];
        let chosen = if ((x - i as f64) as f32) < keep { i } else { alias as usize };
        (chosen, Pmf(self.pmf[chosen]))
    }

    /// Probability of an outcome.
    #[inline]
    pub fn pmf(&self, i: usize) -> Pmf {
        Pmf(self.pmf[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_follow_the_weights() {
        let weights = [0.0, 1.0, 3.0, 1e-3, 6.0];
        let table = AliasTable::new(&weights).expect("valid weights");
        let mut counts = [0u32; 5];
        let n = 1_000_000;
        for i in 0..n {
            let (k, pmf) = table.sample((i as f32 + 0.5) / n as f32);
            counts[k] += 1;
            assert_eq!(pmf, table.pmf(k));
        }
        assert_eq!(counts[0], 0);
        let total: f64 = weights.iter().sum();
        for (c, w) in counts.iter().zip(weights) {
            assert!((f64::from(*c) / f64::from(n) - w / total).abs() < 1e-5, "{counts:?}");
        }
    }

    #[test]
    fn useless_weights_make_no_table() {
        for w in [&[][..], &[0.0, 0.0], &[f64::NAN], &[-1.0, 2.0], &[f64::INFINITY]] {
            assert!(AliasTable::new(w).is_none(), "{w:?}");
        }
    }
}

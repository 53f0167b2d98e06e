//! Discrete choice in constant time.

use crate::pdf::Pmf;

/// A discrete distribution sampled in O(1) (Walker 1974; Vose 1991, "A Linear Algorithm for Generating Random
/// Numbers with a Given Distribution").
#[derive(Clone, Debug)]
pub struct AliasTable {
    /// Probability of keeping a bin, and what to take otherwise.
    bins: Vec<(f64, u32)>,
    pmf: Vec<f32>,
}

impl AliasTable {
    /// Builds the table for weights that are finite, non-negative and not all zero; `None` otherwise.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let total = compensated_sum(weights);
        if weights.is_empty() || !total.is_finite() || total <= 0.0 || weights.iter().any(|w| *w < 0.0) {
            return None;
        }
        let n = weights.len();
        let mut scaled: Vec<f64> = weights.iter().map(|w| w / total * n as f64).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| scaled[i] < 1.0);
        let mut bins = vec![(1.0, 0); n];
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            bins[s] = (scaled[s], l as u32);
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

    /// Chooses an outcome by one uniform number in [0, 1). It decides twice, for a bin and for what the bin holds, and
    /// therefore needs all the bits of an f64 (`Sampler::next_f64`): among 10⁶ outcomes, 24 bits would leave 4 for the
    /// second decision.
    #[inline]
    pub fn sample(&self, u: f64) -> (usize, Pmf) {
        let n = self.bins.len();
        if n == 1 {
            return (0, Pmf(1.0));
        }
        let x = u * n as f64;
        let i = (x as usize).min(n - 1);
        let (keep, alias) = self.bins[i];
        let chosen = if x - (i as f64) < keep { i } else { alias as usize };
        (chosen, Pmf(self.pmf[chosen]))
    }

    /// Probability of an outcome.
    #[inline]
    pub fn pmf(&self, i: usize) -> Pmf {
        Pmf(self.pmf[i])
    }
}

/// A sum without the rounding of its partial sums (Neumaier 1974): among a million weights, what a plain sum is off
/// by would all end up in the last bin.
fn compensated_sum(values: &[f64]) -> f64 {
    let (mut sum, mut lost) = (0.0f64, 0.0);
    for &x in values {
        let next = sum + x;
        lost += if sum.abs() >= x.abs() { (sum - next) + x } else { (x - next) + sum };
        sum = next;
    }
    sum + lost
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
            let (k, pmf) = table.sample((f64::from(i) + 0.5) / f64::from(n));
            counts[k] += 1;
            assert_eq!(pmf, table.pmf(k));
        }
        assert_eq!(counts[0], 0);
        let total: f64 = weights.iter().sum();
        for (c, w) in counts.iter().zip(weights) {
            assert!((f64::from(*c) / f64::from(n) - w / total).abs() < 1e-5, "{counts:?}");
        }
    }

    /// What the table does over all of [0, 1): the measure of the u that lead to each outcome.
    fn measures(table: &AliasTable) -> Vec<f64> {
        let n = table.len() as f64;
        let mut p = vec![0.0; table.len()];
        for (i, &(keep, alias)) in table.bins.iter().enumerate() {
            p[i] += keep.min(1.0) / n;
            p[alias as usize] += (1.0 - keep).max(0.0) / n;
        }
        p
    }

    #[test]
    fn many_and_very_different_weights_keep_their_probabilities() {
        let many: Vec<f64> = (0..1_000_000u32).map(|i| 0.5 + (f64::from(i) * 0.618_034).fract()).collect();
        let one_bright: Vec<f64> = (0..1000).map(|i| if i == 500 { 1e12 } else { 1.0 }).collect();
        for weights in [many, one_bright] {
            let table = AliasTable::new(&weights).expect("valid weights");
            let total: f64 = weights.iter().sum();
            for (i, p) in measures(&table).into_iter().enumerate() {
                let want = weights[i] / total;
                // Differences of numbers of order 1/n, in f64.
                assert!((p - want).abs() < 1e-6 * want + 1e-16, "{i}: {p} for {want}");
            }
        }
    }

    #[test]
    fn the_samplers_numbers_reach_every_bin_and_both_halves() {
        use crate::sampling::{Sampler, SamplerKind, Stream};
        let n = 1 << 20;
        let weights: Vec<f64> = (0..n).map(|i| if i % 2 == 0 { 0.75 } else { 1.25 }).collect();
        let table = AliasTable::new(&weights).expect("valid weights");
        for kind in [SamplerKind::Sobol, SamplerKind::Independent] {
            let draws = 1 << 21;
            let even = (0..draws)
                .filter(|&i| table.sample(Sampler::new(kind, 5, 6, Stream::Camera, i).next_f64()).0 % 2 == 0)
                .count();
            // Binomial with p = 3/8: five standard deviations.
            let off = even as f64 - 0.375 * f64::from(draws);
            assert!(off.abs() < 5.0 * (0.375f64 * 0.625 * f64::from(draws)).sqrt(), "{kind:?}: {even}");
        }
    }

    #[test]
    fn useless_weights_make_no_table() {
        for w in [&[][..], &[0.0, 0.0], &[f64::NAN], &[-1.0, 2.0], &[f64::INFINITY]] {
            assert!(AliasTable::new(w).is_none(), "{w:?}");
        }
    }
}

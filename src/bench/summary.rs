//! What the runs of a configuration say together.

use super::report::RunReport;
use crate::compare::stats::Median;

/// Medians over a configuration's runs, with their intervals. An error below the reference's noise is −∞ and the efficiency
/// that goes with it +∞: of several values the median may still be known. `None` where a value is missing.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Processor time of the render, seconds.
    pub cpu_seconds: Option<Median>,
    /// Wall time of the render, seconds.
    pub wall_seconds: Option<Median>,
    /// MSE without the reference's noise.
    pub mse: Option<Median>,
    /// relMSE without the reference's noise.
    pub rel_mse: Option<Median>,
    /// The same without the worst pixels.
    pub rel_mse_trimmed: Option<Median>,
    /// 1 / (relMSE × processor seconds).
    pub efficiency: Option<Median>,
    /// Efficiency over the first configuration's in the same repetition; `None` of the first itself, and where one of
    /// the pairs lacks a value: what is left of them would be chosen by its outcome.
    pub ratio: Option<Median>,
    /// Mean over the reference's.
    pub energy: Option<Median>,
    /// Rays per processor second.
    pub rays_per_cpu_second: Option<Median>,
    /// Samples of all pixels per processor second.
    pub samples_per_cpu_second: Option<Median>,
    /// Largest resident memory, bytes.
    pub peak_memory: Option<Median>,
}

impl Summary {
    /// Of these runs, each with the efficiency of the same repetition of the first configuration.
    pub(super) fn of(runs: &[RunReport], samples: u32, first: Option<&Vec<Option<f64>>>) -> Self {
        let of = |value: &dyn Fn(&RunReport) -> f64| Median::of(&runs.iter().map(value).collect::<Vec<f64>>());
        let efficiencies: Vec<Option<f64>> = runs.iter().map(RunReport::efficiency).collect();
        let memory: Option<Vec<f64>> = runs.iter().map(|r| r.peak_memory.map(|bytes| bytes as f64)).collect();
        Self {
            cpu_seconds: of(&|r| r.cpu_seconds),
            wall_seconds: of(&|r| r.wall_seconds),
            mse: of(&|r| r.mse.value().unwrap_or(f64::NEG_INFINITY)),
            rel_mse: of(&|r| r.rel_mse.value().unwrap_or(f64::NEG_INFINITY)),
            rel_mse_trimmed: of(&|r| r.rel_mse_trimmed.value().unwrap_or(f64::NEG_INFINITY)),
            efficiency: of(&|r| r.efficiency().unwrap_or(f64::INFINITY)),
            ratio: first.and_then(|first| Median::of(&ratios(&efficiencies, first)?)),
            energy: of(&|r| r.energy),
            rays_per_cpu_second: of(&RunReport::rays_per_cpu_second),
            samples_per_cpu_second: of(&|r| r.samples_per_cpu_second(samples)),
            peak_memory: memory.and_then(|values| Median::of(&values)),
        }
    }
}

/// Pair by pair; `None` when one of a pair is missing.
fn ratios(of: &[Option<f64>], to: &[Option<f64>]) -> Option<Vec<f64>> {
    of.iter().zip(to).map(|(a, b)| Some((*a)? / (*b)?)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_of_pairs() {
        // A machine that slows down by half in each repetition: the medians' ratio says as much as the pairs', the intervals do not.
        let [slow, fast] = [1.0, 2.0].map(|x| (0..5).map(|i| Some(x * 0.5_f64.powi(i))).collect::<Vec<_>>());
        let paired = Median::of(&ratios(&fast, &slow).expect("all there")).expect("a median");
        assert_eq!((paired.median, paired.interval.low, paired.interval.high), (2.0, 2.0, 2.0));
        assert_eq!(ratios(&[Some(1.0), None], &[Some(1.0), Some(1.0)]), None);
    }
}

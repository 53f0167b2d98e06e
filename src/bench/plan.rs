//! What is run, and in which order.

use crate::accel::Accel;
use crate::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use crate::accel::embree::EmbreeAccel;
use crate::integrator::Settings;

/// The seeds of a reference's two halves. Runs have seeds below 2³³, so that none has a sample in common with it.
pub const REFERENCE_SEEDS: [u64; 2] = [u64::MAX, u64::MAX - 1];

/// The seed of what is rendered and not measured: pilots, and what warms a new scene up.
pub(super) const IDLE_SEED: u64 = u64::MAX - 2;

/// What answers rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Intel Embree 4.
    #[cfg(feature = "embree")]
    Embree,
    /// The pure-Rust BVH.
    Bvh,
}

impl Backend {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(feature = "embree")]
            Self::Embree => EmbreeAccel::NAME,
            Self::Bvh => BvhAccel::NAME,
        }
    }
}

/// How much is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// Samples per pixel.
    Samples(u32),
    /// As many samples per pixel as take about so many seconds of processor time. The number is fixed by a pilot before the
    /// runs: no render reads a clock.
    Seconds(f64),
}

/// One way to render a scene.
#[derive(Clone, Copy, Debug)]
pub struct Configuration {
    /// The integrator as it was asked for; `auto` renders by another.
    pub integrator: &'static str,
    /// What is rendered by; the seed is the run's.
    pub settings: Settings,
    /// What answers rays.
    pub backend: Backend,
    /// How much.
    pub effort: Effort,
}

/// What is run of each scene.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The ways to render it; others are compared with the first.
    pub configurations: Vec<Configuration>,
    /// Runs of each, with seeds of their own.
    pub repetitions: u32,
    /// The first run's seed; the others' follow.
    pub first_seed: u32,
    /// Threads of each run.
    pub threads: usize,
}

/// One run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Counted from 0.
    pub repetition: u32,
    /// Index into the plan's configurations.
    pub configuration: usize,
    /// Seed, the same for all configurations of a repetition.
    pub seed: u64,
}

impl Plan {
    /// The seed of a repetition.
    pub fn seed(&self, repetition: u32) -> u64 {
        u64::from(self.first_seed) + u64::from(repetition)
    }

    /// All runs in their order: every configuration once, then every one again, with the next seed. Within a repetition
    /// those on one accelerator follow each other, so that a scene is built once for them, and only one is in memory.
    pub fn turns(&self) -> Vec<Turn> {
        let mut order: Vec<usize> = (0..self.configurations.len()).collect();
        let first = |i: &usize| {
            let backend = self.configurations[*i].backend;
            self.configurations.iter().position(|c| c.backend == backend)
        };
        order.sort_by_key(first);
        let turn = |repetition| {
            let seed = self.seed(repetition);
            order.iter().map(move |&configuration| Turn { repetition, configuration, seed })
        };
        (0..self.repetitions).flat_map(turn).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(backends: &[Backend], efforts: &[u32], repetitions: u32) -> Plan {
        let configurations = ["path", "bdpt"].into_iter().flat_map(|integrator| {
            backends.iter().flat_map(move |&backend| {
                let settings = Settings::default();
                efforts.iter().map(move |&n| Configuration {
                    integrator,
                    settings,
                    backend,
                    effort: Effort::Samples(n),
                })
            })
        });
        Plan { configurations: configurations.collect(), repetitions, first_seed: 7, threads: 1 }
    }

    #[test]
    fn configurations_take_turns() {
        let turns = plan(&[Backend::Bvh], &[1, 4], 3).turns();
        let all: Vec<(u32, usize, u64)> = turns.iter().map(|t| (t.repetition, t.configuration, t.seed)).collect();
        let expected: Vec<_> = (0..3).flat_map(|r| (0..4).map(move |c| (r, c, 7 + u64::from(r)))).collect();
        assert_eq!(all, expected);
    }

    #[cfg(feature = "embree")]
    #[test]
    fn a_repetition_builds_each_accelerator_once() {
        let plan = plan(&[Backend::Embree, Backend::Bvh], &[1, 4], 3);
        let turns = plan.turns();
        assert_eq!(turns.len(), 24);
        for (repetition, turns) in turns.chunks(8).enumerate() {
            assert!(turns.iter().all(|t| t.repetition == repetition as u32));
            // Path and bdpt on Embree with each effort, then on the BVH.
            let order: Vec<usize> = turns.iter().map(|t| t.configuration).collect();
            assert_eq!(order, [0, 1, 4, 5, 2, 3, 6, 7]);
        }
    }

    #[test]
    fn no_run_has_a_seed_of_the_reference() {
        let plan = Plan { repetitions: 1000, first_seed: u32::MAX, ..plan(&[Backend::Bvh], &[1], 1) };
        let used: Vec<u64> = plan.turns().iter().map(|t| t.seed).collect();
        assert!(REFERENCE_SEEDS.iter().chain([&IDLE_SEED]).all(|seed| !used.contains(seed)));
    }
}

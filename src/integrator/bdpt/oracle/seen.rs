//! What the judge has seen over many paths.

use super::condition::Condition;
use super::paths::random_path;
use super::{Fault, Faults, Judge};
use crate::accel::Accel;

/// How far techniques may differ next to delta vertices, over the condition there, of which only the stored points' own rounding
/// counts: between points nothing starts beside its surface (measured: 0.26).
const IDENTITY: f64 = 0.4;

/// What was seen over many paths.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// How many there were.
    pub paths: u64,
    pub(super) techniques: u64,
    pub(super) with_delta: u64,
    pub(super) techniques_with_delta: u64,
    /// Techniques whose identity is off by more than 1e-4 next to a delta vertex.
    pub(super) tail: u64,
    /// The largest |Σw − 1|.
    pub worst_sum: f64,
    /// The largest deviation of a weight from the oracle's, over that plus 10⁻⁶.
    pub worst_weight: f64,
    /// The same over what rounding the path's points may do, where it is more than 10⁻⁴.
    pub worst_weight_over_condition: f64,
    /// The largest relative error of an unweighted contribution.
    pub worst_contribution: f64,
    /// The same over what rounding may do, where it is more than 10⁻⁵.
    pub worst_contribution_over_condition: f64,
    /// The largest relative difference between what a path's techniques measure, delta vertices' tail left out.
    pub(super) worst_identity: f64,
    /// The largest such difference over what rounding may do, where it is more than 10⁻⁴.
    pub worst_identity_over_condition: f64,
    /// Over the tail: the largest deviation, the largest condition, the largest ratio of the one to the other.
    pub(super) worst_tail: f64,
    pub(super) worst_condition: f64,
    pub(super) worst_ratio: f64,
    /// Paths on which a mixture scattered by its delta lobe; with an edge through a cut-out surface.
    pub(super) mixtures: u64,
    pub(super) thinned: u64,
    /// Paths with an edge that was walked along and is not seen along, or not alike from both ends.
    pub(super) blocked: u64,
    /// What no rounding explains, with the first path that has such a fault.
    pub structural: Faults,
    /// What is wrong with the numbers of the first path of which some are, by the bounds of scenes without extremes.
    pub failure: Option<String>,
}

/// The larger of two deviations; a NaN, which `f64::max` would pass over, is larger than all.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

impl Seen {
    /// Looks at the path of this number.
    pub fn path<A: Accel>(judge: &Judge<'_, A>, index: u32) -> Self {
        let mut seen = Self::default();
        let Some(path) = random_path(judge.scene, index) else { return seen };
        let mut fault = None;
        let Some(verdicts) = judge.judge(&path, &mut fault) else {
            if let Some(fault) = fault {
                seen.structural.push(Fault { details: format!("{} on {path:?}", fault.details), ..fault });
            }
            return seen;
        };
        if verdicts.is_empty() {
            return seen;
        }
        let delta = path.inner.iter().any(|v| v.delta);
        seen.paths = 1;
        seen.techniques = verdicts.len() as u64;
        seen.with_delta = u64::from(delta);
        seen.techniques_with_delta = if delta { seen.techniques } else { 0 };
        let mut require = |holds: bool, what: &str| {
            if !holds && seen.failure.is_none() {
                seen.failure = Some(format!("{what}: {verdicts:?} on {path:?}"));
            }
        };
        let oracle_sum: f64 = verdicts.iter().map(|v| v.oracle).sum();
        require((oracle_sum - 1.0).abs() < 1e-9, "the oracle's weights do not sum to 1");
        let sum: f64 = verdicts.iter().map(|v| v.weight).sum();
        seen.worst_sum = (sum - 1.0).abs();
        require(seen.worst_sum < 1e-4, "the weights do not sum to 1");
        seen.mixtures = u64::from(path.inner.iter().any(|v| v.delta && v.bsdf.is_connectible()));
        let visibilities = path.visibilities(judge.scene);
        seen.thinned = u64::from(visibilities.iter().flatten().any(|x| 0.0 < *x && *x < 1.0));
        seen.blocked =
            u64::from(visibilities.iter().any(|[a, b]| *a == 0.0 || *b == 0.0 || (a / b - 1.0).abs() > 1e-4));
        let condition = Condition::of(judge, &path);
        let beyond = |off: f64, from: f64| if off < from { 0.0 } else { off / condition.all };
        for v in &verdicts {
            let off = (v.weight - v.oracle).abs() / (v.oracle + 1e-6);
            seen.worst_weight = worse(seen.worst_weight, off);
            seen.worst_weight_over_condition = worse(seen.worst_weight_over_condition, beyond(off, 1e-4));
            require(off < 1e-4, "a weight differs from the oracle's");
            let off = v.contribution.abs();
            seen.worst_contribution = worse(seen.worst_contribution, off);
            seen.worst_contribution_over_condition = worse(seen.worst_contribution_over_condition, beyond(off, 1e-5));
            require(off < 1e-5, "a contribution is not the product of its factors");
            // The stored points around a delta vertex are a rounding away from Snell's law: the cosines there are off
            // by that rounding over the edge's length and the cosine. Everywhere else the identity holds to rounding.
            let spread = (v.measurement / verdicts[0].measurement - 1.0).abs();
            seen.worst_identity_over_condition = worse(seen.worst_identity_over_condition, beyond(spread, 1e-4));
            if delta && spread >= 1e-4 {
                seen.tail += 1;
                seen.worst_tail = worse(seen.worst_tail, spread);
                seen.worst_condition = worse(seen.worst_condition, condition.deltas);
                seen.worst_ratio = worse(seen.worst_ratio, spread / condition.deltas);
                require(spread < IDENTITY * condition.deltas, "techniques measure differently");
            } else {
                seen.worst_identity = worse(seen.worst_identity, spread);
                require(spread < 1e-4, "techniques measure differently");
            }
        }
        seen
    }

    /// Both together.
    #[must_use]
    pub fn merge(self, o: Self) -> Self {
        Self {
            paths: self.paths + o.paths,
            techniques: self.techniques + o.techniques,
            with_delta: self.with_delta + o.with_delta,
            techniques_with_delta: self.techniques_with_delta + o.techniques_with_delta,
            tail: self.tail + o.tail,
            worst_sum: worse(self.worst_sum, o.worst_sum),
            worst_weight: worse(self.worst_weight, o.worst_weight),
            worst_weight_over_condition: worse(self.worst_weight_over_condition, o.worst_weight_over_condition),
            worst_contribution: worse(self.worst_contribution, o.worst_contribution),
            worst_contribution_over_condition: worse(
                self.worst_contribution_over_condition,
                o.worst_contribution_over_condition,
            ),
            worst_identity: worse(self.worst_identity, o.worst_identity),
            worst_identity_over_condition: worse(self.worst_identity_over_condition, o.worst_identity_over_condition),
            worst_tail: worse(self.worst_tail, o.worst_tail),
            worst_condition: worse(self.worst_condition, o.worst_condition),
            worst_ratio: worse(self.worst_ratio, o.worst_ratio),
            mixtures: self.mixtures + o.mixtures,
            thinned: self.thinned + o.thinned,
            blocked: self.blocked + o.blocked,
            structural: self.structural.merge(o.structural),
            // Of two faults the one that cannot be told in numbers.
            failure: if o.worst_sum.is_nan() { o.failure.or(self.failure) } else { self.failure.or(o.failure) },
        }
    }
}

//! Features are dealt, not drawn: each list's features come around equally often over consecutive scenes.

use std::collections::{BTreeMap, BTreeSet};

use crate::common::Random;

/// Deals from lists, and takes note of what was dealt to the scene under way.
#[derive(Default)]
pub struct Deck {
    /// What remains of each list, by its name.
    rest: BTreeMap<&'static str, Vec<&'static str>>,
    /// Rounds dealt of each list.
    rounds: BTreeMap<&'static str, u64>,
    /// All that may be dealt from the lists so far.
    pub known: BTreeSet<String>,
    /// What the scene under way has.
    pub features: BTreeSet<String>,
}

impl Deck {
    /// The next feature of a list, in an order shuffled anew for every round; noted as `list: feature`.
    pub fn deal(&mut self, list: &'static str, features: &[&'static str]) -> &'static str {
        let rest = self.rest.entry(list).or_default();
        if rest.is_empty() {
            let round = self.rounds.entry(list).or_insert(0);
            let seed = list.bytes().fold(*round, |h, b| h.wrapping_mul(0x100_0000_01b3).wrapping_add(u64::from(b)));
            *round += 1;
            let mut random = Random(seed);
            rest.extend_from_slice(features);
            self.known.extend(features.iter().map(|feature| format!("{list}: {feature}")));
            for i in (1..rest.len()).rev() {
                rest.swap(i, (random.uniform() * (i + 1) as f64) as usize);
            }
        }
        let feature = rest.pop().expect("lists are not empty");
        self.features.insert(format!("{list}: {feature}"));
        feature
    }
}

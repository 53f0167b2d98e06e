//! Choosing one light among all: once for light subpaths, once for next-event estimation.

use super::Light;
use crate::math::{Vec3, luminance};
use crate::pdf::Pmf;
use crate::planted::{Bug, planted};
use crate::sampling::AliasTable;

/// Chooses lights in proportion to their power, in constant time.
#[derive(Clone, Debug)]
pub struct LightChoice {
    table: AliasTable,
}

impl LightChoice {
    /// `None` when no light emits anything.
    pub fn new(lights: &[Light]) -> Option<Self> {
        let weights: Vec<f64> = lights.iter().map(|l| f64::from(luminance(l.power()))).collect();
        Some(Self { table: AliasTable::new(&weights)? })
    }

    /// Chooses a light to start a light subpath from.
    #[inline]
    pub fn sample_emission(&self, u: f64) -> (u32, Pmf) {
        let (i, pmf) = self.table.sample(u);
        (i as u32, self.counted(pmf))
    }

    /// The probability of `sample_emission` choosing a light.
    #[inline]
    pub fn pmf_emission(&self, light: u32) -> Pmf {
        self.counted(self.table.pmf(light as usize))
    }

    /// The probability itself, unless by a planted bug.
    #[inline(always)]
    fn counted(&self, pmf: Pmf) -> Pmf {
        let n = self.table.len() as f32;
        if planted(Bug::LightChoiceOfOneMore) { Pmf(pmf.0 * (n / (n + 1.0))) } else { pmf }
    }

    /// Chooses a light for next-event estimation at `from`.
    #[inline]
    pub fn sample_direct(&self, _from: Vec3, u: f64) -> (u32, Pmf) {
        self.sample_emission(u)
    }

    /// The probability of `sample_direct` at `from` choosing a light.
    #[inline]
    pub fn pmf_direct(&self, _from: Vec3, light: u32) -> Pmf {
        self.pmf_emission(light)
    }
}

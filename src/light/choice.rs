//! Choosing one light among all.

use super::Light;
use crate::math::luminance;
use crate::pdf::Pmf;
use crate::sampling::AliasTable;

/// Chooses lights in proportion to their power, in constant time.
#[derive(Clone, Debug)]
pub struct LightChoice {
    table: AliasTable,
}

impl LightChoice {
    /// `None` when no light emits anything.
    pub fn by_power(lights: &[Light]) -> Option<Self> {
        let weights: Vec<f64> = lights.iter().map(|l| f64::from(luminance(l.power()))).collect();
        Some(Self { table: AliasTable::new(&weights)? })
    }

    /// Chooses a light.
    #[inline]
    pub fn sample(&self, u: f64) -> (u32, Pmf) {
        let (i, pmf) = self.table.sample(u);
        (i as u32, pmf)
    }

    /// The probability of choosing a light.
    #[inline]
    pub fn pmf(&self, light: u32) -> Pmf {
        self.table.pmf(light as usize)
    }
}

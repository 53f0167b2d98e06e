//! Choosing one light among all: once for light subpaths, once for next-event estimation.

use super::tree::{EmitterBound, LightTree};
use super::{Light, Receiver};
use crate::geometry::Geometry;
use crate::math::luminance;
use crate::pdf::Pmf;
use crate::planted::{Bug, planted};
use crate::sampling::AliasTable;

/// Where the choice for next-event estimation finds a light again.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// The first of its emitters.
    Emitters(u32),
    /// Its index among the lights at infinity.
    Infinite(u32),
}

/// Chooses lights: for light subpaths in proportion to their power, in constant time; for next-event estimation by what
/// they may send to the receiver, in the time of a descent of a tree over all emitters (`LightTree`).
#[derive(Clone, Debug)]
pub struct LightChoice {
    /// The one light and part, where there is one.
    only: Option<(u32, u32)>,
    power: AliasTable,
    /// The lights that have a place, by emitter: light and part. Empty trees choose nothing.
    tree: Option<LightTree>,
    emitters: Vec<(u32, u32)>,
    /// By light.
    places: Vec<Place>,
    /// Probability of choosing one of the lights at infinity, and which of them, by power.
    infinite: f64,
    infinite_lights: Option<(Vec<u32>, AliasTable)>,
}

impl LightChoice {
    /// `None` when no light emits anything.
    pub fn new(lights: &[Light], geometry: &Geometry) -> Option<Self> {
        let weights: Vec<f64> = lights.iter().map(|l| f64::from(luminance(l.power()))).collect();
        let power = AliasTable::new(&weights)?;
        let (mut emitters, mut bounds, mut places) = (Vec::new(), Vec::<EmitterBound>::new(), Vec::new());
        let (mut infinite, mut infinite_weights) = (Vec::new(), Vec::new());
        for ((id, light), weight) in (0..).zip(lights).zip(&weights) {
            if light.is_infinite() {
                places.push(Place::Infinite(infinite.len() as u32));
                infinite.push(id);
                infinite_weights.push(*weight);
                continue;
            }
            places.push(Place::Emitters(emitters.len() as u32));
            for part in 0..light.parts() {
                if let Some(bound) = light.bound(geometry, part) {
                    emitters.push((id, part));
                    bounds.push(bound);
                }
            }
        }
        let count = infinite.len() as f64;
        let share = infinite_weights.iter().sum::<f64>() / weights.iter().sum::<f64>();
        let infinite_lights = AliasTable::new(&infinite_weights).map(|table| (infinite, table));
        let tree = LightTree::new(&bounds);
        // What enters the scene's ball from infinity says little of what arrives, and nor does the power of lamps that may be
        // shut away: both keep a chance.
        let infinite = match (&tree, &infinite_lights) {
            (_, None) => 0.0,
            (None, _) => 1.0,
            _ => share.clamp(0.5 * count / (count + 1.0), count / (count + 1.0)),
        };
        let only = match (emitters.as_slice(), &infinite_lights) {
            (&[only], None) => Some(only),
            _ => None,
        };
        Some(Self { only, power, tree, emitters, places, infinite, infinite_lights })
    }

    /// Chooses a light to start a light subpath from.
    #[inline]
    pub fn sample_emission(&self, u: f64) -> (u32, Pmf) {
        let (i, pmf) = self.power.sample(u);
        (i as u32, self.counted(pmf))
    }

    /// The probability of `sample_emission` choosing a light.
    #[inline]
    pub fn pmf_emission(&self, light: u32) -> Pmf {
        self.counted(self.power.pmf(light as usize))
    }

    /// The probability itself, unless by a planted bug.
    #[inline(always)]
    fn counted(&self, pmf: Pmf) -> Pmf {
        let n = self.power.len() as f32;
        if planted(Bug::LightChoiceOfOneMore) { Pmf(pmf.0 * (n / (n + 1.0))) } else { pmf }
    }

    /// Chooses a light, and a part of it, for next-event estimation by a number uniform in [0, 1), if there is a choice;
    /// `None` where none shines on the receiver.
    #[inline(always)]
    pub fn sample_direct(&self, receiver: &Receiver, u: impl FnOnce() -> f64) -> Option<(u32, u32, Pmf)> {
        // A scene of one lamp pays for no choice.
        if let Some((light, part)) = self.only {
            return Some((light, part, self.counted(Pmf(1.0))));
        }
        self.sample_among(receiver, u()).map(|(light, part, pmf)| (light, part, self.counted(pmf)))
    }

    #[inline(never)]
    fn sample_among(&self, receiver: &Receiver, u: f64) -> Option<(u32, u32, Pmf)> {
        let mut u = u;
        if let Some((lights, table)) = &self.infinite_lights {
            if u < self.infinite {
                let (i, pmf) = table.sample(u / self.infinite);
                return Some((lights[i], 0, Pmf((self.infinite * f64::from(pmf.0)) as f32)));
            }
            u = ((u - self.infinite) / (1.0 - self.infinite)).min(1.0 - 0.5 * f64::EPSILON);
        }
        let (emitter, p) = self.tree.as_ref()?.sample(receiver, u)?;
        let (light, part) = self.emitters[emitter as usize];
        let pmf = Pmf(((1.0 - self.infinite) * p) as f32);
        (pmf.0 > 0.0).then_some((light, part, pmf))
    }

    /// The probability of `sample_direct` choosing a part of a light.
    #[inline]
    pub fn pmf_direct(&self, receiver: &Receiver, light: u32, part: u32) -> Pmf {
        if self.only.is_some() {
            return self.counted(Pmf(1.0));
        }
        self.counted(self.pmf_among(receiver, light, part))
    }

    #[inline(never)]
    fn pmf_among(&self, receiver: &Receiver, light: u32, part: u32) -> Pmf {
        let p = match (self.places[light as usize], &self.tree, &self.infinite_lights) {
            (Place::Infinite(i), _, Some((_, table))) => self.infinite * f64::from(table.pmf(i as usize).0),
            (Place::Emitters(first), Some(tree), _) => (1.0 - self.infinite) * tree.pmf(receiver, first + part),
            // Lights whose power no f32 holds are never chosen.
            _ => 0.0,
        };
        Pmf(p as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Rgb, Vec3};
    use crate::scene::prepare;

    /// Lights of any two kinds that send the same irradiance to a receiver have about the same chance there.
    #[test]
    fn kinds_of_lights_are_weighed_alike() {
        // Each at distance 2 of the origin, in another direction, with unit irradiance across the line of sight.
        let flat = |extra: &str| {
            format!(r#""type": "quad", "size": 0.2, "material": {{"type": "diffuse light", "emit": 100{extra}}}"#)
        };
        let kinds = [
            (flat(""), ""),
            (flat(r#", "two_sided": true"#), ""),
            (r#""type": "disk", "radius": 0.1128379, "material": {"type": "diffuse light", "emit": 100}"#.into(), ""),
            (r#""type": "sphere", "radius": 0.1128379, "material": {"type": "diffuse light", "emit": 100}"#.into(), ""),
            (r#""type": "delta point", "material": {"type": "point light", "emit": 4}"#.into(), ""),
            (r#""type": "delta point", "material": {"type": "spot light", "emit": 4, "inner_angle": 5, "outer_angle": 8}"#.into(), "turn"),
        ];
        // A quad faces along z, a spot along −z.
        let place = |x: f64, turn: &str| {
            let about = if turn.is_empty() { "" } else { r#"{"rotate": [180, 0, 1, 0]}, "# };
            format!(r#""transform": [{about}{{"translate": [0, 0, -2]}}, {{"rotate": [{x}, 0, 1, 0]}}]"#)
        };
        for (i, (a, turn_a)) in kinds.iter().enumerate() {
            for (b, turn_b) in &kinds[i..] {
                let json = format!(
                    r#"{{"camera": {{}}, "surfaces": [{{{a}, {}}}, {{{b}, {}}},
                        {{"type": "quad", "size": 0.1, "material": {{"type": "lambertian", "albedo": 0.5}}}}]}}"#,
                    place(30.0, turn_a),
                    place(-30.0, turn_b)
                );
                let desc = crate::import::scene_from_str(&json, "test.json", std::path::Path::new(".")).expect(&json);
                let prepared = prepare(&desc).expect(&json);
                let choice = LightChoice::new(&prepared.lights, &prepared.geometry).expect("two lights");
                let p = ((glam::DVec3::ZERO - prepared.center) * prepared.scale).as_vec3a();
                let receiver = Receiver { p, n: -Vec3::Z };
                let pmf = [0, 1].map(|light| choice.pmf_direct(&receiver, light, 0).0);
                assert!((pmf[0] + pmf[1] - 1.0).abs() < 1e-6 && (pmf[0] - 0.5).abs() < 0.05, "{pmf:?}: {json}");
                assert!(prepared.lights.iter().all(|l| l.power() != Rgb::ZERO));
            }
        }
    }
}

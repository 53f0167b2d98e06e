//! Pixel filters: which share of the film around a pixel's centre its value is the mean of.
//!
//! A filter is a density over the film, separable and normalised to 1 per pixel area. Camera rays are drawn from it
//! [PBRT4, §8.8], so that each counts fully and a constant image stays constant, its edge included. A light subpath
//! that lands on the film is given to one of the pixels whose filter covers the place, each with the probability of its
//! filter's share among them; what is then left in the weights is the sum of the filters there (docs/MIS.md, section 12).

/// A pixel filter. Radii are in pixels, along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// The pixel itself: a box of radius ½, which covers each place of the film once.
    Pixel,
    /// The same everywhere up to the radius.
    Box(f32),
    /// Falls linearly to nothing at the radius.
    Tent(f32),
    /// A Gaussian whose radius is three standard deviations, cut off there (at a ninetieth of its height).
    Gaussian(f32),
}

/// Standard deviations in the radius of a Gaussian filter.
const DEVIATIONS: f64 = 3.0;

/// What a normal distribution holds within `DEVIATIONS`: erf(3/√2).
const HELD: f64 = 0.997_300_203_936_739_8;

impl Filter {
    /// The box filter of this radius.
    pub fn boxed(radius: f64) -> Self {
        if radius == 0.5 { Self::Pixel } else { Self::Box(radius as f32) }
    }

    /// Along one axis: a place drawn from the filter, from the pixel's near edge (its centre is ½).
    #[inline]
    pub fn sample(&self, u: f32) -> f64 {
        let u = f64::from(u);
        let from_center = match *self {
            Self::Pixel => return u,
            Self::Box(r) => f64::from(r) * (2.0 * u - 1.0),
            Self::Tent(r) => f64::from(r) * if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() },
            Self::Gaussian(r) => {
                let x = f64::from(r) / DEVIATIONS * std::f64::consts::SQRT_2 * inverse_erf(HELD * (2.0 * u - 1.0));
                x.clamp(f64::from(-r), f64::from(r))
            }
        };
        0.5 + from_center
    }

    /// Along one axis: the filter at a distance from the pixel's centre, per pixel.
    #[inline]
    pub fn eval(&self, from_center: f64) -> f64 {
        let r = f64::from(self.radius());
        let x = from_center / r;
        if !(-1.0..1.0).contains(&x) {
            return 0.0;
        }
        match self {
            Self::Pixel | Self::Box(_) => 0.5 / r,
            Self::Tent(_) => (1.0 - x.abs()) / r,
            Self::Gaussian(_) => {
                let deviation = r / DEVIATIONS;
                let z = x * DEVIATIONS;
                (-0.5 * z * z).exp() / (HELD * deviation * (2.0 * std::f64::consts::PI).sqrt())
            }
        }
    }

    /// How far from a pixel's centre the filter reaches along each axis.
    #[inline]
    pub fn radius(&self) -> f32 {
        match *self {
            Self::Pixel => 0.5,
            Self::Box(r) | Self::Tent(r) | Self::Gaussian(r) => r,
        }
    }

    /// Along one axis: the sum of the filters of pixels 0 to `count` at a place of the film.
    #[inline]
    pub fn coverage(&self, place: f64, count: u32) -> f64 {
        self.covering(place, count).map(|(_, f)| f).sum()
    }

    /// Along one axis: one of the pixels 0 to `count` whose filter covers a place of the film, drawn with the
    /// probability of its filter's share, and the sum of the filters there; `None` where there is none.
    #[inline]
    pub fn choose(&self, place: f64, count: u32, u: f32) -> Option<(u32, f64)> {
        let sum = self.coverage(place, count);
        let mut left = f64::from(u) * sum;
        let mut chosen = None;
        for (pixel, f) in self.covering(place, count).filter(|(_, f)| *f > 0.0) {
            chosen = Some((pixel, sum));
            left -= f;
            if left < 0.0 {
                break;
            }
        }
        chosen
    }

    /// The pixels whose filter may reach a place, each with its filter there.
    #[inline]
    fn covering(&self, place: f64, count: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        let r = f64::from(self.radius());
        // A cast saturates, and makes 0 of a NaN, where every filter is 0.
        let first = (place - r - 0.5).floor().max(0.0) as u32;
        let end = ((place + r + 0.5).ceil().max(0.0) as u32).min(count);
        (first..end).map(move |pixel| (pixel, self.eval(place - f64::from(pixel) - 0.5)))
    }
}

/// The inverse of the error function, to about 1e-6 of its value [Giles11].
fn inverse_erf(x: f64) -> f64 {
    let w = -((1.0 - x) * (1.0 + x)).ln();
    let (w, coefficients) = if w < 5.0 {
        (
            w - 2.5,
            [
                2.810_226_36e-8,
                3.432_739_39e-7,
                -3.523_387_7e-6,
                -4.391_506_54e-6,
                0.000_218_580_87,
                -0.001_253_725_03,
                -0.004_177_681_64,
                0.246_640_727,
                1.501_409_41,
            ],
        )
    } else {
        (
            w.sqrt() - 3.0,
            [
                -0.000_200_214_257,
                0.000_100_950_558,
                0.001_349_343_22,
                -0.003_673_428_44,
                0.005_739_507_73,
                -0.007_622_461_3,
                0.009_438_870_47,
                1.001_674_06,
                2.832_976_82,
            ],
        )
    };
    x * coefficients.into_iter().fold(0.0, |sum: f64, c| sum * w + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILTERS: [Filter; 6] = [
        Filter::Pixel,
        Filter::Box(0.8),
        Filter::Tent(1.0),
        Filter::Tent(0.7),
        Filter::Gaussian(1.5),
        Filter::Gaussian(2.25),
    ];

    /// ∫ of the filter from −∞ to a distance from the centre, by the midpoint rule.
    fn integral(filter: &Filter, to: f64) -> f64 {
        let r = f64::from(filter.radius());
        let n = 20_000;
        let step = (to.min(r) + r) / f64::from(n);
        (0..n).map(|i| filter.eval(-r + (f64::from(i) + 0.5) * step)).sum::<f64>() * step
    }

    #[test]
    fn each_filter_holds_one_pixel() {
        for f in FILTERS {
            assert!((integral(&f, f64::INFINITY) - 1.0).abs() < 1e-6, "{f:?}");
        }
    }

    #[test]
    fn places_are_drawn_with_the_filters_density() {
        // The distribution function at the place drawn from u is u.
        for f in FILTERS {
            for i in 0..=64 {
                let u = (i as f32 / 64.0).min(1.0 - 0.5 * f32::EPSILON);
                let place = f.sample(u) - 0.5;
                assert!(place.abs() <= f64::from(f.radius()) * (1.0 + 1e-6), "{f:?} at {u}: {place}");
                let got = integral(&f, place);
                assert!((got - f64::from(u)).abs() < 3e-6, "{f:?}: the {u} quantile holds {got}");
            }
        }
    }

    #[test]
    fn a_place_is_given_to_pixels_in_proportion_to_their_filters() {
        for f in FILTERS {
            for place in [-0.4, 0.1, 0.5, 2.3, 4.999, 5.2] {
                let sum: f64 = (0..5).map(|p| f.eval(place - f64::from(p) - 0.5)).sum();
                let n = 4000;
                let mut hits = [0; 5];
                for i in 0..n {
                    match f.choose(place, 5, (i as f32 + 0.5) / n as f32) {
                        Some((pixel, s)) => {
                            assert!((s - sum).abs() < 1e-12);
                            hits[pixel as usize] += 1;
                        }
                        None => assert_eq!(sum, 0.0, "{f:?} at {place}"),
                    }
                }
                for (p, hits) in hits.into_iter().enumerate().filter(|_| sum > 0.0) {
                    let share = f.eval(place - p as f64 - 0.5) / sum;
                    assert!((f64::from(hits) / f64::from(n) - share).abs() < 1e-3, "{f:?} at {place}: pixel {p}");
                }
            }
        }
    }

    #[test]
    fn far_places_and_ends_of_the_unit_interval_are_harmless() {
        let last = 1.0 - 0.5 * f32::EPSILON;
        for f in FILTERS {
            for place in [-1e30, 1e30, f64::NAN, f64::INFINITY, -100.0, 100.0] {
                assert!(f.choose(place, 5, 0.5).is_none());
            }
            for u in [0.0, last] {
                let place = f.sample(u);
                assert!((place - 0.5).abs() <= f64::from(f.radius()) + 1e-9);
                assert!(f.choose(2.5, 5, u).is_some());
            }
        }
    }
}

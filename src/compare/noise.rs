//! What a reference's own noise adds to errors that are measured by it.
//!
//! An image's measured squared error is, in the mean, its own plus the reference's: `E(x − r)² = E(x − μ)² + E(r − μ)²`,
//! as the two are independent. The second part is known where the reference is the mean `r` of two independent halves `a`
//! and `b` of equal size: each has twice the variance of `r`, and their difference has the sum of both, so that
//! `E(a − b)² / 4 = E(r − μ)²`, pixel by pixel. The relative noise has the denominators that the errors have, `r² + 1e-2` of
//! the mean: over those, `(a − b)²/4` is what is contained in `(x − r)²`; a half's own denominators would be those of no
//! error that is measured. That the denominators are noisy themselves is of second order: where the reference's relMSE is
//! 1 %, errors are off by some percent of themselves.

use super::metrics::{CompareError, REL_MSE_EPSILON, TRIM_ONE_IN, same_size};
use crate::film::Image;

/// A reference and what is known of its noise.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The image to measure by.
    pub image: Image,
    /// Its noise.
    pub noise: ReferenceNoise,
}

/// What is known of a reference's noise.
#[derive(Clone, Debug)]
pub enum ReferenceNoise {
    /// Nothing.
    Unknown,
    /// Its relMSE, from elsewhere.
    RelMse(f64),
    /// Squared standard error of each pixel and channel, estimated: `(a − b)² / 4` of its two halves.
    Variance(Image),
}

/// What the reference's noise contributes to an image's measured errors; `None` where it is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseShare {
    /// To the MSE.
    pub mse: Option<f64>,
    /// To the relMSE.
    pub rel_mse: Option<f64>,
    /// To the relMSE without the worst pixels.
    pub rel_mse_trimmed: Option<f64>,
}

impl Reference {
    /// The mean of two independent images with equal numbers of samples, with its noise.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn of_halves(a: &Image, b: &Image) -> Result<Self, CompareError> {
        same_size(a, b)?;
        let (mut image, mut variance) = (Image::new(a.width, a.height), Image::new(a.width, a.height));
        for (i, (p, q)) in a.rgb.iter().zip(&b.rgb).enumerate() {
            for c in 0..3 {
                let (p, q) = (f64::from(p[c]), f64::from(q[c]));
                image.rgb[i][c] = (0.5 * (p + q)) as f32;
                variance.rgb[i][c] = (0.25 * (p - q) * (p - q)) as f32;
            }
        }
        Ok(Self { image, noise: ReferenceNoise::Variance(variance) })
    }

    /// The reference's part in the errors that `metrics` measures of `x`.
    ///
    /// From halves it is over the very pixels that each of them counts: those that are finite in both images, and for the
    /// trimmed error without those that are worst in `x`, so that a reference's own outlier, which is among them, is not
    /// subtracted from errors that it is no part of. A noise given as relMSE is taken as spread evenly, and tells nothing of the
    /// MSE.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn share(&self, x: &Image) -> Result<NoiseShare, CompareError> {
        same_size(x, &self.image)?;
        let variance = match &self.noise {
            ReferenceNoise::Unknown => return Ok(NoiseShare::default()),
            ReferenceNoise::RelMse(noise) => {
                return Ok(NoiseShare { mse: None, rel_mse: Some(*noise), rel_mse_trimmed: Some(*noise) });
            }
            ReferenceNoise::Variance(variance) => variance,
        };
        let mut sum = 0.0;
        // By pixel: relative error, and the noise's part in it.
        let mut relative = Vec::with_capacity(x.rgb.len());
        for ((p, r), v) in x.rgb.iter().zip(&self.image.rgb).zip(&variance.rgb) {
            if [p, r].iter().any(|pixel| pixel.iter().any(|c| !c.is_finite())) {
                continue;
            }
            let (mut error, mut noise) = (0.0, 0.0);
            for c in 0..3 {
                let (x, r, v) = (f64::from(p[c]), f64::from(r[c]), f64::from(v[c]));
                let denominator = r * r + REL_MSE_EPSILON;
                sum += v;
                error += (x - r) * (x - r) / denominator;
                noise += v / denominator;
            }
            relative.push((error, noise));
        }
        relative.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let kept = relative.len() - relative.len() / TRIM_ONE_IN;
        let mean = |of: &[(f64, f64)]| of.iter().map(|(_, noise)| noise).sum::<f64>() / (3.0 * of.len() as f64);
        Ok(NoiseShare {
            mse: Some(sum / (3.0 * relative.len() as f64)),
            rel_mse: Some(mean(&relative)),
            rel_mse_trimmed: Some(mean(&relative[..kept])),
        })
    }
}

/// A measured error, and what is left of it without the reference's noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// As measured.
    pub measured: f64,
    /// The reference's part, if it is known.
    pub noise: Option<f64>,
}

impl Figure {
    /// The image's own error, `measured − noise`, or `measured` where the noise is not known. `None` where that is below the
    /// noise: the difference of two estimates of one size says nothing but that it is small.
    pub fn value(&self) -> Option<f64> {
        (!self.below_noise()).then_some(self.measured - self.noise.unwrap_or(0.0))
    }

    /// Whether the image's own error is less than the reference's.
    pub fn below_noise(&self) -> bool {
        self.noise.is_some_and(|noise| self.measured - noise < noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::metrics;

    /// Images around a known one with Gaussian noise of known size, relative to each pixel.
    struct Source {
        truth: Image,
        state: u64,
    }

    impl Source {
        fn new() -> Self {
            let mut truth = Image::new(64, 32);
            for (i, pixel) in truth.rgb.iter_mut().enumerate() {
                *pixel = [0.02, 0.5, 3.0].map(|x| x * (1.0 + (i % 7) as f32));
            }
            Self { truth, state: 1 }
        }

        fn uniform(&mut self) -> f64 {
            self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((self.state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        }

        /// With standard deviation `sigma · √(r² + ε)`, so that the relMSE is σ².
        fn image(&mut self, sigma: f64) -> Image {
            let mut image = self.truth.clone();
            for pixel in &mut image.rgb {
                for c in pixel {
                    let r = f64::from(*c);
                    let normal = (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos();
                    *c = (r + sigma * (r * r + REL_MSE_EPSILON).sqrt() * normal) as f32;
                }
            }
            image
        }
    }

    /// Of many runs against one noisy reference, the mean corrected error is the true one; the uncorrected is not.
    #[test]
    fn the_noise_is_what_is_subtracted() {
        let mut source = Source::new();
        let (sigma, half) = (0.05, 0.05);
        let (mut true_noise, mut noise, mut measured) = (0.0, 0.0, 0.0);
        let (mut mse, mut mse_true) = (0.0, 0.0);
        let rounds = 40;
        for _ in 0..rounds {
            let reference = Reference::of_halves(&source.image(half), &source.image(half)).expect("one size");
            let x = source.image(sigma);
            let share = reference.share(&x).expect("one size");
            let m = metrics(&x, &reference.image).expect("one size");
            measured += m.rel_mse / f64::from(rounds);
            noise += share.rel_mse.expect("known") / f64::from(rounds);
            true_noise += metrics(&reference.image, &source.truth).expect("one size").rel_mse / f64::from(rounds);
            mse += (m.mse - share.mse.expect("known")) / f64::from(rounds);
            mse_true += metrics(&x, &source.truth).expect("one size").mse / f64::from(rounds);
        }
        // Half of a half's variance, by construction and by measurement.
        let (own, expected) = (sigma * sigma, 0.5 * half * half);
        let close = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 0.02, "{got}, not {want}");
        close(true_noise, expected);
        close(noise, expected);
        close(measured, own + expected);
        close(measured - noise, own);
        assert!((mse / mse_true - 1.0).abs() < 0.02, "{mse} {mse_true}");
    }

    #[test]
    fn an_outlier_of_the_reference_is_trimmed_with_its_noise() {
        let mut source = Source::new();
        let (a, mut b) = (source.image(0.05), source.image(0.05));
        b.rgb[77][1] = 1e3;
        let reference = Reference::of_halves(&a, &b).expect("one size");
        let x = source.image(0.1);
        let (m, share) = (metrics(&x, &reference.image).expect("sizes"), reference.share(&x).expect("sizes"));
        // 2048 pixels without the worst two.
        let own = m.rel_mse_trimmed - share.rel_mse_trimmed.expect("known");
        assert!((own / 0.01 - 1.0).abs() < 0.05, "{own}");
        assert!(share.rel_mse.expect("known") > 1.04 * share.rel_mse_trimmed.expect("known"));
    }

    #[test]
    fn what_is_known_decides_what_is_said() {
        let source = Source::new();
        let mut reference = Reference { image: source.truth.clone(), noise: ReferenceNoise::Unknown };
        assert_eq!(reference.share(&source.truth).expect("one size"), NoiseShare::default());
        reference.noise = ReferenceNoise::RelMse(1e-4);
        let share = reference.share(&source.truth).expect("one size");
        assert_eq!((share.mse, share.rel_mse, share.rel_mse_trimmed), (None, Some(1e-4), Some(1e-4)));
        assert!(
            reference.share(&Image::new(1, 1)).is_err()
                && Reference::of_halves(&source.truth, &Image::new(1, 1)).is_err()
        );

        let figure = |measured, noise| Figure { measured, noise };
        assert_eq!(figure(5.0, None).value(), Some(5.0));
        assert_eq!(figure(5.0, Some(2.0)).value(), Some(3.0));
        assert_eq!(figure(4.0, Some(2.0)).value(), Some(2.0));
        assert_eq!((figure(3.9, Some(2.0)).value(), figure(3.9, Some(2.0)).below_noise()), (None, true));
        // No error and no noise is an answer.
        assert_eq!((figure(0.0, Some(0.0)).value(), figure(0.0, Some(0.0)).below_noise()), (Some(0.0), false));
        assert!(figure(f64::NAN, Some(0.1)).value().is_some_and(f64::is_nan));
    }
}

//! Error metrics between an image and a reference.

use std::fmt;

use crate::film::Image;

/// Keeps the relative error finite in the dark: `(a − r)² / (r² + ε)`, the value the field's comparisons use (Rousselle,
/// Knaus, Zwicker 2011, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", §6).
pub(super) const REL_MSE_EPSILON: f64 = 1e-2;

/// One in this many pixels is left out of `rel_mse_trimmed`.
pub(super) const TRIM_ONE_IN: usize = 1000;

/// The differences between an image and a reference, over the pixels at which both are finite in all channels; all
/// sums in f64. Without such a pixel the means are NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct Metrics {
    /// Mean of the image per channel.
    pub mean_a: [f64; 3],
    /// Mean of the reference per channel.
    pub mean_ref: [f64; 3],
    /// `mean_a / mean_ref` per channel; NaN where both are zero.
    pub mean_ratio: [f64; 3],
    /// Mean over pixels and channels of `(a − r)²`.
    pub mse: f64,
    /// Mean over pixels and channels of `(a − r)² / (r² + 1e-2)`.
    pub rel_mse: f64,
    /// `rel_mse` without the worst thousandth of the pixels (rounded down): what is left without fireflies.
    pub rel_mse_trimmed: f64,
    /// Largest `|a − r|` of any channel.
    pub max_abs: f64,
    /// Column and row of the first pixel with that difference.
    pub max_at: [u32; 2],
    /// Pixels of the image with a non-finite channel.
    pub non_finite_a: u64,
    /// Pixels of the reference with a non-finite channel.
    pub non_finite_ref: u64,
}

/// The two images cannot be compared.
#[derive(Debug, Clone)]
pub struct CompareError {
    /// What is wrong and what to do.
    pub message: String,
}

impl fmt::Display for CompareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for CompareError {}

/// Refuses images of several sizes.
///
/// # Errors
/// When the sizes differ.
pub(super) fn same_size(a: &Image, reference: &Image) -> Result<(), CompareError> {
    if (a.width, a.height) != (reference.width, reference.height) {
        return Err(CompareError {
            message: format!(
                "the image has {} × {} pixels, the reference {} × {}: render or crop them to one size",
                a.width, a.height, reference.width, reference.height
            ),
        });
    }
    Ok(())
}

/// Compares an image with a reference of the same size.
///
/// # Errors
/// When the sizes differ.
pub fn metrics(a: &Image, reference: &Image) -> Result<Metrics, CompareError> {
    same_size(a, reference)?;
    let mut sum_a = [0.0; 3];
    let mut sum_ref = [0.0; 3];
    let mut sum_squares = 0.0;
    let mut relative = Vec::with_capacity(a.rgb.len());
    let (mut max_abs, mut max_at) = (0.0_f64, [0, 0]);
    let (mut non_finite_a, mut non_finite_ref) = (0, 0);
    for (i, (p, r)) in a.rgb.iter().zip(&reference.rgb).enumerate() {
        let [finite_p, finite_r] = [p, r].map(|x| x.iter().all(|c| c.is_finite()));
        non_finite_a += u64::from(!finite_p);
        non_finite_ref += u64::from(!finite_r);
        if !(finite_p && finite_r) {
            continue;
        }
        let mut pixel = 0.0;
        for channel in 0..3 {
            let (x, y) = (f64::from(p[channel]), f64::from(r[channel]));
            let difference = x - y;
            sum_a[channel] += x;
            sum_ref[channel] += y;
            sum_squares += difference * difference;
            pixel += difference * difference / (y * y + REL_MSE_EPSILON);
            if difference.abs() > max_abs {
                max_abs = difference.abs();
                max_at = [(i % a.width as usize) as u32, (i / a.width as usize) as u32];
            }
        }
        relative.push(pixel);
    }
    let pixels = relative.len() as f64;
    let rel_mse = relative.iter().sum::<f64>() / (3.0 * pixels);
    relative.sort_unstable_by(f64::total_cmp);
    let kept = relative.len() - relative.len() / TRIM_ONE_IN;
    let rel_mse_trimmed = relative[..kept].iter().sum::<f64>() / (3.0 * kept as f64);
    let (mean_a, mean_ref) = (sum_a.map(|s| s / pixels), sum_ref.map(|s| s / pixels));
    Ok(Metrics {
        mean_a,
        mean_ref,
        mean_ratio: std::array::from_fn(|c| mean_a[c] / mean_ref[c]),
        mse: sum_squares / (3.0 * pixels),
        rel_mse,
        rel_mse_trimmed,
        max_abs,
        max_at,
        non_finite_a,
        non_finite_ref,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(width: u32, height: u32, value: [f32; 3]) -> Image {
        Image { width, height, rgb: vec![value; (width * height) as usize] }
    }

    #[test]
    fn a_known_difference() {
        let r = filled(4, 2, [1.0, 2.0, 0.0]);
        let mut a = r.clone();
        a.rgb[6] = [1.5, 2.0, -3.0];
        let m = metrics(&a, &r).expect("one size");
        assert_eq!(m.mean_ref, [1.0, 2.0, 0.0]);
        assert_eq!(m.mean_a, [1.0625, 2.0, -0.375]);
        assert_eq!(m.mean_ratio[..2], [1.0625, 1.0]);
        assert_eq!(m.mse, (0.25 + 9.0) / 24.0);
        assert!((m.rel_mse - (0.25 / 1.01 + 9.0 / 0.01) / 24.0).abs() < 1e-12);
        assert_eq!((m.max_abs, m.max_at), (3.0, [2, 1]));
        assert_eq!(m.rel_mse_trimmed, m.rel_mse, "a thousandth of 8 pixels is none");
    }

    #[test]
    fn the_worst_thousandth_is_trimmed() {
        let r = filled(100, 20, [1.0; 3]);
        let mut a = filled(100, 20, [1.1; 3]);
        a.rgb[7] = [100.0; 3];
        a.rgb[1999] = [50.0; 3];
        let m = metrics(&a, &r).expect("one size");
        let usual = f64::from(1.1_f32 - 1.0).powi(2) / 1.01;
        assert!((m.rel_mse_trimmed - usual).abs() < 1e-9, "{m:?}");
        assert!(m.rel_mse > 1.0);
    }

    #[test]
    fn non_finite_pixels_are_counted_and_left_out() {
        let mut r = filled(10, 10, [2.0; 3]);
        let mut a = filled(10, 10, [1.0; 3]);
        a.rgb[0][1] = f32::NAN;
        a.rgb[1] = [f32::INFINITY; 3];
        r.rgb[1][0] = f32::NEG_INFINITY;
        r.rgb[2][2] = f32::NAN;
        let m = metrics(&a, &r).expect("one size");
        assert_eq!((m.non_finite_a, m.non_finite_ref), (2, 2));
        assert_eq!((m.mean_a, m.mean_ref, m.mse), ([1.0; 3], [2.0; 3], 1.0));
        let nothing = metrics(&filled(2, 2, [f32::NAN; 3]), &filled(2, 2, [1.0; 3])).expect("one size");
        assert!(nothing.mse.is_nan() && nothing.rel_mse_trimmed.is_nan());
    }

    #[test]
    fn other_sizes_are_refused_by_name() {
        let message = metrics(&filled(4, 3, [0.0; 3]), &filled(3, 4, [0.0; 3])).expect_err("sizes differ").message;
        assert!(message.contains("4 × 3") && message.contains("3 × 4"), "{message}");
    }
}

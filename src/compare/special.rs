//! The special functions behind the distributions, in f64, to about 1e-13 relative.

/// Coefficients of Lanczos' approximation with g = 7 and nine terms (Godfrey 2001, "A note on the computation of the
/// convergent Lanczos complex Gamma approximation").
const LANCZOS: [f64; 9] = [
    0.999_999_999_999_809_9,
    676.520_368_121_885_1,
    -1_259.139_216_722_402_8,
    771.323_428_777_653_1,
    -176.615_029_162_140_6,
    12.507_343_278_686_905,
    -0.138_571_095_265_720_12,
    9.984_369_578_019_572e-6,
    1.505_632_735_149_311_6e-7,
];

/// `ln Γ(x)` for `x > 0`.
pub fn ln_gamma(x: f64) -> f64 {
    if x < 0.5 {
        // Reflection: Γ(x)Γ(1−x) = π / sin πx.
        return (std::f64::consts::PI / (std::f64::consts::PI * x).sin()).ln() - ln_gamma(1.0 - x);
    }
    let x = x - 1.0;
    let t = x + 7.5;
    let series = LANCZOS[1..].iter().zip(1..).fold(LANCZOS[0], |sum, (c, i)| sum + c / (x + f64::from(i)));
    0.5 * std::f64::consts::TAU.ln() + (x + 0.5) * t.ln() - t + series.ln()
}

/// `ln(Γ(a + b) / Γ(a))` for `a, b > 0` without the cancellation of two large logarithms: Stirling's series (DLMF
/// 5.11.1) for each, subtracted term by term.
fn ln_gamma_ratio(a: f64, b: f64) -> f64 {
    if a < 20.0 {
        return ln_gamma(a + b) - ln_gamma(a);
    }
    // From a = 20 on, the first term left out is below 2e-15.
    let rest = |x: f64| {
        let y = 1.0 / (x * x);
        (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y / 1680.0))) / x
    };
    (a - 0.5) * (b / a).ln_1p() + b * (a + b).ln() - b + rest(a + b) - rest(a)
}

/// Stands in for zero in Lentz' recurrence.
const TINY: f64 = 1e-300;

/// A continued fraction `b₀ + a₁/(b₁ + a₂/(b₂ + …))` by the modified Lentz method (Press et al. 2007, "Numerical
/// Recipes", 3rd ed., §5.2); `terms(n)` gives `(aₙ, bₙ)`.
fn continued_fraction(b0: f64, terms: impl Fn(u32) -> (f64, f64)) -> f64 {
    let not_zero = |x: f64| if x.abs() < TINY { TINY } else { x };
    let mut f = not_zero(b0);
    let (mut c, mut d) = (f, 0.0);
    // Convergence takes O(√max(a, b)) terms; the limit is for non-finite arguments.
    for n in 1..1_000_000 {
        let (a, b) = terms(n);
        d = 1.0 / not_zero(b + a * d);
        c = not_zero(b + a / c);
        f *= c * d;
        if (c * d - 1.0).abs() < 2.0 * f64::EPSILON || f.is_nan() {
            break;
        }
    }
    f
}

/// The regularised incomplete beta function `I_x(a, b)` for `a, b > 0` and `x` in [0, 1]
/// (Press et al. 2007, (6.4.9); DLMF 8.17.22).
pub fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    incomplete_beta_with_complement(a, b, x, 1.0 - x)
}

/// `I_x(a, b)` where `y = 1 − x` is given, too, for callers that know it better than the subtraction would.
pub fn incomplete_beta_with_complement(a: f64, b: f64, x: f64, y: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if y <= 0.0 {
        return 1.0;
    }
    // Whichever of the two is near 1 has its logarithm from the other.
    let ln_x = if x > 0.5 { (-y).ln_1p() } else { x.ln() };
    let ln_y = if y > 0.5 { (-x).ln_1p() } else { y.ln() };
    let (large, small) = if a > b { (a, b) } else { (b, a) };
    let ln_front = ln_gamma_ratio(large, small) - ln_gamma(small) + a * ln_x + b * ln_y;
    // The fraction converges fast below the mean; above it, I_x(a, b) = 1 − I_y(b, a).
    if x < (a + 1.0) / (a + b + 2.0) {
        ln_front.exp() / (a * beta_fraction(a, b, x))
    } else {
        1.0 - ln_front.exp() / (b * beta_fraction(b, a, y))
    }
}

fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    continued_fraction(1.0, |n| {
        let m = f64::from(n / 2);
        let numerator = if n % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        (numerator, 1.0)
    })
}

/// The regularised lower incomplete gamma function `P(a, x)` for `a > 0`, `x ≥ 0`.
pub fn gamma_p(a: f64, x: f64) -> f64 {
    if x < a + 1.0 { gamma_series(a, x) } else { 1.0 - gamma_fraction(a, x) }
}

/// The regularised upper incomplete gamma function `Q(a, x) = 1 − P(a, x)`.
pub fn gamma_q(a: f64, x: f64) -> f64 {
    if x < a + 1.0 { 1.0 - gamma_series(a, x) } else { gamma_fraction(a, x) }
}

/// `P(a, x)` by its series (DLMF 8.11.4).
fn gamma_series(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
    while term > sum * f64::EPSILON * 0.1 {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    sum * (a * x.ln() - x - ln_gamma(a)).exp()
}

/// `Q(a, x)` by its continued fraction (DLMF 8.9.2).
fn gamma_fraction(a: f64, x: f64) -> f64 {
    if x == f64::INFINITY {
        return 0.0;
    }
    let fraction = continued_fraction(x + 1.0 - a, |n| {
        let n = f64::from(n);
        (-n * (n - a), x + 2.0 * n + 1.0 - a)
    });
    (a * x.ln() - x - ln_gamma(a)).exp() / fraction
}

/// The complementary error function, `erfc x = Q(1/2, x²)` for `x ≥ 0`.
pub fn erfc(x: f64) -> f64 {
    if x < 0.0 { 1.0 + gamma_p(0.5, x * x) } else { gamma_q(0.5, x * x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(got: f64, want: f64, relative: f64) {
        assert!((got - want).abs() <= relative * want.abs(), "{got:e}, not {want:e}");
    }

    #[test]
    fn gamma_of_integers_and_halves() {
        let mut factorial = 1.0_f64;
        for n in 1..30 {
            assert!((ln_gamma(f64::from(n)) - factorial.ln()).abs() < 1e-13 * factorial.ln().max(1.0), "{n}");
            factorial *= f64::from(n);
        }
        close(ln_gamma(0.5), std::f64::consts::PI.sqrt().ln(), 1e-14);
        close(ln_gamma(0.25), 3.625_609_908_221_908_f64.ln(), 1e-13);
        // Γ(a + 3)/Γ(a) = a(a + 1)(a + 2), on both sides of the switch to the series.
        for a in [2.5_f64, 19.9, 20.1, 1e4, 1e12] {
            close(ln_gamma_ratio(a, 3.0), (a * (a + 1.0) * (a + 2.0)).ln(), 1e-13);
        }
    }

    #[test]
    fn beta_has_its_closed_forms() {
        for x in [0.0, 1e-9, 0.1, 0.5, 0.77, 0.999, 1.0] {
            // I_x(1, b) = 1 − (1−x)ᵇ, I_x(a, 1) = xᵃ, I_x(1/2, 1/2) = (2/π) asin √x, I_x(2, 2) = x²(3 − 2x).
            assert!((incomplete_beta(1.0, 3.5, x) - (1.0 - (1.0 - x).powf(3.5))).abs() < 1e-13);
            assert!((incomplete_beta(2.5, 1.0, x) - x.powf(2.5)).abs() < 1e-13);
            let arcsine = 2.0 / std::f64::consts::PI * x.sqrt().asin();
            assert!((incomplete_beta(0.5, 0.5, x) - arcsine).abs() < 1e-13);
            assert!((incomplete_beta(2.0, 2.0, x) - x * x * (3.0 - 2.0 * x)).abs() < 1e-13);
        }
        // A binomial tail: P(X ≥ 400 of 1000, p = 0.4), summed directly.
        let (n, k, p) = (1000, 400, 0.4_f64);
        let ln_choose =
            |j: i32| ln_gamma(f64::from(n) + 1.0) - ln_gamma(f64::from(j) + 1.0) - ln_gamma(f64::from(n - j) + 1.0);
        let tail: f64 =
            (k..=n).map(|j| (ln_choose(j) + f64::from(j) * p.ln() + f64::from(n - j) * (1.0 - p).ln()).exp()).sum();
        close(incomplete_beta(f64::from(k), f64::from(n - k) + 1.0, p), tail, 1e-11);
    }

    #[test]
    fn gamma_has_its_closed_forms() {
        for x in [0.0, 1e-6, 0.3, 1.0, 2.0, 5.0, 40.0, 300.0] {
            // Q(1, x) = e⁻ˣ, Q(3, x) = e⁻ˣ (1 + x + x²/2).
            close(gamma_q(1.0, x), (-x).exp(), 1e-12);
            close(gamma_q(3.0, x), (-x).exp() * (1.0 + x + x * x / 2.0), 1e-12);
            assert!((gamma_p(3.0, x) + gamma_q(3.0, x) - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn erfc_has_its_table_values() {
        // Abramowitz and Stegun 1964, table 7.1, and DLMF 7.
        close(erfc(0.5), 0.479_500_122_186_953_5, 1e-13);
        close(erfc(1.0), 0.157_299_207_050_285_13, 1e-13);
        close(erfc(2.0), 4.677_734_981_047_266e-3, 1e-13);
        close(erfc(5.0), 1.537_459_794_428_035e-12, 1e-12);
        close(erfc(-1.0), 1.842_700_792_949_715, 1e-14);
    }
}

use super::*;

fn close(got: f64, want: f64, relative: f64) {
    assert!((got - want).abs() <= relative * want.abs(), "{got:e}, not {want:e}");
}

/// A uniform stream with a fixed seed (PCG's multiplier, upper bits).
fn uniforms(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed;
    (0..n)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        })
        .collect()
}

#[test]
fn moments_are_exact_far_from_zero_and_merge() {
    let m: Moments = [4.0, 7.0, 13.0, 16.0].map(|x| x + 1e9).into_iter().collect();
    assert_eq!((m.count(), m.mean(), m.variance()), (4, 1e9 + 10.0, 30.0));
    let values = uniforms(3, 1000);
    let whole: Moments = values.iter().copied().collect();
    let (a, b) = values.split_at(137);
    let parts = a.iter().copied().collect::<Moments>().merged(b.iter().copied().collect());
    close(parts.mean(), whole.mean(), 1e-14);
    close(parts.variance(), whole.variance(), 1e-13);
    assert_eq!(Moments::default().merged(m), m);
    assert!(Moments::from_iter([1.0]).variance().is_nan());
}

#[test]
fn student_t_has_its_closed_forms() {
    for t in [0.0, 1e-8, 0.1, 1.0, 2.5, 30.0, 1e4] {
        // ν = 1 is Cauchy's: 1 − (2/π) atan t; ν = 2: 1 − t/√(2 + t²), rewritten without cancellation.
        let cauchy = 2.0 / std::f64::consts::PI * 1.0_f64.atan2(t);
        close(student_t_two_sided(t, 1.0), cauchy, 1e-11);
        let s = (2.0 + t * t).sqrt();
        close(student_t_two_sided(t, 2.0), 2.0 / (s * (s + t)), 1e-11);
        assert_eq!(student_t_two_sided(t, 7.3), student_t_two_sided(-t, 7.3));
    }
    // ν = 4: F(t) = 1/2 + 3/8 · t/√(1 + t²/4) · (1 − t²/(12(1 + t²/4))).
    for t in [0.3_f64, 1.0, 3.0] {
        let w = 1.0 + t * t / 4.0;
        close(student_t_cdf(t, 4.0), 0.5 + 0.375 * t / w.sqrt() * (1.0 - t * t / (12.0 * w)), 1e-12);
    }
    // Towards the normal distribution with its first correction, t(t² + 1)φ(t)/(2ν) (Abramowitz and Stegun, 26.7.8).
    for (t, dof) in [(1.5_f64, 1e5), (0.3, 1e6), (4.0, 1e7), (1.5, 1e12)] {
        let phi = (-0.5 * t * t).exp() / std::f64::consts::TAU.sqrt();
        let want = 2.0 * (1.0 - normal_cdf(t)).min(normal_cdf(-t)) + t * (t * t + 1.0) * phi / (2.0 * dof);
        assert!((student_t_two_sided(t, dof) - want).abs() < 1e-10, "{t} {dof}");
    }
    assert_eq!((student_t_two_sided(f64::INFINITY, 3.0), student_t_two_sided(0.0, 3.0)), (0.0, 1.0));
}

#[test]
fn student_t_quantiles_have_their_table_values() {
    // ν = 1: tan(π(p − 1/2)); ν = 2: (2p − 1)√(2/(4p(1−p))); the rest from the usual tables, to their digits.
    for p in [1e-6, 0.01, 0.4, 0.5, 0.9, 0.999] {
        let cauchy = (std::f64::consts::PI * (p - 0.5)).tan();
        assert!((student_t_quantile(p, 1.0) - cauchy).abs() <= 1e-9 * cauchy.abs().max(1e-3), "{p}");
        let two = (2.0 * p - 1.0) * (2.0 / (4.0 * p * (1.0 - p))).sqrt();
        assert!((student_t_quantile(p, 2.0) - two).abs() <= 1e-9 * two.abs().max(1e-3), "{p}");
    }
    for (p, dof, want) in
        [(0.975, 10.0, 2.228_14), (0.995, 30.0, 2.750_00), (0.95, 5.0, 2.015_05), (0.975, 120.0, 1.979_93)]
    {
        assert!((student_t_quantile(p, dof) - want).abs() < 1e-5, "{p} {dof}");
    }
    for dof in [0.7, 3.0, 33.3, 1e6] {
        close(student_t_cdf(student_t_quantile(0.8, dof), dof), 0.8, 1e-12);
    }
    assert!(student_t_quantile(1.0, 3.0).is_nan() && student_t_quantile(0.5, 0.0).is_nan());
}

#[test]
fn normal_quantiles_have_their_published_values() {
    // Wichura 1988, the check values: p = 0.25, 0.001, 1e-20.
    close(normal_quantile(0.25), -0.674_489_750_196_081_7, 1e-15);
    close(normal_quantile(0.001), -3.090_232_306_167_814, 1e-15);
    close(normal_quantile(1e-20), -9.262_340_089_798_408, 1e-15);
    close(normal_quantile(0.975), 1.959_963_984_540_054, 1e-15);
    assert_eq!(normal_quantile(0.5), 0.0);
    for p in [1e-12, 1e-3, 0.07, 0.08, 0.3, 0.6, 0.93, 0.999] {
        close(normal_cdf(normal_quantile(p)), p, 1e-12);
    }
    assert!(normal_quantile(0.0).is_nan());
}

#[test]
fn welch_agrees_with_a_worked_example() {
    // Two samples with t and ν by hand: means 3 and 6, variances 2.5 and 10, five values each:
    // t = −3/√(0.5 + 2), ν = 2.5²/((0.25 + 4)/4) = 100/17.
    let a: Moments = [1.0, 2.0, 3.0, 4.0, 5.0].into_iter().collect();
    let b: Moments = [2.0, 4.0, 6.0, 8.0, 10.0].into_iter().collect();
    let w = Welch::new(&a, &b);
    close(w.t, -3.0 / 2.5_f64.sqrt(), 1e-14);
    close(w.dof, 100.0 / 17.0, 1e-14);
    // The density integrated by Simpson's rule instead of the incomplete beta function.
    let nu = w.dof;
    let density = |x: f64| (1.0 + x * x / nu).powf(-0.5 * (nu + 1.0));
    let integral = |from: f64, to: f64| {
        let n = 200_000;
        let h = (to - from) / f64::from(n);
        (0..=n)
            .map(|i| density(from + f64::from(i) * h) * if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) })
            .sum::<f64>()
            * h
            / 3.0
    };
    let ln_norm = crate::compare::special::ln_gamma(0.5 * (nu + 1.0))
        - crate::compare::special::ln_gamma(0.5 * nu)
        - 0.5 * (nu * std::f64::consts::PI).ln();
    let p = 1.0 - 2.0 * integral(0.0, w.t.abs()) * ln_norm.exp();
    assert!((w.p - p).abs() < 1e-10, "{} {p}", w.p);
    let interval = w.confidence_interval(1.0 - w.p);
    assert!(interval.high.abs() < 1e-9, "at confidence 1 − p the interval ends at zero: {interval:?}");
}

#[test]
fn welch_without_variance_or_values() {
    let constant: Moments = [2.0; 5].into_iter().collect();
    let other: Moments = [3.0; 4].into_iter().collect();
    assert_eq!(Welch::new(&constant, &constant).p, 1.0);
    assert_eq!(Welch::new(&constant, &other).p, 0.0);
    assert!(Welch::new(&constant, &Moments::from_iter([1.0])).p.is_nan());
}

#[test]
fn welchs_p_is_uniform_under_the_null() {
    let mut p = Vec::new();
    for trial in 0..2000 {
        let normal = |seed, n| uniforms(seed, n).into_iter().map(|u| normal_quantile(u.clamp(1e-12, 1.0 - 1e-12)));
        let a: Moments = normal(3 * trial + 1, 12).collect();
        let b: Moments = normal(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(trial + 1), 30).map(|z| 4.0 * z).collect();
        p.push(Welch::new(&a, &b).p);
    }
    let ks = ks_uniform(&p);
    assert!(ks.p > 1e-3, "{ks:?}");
}

#[test]
fn intervals_cover_as_often_as_they_claim_and_prove_equivalence() {
    let trials = 2000;
    let mut covered = 0;
    for trial in 0..trials {
        let m: Moments = uniforms(0x2545_f491_4f6c_dd1d_u64.wrapping_mul(trial + 1), 20).into_iter().collect();
        covered += u32::from(m.confidence_interval(0.9).contains(0.5));
    }
    // Binomial(2000, 0.9): standard deviation 13.4; uniform parents cost a fraction of it.
    assert!((f64::from(covered) - 1800.0).abs() < 55.0, "{covered}");
    let m: Moments = uniforms(9, 100_000).into_iter().collect();
    let bias = m.confidence_interval(0.99);
    let bias = Interval { low: bias.low - 0.5, high: bias.high - 0.5 };
    assert!(bias.within(0.005) && !bias.within(0.0005), "{bias:?}");
    assert!(bias.scaled(-2.0).within(0.01) && bias.scaled(-2.0).low < bias.scaled(-2.0).high);
    assert!(!Moments::from_iter([0.0]).confidence_interval(0.9).within(1e9), "one value proves nothing");
}

#[test]
fn chi_squared_has_its_closed_forms() {
    // ν = 2: e^{−x/2}; ν = 4: e^{−x/2}(1 + x/2); ν = 1: erfc √(x/2); 5 % points from the usual tables.
    for x in [0.0_f64, 0.1, 2.0, 20.0, 200.0] {
        close(chi_squared_p(x, 2.0), (-x / 2.0).exp(), 1e-12);
        close(chi_squared_p(x, 4.0), (-x / 2.0).exp() * (1.0 + x / 2.0), 1e-12);
    }
    for (x, dof) in [(3.841_459, 1.0), (18.307_038, 10.0), (124.342_113, 100.0)] {
        close(chi_squared_p(x, dof), 0.05, 1e-6);
    }
}

#[test]
fn sidaks_levels_multiply_back() {
    for (alpha, m) in [(0.05, 1), (0.05, 10), (1e-3, 4096), (1e-12, 1_000_000)] {
        let each = sidak(alpha, m);
        close(-(m as f64 * (-each).ln_1p()).exp_m1(), alpha, 1e-12);
    }
    close(sidak(0.05, 1), 0.05, 1e-15);
}

#[test]
fn kolmogorov_smirnov_has_its_table_values_and_bites() {
    // Smirnov's table of the limit: 1.3581 at 5 %, 1.6276 at 1 %; 0.5 at 0.8276; both series agree at their join.
    assert!((kolmogorov_q(1.358_10) - 0.05).abs() < 1e-5);
    assert!((kolmogorov_q(1.627_62) - 0.01).abs() < 1e-5);
    assert!((kolmogorov_q(0.827_57) - 0.5).abs() < 1e-4);
    assert!((kolmogorov_q(1.0 - 1e-12) - kolmogorov_q(1.0)).abs() < 1e-10);
    // One value: D = max(x, 1 − x).
    assert_eq!(ks_uniform(&[0.3]).d, 0.7);
    assert_eq!(ks_uniform(&[0.5, 0.0, 1.0, 0.75, 0.25]).d, 0.2);
    let values = uniforms(1, 10_000);
    assert!(ks_uniform(&values).p > 0.01);
    let bent: Vec<f64> = values.iter().map(|x| x.powf(1.1)).collect();
    assert!(ks_uniform(&bent).p < 1e-6);
    assert!(ks_uniform(&[]).p.is_nan());
}

//! Special functions that turn a statistic into a probability.

use std::f64::consts::{PI, SQRT_2};

/// The probability that a chi-square variable with `dof` degrees of freedom exceeds `statistic`.
///
/// # Maths
/// Q(dof / 2, statistic / 2), the regularised upper incomplete gamma function.
pub fn chi2_survival(statistic: f64, dof: usize) -> f64 {
    gamma_q(0.5 * dof as f64, 0.5 * statistic)
}

/// The probability that a standard normal variable lies further than `|z|` from zero.
///
/// # Maths
/// erfc(|z| / √2) = Q(1/2, z² / 2)
pub fn normal_two_sided(z: f64) -> f64 {
    let x = z.abs() / SQRT_2;
    gamma_q(0.5, x * x)
}

/// The regularised upper incomplete gamma function Q(a, x), to about 1e-12.
///
/// # References
/// Abramowitz and Stegun, 6.5.29 (series, good for x < a + 1) and 6.5.31 (continued fraction, else).
fn gamma_q(a: f64, x: f64) -> f64 {
    if !(a > 0.0 && x >= 0.0) {
        return f64::NAN;
    }
    if x == 0.0 {
        return 1.0;
    }
    if x.is_infinite() {
        return 0.0;
    }
    let prefactor = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 { 1.0 - prefactor * lower_series(a, x) } else { prefactor * upper_fraction(a, x) }
}

/// Σ xⁿ / (a (a+1) … (a+n)).
fn lower_series(a: f64, x: f64) -> f64 {
    let mut term = 1.0 / a;
    let mut sum = term;
    let mut n = a;
    while term > sum * 1e-16 {
        n += 1.0;
        term *= x / n;
        sum += term;
    }
    sum
}

/// 1/(x+1-a- 1(1-a)/(x+3-a- 2(2-a)/(x+5-a- …))), by Lentz's method.
fn upper_fraction(a: f64, x: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let nonzero = |v: f64| if v.abs() < TINY { TINY } else { v };
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / TINY;
    let mut d = 1.0 / nonzero(b);
    let mut value = d;
    for i in 1..100_000 {
        let i = f64::from(i);
        let numerator = -i * (i - a);
        b += 2.0;
        d = 1.0 / nonzero(numerator * d + b);
        c = nonzero(b + numerator / c);
        let factor = d * c;
        value *= factor;
        if (factor - 1.0).abs() < 1e-15 {
            break;
        }
    }
    value
}

/// ln Γ(x) for x > 0.
///
/// # References
/// Stirling's series, Abramowitz and Stegun 6.1.41, after stepping up to x ≥ 10 by Γ(x) = Γ(x+1) / x.
fn ln_gamma(mut x: f64) -> f64 {
    let mut shift = 0.0;
    while x < 10.0 {
        shift -= x.ln();
        x += 1.0;
    }
    let inverse = 1.0 / x;
    let inverse2 = inverse * inverse;
    let series = inverse
        * (1.0 / 12.0
            - inverse2
                * (1.0 / 360.0 - inverse2 * (1.0 / 1260.0 - inverse2 * (1.0 / 1680.0 - inverse2 / 1188.0))));
    shift + (x - 0.5) * x.ln() - x + 0.5 * (2.0 * PI).ln() + series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ln_gamma_matches_factorials() {
        let mut factorial = 1.0_f64;
        for n in 1..20 {
            assert!((ln_gamma(f64::from(n)) - factorial.ln()).abs() < 1e-12 * factorial.ln().max(1.0));
            factorial *= f64::from(n);
        }
        assert!((ln_gamma(0.5) - PI.sqrt().ln()).abs() < 1e-12);
    }

    #[test]
    fn survival_matches_closed_forms() {
        // Two degrees of freedom: exp(-x/2). Four: exp(-x/2) (1 + x/2).
        for x in [0.1, 1.0, 2.5, 5.0, 20.0, 100.0] {
            let e = f64::exp(-0.5 * x);
            assert!((chi2_survival(x, 2) - e).abs() < 1e-12);
            assert!((chi2_survival(x, 4) - e * (1.0 + 0.5 * x)).abs() < 1e-12);
        }
        // Printed tables of quantiles.
        assert!((chi2_survival(3.841_459, 1) - 0.05).abs() < 1e-7);
        assert!((chi2_survival(124.342_113, 100) - 0.05).abs() < 1e-7);
        assert!((chi2_survival(149.449_253, 100) - 0.001).abs() < 1e-7);
    }

    #[test]
    fn normal_tail_matches_tables() {
        assert!((normal_two_sided(1.959_963_985) - 0.05).abs() < 1e-9);
        assert!((normal_two_sided(-5.0) - 5.733_031e-7).abs() < 1e-12);
        assert_eq!(normal_two_sided(0.0), 1.0);
    }
}

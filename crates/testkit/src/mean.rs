//! Means of draws, their errors, and z-tests on them.

use aureole_math::Pcg32;

use crate::normal_two_sided;

/// A mean with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean {
    /// The mean of the draws.
    pub value: f64,
    /// The standard deviation of `value` itself: σ / √n.
    pub standard_error: f64,
    /// How many draws.
    pub count: usize,
}

impl Mean {
    /// The mean of the given draws, by Welford's recurrence.
    pub fn of(draws: impl IntoIterator<Item = f64>) -> Self {
        let (mut count, mut mean, mut squares) = (0_usize, 0.0, 0.0);
        for x in draws {
            count += 1;
            let delta = x - mean;
            mean += delta / count as f64;
            squares += delta * (x - mean);
        }
        let n = count as f64;
        let standard_error = if count > 1 { (squares / (n - 1.0) / n).sqrt() } else { f64::INFINITY };
        Self { value: mean, standard_error, count }
    }

    /// Whether the true mean may be at most `bound`: the value exceeds it by no more than `sigmas` standard errors.
    ///
    /// A mean that is at the bound is called too large in 2.3 %, 0.13 % or 0.00003 % of all runs for 2, 3 or 5 sigmas.
    pub fn is_at_most(&self, bound: f64, sigmas: f64) -> bool {
        self.value <= bound + sigmas * self.standard_error + 1e-6 * bound.abs()
    }
}

/// The mean of `count` draws of `draw`, from a fixed seed.
pub fn mean_with_error(count: usize, seed: u64, mut draw: impl FnMut(&mut Pcg32) -> f64) -> Mean {
    let mut rng = Pcg32::new(seed);
    Mean::of((0..count).map(|_| draw(&mut rng)))
}

/// The probability of a mean at least as far from `expected` if that is the true mean.
///
/// Reject below the significance that you want; that is the false-alarm rate, for draws of finite variance and
/// enough of them. A mean without spread gets 1 if it equals `expected` up to rounding, else 0.
pub fn z_test(mean: &Mean, expected: f64) -> f64 {
    p_value(mean.value - expected, mean.standard_error, expected)
}

/// The probability of two means at least as far apart if they estimate the same value.
pub fn z_test_between(a: &Mean, b: &Mean) -> f64 {
    p_value(a.value - b.value, a.standard_error.hypot(b.standard_error), b.value)
}

fn p_value(difference: f64, error: f64, scale: f64) -> f64 {
    // Single-precision rounding of the draws is not evidence against the hypothesis.
    let rounding = 2e-6 * scale.abs();
    let excess = (difference.abs() - rounding).max(0.0);
    match (excess == 0.0, error == 0.0) {
        (true, _) => 1.0,
        (false, true) => 0.0,
        (false, false) => normal_two_sided(excess / error),
    }
}

/// The significance that each of `test_count` tests may use so that all together raise a false alarm with
/// probability `significance`.
///
/// # Maths
/// 1 - (1 - α)^(1/n) [Šidák 1967]
pub fn sidak(significance: f64, test_count: usize) -> f64 {
    -f64::exp_m1(f64::ln_1p(-significance) / test_count.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_error_of_the_uniform_distribution() {
        let n = 100_000;
        let mean = mean_with_error(n, 1, |rng| f64::from(rng.next_f32()));
        assert!((mean.standard_error - (1.0 / 12.0 / n as f64).sqrt()).abs() < 1e-5);
        // False alarm in one of a thousand seeds.
        assert!(z_test(&mean, 0.5) > 1e-3);
        assert!(z_test(&mean, 0.51) < 1e-6);
        assert!(mean.is_at_most(0.5, 4.0) && !mean.is_at_most(0.49, 4.0));
        let other = mean_with_error(n, 2, |rng| f64::from(rng.next_f32()));
        assert!(z_test_between(&mean, &other) > 1e-3);
    }

    #[test]
    fn constants_compare_exactly() {
        let mean = mean_with_error(10, 0, |_| 0.25);
        assert_eq!(z_test(&mean, 0.25), 1.0);
        assert_eq!(z_test(&mean, 0.26), 0.0);
    }

    #[test]
    fn sidak_keeps_the_rate_of_the_family() {
        assert!((sidak(0.05, 1) - 0.05).abs() < 1e-15);
        let single = sidak(0.05, 100);
        assert!((1.0 - (1.0 - single).powi(100) - 0.05).abs() < 1e-12);
    }
}

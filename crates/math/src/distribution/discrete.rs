//! A choice among finitely many, in proportion to weights.

/// A discrete distribution, sampled by inverting its cumulative sums.
#[derive(Clone, Debug)]
pub struct Discrete {
    /// Cumulative sums, normalised; the last one is 1.
    cdf: Vec<f32>,
    sum: f32,
}

/// A choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteSample {
    /// Which one.
    pub index: usize,
    /// Its probability.
    pub pmf: f32,
    /// The random number, stretched to be used again.
    pub u: f32,
}

impl Discrete {
    /// A distribution in proportion to weights; `None` when they are empty, negative, not finite or all zero.
    pub fn new(weights: impl IntoIterator<Item = f32>) -> Option<Self> {
        let mut sum = 0.0_f64;
        let mut sums = Vec::new();
        for weight in weights {
            if !(weight >= 0.0 && weight.is_finite()) {
                return None;
            }
            sum += f64::from(weight);
            sums.push(sum);
        }
        if sum.is_nan() || sum <= 0.0 {
            return None;
        }
        let cdf = sums.iter().map(|s| (s / sum) as f32).collect();
        Some(Self { cdf, sum: sum as f32 })
    }

    /// How many choices there are.
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.cdf.len()
    }

    /// The sum of the weights.
    pub fn sum(&self) -> f32 {
        self.sum
    }

    /// The probability of a choice.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        self.cdf[index] - if index == 0 { 0.0 } else { self.cdf[index - 1] }
    }

    /// The choice at `u` in [0, 1). Never one of probability zero.
    #[inline]
    pub fn sample(&self, u: f32) -> DiscreteSample {
        let index = self.cdf.partition_point(|&c| c <= u).min(self.cdf.len() - 1);
        let start = if index == 0 { 0.0 } else { self.cdf[index - 1] };
        let pmf = self.cdf[index] - start;
        let u = if pmf > 0.0 { ((u - start) / pmf).clamp(0.0, 1.0 - f32::EPSILON) } else { 0.0 };
        DiscreteSample { index, pmf, u }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pcg32;

    #[test]
    fn frequencies_follow_the_weights() {
        let weights = [1.0, 0.0, 3.0, 6.0];
        let d = Discrete::new(weights).unwrap();
        let mut counts = [0_u32; 4];
        let mut rng = Pcg32::new(5);
        for _ in 0..100_000 {
            let s = d.sample(rng.next_f32());
            assert_eq!(s.pmf, d.pmf(s.index));
            counts[s.index] += 1;
        }
        assert_eq!(counts[1], 0);
        // Pearson's statistic with two degrees of freedom: 27.6 is exceeded in one of a million runs.
        let chi2: f32 = [0, 2, 3]
            .map(|i| (counts[i] as f32 - weights[i] * 1e4).powi(2) / (weights[i] * 1e4))
            .iter()
            .sum();
        assert!(chi2 < 27.6, "{counts:?}");
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(Discrete::new([]).is_none());
        assert!(Discrete::new([0.0, 0.0]).is_none());
        assert!(Discrete::new([1.0, f32::NAN]).is_none());
        assert!(Discrete::new([1.0, -1.0]).is_none());
    }
}

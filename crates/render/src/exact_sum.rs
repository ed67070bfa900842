//! A sum of floats that does not depend on the order in which they were added.

use std::ops::AddAssign;

/// Units per one: values are kept to 2⁻⁶⁴.
const UNITS: f64 = 18_446_744_073_709_551_616.0;

/// An exact sum of numbers of magnitude up to 10¹², with a resolution of 2⁻⁶⁴.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSum(i128);

impl ExactSum {
    /// Adds a finite number.
    #[inline]
    pub fn add(&mut self, x: f32) {
        // A float is a whole number of 24 bits times a power of two, and so is the number of units, cut off below.
        let bits = x.to_bits();
        let exponent = (bits >> 23 & 0xff) as i32;
        let fraction = i128::from(bits & 0x7f_ffff) | i128::from(exponent > 0) << 23;
        let shift = exponent.max(1) - 150 + 64;
        let units = match shift {
            ..=-24 => 0,
            -23..=-1 => fraction >> -shift,
            0..=100 => fraction << shift,
            // Far beyond what a film takes.
            _ => (f64::from(x.abs()) * UNITS) as i128,
        };
        self.0 = self.0.wrapping_add(if x < 0.0 { -units } else { units });
    }

    /// The sum, rounded once.
    #[inline]
    pub fn value(self) -> f64 {
        self.0 as f64 / UNITS
    }

    /// The sum as four words, the lowest first.
    pub fn words(self) -> [u32; 4] {
        std::array::from_fn(|i| (self.0 >> (32 * i)) as u32)
    }

    /// The sum of four words, the lowest first.
    pub fn from_words(words: [u32; 4]) -> Self {
        Self(words.iter().rev().fold(0, |sum, &word| sum << 32 | i128::from(word)))
    }
}

impl AddAssign for ExactSum {
    fn add_assign(&mut self, other: Self) {
        // Numbers from a damaged file must not end the program; those of a render are far from the limit.
        self.0 = self.0.wrapping_add(other.0);
    }
}

#[cfg(test)]
mod tests {
    use aureole_math::Pcg32;

    use super::*;

    #[test]
    fn sums_do_not_depend_on_order() {
        let values = [1e6_f32, 1.5e-12, -0.3, 7.25, 1e-7, -1e6, 3e9];
        let sum = |order: &[usize]| {
            let mut s = ExactSum::default();
            order.iter().for_each(|&i| s.add(values[i]));
            s
        };
        let forward = sum(&[0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(forward, sum(&[6, 3, 1, 0, 5, 4, 2]));
        assert!((forward.value() - values.iter().map(|&x| f64::from(x)).sum::<f64>()).abs() < 1e-6);
    }

    #[test]
    fn units_are_those_of_the_product() {
        let mut rng = Pcg32::new(7);
        let special = [0.0, -0.0, 1.0, -1.5, 1e12, -1e12, f32::MIN_POSITIVE, 1e-45, 2.0_f32.powi(-64)];
        let random = (0..100_000).map(|_| f32::from_bits(rng.next_u32()));
        for x in special.into_iter().chain(random).filter(|x| x.abs() <= 1e12) {
            let mut sum = ExactSum::default();
            sum.add(x);
            assert_eq!(sum, ExactSum((f64::from(x) * UNITS) as i128), "{x:e}");
        }
    }

    #[test]
    fn sums_are_words_and_back() {
        for x in [0.0, 1.0, -1.0, 1e12, -1e-12, 0.1] {
            let mut sum = ExactSum::default();
            sum.add(x);
            assert_eq!(ExactSum::from_words(sum.words()), sum);
        }
    }
}

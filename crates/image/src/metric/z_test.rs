//! Whether an image's differences from a converged reference can be Monte Carlo noise.

use rayon::prelude::*;

use aureole_spectrum::xyz_from_srgb;

use crate::metric::ErrorMap;
use crate::{Image, ImageError};

/// The chance of a false alarm somewhere in the image, before the correction for the number of pixels.
const SIGNIFICANCE: f64 = 0.01;
/// The fraction of values that must be accepted: a few are not normally distributed at low sample counts.
const WANTED_FRACTION: f64 = 0.9975;
/// Pixels that no sample varied in still have the rounding of a reference.
const MIN_VARIANCE: f64 = 1e-4;

/// The outcome of [`z_test`].
#[derive(Clone, Debug, PartialEq)]
pub struct ZTest {
    /// Fraction of the values (three a pixel) whose difference noise explains.
    pub accepted: f64,
    /// Values of the image that are NaN or infinite; they are taken as zero.
    pub non_finite: usize,
    /// The smallest p-value of every pixel.
    pub p_values: ErrorMap,
}

impl ZTest {
    /// Whether enough values are accepted and all are finite.
    pub fn passes(&self) -> bool {
        self.accepted >= WANTED_FRACTION && self.non_finite == 0
    }
}

/// Tests every value of an image of `samples` samples a pixel against a converged reference.
///
/// Values are compared in CIE XYZ, where noise in one primary does not hide in the others. `variance` is that of a single
/// sample, as linear RGB like the images.
///
/// # Maths
/// z = |x - μ| √(n / σ²), p = erfc(z / √2); a value is accepted if p > 1 - (1 - 0.01)^(1/pixels).
///
/// # Errors
/// [`ImageError::Mismatch`] if the sizes differ.
///
/// # References
/// [Šidák 1967] "Rectangular Confidence Regions for the Means of Multivariate Normal Distributions"; the test as renderers
/// use it: [Subr & Arvo 2007] "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators".
pub fn z_test(reference: &Image, variance: &Image, image: &Image, samples: u64) -> Result<ZTest, ImageError> {
    reference.check_same_size(image)?;
    reference.check_same_size(variance)?;
    let pixels = image.width() * image.height();
    let threshold = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / pixels as f64);
    let xyz = |image: &Image| -> Vec<[f32; 3]> {
        let clean = |x: f32| if x.is_finite() { x } else { 0.0 };
        image.to_rgb().into_par_iter().map(|rgb| xyz_from_srgb(rgb.map(clean))).collect()
    };
    let (mean, variance, values) = (xyz(reference), xyz(variance), xyz(image));
    let p_values: Vec<[f64; 3]> = (0..pixels)
        .into_par_iter()
        .map(|i| {
            [0, 1, 2].map(|c| {
                let variance = f64::from(variance[i][c]).max(MIN_VARIANCE);
                let difference = f64::from(values[i][c]) - f64::from(mean[i][c]);
                let z = difference.abs() * (samples as f64 / variance).sqrt();
                libm::erfc(z / std::f64::consts::SQRT_2)
            })
        })
        .collect();
    let accepted = p_values.as_flattened().iter().filter(|&&p| p > threshold).count();
    let smallest = p_values.iter().map(|p| p[0].min(p[1]).min(p[2]) as f32).collect();
    Ok(ZTest {
        accepted: accepted as f64 / (3 * pixels).max(1) as f64,
        non_finite: image.to_rgb().as_flattened().iter().filter(|x| !x.is_finite()).count(),
        p_values: ErrorMap::new(image.width(), image.height(), smallest),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 100;

    /// An image of one value with noise of a standard deviation, from a small generator (PCG, O'Neill 2014).
    fn noisy(value: f32, deviation: f32, seed: u64) -> Image {
        let mut state = seed;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let word = (((state >> 18) ^ state) >> 27) as u32;
            f64::from(word.rotate_right((state >> 59) as u32)) / 4_294_967_296.0
        };
        // Grey noise, so that the variance of Y is that of the channels.
        let pixels: Vec<_> = (0..SIZE * SIZE)
            .map(|_| {
                let normal = (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
                [value + deviation * normal as f32; 3]
            })
            .collect();
        Image::from_rgb(SIZE, SIZE, &pixels).unwrap()
    }

    #[test]
    fn noise_passes_and_bias_fails() {
        let reference = noisy(0.5, 0.0, 1);
        let variance = noisy(0.04, 0.0, 1);
        // 64 samples of standard deviation 0.2 leave 0.025.
        let fair = z_test(&reference, &variance, &noisy(0.5, 0.025, 7), 64).unwrap();
        assert!(fair.passes() && fair.accepted > 0.999, "{}", fair.accepted);
        assert!(!z_test(&reference, &variance, &noisy(0.7, 0.025, 7), 64).unwrap().passes());
    }

    #[test]
    fn one_value_that_is_not_finite_fails() {
        let (reference, variance) = (noisy(0.5, 0.0, 1), noisy(0.04, 0.0, 1));
        let mut image = reference.clone();
        image.pixel_mut(3, 4)[1] = f32::NAN;
        let test = z_test(&reference, &variance, &image, 64).unwrap();
        assert!(test.non_finite == 1 && !test.passes());
        assert!(test.p_values.values()[4 * SIZE + 3] < 1e-3);
    }
}

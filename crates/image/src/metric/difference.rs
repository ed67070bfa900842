//! Sums of differences.

use rayon::prelude::*;

use crate::metric::ErrorMap;
use crate::{Image, ImageError, ToneMapping};

/// The number added to the squared reference in a relative error, so that black does not divide by zero.
pub const REL_MSE_EPSILON: f64 = 0.01;

/// Sums over the red, green and blue of all pixels, in linear values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Mean squared error.
    pub mse: f64,
    /// Mean of the squared error over the squared reference plus [`REL_MSE_EPSILON`].
    pub rel_mse: f64,
    /// Mean absolute error.
    pub mae: f64,
    /// Largest absolute error.
    pub max: f64,
    /// Mean of the image over mean of the reference: 1 for an unbiased render.
    pub mean_ratio: f64,
    /// Values that are NaN or infinite in either image. They are in none of the sums.
    pub non_finite: usize,
}

/// Sums over some of the pixels.
#[derive(Clone, Copy, Default)]
struct Sums {
    squared: f64,
    relative: f64,
    absolute: f64,
    max: f64,
    reference: f64,
    image: f64,
    count: usize,
    non_finite: usize,
}

impl Sums {
    fn add(&mut self, reference: f32, image: f32) {
        if !(reference.is_finite() && image.is_finite()) {
            self.non_finite += 1;
            return;
        }
        let (r, x) = (f64::from(reference), f64::from(image));
        let squared = (x - r) * (x - r);
        self.squared += squared;
        self.relative += squared / (r * r + REL_MSE_EPSILON);
        self.absolute += (x - r).abs();
        self.max = self.max.max((x - r).abs());
        self.reference += r;
        self.image += x;
        self.count += 1;
    }

    fn join(self, other: Self) -> Self {
        Self {
            squared: self.squared + other.squared,
            relative: self.relative + other.relative,
            absolute: self.absolute + other.absolute,
            max: self.max.max(other.max),
            reference: self.reference + other.reference,
            image: self.image + other.image,
            count: self.count + other.count,
            non_finite: self.non_finite + other.non_finite,
        }
    }
}

/// Compares an image's colours with a reference's.
///
/// The result does not depend on the number of threads: rows are summed apart and joined in order.
///
/// # Errors
/// [`ImageError::Mismatch`] if the sizes differ.
pub fn compare(reference: &Image, image: &Image) -> Result<Errors, ImageError> {
    reference.check_same_size(image)?;
    let (a, b) = (reference.to_rgb(), image.to_rgb());
    let width = reference.width().max(1);
    let rows: Vec<Sums> = a
        .par_chunks(width)
        .zip(b.par_chunks(width))
        .map(|(a, b)| {
            let mut sums = Sums::default();
            a.as_flattened().iter().zip(b.as_flattened()).for_each(|(&r, &x)| sums.add(r, x));
            sums
        })
        .collect();
    let sums = rows.into_iter().fold(Sums::default(), Sums::join);
    let n = sums.count.max(1) as f64;
    Ok(Errors {
        mse: sums.squared / n,
        rel_mse: sums.relative / n,
        mae: sums.absolute / n,
        max: sums.max,
        mean_ratio: if sums.reference == sums.image { 1.0 } else { sums.image / sums.reference },
        non_finite: sums.non_finite,
    })
}

/// Peak signal-to-noise ratio in decibels between the pictures as a display shows them; infinite for equal ones.
///
/// PSNR = -10 log₁₀ MSE of display values, whose peak is 1.
///
/// # Errors
/// [`ImageError::Mismatch`] if the sizes differ.
pub fn psnr(reference: &Image, image: &Image, tone: &ToneMapping) -> Result<f64, ImageError> {
    let display = |image: &Image| {
        let rgb: Vec<_> = image.to_rgb().into_par_iter().map(|pixel| tone.apply(pixel)).collect();
        Image::from_rgb(image.width(), image.height(), &rgb)
            .ok_or_else(|| ImageError::Mismatch("an image without pixels".into()))
    };
    let mse = compare(&display(reference)?, &display(image)?)?.mse;
    Ok(-10.0 * mse.log10())
}

/// The squared error of every pixel, the mean of its three colours.
///
/// # Errors
/// [`ImageError::Mismatch`] if the sizes differ.
pub fn squared_error_map(reference: &Image, image: &Image) -> Result<ErrorMap, ImageError> {
    reference.check_same_size(image)?;
    let (a, b) = (reference.to_rgb(), image.to_rgb());
    let error = |(a, b): (&[f32; 3], &[f32; 3])| {
        a.iter().zip(b).map(|(r, x)| (x - r) * (x - r)).sum::<f32>() * (1.0 / 3.0)
    };
    let values = a.par_iter().zip(&b).map(error).collect();
    Ok(ErrorMap::new(reference.width(), reference.height(), values))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(pixels: &[[f32; 3]]) -> Image {
        Image::from_rgb(pixels.len(), 1, pixels).unwrap()
    }

    #[test]
    fn the_sums_are_those_of_the_definitions() {
        let (reference, test) = (image(&[[1.0; 3], [0.0; 3]]), image(&[[1.5; 3], [0.0, 0.2, 0.0]]));
        let errors = compare(&reference, &test).unwrap();
        assert!((errors.mse - (3.0 * 0.25 + 0.04) / 6.0).abs() < 1e-7);
        assert!((errors.rel_mse - (3.0 * 0.25 / 1.01 + 0.04 / 0.01) / 6.0).abs() < 1e-6);
        assert!((errors.mae - (1.5 + 0.2) / 6.0).abs() < 1e-7 && errors.max == 0.5);
        assert!((errors.mean_ratio - 4.7 / 3.0).abs() < 1e-6);
        let map = squared_error_map(&reference, &test).unwrap();
        assert!((map.mean() - errors.mse).abs() < 1e-7);
    }

    #[test]
    fn equal_images_have_no_error() {
        let reference = image(&[[0.3, 0.6, 0.9], [0.0; 3]]);
        let errors = compare(&reference, &reference).unwrap();
        assert_eq!(errors, Errors { mean_ratio: 1.0, ..Default::default() });
        assert_eq!(psnr(&reference, &reference, &ToneMapping::default()).unwrap(), f64::INFINITY);
    }

    #[test]
    fn a_tenth_of_the_peak_is_twenty_decibels() {
        let linear = ToneMapping { curve: crate::ToneCurve::Linear, ..Default::default() };
        let decibels = psnr(&image(&[[0.5; 3]]), &image(&[[0.6; 3]]), &linear).unwrap();
        assert!((decibels - 20.0).abs() < 1e-4);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_sizes_must_match() {
        let (reference, test) =
            (image(&[[1.0; 3], [1.0; 3]]), image(&[[f32::NAN, 1.0, f32::INFINITY], [1.0; 3]]));
        let errors = compare(&reference, &test).unwrap();
        assert_eq!((errors.non_finite, errors.mse), (2, 0.0));
        assert!(matches!(compare(&reference, &image(&[[1.0; 3]])), Err(ImageError::Mismatch(_))));
    }
}

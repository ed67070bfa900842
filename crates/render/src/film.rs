//! Sums of samples that do not depend on the order in which they were added.
//!
//! Floating-point sums do: (a + b) + c is not a + (b + c). Here sums are whole numbers of a tiny unit, so that any split
//! of a render over threads, machines or sessions gives the bits of the unsplit one.

use std::ops::AddAssign;

use aureole_scene::Crop;
use aureole_spectrum::Spectrum;

/// Units per one: values are kept to 2⁻⁶⁴.
const UNITS: f64 = 18_446_744_073_709_551_616.0;
/// Samples beyond this are counted as broken: a million of them fit into a sum.
pub(crate) const LARGEST: f32 = 1e12;

/// An exact sum of numbers of magnitude up to 10¹², with a resolution of 2⁻⁶⁴.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSum(i128);

impl ExactSum {
    /// Adds a finite number.
    #[inline]
    pub fn add(&mut self, x: f32) {
        // The product is exact: a power of two only changes the exponent.
        self.0 += (f64::from(x) * UNITS) as i128;
    }

    /// The sum, rounded once.
    #[inline]
    pub fn value(self) -> f64 {
        self.0 as f64 / UNITS
    }
}

impl AddAssign for ExactSum {
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

/// The sums of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct PixelSum {
    rgb: [ExactSum; 3],
    weight: ExactSum,
    samples: u32,
}

/// A rectangle of the film.
#[derive(Clone, Debug)]
pub struct FilmTile {
    /// Where it is.
    pub area: Crop,
    pixels: Vec<PixelSum>,
    /// Samples that were not finite and therefore left out.
    pub dropped: u64,
}

impl FilmTile {
    /// Bytes that a pixel takes.
    pub const BYTES_PER_PIXEL: usize = size_of::<PixelSum>();

    /// An empty tile.
    pub fn new(area: Crop) -> Self {
        let pixels = vec![PixelSum::default(); area.width as usize * area.height as usize];
        Self { area, pixels, dropped: 0 }
    }

    /// Adds a sample to the pixel at a column and row of the tile; broken ones are left out and counted. Tells whether it
    /// was added.
    #[inline]
    pub fn add(&mut self, x: u32, y: u32, radiance: Spectrum, filter_weight: f32) -> bool {
        let pixel = &mut self.pixels[(y * self.area.width + x) as usize];
        let rgb = radiance.rgb();
        if !rgb.iter().all(|c| c.abs() <= LARGEST) {
            self.dropped += 1;
            return false;
        }
        for (sum, c) in pixel.rgb.iter_mut().zip(rgb) {
            sum.add(c * filter_weight);
        }
        pixel.weight.add(filter_weight);
        pixel.samples += 1;
        true
    }

    /// The estimate of a pixel: the weighted mean of its samples.
    pub fn rgb(&self, x: u32, y: u32) -> [f32; 3] {
        let pixel = &self.pixels[(y * self.area.width + x) as usize];
        let weight = pixel.weight.value();
        // With few samples of a filter with negative lobes the weights may cancel; their mean is one.
        let weight =
            if weight > 0.1 * f64::from(pixel.samples) { weight } else { f64::from(pixel.samples.max(1)) };
        pixel.rgb.map(|sum| (sum.value() / weight) as f32)
    }
}

#[cfg(test)]
mod tests {
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
    fn broken_samples_are_counted_and_left_out() {
        let mut tile = FilmTile::new(Crop { x: 0, y: 0, width: 1, height: 1 });
        tile.add(0, 0, Spectrum::splat(2.0), 1.0);
        tile.add(0, 0, Spectrum::splat(f32::NAN), 1.0);
        tile.add(0, 0, Spectrum::splat(f32::INFINITY), 1.0);
        assert_eq!((tile.rgb(0, 0), tile.dropped), ([2.0; 3], 2));
    }
}

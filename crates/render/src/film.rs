//! Sums of samples that do not depend on the order in which they were added.
//!
//! Floating-point sums do: (a + b) + c is not a + (b + c). Here sums are whole numbers of a tiny unit, so that any split
//! of a render over threads, machines or sessions gives the bits of the unsplit one.

use std::ops::{AddAssign, Range};

use aureole_image::{Image, Window};
use aureole_scene::{Crop, Film as FilmShape};
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

/// The sums of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct PixelSum {
    pub(crate) rgb: [ExactSum; 3],
    pub(crate) weight: ExactSum,
    /// Samples drawn, in the order of their indices from the film's first on.
    pub(crate) drawn: u32,
    /// Those of them that were not finite and therefore left out.
    pub(crate) dropped: u32,
}

impl PixelSum {
    /// The estimate: the weighted mean of the samples.
    fn mean(&self) -> [f32; 3] {
        let (weight, count) = (self.weight.value(), f64::from((self.drawn - self.dropped).max(1)));
        // With few samples of a filter with negative lobes the weights may cancel; their mean is one.
        let weight = if weight > 0.1 * count { weight } else { count };
        self.rgb.map(|sum| (sum.value() / weight) as f32)
    }
}

impl AddAssign for PixelSum {
    fn add_assign(&mut self, other: Self) {
        self.rgb.iter_mut().zip(other.rgb).for_each(|(sum, x)| *sum += x);
        self.weight += other.weight;
        self.drawn = self.drawn.saturating_add(other.drawn);
        self.dropped = self.dropped.saturating_add(other.dropped);
    }
}

/// A rectangle of the film, which one thread at a time adds to.
#[derive(Clone, Debug)]
pub(crate) struct FilmTile {
    /// Where it is.
    pub(crate) area: Crop,
    pixels: Vec<PixelSum>,
}

impl FilmTile {
    /// How many samples of the pixel at a column and row of the tile were drawn.
    #[inline]
    pub(crate) fn drawn(&self, x: u32, y: u32) -> u32 {
        self.pixels[(y * self.area.width + x) as usize].drawn
    }

    /// Adds a sample to the pixel at a column and row of the tile; broken ones are left out and counted. Tells whether it
    /// was added.
    #[inline]
    pub(crate) fn add(&mut self, x: u32, y: u32, radiance: Spectrum, filter_weight: f32) -> bool {
        let pixel = &mut self.pixels[(y * self.area.width + x) as usize];
        let rgb = radiance.rgb();
        pixel.drawn += 1;
        if !rgb.iter().all(|c| c.abs() <= LARGEST) {
            pixel.dropped += 1;
            return false;
        }
        for (sum, c) in pixel.rgb.iter_mut().zip(rgb) {
            sum.add(c * filter_weight);
        }
        pixel.weight.add(filter_weight);
        true
    }
}

/// What a render has gathered: for every pixel the exact sums of its samples, and how many there are.
///
/// A pixel holds the samples from [`first`](Self::first) on without a gap, but each may have another number of them: that
/// is how a film looks in the middle of a render, and how it would look when noise decides who gets more. Films of disjoint
/// samples are added to each other in any order, with the bits of the render that was never split. What is splatted by other
/// pixels' paths would be further sums of the same kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    shape: FilmShape,
    /// Index of the first sample of every pixel.
    pub first: u32,
    pub(crate) pixels: Vec<PixelSum>,
}

impl Film {
    /// Bytes that a pixel takes.
    pub const BYTES_PER_PIXEL: usize = size_of::<PixelSum>();

    /// A film without samples, to gather those from `first` on.
    pub fn new(shape: FilmShape, first: u32) -> Self {
        let pixels = vec![PixelSum::default(); shape.crop.width as usize * shape.crop.height as usize];
        Self { shape, first, pixels }
    }

    /// Its size and place.
    pub fn shape(&self) -> FilmShape {
        self.shape
    }

    /// The least and the largest number of samples that a pixel has.
    pub fn drawn(&self) -> [u32; 2] {
        let drawn = || self.pixels.iter().map(|pixel| pixel.drawn);
        [drawn().min().unwrap_or(0), drawn().max().unwrap_or(0)]
    }

    /// All samples of all pixels.
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.drawn)).sum()
    }

    /// Samples that were not finite and are left out.
    pub fn dropped(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.dropped)).sum()
    }

    /// Adds the sums of another film of the same size; the caller answers for the samples being others.
    pub fn add(&mut self, other: &Self) {
        debug_assert_eq!(self.shape, other.shape);
        self.first = self.first.min(other.first);
        self.pixels.iter_mut().zip(&other.pixels).for_each(|(sum, x)| *sum += *x);
    }

    /// The image as it is now.
    pub fn image(&self) -> Image {
        let FilmShape { full, crop } = self.shape;
        let mut image = Image::new(crop.width as usize, crop.height as usize, &["R", "G", "B"]);
        let whole = Crop { x: 0, y: 0, width: full.width, height: full.height };
        image.window = (crop != whole).then_some(Window {
            x: crop.x as i32,
            y: crop.y as i32,
            full_width: full.width as usize,
            full_height: full.height as usize,
        });
        for (rgb, pixel) in image.data_mut().chunks_exact_mut(3).zip(&self.pixels) {
            rgb.copy_from_slice(&pixel.mean());
        }
        image
    }

    /// A copy of a rectangle.
    pub(crate) fn tile(&self, area: Crop) -> FilmTile {
        let pixels = self.rows(area).flat_map(|row| &self.pixels[row]).copied().collect();
        FilmTile { area, pixels }
    }

    /// Puts a rectangle back.
    pub(crate) fn put(&mut self, tile: &FilmTile) {
        for (row, from) in self.rows(tile.area).zip(tile.pixels.chunks_exact(tile.area.width as usize)) {
            self.pixels[row].copy_from_slice(from);
        }
    }

    /// Where a rectangle's rows are among the pixels.
    fn rows(&self, area: Crop) -> impl Iterator<Item = Range<usize>> + use<> {
        let Crop { x, y, width, .. } = self.shape.crop;
        (area.y - y..area.y - y + area.height).map(move |row| {
            let start = row as usize * width as usize + (area.x - x) as usize;
            start..start + area.width as usize
        })
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
    fn sums_are_words_and_back() {
        for x in [0.0, 1.0, -1.0, 1e12, -1e-12, 0.1] {
            let mut sum = ExactSum::default();
            sum.add(x);
            assert_eq!(ExactSum::from_words(sum.words()), sum);
        }
    }

    #[test]
    fn broken_samples_are_counted_and_left_out() {
        let mut film = Film::new(FilmShape::new(2, 2), 0);
        let mut tile = film.tile(Crop { x: 1, y: 1, width: 1, height: 1 });
        tile.add(0, 0, Spectrum::splat(2.0), 1.0);
        tile.add(0, 0, Spectrum::splat(f32::NAN), 1.0);
        tile.add(0, 0, Spectrum::splat(f32::INFINITY), 1.0);
        film.put(&tile);
        assert_eq!((film.image().rgb(1, 1), film.dropped(), film.drawn()), ([2.0; 3], 2, [0, 3]));
    }
}

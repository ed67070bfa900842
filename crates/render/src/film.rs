//! Sums of samples that do not depend on the order in which they were added.
//!
//! Floating-point sums do: (a + b) + c is not a + (b + c). Here sums are whole numbers of a tiny unit, so that any split
//! of a render over threads, machines or sessions gives the bits of the unsplit one.

use std::ops::{AddAssign, Range};

use aureole_image::{Image, Window};
use aureole_scene::{Colors, Crop, Film as FilmShape};
use aureole_spectrum::{Spectrum, luminance, xyz_from_srgb};

use crate::exact_sum::ExactSum;
use crate::splat::Footprint;

/// Samples beyond this are counted as broken: a million of them fit into a sum.
pub(crate) const LARGEST: f32 = 1e12;

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
    /// What sums are divided by: the weights of the samples, whose mean is one.
    fn divisor(&self) -> f64 {
        let (weight, count) = (self.weight.value(), f64::from((self.drawn - self.dropped).max(1)));
        // With few samples of a filter with negative lobes the weights may cancel.
        if weight > 0.1 * count { weight } else { count }
    }

    /// The estimate: the weighted mean of the samples.
    pub(crate) fn mean(&self) -> [f32; 3] {
        let divisor = self.divisor();
        self.rgb.map(|sum| (sum.value() / divisor) as f32)
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

/// A rectangle of the film, which one thread at a time adds to, and the pixels around it that its samples reach.
#[derive(Clone, Debug)]
pub(crate) struct FilmTile {
    /// The pixels whose samples are drawn here.
    pub(crate) area: Crop,
    border: [u32; 2],
    /// The area and the pixels around it.
    grid: Crop,
    pixels: Vec<PixelSum>,
    /// Sums of the layers, pixel by pixel.
    layers: Vec<ExactSum>,
    layer_count: usize,
}

/// Samples that are added together: radiance, and values of the film's layers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleValue<'a> {
    pub(crate) radiance: Spectrum,
    pub(crate) layers: &'a [f32],
}

impl FilmTile {
    fn index(&self, x: u32, y: u32) -> usize {
        let (dx, dy) = (self.area.x - self.grid.x, self.area.y - self.grid.y);
        ((y + dy) * self.grid.width + x + dx) as usize
    }

    /// How many samples of the pixel at a column and row of the tile were drawn.
    #[inline]
    pub(crate) fn drawn(&self, x: u32, y: u32) -> u32 {
        self.pixels[self.index(x, y)].drawn
    }

    /// Adds a sample of the pixel at a column and row of the tile to all pixels that it reaches; broken ones are left out and
    /// counted. Tells whether it was added.
    #[inline]
    pub(crate) fn add(&mut self, x: u32, y: u32, sample: SampleValue<'_>, footprint: &Footprint) -> bool {
        let rgb = sample.radiance.rgb();
        let index = self.index(x, y);
        let own = &mut self.pixels[index];
        own.drawn += 1;
        let values = rgb.iter().chain(sample.layers);
        if !values.into_iter().all(|c| c.abs() <= LARGEST) {
            own.dropped += 1;
            return false;
        }
        // The sample's column and row in the grid, and the first and last that it reaches there.
        let (cx, cy) = (x + self.area.x - self.grid.x, y + self.area.y - self.grid.y);
        let [bx, by] = self.border;
        let [along_x, along_y] = [footprint.along(0, bx), footprint.along(1, by)];
        for (j, &wy) in along_y.iter().enumerate() {
            let Some(row) = (cy + j as u32).checked_sub(by).filter(|row| *row < self.grid.height) else {
                continue;
            };
            for (i, &wx) in along_x.iter().enumerate() {
                let weight = wx * wy;
                let Some(column) = (cx + i as u32)
                    .checked_sub(bx)
                    .filter(|column| *column < self.grid.width && weight != 0.0)
                else {
                    continue;
                };
                let index = (row * self.grid.width + column) as usize;
                let pixel = &mut self.pixels[index];
                for (sum, c) in pixel.rgb.iter_mut().zip(rgb) {
                    sum.add(c * weight);
                }
                pixel.weight.add(weight);
                let layers = &mut self.layers[index * self.layer_count..][..self.layer_count];
                layers.iter_mut().zip(sample.layers).for_each(|(sum, value)| sum.add(value * weight));
            }
        }
        true
    }
}

/// What a render has gathered: for every pixel the exact sums of its samples, and how many there are.
///
/// A pixel holds the samples from [`first`](Self::first) on without a gap, but each may have another number of them: that
/// is how a film looks in the middle of a render, and how it would look when noise decides who gets more. Films of disjoint
/// samples are added to each other in any order, with the bits of the render that was never split. Where a filter covers
/// several pixels, a sample is in the sums of all of them, and counted in its own; samples of the pixels around a crop that
/// reach into it are gathered too.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    shape: FilmShape,
    /// Index of the first sample of every pixel.
    pub first: u32,
    /// The pixels of the shape's area.
    pub(crate) pixels: Vec<PixelSum>,
    /// Names of the layers besides the picture.
    names: Vec<String>,
    /// Sums of the layers, pixel by pixel.
    pub(crate) layers: Vec<ExactSum>,
}

impl Film {
    /// Bytes that a pixel takes.
    pub const BYTES_PER_PIXEL: usize = size_of::<PixelSum>();

    /// A film without samples, to gather those from `first` on.
    pub fn new(shape: FilmShape, first: u32) -> Self {
        Self::with_layers(shape, first, Vec::new())
    }

    /// A film without samples that gathers layers besides the picture.
    pub(crate) fn with_layers(shape: FilmShape, first: u32, names: Vec<String>) -> Self {
        let area = shape.area();
        let size = area.width as usize * area.height as usize;
        let layers = vec![ExactSum::default(); size * names.len()];
        Self { shape, first, pixels: vec![PixelSum::default(); size], names, layers }
    }

    /// Its size and place.
    pub fn shape(&self) -> FilmShape {
        self.shape
    }

    /// The names of its layers: channels of the image besides the picture.
    pub fn layer_names(&self) -> &[String] {
        &self.names
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

    /// Adds the sums of another film of the same size and layers; the caller answers for the samples being others.
    pub fn add(&mut self, other: &Self) {
        debug_assert_eq!((self.shape, &self.names), (other.shape, &other.names));
        self.first = self.first.min(other.first);
        self.pixels.iter_mut().zip(&other.pixels).for_each(|(sum, x)| *sum += *x);
        self.layers.iter_mut().zip(&other.layers).for_each(|(sum, x)| *sum += *x);
    }

    /// The image as it is now: the picture, and then the layers.
    pub fn image(&self) -> Image {
        let FilmShape { full, crop, colors, gain, .. } = self.shape;
        let picture: &[&str] = match colors {
            Colors::Rgb => &["R", "G", "B"],
            Colors::Luminance => &["Y"],
            Colors::Xyz => &["X", "Y", "Z"],
        };
        let names = picture.iter().copied().chain(self.names.iter().map(String::as_str));
        let names: Vec<&str> = names.collect();
        let mut image = Image::new(crop.width as usize, crop.height as usize, &names);
        let whole = Crop { x: 0, y: 0, width: full.width, height: full.height };
        image.window = (crop != whole).then_some(Window {
            x: crop.x as i32,
            y: crop.y as i32,
            full_width: full.width as usize,
            full_height: full.height as usize,
        });
        let indices = self.rows(crop).flatten();
        for (values, index) in image.data_mut().chunks_exact_mut(names.len()).zip(indices) {
            let pixel = &self.pixels[index];
            let (picture, layers) = values.split_at_mut(picture.len());
            let rgb = pixel.mean().map(|c| c * gain);
            match picture {
                [grey] => *grey = luminance(rgb),
                picture if colors == Colors::Xyz => picture.copy_from_slice(&xyz_from_srgb(rgb)),
                picture => picture.copy_from_slice(&rgb),
            }
            let divisor = pixel.divisor();
            let sums = &self.layers[index * self.names.len()..];
            layers.iter_mut().zip(sums).for_each(|(value, sum)| *value = (sum.value() / divisor) as f32);
        }
        image
    }

    /// A rectangle to add samples to, with what the film has there already.
    pub(crate) fn tile(&self, area: Crop) -> FilmTile {
        let grid = area.grown(self.shape.border, &self.shape.area());
        let size = grid.width as usize * grid.height as usize;
        let layer_count = self.names.len();
        let mut tile = FilmTile {
            area,
            border: self.shape.border,
            grid,
            pixels: vec![PixelSum::default(); size],
            layers: vec![ExactSum::default(); size * layer_count],
            layer_count,
        };
        for (y, row) in self.rows(area).enumerate() {
            let start = tile.index(0, y as u32);
            let end = start + row.len();
            tile.pixels[start..end].copy_from_slice(&self.pixels[row.clone()]);
            tile.layers[start * layer_count..end * layer_count]
                .copy_from_slice(&self.layers[row.start * layer_count..row.end * layer_count]);
        }
        tile
    }

    /// Adds a tile to a film that has not got it yet.
    pub(crate) fn put(&mut self, tile: &FilmTile) {
        let n = tile.layer_count;
        for (y, row) in self.rows(tile.grid).enumerate() {
            let start = y * tile.grid.width as usize;
            let end = start + row.len();
            let pixels = self.pixels[row.clone()].iter_mut().zip(&tile.pixels[start..end]);
            pixels.for_each(|(sum, x)| *sum += *x);
            let layers = self.layers[row.start * n..row.end * n].iter_mut();
            layers.zip(&tile.layers[start * n..end * n]).for_each(|(sum, x)| *sum += *x);
        }
    }

    /// Where a rectangle's rows are among the pixels.
    fn rows(&self, area: Crop) -> impl Iterator<Item = Range<usize>> + use<> {
        let Crop { x, y, width, .. } = self.shape.area();
        (area.y - y..area.y - y + area.height).map(move |row| {
            let start = row as usize * width as usize + (area.x - x) as usize;
            start..start + area.width as usize
        })
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use aureole_math::Vector2;

    use super::*;

    /// Adds a sample to its own pixel alone.
    pub(crate) fn add(tile: &mut FilmTile, x: u32, y: u32, radiance: Spectrum, weight: f32) -> bool {
        let mut weights = [[0.0; 9]; 2];
        (weights[0][4], weights[1][4]) = (weight, 1.0);
        let footprint = Footprint { offset: Vector2::ZERO, weights };
        tile.add(x, y, SampleValue { radiance, layers: &[] }, &footprint)
    }

    #[test]
    fn broken_samples_are_counted_and_left_out() {
        let mut film = Film::new(FilmShape::new(2, 2), 0);
        let mut tile = film.tile(Crop { x: 1, y: 1, width: 1, height: 1 });
        add(&mut tile, 0, 0, Spectrum::splat(2.0), 1.0);
        add(&mut tile, 0, 0, Spectrum::splat(f32::NAN), 1.0);
        add(&mut tile, 0, 0, Spectrum::splat(f32::INFINITY), 1.0);
        film.put(&tile);
        assert_eq!((film.image().rgb(1, 1), film.dropped(), film.drawn()), ([2.0; 3], 2, [0, 3]));
    }

    #[test]
    fn pictures_are_in_the_colours_that_are_asked_for() {
        for (colors, names, expected) in [
            (Colors::Rgb, vec!["R", "G", "B"], vec![0.3, 0.5, 0.9]),
            // Mitsuba's numbers for this colour.
            (Colors::Luminance, vec!["Y"], vec![0.4863334]),
            (Colors::Xyz, vec!["X", "Y", "Z"], vec![0.4649066, 0.4863334, 0.920601]),
        ] {
            let mut film = Film::new(FilmShape { colors, ..FilmShape::new(1, 1) }, 0);
            let mut tile = film.tile(film.shape().crop);
            add(&mut tile, 0, 0, Spectrum::from_rgb([0.3, 0.5, 0.9]), 1.0);
            film.put(&tile);
            let image = film.image();
            assert_eq!(image.channels(), names);
            for (found, expected) in image.data().iter().zip(expected) {
                assert!((found - expected).abs() < 1e-5, "{names:?}: {:?}", image.data());
            }
            let back = image.in_rgb().rgb(0, 0);
            assert!(colors == Colors::Luminance || (back[0] - 0.3).abs() < 1e-4, "{back:?}");
        }
    }

    #[test]
    fn samples_reach_the_pixels_around() {
        let mut shape = FilmShape::new(6, 6);
        shape.crop = Crop { x: 2, y: 2, width: 2, height: 2 };
        shape.border = [1, 1];
        assert_eq!(shape.area(), Crop { x: 1, y: 1, width: 4, height: 4 });
        let mut film = Film::with_layers(shape, 0, vec!["d.T".to_owned()]);
        // A sample of a pixel outside the crop, at its corner.
        let mut tile = film.tile(Crop { x: 1, y: 1, width: 1, height: 1 });
        let mut weights = [[0.0; 9]; 2];
        weights[0][4..6].copy_from_slice(&[0.5, 0.25]);
        weights[1][4..6].copy_from_slice(&[0.5, 0.25]);
        let footprint = Footprint { offset: Vector2::ZERO, weights };
        tile.add(0, 0, SampleValue { radiance: Spectrum::splat(3.0), layers: &[7.0] }, &footprint);
        film.put(&tile);
        let image = film.image();
        assert_eq!(image.channels(), ["R", "G", "B", "d.T"]);
        assert_eq!((image.width(), image.height()), (2, 2));
        // Its weight is little, so its sum is divided by the number of samples.
        assert_eq!(image.pixel(0, 0), [3.0 / 16.0, 3.0 / 16.0, 3.0 / 16.0, 7.0 / 16.0]);
        assert_eq!(image.pixel(1, 1), [0.0; 4]);
        assert_eq!((film.drawn(), film.samples()), ([0, 1], 1));
    }
}

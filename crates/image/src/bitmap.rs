//! Images as textures read them: compact texels, decoded on the fly.

use std::sync::OnceLock;

use exr::prelude::f16;

use crate::encoding::{ByteTable, Encoding, WordTable, byte_table, word_table};
use crate::raster::{Raster, Texels};

/// Stored texels with what turns them into linear numbers.
#[derive(Clone, Debug)]
enum Store {
    Bytes { data: Vec<u8>, table: ByteTable },
    Words { data: Vec<u16>, table: WordTable },
    Halves(Vec<f16>),
    Floats(Vec<f32>),
}

/// A picture for textures, kept as small as its file: bytes, 16-bit words, half floats or floats.
///
/// It has 1 (grey), 2 (grey, alpha), 3 or 4 channels; rows run from top to bottom. Alpha is never multiplied in by
/// this type. Values that are not finite are taken as zero and counted.
#[derive(Clone, Debug)]
pub struct Bitmap {
    width: usize,
    height: usize,
    channels: usize,
    non_finite: usize,
    store: Store,
    /// Smaller versions, made when they are first asked for.
    pyramid: OnceLock<Vec<Bitmap>>,
}

impl Bitmap {
    /// From bytes; `None` when the lengths do not match.
    pub fn from_bytes(
        width: usize,
        height: usize,
        channels: usize,
        data: Vec<u8>,
        encoding: Encoding,
    ) -> Option<Self> {
        Self::checked(width, height, channels, Texels::Bytes(data), encoding)
    }

    /// From 16-bit words; `None` when the lengths do not match.
    pub fn from_words(
        width: usize,
        height: usize,
        channels: usize,
        data: Vec<u16>,
        encoding: Encoding,
    ) -> Option<Self> {
        Self::checked(width, height, channels, Texels::Words(data), encoding)
    }

    /// From floats; `None` when the lengths do not match.
    pub fn from_floats(
        width: usize,
        height: usize,
        channels: usize,
        data: Vec<f32>,
        encoding: Encoding,
    ) -> Option<Self> {
        Self::checked(width, height, channels, Texels::Floats(data), encoding)
    }

    /// One texel of one colour, to stand in for a picture that cannot be read.
    pub fn placeholder(rgb: [f32; 3]) -> Self {
        Self {
            width: 1,
            height: 1,
            channels: 3,
            non_finite: 0,
            store: Store::Floats(rgb.to_vec()),
            pyramid: OnceLock::new(),
        }
    }

    /// The picture among a file's channels.
    pub(crate) fn from_raster(mut raster: Raster, encoding: Encoding) -> Option<Self> {
        raster.convert_xyz();
        let picture = raster.picture_channels();
        let texels = raster.texels.pick(raster.channels.len(), &picture);
        Self::checked(raster.width, raster.height, picture.len(), texels, encoding)
    }

    fn checked(
        width: usize,
        height: usize,
        channels: usize,
        texels: Texels,
        encoding: Encoding,
    ) -> Option<Self> {
        let size = width.checked_mul(height)?.checked_mul(channels)?;
        if size == 0 || size != texels.len() || !(1..=4).contains(&channels) {
            return None;
        }
        let encoding = encoding.resolve(texels.is_integer());
        let mut non_finite = 0;
        let store = match texels {
            Texels::Bytes(data) => Store::Bytes { data, table: byte_table(encoding) },
            Texels::Words(data) => Store::Words { data, table: word_table(encoding) },
            Texels::Halves(mut data) if encoding == Encoding::Linear => {
                data.iter_mut().filter(|x| !x.is_finite()).for_each(|x| {
                    *x = f16::ZERO;
                    non_finite += 1;
                });
                Store::Halves(data)
            }
            Texels::Halves(data) => {
                let floats = data.into_iter().map(f16::to_f32).collect();
                Store::Floats(linear_floats(floats, channels, encoding, &mut non_finite))
            }
            Texels::Floats(data) => Store::Floats(linear_floats(data, channels, encoding, &mut non_finite)),
        };
        Some(Self { width, height, channels, non_finite, store, pyramid: OnceLock::new() })
    }

    /// The picture and its smaller versions: each half as large, rounded down, as the last, down to a single texel. A texel is
    /// the mean of the area that it covers, in linear numbers.
    ///
    /// `level` beyond the last gives the last.
    #[inline]
    pub fn level(&self, level: usize) -> &Bitmap {
        if level == 0 {
            return self;
        }
        let pyramid = self.pyramid.get_or_init(|| self.build_pyramid());
        pyramid.get(level - 1).or(pyramid.last()).unwrap_or(self)
    }

    /// Levels of [`level`](Self::level), the picture itself among them.
    pub fn level_count(&self) -> usize {
        1 + self.width.max(self.height).ilog2() as usize
    }

    fn build_pyramid(&self) -> Vec<Bitmap> {
        let mut levels: Vec<Bitmap> = Vec::new();
        for _ in 1..self.level_count() {
            levels.push(levels.last().unwrap_or(self).halved());
        }
        levels
    }

    fn halved(&self) -> Bitmap {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        // What a texel covers of the larger picture: texels, and how much of each.
        let cover = |i: usize, from: usize, to: usize| {
            let scale = from as f64 / to as f64;
            let (low, high) = (i as f64 * scale, (i + 1) as f64 * scale);
            let last = (high.ceil() as usize).min(from);
            (low as usize..last).map(move |j| {
                let share = (high.min(j as f64 + 1.0) - low.max(j as f64)) / scale;
                (j, share as f32)
            })
        };
        let mut data = Vec::with_capacity(width * height * self.channels);
        for y in 0..height {
            for x in 0..width {
                let mut sum = [0.0_f32; 4];
                for (j, share_y) in cover(y, self.height, height) {
                    for (i, share_x) in cover(x, self.width, width) {
                        let texel = self.texel(i, j);
                        sum.iter_mut().zip(texel).for_each(|(sum, t)| *sum += t * (share_x * share_y));
                    }
                }
                let [r, g, b, a] = sum;
                match self.channels {
                    1 => data.push(r),
                    2 => data.extend([r, a]),
                    3 => data.extend([r, g, b]),
                    _ => data.extend([r, g, b, a]),
                }
            }
        }
        Bitmap {
            width,
            height,
            channels: self.channels,
            non_finite: 0,
            store: Store::Floats(data),
            pyramid: OnceLock::new(),
        }
    }

    /// Texels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Texels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Values per texel: 1 (grey), 2 (grey, alpha), 3 or 4.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Whether texels have an opacity.
    pub fn has_alpha(&self) -> bool {
        self.channels.is_multiple_of(2)
    }

    /// Whether texels have no colour.
    pub fn is_grey(&self) -> bool {
        self.channels < 3
    }

    /// How many stored values were NaN or infinite and are taken as zero.
    pub fn non_finite(&self) -> usize {
        self.non_finite
    }

    /// Bytes that the texels take.
    pub fn memory(&self) -> usize {
        match &self.store {
            Store::Bytes { data, .. } => data.len(),
            Store::Words { data, .. } => data.len() * 2,
            Store::Halves(data) => data.len() * 2,
            Store::Floats(data) => data.len() * 4,
        }
    }

    /// The linear red, green, blue and alpha of a texel; grey is repeated, a missing alpha is one.
    ///
    /// `x` < width and `y` < height, counted from the top left; beyond them it panics.
    #[inline]
    pub fn texel(&self, x: usize, y: usize) -> [f32; 4] {
        let start = (y * self.width + x) * self.channels;
        let range = start..start + self.channels;
        match &self.store {
            Store::Bytes { data, table } => {
                spread(&data[range], |v| table[usize::from(v)], |v| f32::from(v) * (1.0 / 255.0))
            }
            Store::Words { data, table } => {
                spread(&data[range], |v| table[usize::from(v)], |v| f32::from(v) * (1.0 / 65535.0))
            }
            Store::Halves(data) => spread(&data[range], f16::to_f32, f16::to_f32),
            Store::Floats(data) => spread(&data[range], |v| v, |v| v),
        }
    }

    /// The linear colour of a texel; grey is repeated.
    #[inline]
    pub fn rgb(&self, x: usize, y: usize) -> [f32; 3] {
        let [r, g, b, _] = self.texel(x, y);
        [r, g, b]
    }

    /// One channel by itself as a grey picture; alpha is read as colours are then, by their encoding.
    ///
    /// # Panics
    /// Where there is no such channel.
    pub fn plane(&self, channel: usize) -> Self {
        assert!(channel < self.channels, "a picture of {} channels has no channel {channel}", self.channels);
        fn pick<T: Copy>(data: &[T], channel: usize, channels: usize) -> Vec<T> {
            data.iter().skip(channel).step_by(channels).copied().collect()
        }
        let n = self.channels;
        self.grey(match &self.store {
            Store::Bytes { data, table } => {
                Store::Bytes { data: pick(data, channel, n), table: table.clone() }
            }
            Store::Words { data, table } => {
                Store::Words { data: pick(data, channel, n), table: table.clone() }
            }
            Store::Halves(data) => Store::Halves(pick(data, channel, n)),
            Store::Floats(data) => Store::Floats(pick(data, channel, n)),
        })
    }

    /// A number of each texel's red, green, blue and alpha as a grey picture.
    pub fn map_to_grey(&self, number: impl Fn([f32; 4]) -> f32) -> Self {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        self.grey(Store::Floats(places.map(|(x, y)| number(self.texel(x, y))).collect()))
    }

    fn grey(&self, store: Store) -> Self {
        Self { channels: 1, store, pyramid: OnceLock::new(), ..*self }
    }

    /// The opacity of a texel; one without an alpha channel.
    #[inline]
    pub fn alpha(&self, x: usize, y: usize) -> f32 {
        if self.has_alpha() { self.texel(x, y)[3] } else { 1.0 }
    }
}

/// A stored texel of one to four values as red, green, blue, alpha.
#[inline(always)]
fn spread<T: Copy>(texel: &[T], color: impl Fn(T) -> f32, alpha: impl Fn(T) -> f32) -> [f32; 4] {
    match *texel {
        [r, g, b] => [color(r), color(g), color(b), 1.0],
        [r, g, b, a] => [color(r), color(g), color(b), alpha(a)],
        [grey] => [color(grey), color(grey), color(grey), 1.0],
        [grey, a] => [color(grey), color(grey), color(grey), alpha(a)],
        _ => [0.0; 4],
    }
}

/// Decodes the colours (not the alpha) of float texels and clears what is not finite.
fn linear_floats(
    mut data: Vec<f32>,
    channels: usize,
    encoding: Encoding,
    non_finite: &mut usize,
) -> Vec<f32> {
    let colors = if channels.is_multiple_of(2) { channels - 1 } else { channels };
    for texel in data.chunks_exact_mut(channels) {
        texel[..colors].iter_mut().for_each(|x| *x = encoding.decode(*x));
        for x in texel.iter_mut().filter(|x| !x.is_finite()) {
            *x = 0.0;
            *non_finite += 1;
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_decode_by_encoding() {
        let data = vec![0, 128, 255, 64];
        let srgb = Bitmap::from_bytes(1, 1, 4, data.clone(), Encoding::Auto).unwrap();
        let raw = Bitmap::from_bytes(1, 1, 4, data, Encoding::Linear).unwrap();
        assert!((srgb.rgb(0, 0)[1] - 0.21586).abs() < 1e-4);
        assert!((raw.rgb(0, 0)[1] - 128.0 / 255.0).abs() < 1e-6);
        assert!((srgb.alpha(0, 0) - 64.0 / 255.0).abs() < 1e-6);
        assert!(Bitmap::from_bytes(2, 2, 3, vec![0; 3], Encoding::Auto).is_none());
    }

    #[test]
    fn every_level_has_the_same_mean() {
        for (width, height, channels) in [(8, 4, 3), (7, 5, 1), (1, 6, 2), (13, 1, 4), (1, 1, 3)] {
            let floats = (0..width * height * channels).map(|i| ((i * i) as f32).sin().abs()).collect();
            let picture = Bitmap::from_floats(width, height, channels, floats, Encoding::Linear).unwrap();
            let mean = |b: &Bitmap| {
                let all = (0..b.width() * b.height()).map(|i| b.texel(i % b.width(), i / b.width())[0]);
                all.sum::<f32>() / (b.width() * b.height()) as f32
            };
            let last = picture.level(picture.level_count() - 1);
            assert_eq!((last.width(), last.height(), last.channels()), (1, 1, channels));
            for level in 0..picture.level_count() + 2 {
                let found = mean(picture.level(level));
                assert!((found - mean(&picture)).abs() < 1e-5, "{width} x {height}, level {level}: {found}");
            }
        }
    }

    #[test]
    fn every_store_and_channel_count_agrees() {
        for channels in 1..=4 {
            let bytes: Vec<u8> = (0..6 * channels).map(|i| (i * 11) as u8).collect();
            let words = bytes.iter().map(|&x| u16::from(x) * 257).collect();
            let floats = bytes.iter().map(|&x| f32::from(x) / 255.0).collect();
            for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Gamma(1.8)] {
                let a = Bitmap::from_bytes(3, 2, channels, bytes.clone(), encoding).unwrap();
                let b = Bitmap::from_words(3, 2, channels, Vec::clone(&words), encoding).unwrap();
                let c = Bitmap::from_floats(3, 2, channels, Vec::clone(&floats), encoding).unwrap();
                for (x, y) in [(0, 0), (2, 0), (1, 1), (2, 1)] {
                    for (i, value) in a.texel(x, y).into_iter().enumerate() {
                        assert!((value - b.texel(x, y)[i]).abs() < 1e-6);
                        assert!((value - c.texel(x, y)[i]).abs() < 1e-6);
                    }
                }
            }
        }
    }

    #[test]
    fn texels_that_are_not_finite_are_counted() {
        let data = vec![f32::NAN, 1.0, f32::INFINITY];
        let bitmap = Bitmap::from_floats(1, 1, 3, data, Encoding::Auto).unwrap();
        assert_eq!(bitmap.texel(0, 0), [0.0, 1.0, 0.0, 1.0]);
        assert_eq!(bitmap.non_finite(), 2);
    }
}

//! From linear radiance to display values.

mod agx;
mod filmic;

use aureole_spectrum::srgb_from_linear;
use rayon::prelude::*;

use crate::Image;

/// How radiance up to and beyond white becomes display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneCurve {
    /// The sRGB transfer curve; what is brighter than white is clipped.
    #[default]
    Srgb,
    /// A film-like shoulder and toe: [Hable 2010] "Filmic Tonemapping Operators".
    Filmic,
    /// AgX ([Sobotka 2022]), which lets bright colours fade to white without turning their hue.
    Agx,
    /// No curve at all: clipped linear values, for data that happens to live in pictures.
    Linear,
}

impl ToneCurve {
    /// Every curve with its name on a command line.
    pub const NAMES: [(&str, Self); 4] =
        [("srgb", Self::Srgb), ("filmic", Self::Filmic), ("agx", Self::Agx), ("linear", Self::Linear)];

    /// The curve of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)).map(|(_, curve)| *curve)
    }
}

/// Noise below the last bit, against bands in smooth gradients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dither {
    /// Round to the nearest.
    #[default]
    Off,
    /// Add triangular noise of one step either way, a fixed function of the pixel.
    Triangular,
}

/// Exposure, curve and dithering.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToneMapping {
    /// Stops: each doubles the brightness.
    pub exposure: f32,
    /// The curve.
    pub curve: ToneCurve,
    /// The noise.
    pub dither: Dither,
}

impl ToneMapping {
    /// Linear Rec. 709 to display values in [0, 1]. NaN becomes black.
    pub fn apply(&self, rgb: [f32; 3]) -> [f32; 3] {
        let gain = self.exposure.exp2();
        let exposed = rgb.map(|x| if x.is_nan() { 0.0 } else { (x * gain).clamp(0.0, 1e30) });
        match self.curve {
            ToneCurve::Srgb => exposed.map(|x| srgb_from_linear(x.min(1.0))),
            ToneCurve::Linear => exposed.map(|x| x.min(1.0)),
            ToneCurve::Filmic => filmic::tone(exposed).map(srgb_from_linear),
            ToneCurve::Agx => agx::tone(exposed),
        }
    }

    /// The picture as bytes, three a pixel.
    pub fn to_bytes(&self, image: &Image) -> Vec<u8> {
        self.quantise(image, Alpha::Drop, u8::MAX.into(), |x| x as u8)
    }

    /// The picture as 16-bit words, three a pixel.
    pub fn to_words(&self, image: &Image) -> Vec<u16> {
        self.quantise(image, Alpha::Drop, u16::MAX.into(), |x| x as u16)
    }

    /// The picture as whole numbers from 0 to `white`, row by row in parallel.
    pub(crate) fn quantise<T: Send>(
        &self,
        image: &Image,
        alpha: Alpha,
        white: f32,
        cast: impl Fn(f32) -> T + Sync,
    ) -> Vec<T> {
        let rgb = image.rgb_channels();
        let alpha = image.channel("A").filter(|_| alpha == Alpha::Keep);
        let stride = image.channels().len();
        let round = |value: f32, index: usize| {
            let noise = match self.dither {
                Dither::Off => 0.0,
                Dither::Triangular => triangular_noise(index),
            };
            cast((value * white + noise).round().clamp(0.0, white))
        };
        let pixels = image.data().par_chunks_exact(stride).enumerate();
        let values = pixels.flat_map_iter(|(i, pixel)| {
            let opacity = alpha.map(|a| pixel[a].clamp(0.0, 1.0));
            // Whole-number files keep colour and alpha apart.
            let divisor = opacity.filter(|&a| a > 0.0).unwrap_or(1.0);
            let display = self.apply(rgb.map(|c| pixel[c] / divisor));
            let colors = display.into_iter().enumerate().map(move |(c, value)| round(value, 3 * i + c));
            colors.chain(opacity.map(|a| cast((a * white).round())))
        });
        values.collect()
    }
}

/// What happens to an image's alpha on its way to whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alpha {
    /// A fourth value, if the image has it; colours are divided by it.
    Keep,
    /// None: the picture over black.
    Drop,
}

/// Noise in (-1, 1) with a triangular density, the difference of two uniform hashes of the index.
///
/// The hash is the finaliser `lowbias32` of [Wellons 2018], "Prospecting for Hash Functions".
fn triangular_noise(index: usize) -> f32 {
    let uniform = |mut h: u32| {
        h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
        h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
        ((h ^ (h >> 16)) >> 8) as f32 / (1 << 24) as f32
    };
    let seed = (index as u32).wrapping_mul(2);
    uniform(seed) - uniform(seed.wrapping_add(1))
}

/// Multiplies a matrix given by rows.
fn transform(m: [[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_monotonic_and_bounded() {
        for (name, curve) in ToneCurve::NAMES {
            let mapping = ToneMapping { curve, ..Default::default() };
            let mut last = -1.0;
            for i in 0..2000 {
                let y = mapping.apply([i as f32 * 0.01; 3])[1];
                assert!((0.0..=1.0).contains(&y) && y >= last - 2e-3, "{name} at {i}: {y} after {last}");
                last = y;
            }
            assert!(mapping.apply([f32::NAN, f32::INFINITY, -1.0]).iter().all(|x| (0.0..=1.0).contains(x)));
        }
    }

    #[test]
    fn a_stop_doubles() {
        let mapping = ToneMapping { exposure: 1.0, curve: ToneCurve::Linear, ..Default::default() };
        assert_eq!(mapping.apply([0.25, 0.1, 0.0]), [0.5, 0.2, 0.0]);
    }

    #[test]
    fn dithering_keeps_the_mean_and_is_repeatable() {
        let image = Image::from_rgb(200, 200, &vec![[0.5 / 255.0 + 100.0 / 255.0; 3]; 40_000]).unwrap();
        let mapping = ToneMapping { curve: ToneCurve::Linear, dither: Dither::Triangular, exposure: 0.0 };
        let bytes = mapping.to_bytes(&image);
        assert_eq!(bytes, mapping.to_bytes(&image));
        let mean = bytes.iter().map(|&x| f64::from(x)).sum::<f64>() / bytes.len() as f64;
        // 120000 values of standard deviation below 0.7: six standard errors.
        assert!((mean - 100.5).abs() < 6.0 * 0.7 / 120_000_f64.sqrt(), "{mean}");
    }

    #[test]
    fn alpha_is_divided_out() {
        let names = ["R", "G", "B", "A"].map(str::to_owned).to_vec();
        let image = Image::from_data(2, 1, names, vec![0.5, 0.25, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0]).unwrap();
        let mapping = ToneMapping { curve: ToneCurve::Linear, ..Default::default() };
        let bytes = mapping.quantise(&image, Alpha::Keep, 255.0, |x| x as u8);
        assert_eq!(bytes, [255, 128, 0, 128, 0, 0, 0, 0]);
        assert_eq!(mapping.to_bytes(&image), [128, 64, 0, 0, 0, 0]);
    }
}

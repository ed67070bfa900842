//! What decoders deliver: numbers as the file stores them.

use exr::prelude::f16;

use crate::encoding::{Encoding, byte_table, word_table};
use crate::image::Window;
use crate::{Image, Metadata};

/// Stored numbers, interleaved, as small as their file allows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Texels {
    /// 0 to 255.
    Bytes(Vec<u8>),
    /// 0 to 65535.
    Words(Vec<u16>),
    /// Half floats.
    Halves(Vec<f16>),
    /// Floats.
    Floats(Vec<f32>),
}

impl Texels {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Bytes(data) => data.len(),
            Self::Words(data) => data.len(),
            Self::Halves(data) => data.len(),
            Self::Floats(data) => data.len(),
        }
    }

    pub(crate) fn is_integer(&self) -> bool {
        matches!(self, Self::Bytes(_) | Self::Words(_))
    }

    /// Keeps some channels of every pixel, in the order given.
    pub(crate) fn pick(self, stride: usize, channels: &[usize]) -> Self {
        fn gather<T: Copy>(data: &[T], stride: usize, channels: &[usize]) -> Vec<T> {
            data.chunks_exact(stride).flat_map(|pixel| channels.iter().map(|&c| pixel[c])).collect()
        }
        if channels.iter().copied().eq(0..stride) {
            return self;
        }
        match self {
            Self::Bytes(data) => Self::Bytes(gather(&data, stride, channels)),
            Self::Words(data) => Self::Words(gather(&data, stride, channels)),
            Self::Halves(data) => Self::Halves(gather(&data, stride, channels)),
            Self::Floats(data) => Self::Floats(gather(&data, stride, channels)),
        }
    }
}

/// A decoded file: stored numbers in named channels.
#[derive(Clone, Debug)]
pub(crate) struct Raster {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) channels: Vec<String>,
    pub(crate) texels: Texels,
    pub(crate) metadata: Metadata,
    pub(crate) window: Option<Window>,
}

impl Raster {
    /// A picture of 1 (grey), 2 (grey and alpha), 3 or 4 channels.
    pub(crate) fn picture(width: usize, height: usize, channel_count: usize, texels: Texels) -> Self {
        let names: &[&str] = match channel_count {
            1 => &["Y"],
            2 => &["Y", "A"],
            3 => &["R", "G", "B"],
            _ => &["R", "G", "B", "A"],
        };
        let channels = names.iter().map(|&name| name.to_owned()).collect();
        Self { width, height, channels, texels, metadata: Metadata::new(), window: None }
    }

    /// The channels of the picture among the layers: `R G B` or `Y` or else the first three or one; then `A`.
    pub(crate) fn picture_channels(&self) -> Vec<usize> {
        let find = |name: &str| self.channels.iter().position(|channel| channel == name);
        let mut picked = match ["R", "G", "B"].map(find) {
            [Some(r), Some(g), Some(b)] => vec![r, g, b],
            _ => match find("Y") {
                Some(y) => vec![y],
                None if self.channels.len() >= 3 => vec![0, 1, 2],
                None => vec![0],
            },
        };
        picked.extend(find("A").filter(|a| !picked.contains(a)));
        picked
    }

    /// The linear image. Colours of whole-number files, which store them beside alpha, are multiplied by it.
    pub(crate) fn into_image(self) -> Option<Image> {
        let is_integer = self.texels.is_integer();
        let encoding = Encoding::Auto.resolve(is_integer);
        let mut data: Vec<f32> = match &self.texels {
            Texels::Bytes(bytes) => {
                let table = byte_table(encoding);
                bytes.iter().map(|&x| table[usize::from(x)]).collect()
            }
            Texels::Words(words) => {
                let table = word_table(encoding);
                words.iter().map(|&x| table[usize::from(x)]).collect()
            }
            Texels::Halves(halves) => halves.iter().map(|x| x.to_f32()).collect(),
            Texels::Floats(_) => Vec::new(),
        };
        let alpha = self.channels.iter().position(|name| name == "A").filter(|_| is_integer);
        match (alpha, self.texels) {
            (Some(a), Texels::Bytes(raw)) => {
                multiply_by_alpha(&mut data, &raw, self.channels.len(), a, 1.0 / 255.0)
            }
            (Some(a), Texels::Words(raw)) => {
                multiply_by_alpha(&mut data, &raw, self.channels.len(), a, 1.0 / 65535.0)
            }
            (_, Texels::Floats(floats)) => data = floats,
            _ => {}
        }
        let mut image = Image::from_data(self.width, self.height, self.channels, data)?;
        image.metadata = self.metadata;
        image.window = self.window;
        Some(image)
    }
}

/// Replaces the alpha channel by the stored numbers, which are linear, and multiplies the others by it.
fn multiply_by_alpha<T: Copy + Into<f32>>(
    data: &mut [f32],
    raw: &[T],
    stride: usize,
    alpha: usize,
    scale: f32,
) {
    for (pixel, stored) in data.chunks_exact_mut(stride).zip(raw.chunks_exact(stride)) {
        let opacity = stored[alpha].into() * scale;
        pixel.iter_mut().for_each(|value| *value *= opacity);
        pixel[alpha] = opacity;
    }
}

//! What decoders deliver: numbers as the file stores them.

use aureole_spectrum::{Primaries, WhitePoint};
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

    /// As floats, as they are stored.
    pub(crate) fn into_floats(self) -> Vec<f32> {
        match self {
            Self::Bytes(data) => data.into_iter().map(f32::from).collect(),
            Self::Words(data) => data.into_iter().map(f32::from).collect(),
            Self::Halves(data) => data.into_iter().map(f16::to_f32).collect(),
            Self::Floats(data) => data,
        }
    }

    /// Planes of one sample each as pixels of several.
    pub(crate) fn interleaved(self, pixels: usize, planes: usize) -> Self {
        fn weave<T: Copy>(data: &[T], pixels: usize, planes: usize) -> Vec<T> {
            (0..pixels).flat_map(|i| (0..planes).map(move |plane| data[plane * pixels + i])).collect()
        }
        match self {
            Self::Bytes(data) => Self::Bytes(weave(&data, pixels, planes)),
            Self::Words(data) => Self::Words(weave(&data, pixels, planes)),
            Self::Halves(data) => Self::Halves(weave(&data, pixels, planes)),
            Self::Floats(data) => Self::Floats(weave(&data, pixels, planes)),
        }
    }

    /// Bytes that hold numbers of fewer bits, spread over all of a byte's range.
    pub(crate) fn widened(self, bits: u32) -> Self {
        match self {
            Self::Bytes(mut data) if bits < 8 => {
                let full = (1_u16 << bits) - 1;
                data.iter_mut().for_each(|x| *x = (u16::from(*x) * 255 / full) as u8);
                Self::Bytes(data)
            }
            other => other,
        }
    }

    /// Changes every pixel; whole numbers are shares of their full range meanwhile.
    pub(crate) fn map_pixels(self, stride: usize, change: impl Fn(&mut [f32])) -> Self {
        let mut pixel = vec![0.0; stride];
        let mut whole = |values: &mut dyn Iterator<Item = f32>, full: f32| -> Vec<f32> {
            pixel.iter_mut().zip(values).for_each(|(to, value)| *to = value / full);
            change(&mut pixel);
            pixel.iter().map(|x| (x.clamp(0.0, 1.0) * full).round()).collect()
        };
        match self {
            Self::Bytes(data) => {
                let pixels = data.chunks_exact(stride);
                let changed = pixels.flat_map(|p| whole(&mut p.iter().map(|&x| x.into()), 255.0));
                Self::Bytes(changed.map(|x| x as u8).collect())
            }
            Self::Words(data) => {
                let pixels = data.chunks_exact(stride);
                let changed = pixels.flat_map(|p| whole(&mut p.iter().map(|&x| x.into()), 65535.0));
                Self::Words(changed.map(|x| x as u16).collect())
            }
            floats => {
                let mut data = floats.into_floats();
                data.chunks_exact_mut(stride).for_each(change);
                Self::Floats(data)
            }
        }
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

/// How a file's rows and columns become those of the picture: first exchanged, then mirrored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Orientation {
    /// The file's rows are the picture's columns.
    pub(crate) transpose: bool,
    /// The picture's columns run from right to left in the file.
    pub(crate) flip_x: bool,
    /// The picture's rows run from bottom to top in the file.
    pub(crate) flip_y: bool,
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

    /// The picture the right way up, from pixels in a file's order.
    pub(crate) fn oriented(self, orientation: Orientation) -> Self {
        if orientation == Orientation::default() {
            return self;
        }
        let (stored_width, stored_height) = (self.width, self.height);
        let Orientation { transpose, flip_x, flip_y } = orientation;
        let (width, height) =
            if transpose { (stored_height, stored_width) } else { (stored_width, stored_height) };
        let stride = self.channels.len();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| {
            let x = if flip_x { width - 1 - x } else { x };
            let y = if flip_y { height - 1 - y } else { y };
            let pixel = if transpose { x * stored_width + y } else { y * stored_width + x };
            pixel * stride..(pixel + 1) * stride
        });
        let texels = match &self.texels {
            Texels::Bytes(data) => Texels::Bytes(places.map(|i| data[i]).collect()),
            Texels::Words(data) => Texels::Words(places.map(|i| data[i]).collect()),
            Texels::Halves(data) => Texels::Halves(places.map(|i| data[i]).collect()),
            Texels::Floats(data) => Texels::Floats(places.map(|i| data[i]).collect()),
        };
        Self { width, height, texels, ..self }
    }

    /// The channels of the picture among the layers: `R G B` or `Y`, or else those of the first layer that has them, or
    /// else the first three or one; then `A`.
    pub(crate) fn picture_channels(&self) -> Vec<usize> {
        let find = |name: &str| self.channels.iter().position(|channel| channel == name);
        let layers = self.channels.iter().map(|name| name.rsplit_once('.').map_or("", |(layer, _)| layer));
        for layer in std::iter::once("").chain(layers) {
            let prefix = if layer.is_empty() { String::new() } else { format!("{layer}.") };
            let member = |name: &str| find(&format!("{prefix}{name}"));
            let mut picked = match ["R", "G", "B"].map(member) {
                [Some(r), Some(g), Some(b)] => vec![r, g, b],
                _ => member("Y").into_iter().collect(),
            };
            if !picked.is_empty() {
                picked.extend(member("A"));
                return picked;
            }
        }
        let mut picked = if self.channels.len() >= 3 { vec![0, 1, 2] } else { vec![0] };
        picked.extend(find("A").filter(|a| !picked.contains(a)));
        picked
    }

    /// Turns the picture's linear `R`, `G`, `B` from other primaries to Rec. 709, with its white to ours. Layers stay as they
    /// are: nobody knows which of them are colours.
    pub(crate) fn convert_primaries(&mut self, primaries: Primaries) {
        if !primaries.is_near(&Primaries::REC709)
            && let Some(matrix) = primaries.to_rec709(WhitePoint::Adapt)
        {
            self.mix(["R", "G", "B"], matrix);
        }
    }

    /// Turns a picture in CIE XYZ (channels `X`, `Y`, `Z` and none of `R`, `G`, `B`) to linear Rec. 709.
    pub(crate) fn convert_xyz(&mut self) {
        let has_rgb = self.channels.iter().any(|name| matches!(name.as_str(), "R" | "G" | "B"));
        if !has_rgb
            && let Some(matrix) = Primaries::XYZ.to_rec709(WhitePoint::Keep)
            && self.mix(["X", "Y", "Z"], matrix)
        {
            for name in &mut self.channels {
                let rgb = match name.as_str() {
                    "X" => "R",
                    "Y" => "G",
                    "Z" => "B",
                    _ => continue,
                };
                rgb.clone_into(name);
            }
        }
    }

    /// Applies a matrix to three linear channels, if there are all of them.
    fn mix(&mut self, names: [&str; 3], matrix: [[f64; 3]; 3]) -> bool {
        let find = |name: &str| self.channels.iter().position(|channel| channel == name);
        let [Some(r), Some(g), Some(b)] = names.map(find) else { return false };
        let rows = matrix.map(|row| row.map(|x| x as f32));
        let convert = |rgb: [f32; 3]| rows.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]);
        let stride = self.channels.len();
        match &mut self.texels {
            Texels::Floats(data) => {
                for pixel in data.chunks_exact_mut(stride) {
                    [pixel[r], pixel[g], pixel[b]] = convert([pixel[r], pixel[g], pixel[b]]);
                }
            }
            Texels::Halves(data) => {
                for pixel in data.chunks_exact_mut(stride) {
                    let rgb = convert([pixel[r], pixel[g], pixel[b]].map(f16::to_f32));
                    [pixel[r], pixel[g], pixel[b]] = rgb.map(f16::from_f32);
                }
            }
            // Whole numbers are encoded, and come from formats that name no primaries.
            Texels::Bytes(_) | Texels::Words(_) => return false,
        }
        true
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

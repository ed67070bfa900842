//! Images as textures read them: compact texels, decoded on the fly.

use std::sync::LazyLock;

use aureole_spectrum::srgb_to_linear;

/// How stored numbers become linear ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Encoding {
    /// sRGB for whole-number formats, linear for floating-point ones.
    #[default]
    Auto,
    /// The sRGB transfer curve.
    Srgb,
    /// Already linear.
    Linear,
    /// A power.
    Gamma(f32),
}

impl Encoding {
    fn decode(self, x: f32, is_integer: bool) -> f32 {
        match self {
            Self::Auto if is_integer => srgb_to_linear(x),
            Self::Srgb => srgb_to_linear(x),
            Self::Gamma(g) => x.max(0.0).powf(g),
            Self::Auto | Self::Linear => x,
        }
    }
}

static SRGB_TABLE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| srgb_to_linear(i as f32 / 255.0)));

/// Texels, as small as their source allows.
#[derive(Clone, Debug)]
enum Texels {
    /// Eight bits with a table per channel kind: colours first, alpha always linear.
    Bytes { data: Vec<u8>, table: Box<[f32; 256]> },
    /// Linear floats.
    Floats(Vec<f32>),
}

/// A picture for textures: 1 (grey), 2 (grey, alpha), 3 or 4 channels; rows from top to bottom.
#[derive(Clone, Debug)]
pub struct Bitmap {
    width: usize,
    height: usize,
    channels: usize,
    texels: Texels,
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
        let table = match encoding {
            Encoding::Auto | Encoding::Srgb => Box::new(*SRGB_TABLE),
            other => Box::new(std::array::from_fn(|i| other.decode(i as f32 / 255.0, true))),
        };
        Self::checked(width, height, channels, data.len(), Texels::Bytes { data, table })
    }

    /// From floats that need decoding when they came from whole numbers; `None` when the lengths do not match.
    pub fn from_floats(
        width: usize,
        height: usize,
        channels: usize,
        mut data: Vec<f32>,
        encoding: Encoding,
        is_integer: bool,
    ) -> Option<Self> {
        let has_alpha = channels.is_multiple_of(2);
        for (i, value) in data.iter_mut().enumerate() {
            let is_alpha = has_alpha && i % channels == channels - 1;
            *value = if is_alpha { *value } else { encoding.decode(*value, is_integer) };
            if !value.is_finite() {
                *value = 0.0;
            }
        }
        Self::checked(width, height, channels, data.len(), Texels::Floats(data))
    }

    fn checked(width: usize, height: usize, channels: usize, len: usize, texels: Texels) -> Option<Self> {
        let size = width.checked_mul(height)?.checked_mul(channels)?;
        let usable = size == len && size > 0 && (1..=4).contains(&channels);
        usable.then_some(Self { width, height, channels, texels })
    }

    /// One texel of one value, to stand in for a picture that cannot be read.
    pub fn placeholder(rgb: [f32; 3]) -> Self {
        Self { width: 1, height: 1, channels: 3, texels: Texels::Floats(rgb.to_vec()) }
    }

    /// Texels across.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Texels down.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Values per texel.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Bytes that the texels take.
    pub fn memory(&self) -> usize {
        match &self.texels {
            Texels::Bytes { data, .. } => data.len(),
            Texels::Floats(data) => data.len() * 4,
        }
    }

    /// The linear colour of a texel; grey is repeated.
    #[inline]
    pub fn rgb(&self, x: usize, y: usize) -> [f32; 3] {
        let start = (y * self.width + x) * self.channels;
        match &self.texels {
            Texels::Bytes { data, table } if self.channels >= 3 => {
                [0, 1, 2].map(|c| table[data[start + c] as usize])
            }
            Texels::Bytes { data, table } => [table[data[start] as usize]; 3],
            Texels::Floats(data) if self.channels >= 3 => [0, 1, 2].map(|c| data[start + c]),
            Texels::Floats(data) => [data[start]; 3],
        }
    }

    /// The opacity of a texel; one without an alpha channel.
    #[inline]
    pub fn alpha(&self, x: usize, y: usize) -> f32 {
        if !self.channels.is_multiple_of(2) {
            return 1.0;
        }
        let last = (y * self.width + x + 1) * self.channels - 1;
        match &self.texels {
            Texels::Bytes { data, .. } => f32::from(data[last]) / 255.0,
            Texels::Floats(data) => data[last],
        }
    }
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
}

//! Transfer curves of stored numbers.

use std::sync::{Arc, LazyLock};

use aureole_spectrum::srgb_to_linear;

/// How stored numbers become linear ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Encoding {
    /// sRGB for whole-number files, linear for floating-point ones.
    #[default]
    Auto,
    /// The sRGB transfer curve.
    Srgb,
    /// Already linear.
    Linear,
    /// A power: linear = stored ^ gamma.
    Gamma(f32),
}

impl Encoding {
    /// What `Auto` stands for in a file of whole numbers or of floats.
    pub(crate) fn resolve(self, is_integer: bool) -> Self {
        match self {
            Self::Auto if is_integer => Self::Srgb,
            Self::Auto => Self::Linear,
            other => other,
        }
    }

    /// A stored number in [0, 1] (or beyond, from a float file) as a linear one.
    pub(crate) fn decode(self, x: f32) -> f32 {
        match self {
            Self::Srgb => srgb_to_linear(x),
            Self::Gamma(gamma) => x.max(0.0).powf(gamma),
            Self::Auto | Self::Linear => x,
        }
    }
}

/// The linear value of every byte.
pub(crate) type ByteTable = Arc<[f32; 256]>;

/// The linear value of every 16-bit word.
pub(crate) type WordTable = Arc<[f32]>;

/// The table of a resolved encoding for bytes; the common ones are made once.
pub(crate) fn byte_table(encoding: Encoding) -> ByteTable {
    fn make(encoding: Encoding) -> ByteTable {
        Arc::new(std::array::from_fn(|i| encoding.decode(i as f32 / 255.0)))
    }
    static SRGB: LazyLock<ByteTable> = LazyLock::new(|| make(Encoding::Srgb));
    static LINEAR: LazyLock<ByteTable> = LazyLock::new(|| make(Encoding::Linear));
    match encoding {
        Encoding::Srgb => SRGB.clone(),
        Encoding::Linear => LINEAR.clone(),
        other => make(other),
    }
}

/// The table of a resolved encoding for 16-bit words; the common ones are made once.
pub(crate) fn word_table(encoding: Encoding) -> WordTable {
    fn make(encoding: Encoding) -> WordTable {
        (0..=u16::MAX).map(|i| encoding.decode(f32::from(i) / 65535.0)).collect()
    }
    static SRGB: LazyLock<WordTable> = LazyLock::new(|| make(Encoding::Srgb));
    static LINEAR: LazyLock<WordTable> = LazyLock::new(|| make(Encoding::Linear));
    match encoding {
        Encoding::Srgb => SRGB.clone(),
        Encoding::Linear => LINEAR.clone(),
        other => make(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_follows_the_file() {
        assert_eq!(Encoding::Auto.resolve(true), Encoding::Srgb);
        assert_eq!(Encoding::Auto.resolve(false), Encoding::Linear);
        assert_eq!(Encoding::Gamma(2.2).resolve(true), Encoding::Gamma(2.2));
    }

    #[test]
    fn tables_span_black_to_white() {
        for encoding in [Encoding::Srgb, Encoding::Linear, Encoding::Gamma(2.2)] {
            let (bytes, words) = (byte_table(encoding), word_table(encoding));
            assert_eq!((bytes[0], words[0]), (0.0, 0.0));
            assert!((bytes[255] - 1.0).abs() < 1e-6 && (words[65535] - 1.0).abs() < 1e-6);
            assert!((bytes[128] - words[128 * 257]).abs() < 1e-6);
        }
    }
}

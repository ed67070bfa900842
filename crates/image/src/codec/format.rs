//! The names of the formats.

use std::path::Path;

use super::{CODECS, Codec};
use crate::ImageError;

/// An image file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// OpenEXR: half or float, any channels.
    Exr,
    /// Portable Network Graphics.
    Png,
    /// JPEG.
    Jpeg,
    /// Radiance: a shared exponent for three bytes.
    Hdr,
    /// Portable float map.
    Pfm,
    /// Portable pixel, grey and bit maps.
    Ppm,
    /// Windows bitmap (read only).
    Bmp,
    /// TIFF (read only).
    Tiff,
    /// WebP (read only).
    WebP,
    /// Truevision TGA (read only).
    Tga,
}

impl Format {
    /// The format of a suffix, without the dot.
    ///
    /// # Errors
    /// [`ImageError::UnknownFormat`], naming those there are.
    pub fn from_suffix(suffix: &str) -> Result<Self, ImageError> {
        let has_suffix =
            |codec: &&Codec| codec.suffixes.iter().any(|known| known.eq_ignore_ascii_case(suffix));
        CODECS.iter().find(has_suffix).map(|codec| codec.format).ok_or_else(|| unknown(suffix, |_| true))
    }

    /// The format that a path's suffix names.
    ///
    /// # Errors
    /// [`ImageError::UnknownFormat`].
    pub fn from_path(path: &Path) -> Result<Self, ImageError> {
        Self::from_suffix(&path.extension().unwrap_or_default().to_string_lossy())
    }

    /// The usual suffix, without the dot.
    pub fn suffix(self) -> &'static str {
        self.codec().suffixes[0]
    }

    /// Whether images can be written in this format.
    pub fn writable(self) -> bool {
        self.codec().encode.is_some()
    }

    /// Every format.
    pub fn all() -> impl Iterator<Item = Self> {
        CODECS.iter().map(|codec| codec.format)
    }

    pub(super) fn codec(self) -> &'static Codec {
        CODECS.iter().find(|codec| codec.format == self).expect("every format has a codec (tested)")
    }
}

/// The error of a suffix that is not among those wanted.
pub(super) fn unknown(suffix: &str, wanted: impl Fn(Format) -> bool) -> ImageError {
    let known =
        || CODECS.iter().filter(|codec| wanted(codec.format)).flat_map(|codec| codec.suffixes).copied();
    let lower = suffix.to_ascii_lowercase();
    let distances = known().map(|name| (strsim::damerau_levenshtein(name, &lower), name));
    let nearest = distances.min_by_key(|(distance, _)| *distance);
    ImageError::UnknownFormat {
        suffix: suffix.to_owned(),
        known: known().collect::<Vec<_>>().join(", "),
        suggestion: nearest
            .filter(|&(distance, _)| distance <= 2 && distance < lower.len())
            .map(|(_, name)| name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_one_codec_and_its_own_suffixes() {
        use Format::*;
        for format in [Exr, Png, Jpeg, Hdr, Pfm, Ppm, Bmp, Tiff, WebP, Tga] {
            assert_eq!(format.codec().format, format);
            for suffix in format.codec().suffixes {
                assert_eq!(Format::from_suffix(&suffix.to_uppercase()).unwrap(), format);
            }
        }
        assert_eq!(Format::all().count(), 10);
    }

    #[test]
    fn a_wrong_suffix_gets_a_suggestion() {
        let message = Format::from_path(Path::new("out.pgn")).unwrap_err().to_string();
        assert!(message.contains("did you mean `png`?") && message.contains("exr"), "{message}");
        let message = Format::from_path(Path::new("out")).unwrap_err().to_string();
        assert!(!message.contains("did you mean"), "{message}");
    }
}

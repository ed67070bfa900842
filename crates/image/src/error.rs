//! What can go wrong with images.

use std::path::PathBuf;

/// An image that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file's content is wrong.
    #[error("`{}` is not a usable image: {message}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// The image cannot be encoded.
    #[error("cannot encode the image: {message}")]
    Encode {
        /// Why.
        message: String,
    },
    /// The file cannot be written.
    #[error("cannot write `{}`: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// No format has this suffix.
    #[error("`{suffix}` is not the suffix of an image format; known: {known}")]
    UnknownFormat {
        /// The suffix.
        suffix: String,
        /// The suffixes there are.
        known: String,
    },
    /// More pixels than allowed.
    #[error("an image of {width} x {height} pixels is beyond the limit of {max_pixels} pixels")]
    TooLarge {
        /// Pixels across.
        width: u64,
        /// Pixels down.
        height: u64,
        /// How many there may be.
        max_pixels: u64,
    },
    /// Two images that should match do not.
    #[error("{0}")]
    Mismatch(String),
}

impl ImageError {
    /// Whether the file system failed, rather than the content being wrong.
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Read { .. } | Self::Write { .. })
    }
}

/// What an image file may ask for; checked before memory is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageLimits {
    /// Pixels.
    pub max_pixels: u64,
}

impl Default for ImageLimits {
    fn default() -> Self {
        Self { max_pixels: 1 << 28 }
    }
}

impl ImageLimits {
    /// Checks a size.
    ///
    /// # Errors
    /// [`ImageError::TooLarge`].
    pub fn check(&self, width: u64, height: u64) -> Result<(), ImageError> {
        let within = width.checked_mul(height).is_some_and(|n| n <= self.max_pixels);
        if within { Ok(()) } else { Err(ImageError::TooLarge { width, height, max_pixels: self.max_pixels }) }
    }
}

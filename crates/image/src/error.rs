//! What can go wrong with images.

use std::path::{Path, PathBuf};

/// An image that cannot be read or written.
///
/// [`is_io`](Self::is_io) and [`is_limit`](Self::is_limit) tell trouble with the machine (a full disk, a forbidden folder,
/// memory) from trouble with the content, so that a program can choose its exit code.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be opened or read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file was read, and its content is wrong or of a kind that is not supported.
    #[error("`{}` is not a usable image: {message}", path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// No format has this suffix, or none that can be written.
    #[error("`{suffix}` is not the suffix of an image format{}; known: {known}", did_you_mean(suggestion))]
    UnknownFormat {
        /// The suffix, without the dot.
        suffix: String,
        /// The suffixes there are.
        known: String,
        /// The nearest of them, if one is near.
        suggestion: Option<&'static str>,
    },
    /// More pixels or memory than the limits allow.
    #[error("`{}` is too large: {what} are beyond the limit of {limit}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// How much it asks for, with its unit.
        what: String,
        /// How much there may be.
        limit: u64,
    },
    /// The image has something that the format cannot hold.
    #[error("cannot encode the image: {message}")]
    Encode {
        /// What the format cannot hold.
        message: String,
    },
    /// The file cannot be written; an older file of that name is untouched.
    #[error("cannot write `{}`: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Two images, or an image and its description, that should match do not.
    #[error("{0}")]
    Mismatch(String),
}

fn did_you_mean(suggestion: &Option<&'static str>) -> String {
    suggestion.map_or_else(String::new, |near| format!(" (did you mean `{near}`?)"))
}

impl ImageError {
    /// Whether the file system failed, rather than the content being wrong.
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Read { .. } | Self::Write { .. })
    }

    /// Whether a limit on pixels or memory was met.
    pub fn is_limit(&self) -> bool {
        matches!(self, Self::TooLarge { .. })
    }
}

/// What a decoder reports; the door adds the path.
#[derive(Debug)]
pub(crate) enum Fault {
    /// Wrong or unsupported content.
    Content(String),
    /// Beyond [`crate::ImageLimits`].
    TooLarge { what: String, limit: u64 },
}

impl Fault {
    pub(crate) fn content(message: impl std::fmt::Display) -> Self {
        Self::Content(message.to_string())
    }

    pub(crate) fn at(self, path: &Path) -> ImageError {
        let path = path.to_owned();
        match self {
            Self::Content(message) => ImageError::Decode { path, message },
            Self::TooLarge { what, limit } => ImageError::TooLarge { path, what, limit },
        }
    }
}

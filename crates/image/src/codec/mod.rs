//! Reading and writing image files: the list of formats and the doors that go through it.
//!
//! A new format is a file here and a line in [`CODECS`]. Decoders work on bytes in memory, so that whatever they
//! report is about the content, and trouble with the file system is only met at the doors.

mod common;
mod exr;
mod format;
mod hdr;
mod pfm;
mod pnm;
mod probe;
mod tiff;

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

pub use exr::{Plane, Planes};
pub use format::Format;
pub use probe::{Probe, probe_image};

use crate::error::Fault;
use crate::raster::Raster;
use crate::{Bitmap, Encoding, Image, ImageError, ImageLimits, ToneMapping, stray, write_atomically};

/// How many bits a floating-point file spends on a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Sixteen for colours and alpha; channels of other data (depth, positions, ids) keep thirty-two.
    Half,
    /// Thirty-two.
    #[default]
    Float,
}

/// How many bits a whole-number file spends on a number, where it has the choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitDepth {
    /// 0 to 255.
    #[default]
    Eight,
    /// 0 to 65535 (PNG, PPM).
    Sixteen,
}

/// How images are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WriteOptions {
    /// For EXR.
    pub precision: Precision,
    /// For PNG and PPM.
    pub bit_depth: BitDepth,
    /// For JPEG, 1 to 100 (default 95).
    pub quality: u8,
    /// For the formats of whole numbers.
    pub tone: ToneMapping,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            precision: Precision::default(),
            bit_depth: BitDepth::default(),
            quality: 95,
            tone: ToneMapping::default(),
        }
    }
}

/// A decoder of a whole file in memory.
type Decode = fn(&[u8], &ImageLimits) -> Result<Raster, Fault>;
/// An encoder to a whole file in memory. Its error is what the format cannot hold.
type Encode = fn(&Image, &WriteOptions) -> Result<Vec<u8>, String>;

/// One file format.
struct Codec {
    format: Format,
    /// The first suffix is the usual one.
    suffixes: &'static [&'static str],
    /// Whether a file with these first bytes is of this format.
    recognises: fn(&[u8]) -> bool,
    decode: Decode,
    encode: Option<Encode>,
}

/// Every format there is.
static CODECS: &[Codec] = &[
    Codec {
        format: Format::Exr,
        suffixes: &["exr"],
        recognises: |bytes| bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]),
        decode: exr::decode,
        encode: Some(exr::encode),
    },
    Codec {
        format: Format::Png,
        suffixes: &["png"],
        recognises: |bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n"),
        decode: common::decode_png,
        encode: Some(common::encode_png),
    },
    Codec {
        format: Format::Jpeg,
        suffixes: &["jpg", "jpeg"],
        recognises: |bytes| bytes.starts_with(&[0xff, 0xd8, 0xff]),
        decode: common::decode_jpeg,
        encode: Some(common::encode_jpeg),
    },
    Codec {
        format: Format::Hdr,
        suffixes: &["hdr", "pic", "rgbe"],
        recognises: |bytes| bytes.starts_with(b"#?"),
        decode: hdr::decode,
        encode: Some(common::encode_hdr),
    },
    Codec {
        format: Format::Pfm,
        suffixes: &["pfm"],
        recognises: |bytes| bytes.starts_with(b"PF") || bytes.starts_with(b"Pf"),
        decode: pfm::decode,
        encode: Some(pfm::encode),
    },
    Codec {
        format: Format::Ppm,
        suffixes: &["ppm", "pgm", "pnm", "pbm", "pam"],
        recognises: |bytes| matches!(bytes, [b'P', b'1'..=b'7', ..]),
        decode: common::decode_pnm,
        encode: Some(pnm::encode),
    },
    Codec {
        format: Format::Bmp,
        suffixes: &["bmp"],
        recognises: |bytes| bytes.starts_with(b"BM"),
        decode: common::decode_bmp,
        encode: None,
    },
    Codec {
        format: Format::Tiff,
        suffixes: &["tif", "tiff"],
        recognises: tiff::recognises,
        decode: tiff::decode,
        encode: None,
    },
    Codec {
        format: Format::WebP,
        suffixes: &["webp"],
        recognises: |bytes| bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP"),
        decode: common::decode_webp,
        encode: None,
    },
    Codec {
        // Last, for its files have no mark to know them by.
        format: Format::Tga,
        suffixes: &["tga"],
        recognises: |_| false,
        decode: common::decode_tga,
        encode: None,
    },
];

/// Decodes a file by what its first bytes say or else by its suffix.
fn decode(bytes: &[u8], path: &Path, limits: &ImageLimits) -> Result<Raster, ImageError> {
    if let Some(what) = stray(bytes) {
        return Err(Fault::content(what).at(path));
    }
    let codec = match CODECS.iter().find(|codec| (codec.recognises)(bytes)) {
        Some(codec) => codec,
        None => Format::from_path(path)?.codec(),
    };
    // A decoder that fails an assertion on a hostile file must cost that file, not the render.
    let decoded = catch_unwind(AssertUnwindSafe(|| (codec.decode)(bytes, limits)))
        .unwrap_or_else(|_| Err(Fault::content("its decoder failed")));
    decoded.map_err(|fault| fault.at(path))
}

fn no_pixels(path: &Path) -> ImageError {
    Fault::content("it has no pixels").at(path)
}

/// Reads a file of at most as many bytes as a decoded image may have.
fn read_file(path: &Path, limits: &ImageLimits) -> Result<Vec<u8>, ImageError> {
    let failed = |source| ImageError::Read { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(failed)?;
    file.take(limits.max_bytes.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > limits.max_bytes {
        let what = "the file's bytes".to_owned();
        return Err(Fault::TooLarge { what, limit: limits.max_bytes }.at(path));
    }
    Ok(bytes)
}

/// Reads an image with all its channels as linear floats; colours of whole-number files are taken as sRGB.
///
/// # Errors
/// [`ImageError::Read`], [`ImageError::Decode`], [`ImageError::UnknownFormat`] or [`ImageError::TooLarge`].
pub fn read_image(path: &Path, limits: &ImageLimits) -> Result<Image, ImageError> {
    decode_image(&read_file(path, limits)?, path, limits)
}

/// Reads a picture for a texture: colour or grey, with alpha if there is one.
///
/// It must be a regular file: a scene may name a pipe into which nobody writes.
///
/// # Errors
/// As [`read_image`].
pub fn read_bitmap(path: &Path, encoding: Encoding, limits: &ImageLimits) -> Result<Bitmap, ImageError> {
    let failed = |source| ImageError::Read { path: path.to_owned(), source };
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err(failed(io::Error::other("it is not a file")));
    }
    decode_bitmap(&read_file(path, limits)?, path, encoding, limits)
}

/// As [`read_image`], from a file's bytes; the path is for messages and for formats without a mark.
///
/// # Errors
/// As [`read_image`], but for reading.
pub fn decode_image(bytes: &[u8], path: &Path, limits: &ImageLimits) -> Result<Image, ImageError> {
    decode(bytes, path, limits)?.into_image().ok_or_else(|| no_pixels(path))
}

/// As [`read_bitmap`], from a file's bytes; the path is for messages and for formats without a mark.
///
/// # Errors
/// As [`read_image`], but for reading.
pub fn decode_bitmap(
    bytes: &[u8],
    path: &Path,
    encoding: Encoding,
    limits: &ImageLimits,
) -> Result<Bitmap, ImageError> {
    Bitmap::from_raster(decode(bytes, path, limits)?, encoding).ok_or_else(|| no_pixels(path))
}

/// An image as a file's bytes, to be written to a pipe or kept.
///
/// # Errors
/// [`ImageError::Encode`] for what the format cannot hold; [`ImageError::UnknownFormat`] if it can only be read.
pub fn encode(image: &Image, format: Format, options: &WriteOptions) -> Result<Vec<u8>, ImageError> {
    let encode = format.codec().encode.ok_or_else(|| format::unknown(format.suffix(), Format::writable))?;
    if image.data().is_empty() {
        return Err(ImageError::Encode { message: "it has no pixels".into() });
    }
    let image = if format == Format::Exr { Cow::Borrowed(image) } else { image.in_rgb() };
    encode(&image, options).map_err(|message| ImageError::Encode { message })
}

/// Writes an image in the format that the path's suffix names; the file is never half-written.
///
/// # Errors
/// [`ImageError::UnknownFormat`], [`ImageError::Encode`] or [`ImageError::Write`].
pub fn write_image(image: &Image, path: &Path, options: &WriteOptions) -> Result<(), ImageError> {
    let bytes = encode(image, Format::from_path(path)?, options)?;
    write_atomically(path, &bytes)
}

//! Reading and writing image files, by suffix.

mod common;
mod exr;
mod pfm;

use std::io::{Cursor, Write};
use std::path::Path;

use crate::{Bitmap, Encoding, Image, ImageError, ImageLimits, ToneMapping};

/// An image file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the formats' own names")]
pub enum Format {
    Exr,
    Png,
    Jpeg,
    Ppm,
    Pfm,
    Hdr,
}

/// Suffixes and the formats that can be written.
const SUFFIXES: &[(&str, Format)] = &[
    ("exr", Format::Exr),
    ("png", Format::Png),
    ("jpg", Format::Jpeg),
    ("jpeg", Format::Jpeg),
    ("ppm", Format::Ppm),
    ("pfm", Format::Pfm),
    ("hdr", Format::Hdr),
];

impl Format {
    /// The format of a suffix, without the dot.
    ///
    /// # Errors
    /// [`ImageError::UnknownFormat`], naming those there are.
    pub fn from_suffix(suffix: &str) -> Result<Self, ImageError> {
        let found = SUFFIXES.iter().find(|(known, _)| known.eq_ignore_ascii_case(suffix));
        found.map(|(_, format)| *format).ok_or_else(|| ImageError::UnknownFormat {
            suffix: suffix.to_owned(),
            known: SUFFIXES.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", "),
        })
    }

    /// The format that a path's suffix names.
    ///
    /// # Errors
    /// [`ImageError::UnknownFormat`].
    pub fn from_path(path: &Path) -> Result<Self, ImageError> {
        Self::from_suffix(&path.extension().unwrap_or_default().to_string_lossy())
    }
}

/// How many bits a floating-point file spends on a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Sixteen.
    Half,
    /// Thirty-two.
    #[default]
    Float,
}

/// How images are written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// For EXR.
    pub precision: Precision,
    /// For the eight-bit formats.
    pub tone: ToneMapping,
}

/// An image as a file's bytes.
///
/// # Errors
/// [`ImageError::Encode`].
pub fn encode(image: &Image, format: Format, options: &WriteOptions) -> Result<Vec<u8>, ImageError> {
    let mut out = Cursor::new(Vec::new());
    match format {
        Format::Exr => exr::write(image, options.precision, &mut out)?,
        Format::Pfm => pfm::write(image, &mut out)?,
        Format::Png | Format::Jpeg | Format::Ppm | Format::Hdr => {
            common::write(image, format, &options.tone, &mut out)?
        }
    }
    Ok(out.into_inner())
}

/// Writes an image in the format that the path's suffix names; the file is never half-written.
///
/// # Errors
/// [`ImageError::UnknownFormat`], [`ImageError::Encode`] or [`ImageError::Write`].
pub fn write_image(image: &Image, path: &Path, options: &WriteOptions) -> Result<(), ImageError> {
    let bytes = encode(image, Format::from_path(path)?, options)?;
    write_atomically(path, &bytes)
}

/// Writes a file beside its place, flushes it to the disk, and only then gives it its name.
///
/// # Errors
/// [`ImageError::Write`]; the old file, if there was one, is then untouched.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), ImageError> {
    let attempt = || -> std::io::Result<()> {
        // Devices and pipes (`/dev/null`) have no place beside them.
        if std::fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir()) {
            return std::fs::write(path, bytes);
        }
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut builder = tempfile::Builder::new();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = std::fs::metadata(path).map_or(0o644, |meta| meta.permissions().mode() & 0o777);
            builder.permissions(std::fs::Permissions::from_mode(mode));
        }
        let mut file = builder.prefix(".aureole-").tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map(drop).map_err(|error| error.error)
    };
    attempt().map_err(|source| ImageError::Write { path: path.to_owned(), source })
}

fn read_file(path: &Path) -> Result<Vec<u8>, ImageError> {
    std::fs::read(path).map_err(|source| ImageError::Read { path: path.to_owned(), source })
}

/// What a file holds, told by its first bytes.
enum Content {
    Exr,
    Pfm,
    Common,
}

fn content(bytes: &[u8]) -> Content {
    match bytes {
        [0x76, 0x2f, 0x31, 0x01, ..] => Content::Exr,
        [b'P', b'F' | b'f', ..] => Content::Pfm,
        _ => Content::Common,
    }
}

/// Reads an image with all its channels; eight-bit pictures become linear.
///
/// # Errors
/// [`ImageError::Read`], [`ImageError::Decode`] or [`ImageError::TooLarge`].
pub fn read_image(path: &Path, limits: &ImageLimits) -> Result<Image, ImageError> {
    let bytes = read_file(path)?;
    match content(&bytes) {
        Content::Exr => exr::read(path, &bytes, limits),
        Content::Pfm => pfm::read(path, &bytes, limits),
        Content::Common => {
            let bitmap = common::read(path, &bytes, Encoding::Auto, limits)?;
            Ok(common::to_image(&bitmap))
        }
    }
}

/// Reads a picture for a texture.
///
/// # Errors
/// As [`read_image`].
pub fn read_bitmap(path: &Path, encoding: Encoding, limits: &ImageLimits) -> Result<Bitmap, ImageError> {
    let bytes = read_file(path)?;
    let image = match content(&bytes) {
        Content::Exr => exr::read(path, &bytes, limits)?,
        Content::Pfm => pfm::read(path, &bytes, limits)?,
        Content::Common => return common::read(path, &bytes, encoding, limits),
    };
    let (rgb, alpha) = (image.to_rgb(), image.alpha());
    let is_grey = image.channel("R").is_none();
    let colors = rgb.iter().enumerate().flat_map(|(i, pixel)| {
        let color = if is_grey { &pixel[..1] } else { &pixel[..] };
        color.iter().copied().chain(alpha.as_ref().map(|a| a[i]))
    });
    let channels = if is_grey { 1 } else { 3 } + usize::from(alpha.is_some());
    Bitmap::from_floats(image.width(), image.height(), channels, colors.collect(), encoding, false)
        .ok_or_else(|| ImageError::Decode { path: path.to_owned(), message: "it has no pixels".into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Image {
        let mut image = Image::new(7, 5, &["R", "G", "B"]);
        for (i, x) in image.data_mut().iter_mut().enumerate() {
            *x = (i % 97) as f32 / 64.0;
        }
        image
    }

    #[test]
    fn every_format_round_trips() {
        let folder = tempfile::tempdir().unwrap();
        let image = sample();
        // The largest error that each format's precision allows, as a fraction of the value or of white.
        for (suffix, tolerance) in
            [("exr", 0.0), ("pfm", 0.0), ("hdr", 0.02), ("png", 0.01), ("ppm", 0.01), ("jpg", 0.5)]
        {
            let path = folder.path().join(format!("image.{suffix}"));
            write_image(&image, &path, &WriteOptions::default()).unwrap();
            let back = read_image(&path, &ImageLimits::default()).unwrap();
            assert_eq!((back.width(), back.height()), (7, 5), "{suffix}");
            for (a, b) in image.to_rgb().iter().zip(back.to_rgb()) {
                for c in 0..3 {
                    let expected = if tolerance > 0.0 && suffix != "hdr" { a[c].min(1.0) } else { a[c] };
                    assert!(
                        (expected - b[c]).abs() <= tolerance * expected.max(1.0),
                        "{suffix}: {expected} {}",
                        b[c]
                    );
                }
            }
        }
        let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 6, "no temporary file stays behind");
    }

    #[test]
    fn truncated_files_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        for suffix in ["exr", "pfm", "hdr", "png", "ppm", "jpg"] {
            let bytes =
                encode(&sample(), Format::from_suffix(suffix).unwrap(), &WriteOptions::default()).unwrap();
            let path = folder.path().join(format!("cut.{suffix}"));
            // The last bytes of a PNG only say that it ends.
            for length in (0..bytes.len() - 20).step_by(16) {
                std::fs::write(&path, &bytes[..length]).unwrap();
                // JPEG decoders may make up what is missing; nothing may panic.
                let result = read_image(&path, &ImageLimits::default());
                assert!(result.is_err() || suffix == "jpg", "{suffix} cut at {length}");
            }
        }
    }

    #[test]
    fn layers_survive_in_exr() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("layers.exr");
        let mut image = Image::new(3, 2, &["R", "G", "B", "A", "albedo.R", "Z"]);
        image.pixel_mut(2, 1)[5] = 42.0;
        image.metadata.insert("seed".into(), "7".into());
        write_image(&image, &path, &WriteOptions::default()).unwrap();
        let back = read_image(&path, &ImageLimits::default()).unwrap();
        assert_eq!(back.pixel(2, 1)[back.channel("Z").unwrap()], 42.0);
        assert!(back.channel("albedo.R").is_some());
    }

    #[test]
    fn limits_hold() {
        let folder = tempfile::tempdir().unwrap();
        for suffix in ["exr", "pfm", "png"] {
            let path = folder.path().join(format!("big.{suffix}"));
            write_image(&sample(), &path, &WriteOptions::default()).unwrap();
            let result = read_image(&path, &ImageLimits { max_pixels: 10 });
            assert!(matches!(result, Err(ImageError::TooLarge { .. })), "{suffix}");
        }
    }
}

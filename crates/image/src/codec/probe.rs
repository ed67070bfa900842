//! The size of a picture, from its first bytes.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use ::image::{ImageDecoder, ImageReader};

use super::{hdr, pfm, tiff};

/// What a file says of its picture before it is decoded; nothing of it has been checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe {
    /// Pixels across.
    pub width: u64,
    /// Pixels down.
    pub height: u64,
    /// Bytes of a decoded pixel.
    pub bytes_per_pixel: u64,
}

impl Probe {
    /// Bytes of the decoded picture.
    pub fn bytes(&self) -> u64 {
        self.width.saturating_mul(self.height).saturating_mul(self.bytes_per_pixel)
    }
}

/// Looks at a file's header; `None` when it is no picture that can be read.
pub fn probe_image(path: &Path) -> Option<Probe> {
    // Enough for a header of text with all its comments.
    let mut start = Vec::new();
    File::open(path).ok()?.take(1 << 16).read_to_end(&mut start).ok()?;
    match &start[..] {
        [0x76, 0x2f, 0x31, 0x01, ..] => probe_exr(path),
        start if start.starts_with(b"PF") || start.starts_with(b"Pf") => pfm::probe(start),
        start if start.starts_with(b"#?") => hdr::probe(start),
        start if tiff::recognises(start) => tiff::probe(BufReader::new(File::open(path).ok()?)),
        _ => {
            let decoder = ImageReader::open(path).ok()?.with_guessed_format().ok()?.into_decoder().ok()?;
            let (width, height) = decoder.dimensions();
            let bytes_per_pixel = decoder.color_type().bytes_per_pixel().into();
            Some(Probe { width: width.into(), height: height.into(), bytes_per_pixel })
        }
    }
}

fn probe_exr(path: &Path) -> Option<Probe> {
    let file = BufReader::new(File::open(path).ok()?);
    let meta = exr::meta::MetaData::read_from_buffered(file, false).ok()?;
    let largest = meta.headers.iter().max_by_key(|header| header.layer_size.area())?;
    let channels = meta.headers.iter().flat_map(|header| &header.channels.list);
    let bytes_per_pixel = channels.map(|channel| channel.sample_type.bytes_per_sample() as u64).sum();
    let size = largest.layer_size;
    Some(Probe { width: size.0 as u64, height: size.1 as u64, bytes_per_pixel })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Image, WriteOptions, write_image};

    #[test]
    fn sizes_are_known_without_decoding() {
        let folder = tempfile::tempdir().unwrap();
        let image = Image::new(19, 7, &["R", "G", "B"]);
        for (name, bytes_per_pixel) in
            [("a.exr", 12), ("a.png", 3), ("a.jpg", 3), ("a.hdr", 12), ("a.pfm", 12)]
        {
            let path = folder.path().join(name);
            write_image(&image, &path, &WriteOptions::default()).unwrap();
            assert_eq!(probe_image(&path), Some(Probe { width: 19, height: 7, bytes_per_pixel }), "{name}");
        }
        assert_eq!(probe_image(folder.path()), None);
        assert_eq!(probe_image("/nowhere".as_ref()), None);
    }
}

//! Portable float maps: `PF` (colour) or `Pf` (grey), the size, a scale whose sign tells the byte order, and rows of floats
//! from the bottom to the top.
//!
//! [Debevec] P. Debevec, "PFM Portable FloatMap Image Format".

use super::{Probe, WriteOptions};
use crate::error::Fault;
use crate::raster::{Raster, Texels};
use crate::{Image, ImageLimits};

/// A word of the header and what follows the one space after it.
fn word(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace())?;
    let end = start + bytes[start..].iter().position(u8::is_ascii_whitespace)?;
    Some((std::str::from_utf8(&bytes[start..end]).ok()?, &bytes[end + 1..]))
}

/// The header's magic, width, height, scale, and the bytes after it.
fn header(bytes: &[u8]) -> Option<(&str, u64, u64, f32, &[u8])> {
    let (magic, rest) = word(bytes)?;
    let (width, rest) = word(rest)?;
    let (height, rest) = word(rest)?;
    let (scale, rest) = word(rest)?;
    Some((magic, width.parse().ok()?, height.parse().ok()?, scale.parse().ok()?, rest))
}

/// The size of a picture by its first bytes.
pub(super) fn probe(start: &[u8]) -> Option<Probe> {
    let (magic, width, height, ..) = header(start)?;
    let channels = if magic == "PF" { 3 } else { 1 };
    Some(Probe { width, height, bytes_per_pixel: 4 * channels })
}

pub(super) fn decode(bytes: &[u8], limits: &ImageLimits) -> Result<Raster, Fault> {
    let (magic, width, height, scale, body) =
        header(bytes).ok_or_else(|| Fault::content("its PFM header is broken"))?;
    let channels = match magic {
        "PF" => 3,
        "Pf" => 1,
        _ => return Err(Fault::content(format!("{magic:?} is not a kind of PFM"))),
    };
    let size = limits.check(width, height, channels as u64, 4)?;
    let body = body
        .get(..size * 4)
        .ok_or_else(|| Fault::content(format!("it ends after {} of {} bytes", body.len(), size * 4)))?;
    let read = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let row = width as usize * channels;
    let rows = body.chunks_exact(row * 4).rev();
    let data = rows.flat_map(|row| row.as_chunks().0.iter().map(|&value| read(value))).collect();
    Ok(Raster::picture(width as usize, height as usize, channels, Texels::Floats(data)))
}

/// Grey images as `Pf`, others as `PF`; alpha and layers are dropped.
pub(super) fn encode(image: &Image, _: &WriteOptions) -> Result<Vec<u8>, String> {
    let magic = if image.is_grey() { "Pf" } else { "PF" };
    let mut out = format!("{magic}\n{} {}\n-1.0\n", image.width(), image.height()).into_bytes();
    let colors = image.rgb_channels();
    let kept = if image.is_grey() { &colors[..1] } else { &colors[..] };
    for y in (0..image.height()).rev() {
        for x in 0..image.width() {
            let pixel = image.pixel(x, y);
            out.extend(kept.iter().flat_map(|&c| pixel[c].to_le_bytes()));
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn byte_order_and_row_order_are_understood() {
        let mut bytes = b"Pf\n2 2\n1.0\n".to_vec();
        for value in [1.0_f32, 2.0, 3.0, 4.0] {
            bytes.extend(value.to_be_bytes());
        }
        let image = decode(&bytes, &ImageLimits::default()).unwrap().into_image().unwrap();
        assert_eq!(image.data(), [3.0, 4.0, 1.0, 2.0]);
        assert!(image.is_grey());
    }

    #[test]
    fn broken_headers_are_errors() {
        for text in ["", "PF", "PF\n2 2\n", "PF\n-2 2\n1\n", "PF\n2 2\nx\n", "P5\n1 1\n1\n...."] {
            assert!(decode(text.as_bytes(), &ImageLimits::default()).is_err(), "{text:?}");
        }
        let huge = b"PF\n99999999999 99999999999\n-1\n";
        assert!(matches!(decode(huge, &ImageLimits::default()), Err(Fault::TooLarge { .. })));
    }
}

//! Reading TIFF, through the `tiff` crate.
//!
//! The crate unpacks the samples; what they mean is told here, for it knows fewer kinds of colour than the format has. So it
//! is made to believe that all files are grey: then it hands on any number of samples as they are stored.
//!
//! [TIFF 6.0] Adobe Developers Association, "TIFF, Revision 6.0", 1992.

mod color;
mod samples;

use std::io::{BufRead, Cursor, Seek};

use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::tags::Tag;

use self::color::{Color, Tags};
use super::Probe;
use crate::ImageLimits;
use crate::error::Fault;
use crate::raster::{Orientation, Raster};

/// What a file of 4 bytes (TIFF) or 8 bytes (BigTIFF) an offset starts with.
pub(super) fn recognises(start: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| start.starts_with(*magic))
}

/// Bits of a sample, from one to sixty-four.
fn bits_per_sample<R: BufRead + Seek>(decoder: &mut Decoder<R>) -> Result<u32, Fault> {
    let bits = decoder.find_tag_unsigned_vec::<u32>(Tag::BitsPerSample).map_err(Fault::content)?;
    Ok(bits.and_then(|bits| bits.first().copied()).unwrap_or(1).clamp(1, 64))
}

/// The size of a picture by its header.
pub(super) fn probe(file: impl BufRead + Seek) -> Option<Probe> {
    let mut decoder = Decoder::new(file).ok()?;
    let (width, height) = decoder.dimensions().ok()?;
    let samples = decoder.find_tag_unsigned::<u64>(Tag::SamplesPerPixel).ok()?.unwrap_or(1);
    let bytes_per_pixel = samples * u64::from(bits_per_sample(&mut decoder).ok()?.div_ceil(8));
    Some(Probe { width: width.into(), height: height.into(), bytes_per_pixel })
}

pub(super) fn decode(bytes: &[u8], limits: &ImageLimits) -> Result<Raster, Fault> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(Fault::content)?;
    let (width, height) = decoder.dimensions().map_err(Fault::content)?;
    let tags = Tags::read(&mut decoder)?;
    let bits = bits_per_sample(&mut decoder)?;
    let samples = u64::from(tags.samples);
    limits.check(width.into(), height.into(), samples, u64::from(bits.div_ceil(8)))?;
    // The best of its compressions (deflate) packs a thousand bytes into one.
    let size = u64::from(width) * u64::from(height) * samples * u64::from(bits) / 8;
    if size / 1032 > bytes.len() as u64 {
        return Err(Fault::content(format!("{} bytes cannot hold {width} x {height} pixels", bytes.len())));
    }
    let color = Color::new(&tags, bits, &mut decoder)?;
    let orientation = decoder.find_tag_unsigned::<u16>(Tag::Orientation).map_err(Fault::content)?;
    drop(decoder);

    let (width, height) = (width as usize, height as usize);
    let stored = read_samples(as_grey(bytes)?, limits)?;
    let layout = samples::Layout { width, height, samples: usize::from(tags.samples), bits };
    let texels = samples::unpack(stored, &layout, tags.is_planar)?;
    let (channels, texels) = color.apply(texels, &layout);
    Ok(Raster::picture(width, height, channels, texels).oriented(orientation_of(orientation.unwrap_or(1))))
}

/// All samples: rows of whole bytes, plane after plane where there are planes.
fn read_samples(bytes: Vec<u8>, limits: &ImageLimits) -> Result<DecodingResult, Fault> {
    let most = usize::try_from(limits.max_bytes).unwrap_or(usize::MAX);
    let mut own = Limits::default();
    (own.decoding_buffer_size, own.intermediate_buffer_size) = (most, most);
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(Fault::content)?.with_limits(own);
    let mut result = DecodingResult::U8(Vec::new());
    let layout = decoder.read_image_to_buffer(&mut result).map_err(Fault::content)?;
    // The crate falls back to the first plane where all are too many.
    let read = result.as_buffer(0).byte_len();
    if read < layout.complete_len {
        return Err(Fault::content(format!("{read} of its {} bytes can be read", layout.complete_len)));
    }
    Ok(result)
}

/// The file with `PhotometricInterpretation` set to that of grey where zero is black.
fn as_grey(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let mut bytes = bytes.to_vec();
    let (at, is_long) = photometric(&bytes).ok_or_else(|| Fault::content("its directory is broken"))?;
    let is_little = bytes.starts_with(b"II");
    let value: &[u8] = match (is_little, is_long) {
        (true, false) => &[1, 0],
        (false, false) => &[0, 1],
        (true, true) => &[1, 0, 0, 0],
        (false, true) => &[0, 0, 0, 1],
    };
    let place = bytes.get_mut(at..at + value.len());
    place.ok_or_else(|| Fault::content("its directory is cut"))?.copy_from_slice(value);
    Ok(bytes)
}

/// Where the value of `PhotometricInterpretation` is in the first directory, and whether it has four bytes.
fn photometric(bytes: &[u8]) -> Option<(usize, bool)> {
    let is_little = bytes.starts_with(b"II");
    let number = |at: usize, size: usize| -> Option<usize> {
        let field = bytes.get(at..at.checked_add(size)?)?;
        let digit = |n: usize, &b: &u8| n << 8 | usize::from(b);
        Some(if is_little { field.iter().rev().fold(0, digit) } else { field.iter().fold(0, digit) })
    };
    let is_big = number(2, 2)? == 43;
    // Sizes of an offset, of the number of entries, and of an entry.
    let (offset, count, entry) = if is_big { (8, 8, 20) } else { (4, 2, 12) };
    let directory = number(if is_big { 8 } else { 4 }, offset)?;
    let first = directory.checked_add(count)?;
    let entries = (0..number(directory, count)?.min(1 << 16)).map(|i| first + i * entry);
    for at in entries {
        if number(at, 2)? == usize::from(Tag::PhotometricInterpretation.to_u16()) {
            return Some((at + 4 + offset, number(at + 2, 2)? == 4));
        }
    }
    None
}

/// Of the eight ways in which a picture may lie: where the first row and the first column are.
fn orientation_of(tag: u16) -> Orientation {
    let (transpose, flip_x, flip_y) = match tag {
        2 => (false, true, false),
        3 => (false, true, true),
        4 => (false, false, true),
        5 => (true, false, false),
        6 => (true, true, false),
        7 => (true, true, true),
        8 => (true, false, true),
        _ => (false, false, false),
    };
    Orientation { transpose, flip_x, flip_y }
}

#[cfg(test)]
mod tests;

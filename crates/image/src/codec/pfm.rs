//! Portable float maps: a header of three words and rows from bottom to top (P. Debevec's definition).

use std::io::Write;
use std::path::Path;

use crate::{Image, ImageError, ImageLimits};

pub(super) fn write(image: &Image, out: &mut impl Write) -> Result<(), ImageError> {
    let fail = |error: std::io::Error| ImageError::Encode { message: error.to_string() };
    write!(out, "PF\n{} {}\n-1.0\n", image.width(), image.height()).map_err(fail)?;
    let rgb = image.to_rgb();
    for row in rgb.chunks_exact(image.width().max(1)).rev() {
        let bytes: Vec<u8> = row.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        out.write_all(&bytes).map_err(fail)?;
    }
    Ok(())
}

pub(super) fn read(path: &Path, bytes: &[u8], limits: &ImageLimits) -> Result<Image, ImageError> {
    let bad = |message: &str| ImageError::Decode { path: path.to_owned(), message: message.to_owned() };
    let mut rest = bytes;
    let kind = word(&mut rest).ok_or_else(|| bad("the header ends early"))?;
    let width: u64 = number(&mut rest).ok_or_else(|| bad("the width is not a number"))?;
    let height: u64 = number(&mut rest).ok_or_else(|| bad("the height is not a number"))?;
    let scale: f32 = number(&mut rest).ok_or_else(|| bad("the scale is not a number"))?;
    limits.check(width, height)?;
    let (width, height) = (width as usize, height as usize);
    let channels = if kind == "PF" { 3 } else { 1 };
    if rest.len() / 4 / channels < width * height || width * height == 0 {
        return Err(bad("it has fewer pixels than its header says"));
    }
    let decode = |b: [u8; 4]| if scale < 0.0 { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) };
    let names: &[&str] = if channels == 3 { &["R", "G", "B"] } else { &["Y"] };
    let mut image = Image::new(width, height, names);
    let row_length = width * channels;
    for (y, row) in rest.chunks_exact(row_length * 4).take(height).enumerate() {
        let start = (height - 1 - y) * row_length;
        let target = &mut image.data_mut()[start..start + row_length];
        for (value, four) in target.iter_mut().zip(row.chunks_exact(4)) {
            *value = decode([four[0], four[1], four[2], four[3]]);
        }
    }
    Ok(image)
}

/// The next word and the one white-space character behind it.
fn word<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    let end = rest.iter().take(64).position(u8::is_ascii_whitespace)?;
    let (word, tail) = rest.split_at(end);
    *rest = &tail[1..];
    std::str::from_utf8(word).ok()
}

fn number<T: std::str::FromStr>(rest: &mut &[u8]) -> Option<T> {
    word(rest)?.parse().ok()
}

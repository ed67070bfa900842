//! Corners of faces.

use super::part::{Corner, MISSING};
use crate::mesh::lines::Notes;

/// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`. Indices count from one, or (negative) back from the latest of `counts`; those beyond
/// what there is so far may name something that comes later in the file.
pub(super) fn read<'a>(
    mut rest: &'a [u8],
    counts: [usize; 3],
    line: usize,
    notes: &mut Notes,
) -> Result<(Corner, &'a [u8]), String> {
    let mut corner = [MISSING; 3];
    for field in 0..3 {
        if let Some((index, after)) = integer(rest) {
            match resolve(index, counts[field]) {
                Some(found) => corner[field] = found,
                None if field == 0 => {
                    return Err(format!("index {index} points outside of the {} vertices", counts[0]));
                }
                None => {
                    let what = ["vertex", "texture coordinate", "normal"][field];
                    notes.add(&format!("an index points to no {what}: that corner has none"), Some(line));
                }
            }
            rest = after;
        }
        match rest.first() {
            Some(b'/') if field < 2 => rest = &rest[1..],
            _ => break,
        }
    }
    let ends = rest.first().is_none_or(u8::is_ascii_whitespace);
    if !ends || corner[0] == MISSING {
        let word = rest.split(u8::is_ascii_whitespace).next().unwrap_or(rest);
        return Err(format!("cannot understand `{}` in a face", String::from_utf8_lossy(word)));
    }
    Ok((corner, rest))
}

/// Turns an index that counts from one, or from the end, into one that counts from zero.
fn resolve(index: i64, count: usize) -> Option<u32> {
    let found = if index < 0 { index + count as i64 } else { index - 1 };
    u32::try_from(found).ok().filter(|&found| found <= i32::MAX as u32)
}

fn integer(bytes: &[u8]) -> Option<(i64, &[u8])> {
    let negative = bytes.first() == Some(&b'-');
    let digits = if negative { &bytes[1..] } else { bytes };
    let length = digits.iter().take_while(|b| b.is_ascii_digit()).count();
    if length == 0 {
        return None;
    }
    // Saturation is enough: an index that long is refused by its caller.
    let value = digits[..length]
        .iter()
        .fold(0i64, |sum, b| sum.saturating_mul(10).saturating_add(i64::from(b - b'0')));
    Some((if negative { -value } else { value }, &digits[length..]))
}

/// The number of a smoothing group, which a file may call by any; 0 for none.
pub(super) fn smoothing_group(rest: &[u8]) -> u32 {
    match rest.trim_ascii() {
        b"off" | b"" => 0,
        word => integer(word).map_or(1, |(number, _)| u32::try_from(number).unwrap_or(1)),
    }
}

/// The largest index into a list, and the line where it is: indices may run ahead of their list, but not beyond its end.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Farthest {
    /// One more than the index.
    count: usize,
    line: usize,
}

impl Farthest {
    #[inline]
    pub(super) fn see(&mut self, index: u32, line: usize) {
        if index != MISSING && index as usize >= self.count {
            *self = Self { count: index as usize + 1, line };
        }
    }

    /// Whether all indices are within a list of so many.
    pub(super) fn check(&self, what: &str, count: usize) -> Result<(), String> {
        if self.count <= count {
            return Ok(());
        }
        Err(format!("line {}: index {} points outside of the {count} {what}", self.line, self.count))
    }
}

//! RGL's tensor files: named arrays of numbers.
//!
//! `tensor_file` and a zero byte, the version (two bytes: 1, 0), the number of fields (32 bits); for each field the length of
//! its name (16 bits), the name, the number of dimensions (16 bits), the type (a byte), the offset of its data (64 bits),
//! and the dimensions (64 bits each). All is little-endian.

use std::sync::Arc;

use aureole_desc::Limits;

use crate::mesh::MeshError;
use crate::mesh::error::check_count;

const MAGIC: &[u8; 12] = b"tensor_file\0";

/// A field.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tensor {
    pub shape: Vec<u64>,
    pub values: Arc<[f32]>,
}

/// Whether a file says that it is a tensor file.
pub(super) fn is_tensor_file(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Bytes that are taken one after the other.
struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], MeshError> {
        let (taken, rest) =
            self.bytes.split_at_checked(count).ok_or_else(|| MeshError::content("the header is cut off"))?;
        self.bytes = rest;
        Ok(taken)
    }

    fn number(&mut self, bytes: usize) -> Result<u64, MeshError> {
        Ok(self.take(bytes)?.iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }
}

/// Reads all fields of bytes and of floats of 32 or 64 bits; others are left out.
pub(super) fn decode(bytes: &[u8], limits: &Limits) -> Result<Vec<(String, Tensor)>, MeshError> {
    let mut reader = Reader { bytes };
    reader.take(MAGIC.len())?;
    if reader.number(2)? != 1 {
        return Err(MeshError::content("not a tensor file of version 1.0"));
    }
    let count = reader.number(4)?;
    let mut fields = Vec::new();
    let mut used = 0;
    for _ in 0..count {
        let length = reader.number(2)? as usize;
        let name = String::from_utf8_lossy(reader.take(length)?).into_owned();
        let dimensions = reader.number(2)?;
        let kind = reader.number(1)?;
        let offset = reader.number(8)?;
        let shape = (0..dimensions).map(|_| reader.number(8)).collect::<Result<Vec<u64>, _>>()?;
        let size = match kind {
            1 => 1,
            10 => 4,
            11 => 8,
            _ => continue,
        };
        let total = shape.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
        let total = check_count("values", total.unwrap_or(u64::MAX), limits)?;
        let data = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..));
        let data = data.and_then(|data| data.get(..total.checked_mul(size)?));
        let data = data.ok_or_else(|| MeshError::content(format!("the field `{name}` is cut off")))?;
        // Fields that share their bytes could make any amount of memory of a small file.
        used += data.len();
        if used > bytes.len() {
            return Err(MeshError::content("the fields overlap"));
        }
        fields.push((name, Tensor { shape, values: floats(data, size) }));
    }
    Ok(fields)
}

fn floats(data: &[u8], size: usize) -> Arc<[f32]> {
    let number = |b: &[u8]| match *b {
        [a] => f32::from(a),
        [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
        [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]) as f32,
        _ => 0.0,
    };
    data.chunks_exact(size).map(number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One field of two rows.
    fn example(columns: u64) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([1, 0]);
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend(3_u16.to_le_bytes());
        bytes.extend(b"ndf");
        bytes.extend(2_u16.to_le_bytes());
        bytes.push(10);
        let offset = bytes.len() as u64 + 8 + 16;
        bytes.extend(offset.to_le_bytes());
        bytes.extend([2, columns].iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend((0..2 * columns).flat_map(|i| (i as f32).to_le_bytes()));
        bytes
    }

    #[test]
    fn fields_read() {
        let fields = decode(&example(3), &Limits::default()).unwrap();
        assert_eq!(fields[0].0, "ndf");
        assert_eq!(fields[0].1.shape, [2, 3]);
        assert_eq!(&fields[0].1.values[..], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn fields_that_share_their_bytes_are_refused() {
        let once = example(300);
        let (header, data) = once.split_at(once.len() - 2400);
        let field = &header[MAGIC.len() + 6..];
        let bytes = [&header[..MAGIC.len() + 2], &9_u32.to_le_bytes()[..], &field.repeat(9), data].concat();
        assert_eq!(decode(&bytes, &Limits::default()).unwrap_err().to_string(), "the fields overlap");
    }

    #[test]
    fn broken_files_are_refused() {
        let whole = example(3);
        for end in MAGIC.len()..whole.len() {
            assert!(decode(&whole[..end], &Limits::default()).is_err(), "{end}");
        }
        let mut huge = whole.clone();
        let shape = whole.len() - 24 - 16;
        huge[shape..shape + 16].fill(0xff);
        assert!(matches!(decode(&huge, &Limits::default()), Err(MeshError::Limit { .. })));
    }
}

//! Mitsuba's grid volumes (`.vol`): numbers on a regular grid.
//!
//! `VOL`, version 3 (one byte), encoding 1 = 32-bit floats, the resolution in x, y and z, the number of channels (32 bits
//! each), a bounding box (six floats), then the values, channel fastest, then x. All is little-endian.

use std::path::Path;
use std::sync::Arc;

use aureole_desc::{Limits, SceneError, Span};

use crate::file;
use crate::mesh::MeshError;
use crate::mesh::error::check_count;

/// A grid of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Points along x, y and z.
    pub resolution: [usize; 3],
    /// Values per point.
    pub channels: usize,
    /// The box that the grid fills: its lowest and highest corner.
    pub bounds: [[f32; 3]; 2],
    /// The values.
    pub values: Arc<[f32]>,
}

/// Reads a grid.
///
/// # Errors
/// A file that cannot be read, is malformed, or shorter than its resolution says.
pub fn read(path: &Path, limits: &Limits, at: Span) -> Result<Grid, SceneError> {
    let bytes = file::read_bytes(path, limits, at)?;
    decode(&bytes, limits).map_err(|error| error.in_file(path, at))
}

/// Reads a grid from memory.
///
/// # Errors
/// As [`read`].
pub fn decode(bytes: &[u8], limits: &Limits) -> Result<Grid, MeshError> {
    const HEADER: usize = 48;
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return Err(MeshError::content("not a grid volume: the header is cut off"));
    };
    if !header.starts_with(b"VOL\x03") {
        return Err(MeshError::content("not a grid volume of version 3"));
    }
    let word = |i: usize| [header[4 * i], header[4 * i + 1], header[4 * i + 2], header[4 * i + 3]];
    let encoding = i32::from_le_bytes(word(1));
    if encoding != 1 {
        return Err(MeshError::content(format!(
            "encoding {encoding} of grid volumes is not supported, only 1 (float32)"
        )));
    }
    let [x, y, z, channels] = [2, 3, 4, 5].map(|i| u64::from(u32::from_le_bytes(word(i))));
    let count = [x, y, z, channels].iter().try_fold(1u64, |product, &n| product.checked_mul(n));
    let count = check_count("values", count.unwrap_or(u64::MAX), limits)?;
    if count == 0 || body.len() / 4 < count {
        let found = body.len() / 4;
        return Err(MeshError::content(format!("{x}×{y}×{z}×{channels} values expected, found {found}")));
    }
    let bounds = [6, 9].map(|first| [0, 1, 2].map(|axis| f32::from_le_bytes(word(first + axis))));
    let values: Arc<[f32]> =
        body.chunks_exact(4).take(count).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    if let Some(i) = values.iter().position(|value| !value.is_finite()) {
        return Err(MeshError::content(format!(
            "value {} of {count} is {}, not a finite number",
            i + 1,
            values[i]
        )));
    }
    Ok(Grid { resolution: [x, y, z].map(|n| n as usize), channels: channels as usize, bounds, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        bytes.extend([1i32, 2, 1, 3, 1].iter().flat_map(|n| n.to_le_bytes()));
        bytes.extend([0.0f32, 0.0, 0.0, 1.0, 2.0, 3.0].iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend((0..6).flat_map(|i| (i as f32).to_le_bytes()));
        bytes
    }

    #[test]
    fn a_grid_reads() {
        let grid = decode(&example(), &Limits::default()).unwrap();
        assert_eq!((grid.resolution, grid.channels), ([2, 1, 3], 1));
        assert_eq!(grid.bounds, [[0.0; 3], [1.0, 2.0, 3.0]]);
        assert_eq!(&grid.values[..], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    #[test]
    fn broken_grids_are_refused() {
        let whole = example();
        for end in 0..whole.len() {
            assert!(decode(&whole[..end], &Limits::default()).is_err());
        }
        let mut huge = whole.clone();
        huge[8..24].fill(0xff);
        let error = decode(&huge, &Limits::default()).unwrap_err();
        assert!(matches!(error, MeshError::Limit { .. }), "{error}");
    }
}

//! Samples as the crate delivers them, as interleaved texels.

use ::tiff::decoder::DecodingResult;
use exr::prelude::f16;

use crate::error::Fault;
use crate::raster::Texels;

/// How samples lie in a file.
pub(super) struct Layout {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Samples of a pixel.
    pub(super) samples: usize,
    /// Bits of a sample.
    pub(super) bits: u32,
}

/// Interleaved samples. Those below eight bits stay the numbers that they are; signed and wide whole numbers become words.
pub(super) fn unpack(stored: DecodingResult, layout: &Layout, is_planar: bool) -> Result<Texels, Fault> {
    let word = |share: f64| (share.clamp(0.0, 1.0) * f64::from(u16::MAX)).round() as u16;
    let texels = match stored {
        DecodingResult::U8(data) if layout.bits < 8 => Texels::Bytes(small(&data, layout, is_planar)),
        DecodingResult::U8(data) => Texels::Bytes(data),
        DecodingResult::U16(data) => Texels::Words(data),
        DecodingResult::U32(data) => Texels::Words(data.into_iter().map(|x| (x >> 16) as u16).collect()),
        DecodingResult::U64(data) => Texels::Words(data.into_iter().map(|x| (x >> 48) as u16).collect()),
        DecodingResult::F16(data) => {
            Texels::Halves(data.into_iter().map(|x| f16::from_bits(x.to_bits())).collect())
        }
        DecodingResult::F32(data) => Texels::Floats(data),
        DecodingResult::F64(data) => Texels::Floats(data.into_iter().map(|x| x as f32).collect()),
        DecodingResult::I8(data) => {
            Texels::Words(data.into_iter().map(|x| word(f64::from(x) / f64::from(i8::MAX))).collect())
        }
        DecodingResult::I16(data) => {
            Texels::Words(data.into_iter().map(|x| word(f64::from(x) / f64::from(i16::MAX))).collect())
        }
        DecodingResult::I32(data) => {
            Texels::Words(data.into_iter().map(|x| word(f64::from(x) / f64::from(i32::MAX))).collect())
        }
        DecodingResult::I64(data) => {
            Texels::Words(data.into_iter().map(|x| word(x as f64 / i64::MAX as f64)).collect())
        }
    };
    let size = layout.width * layout.height * layout.samples;
    if texels.len() < size {
        return Err(Fault::content(format!("it has {} of {size} samples", texels.len())));
    }
    Ok(if is_planar { texels.interleaved(layout.width * layout.height, layout.samples) } else { texels })
}

/// Samples of one, two or four bits, one a byte. Each row starts with a byte of its own.
fn small(packed: &[u8], layout: &Layout, is_planar: bool) -> Vec<u8> {
    let (across, planes) =
        if is_planar { (layout.width, layout.samples) } else { (layout.width * layout.samples, 1) };
    let bits = layout.bits as usize;
    let mask = (1_u16 << bits) - 1;
    let rows = packed.chunks_exact((across * bits).div_ceil(8).max(1)).take(layout.height * planes);
    let sample = |row: &[u8], i: usize| {
        // A sample of three bits may begin in one byte and end in the next.
        let bit = i * bits;
        let pair = u16::from_be_bytes([row[bit / 8], row.get(bit / 8 + 1).copied().unwrap_or(0)]);
        (pair >> (16 - bits - bit % 8) & mask) as u8
    };
    rows.flat_map(|row| (0..across).map(move |i| sample(row, i))).collect()
}

//! Portable pixel maps (P6): a line of text and the bytes. Reading is in `common`.

use super::{BitDepth, WriteOptions};
use crate::Image;

/// P6 with 8 or 16 bits (the high byte first) a value; alpha is dropped.
pub(super) fn encode(image: &Image, options: &WriteOptions) -> Result<Vec<u8>, String> {
    let (bytes, white) = match options.bit_depth {
        BitDepth::Eight => (options.tone.to_bytes(image), u16::from(u8::MAX)),
        BitDepth::Sixteen => {
            (options.tone.to_words(image).into_iter().flat_map(u16::to_be_bytes).collect(), u16::MAX)
        }
    };
    let mut out = format!("P6\n{} {}\n{white}\n", image.width(), image.height()).into_bytes();
    out.extend(bytes);
    Ok(out)
}

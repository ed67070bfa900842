//! MERL's files: three counts (32 bits), then a table of doubles for each of red, green and blue. Little-endian.

use std::sync::Arc;

use aureole_desc::{Limits, Params, Span, Value};

use crate::mesh::MeshError;
use crate::mesh::error::check_count;

/// What the database's numbers are multiplied by to be reflectances.
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Reads a reflectance.
pub(super) fn decode(bytes: &[u8], limits: &Limits) -> Result<Params, MeshError> {
    const HEADER: usize = 12;
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        return Err(MeshError::content("neither a tensor file nor one of MERL's: the header is cut off"));
    };
    let count = |i: usize| {
        i32::from_le_bytes([header[4 * i], header[4 * i + 1], header[4 * i + 2], header[4 * i + 3]])
    };
    let size = [count(0), count(1), count(2)];
    if size.iter().any(|&n| n <= 0) {
        return Err(MeshError::content("neither a tensor file nor one of MERL's"));
    }
    let plane = size.iter().try_fold(1_u64, |product, &n| product.checked_mul(n as u64));
    let total = plane.and_then(|plane| plane.checked_mul(3)).unwrap_or(u64::MAX);
    let total = check_count("values", total, limits)?;
    if body.len() / 8 < total {
        return Err(MeshError::content(format!("{total} values expected, found {}", body.len() / 8)));
    }
    let number = |(i, b): (usize, &[u8])| {
        let value = <[u8; 8]>::try_from(b).map_or(0.0, f64::from_le_bytes);
        (value * SCALE[i / (total / 3)]).max(0.0) as f32
    };
    let values: Arc<[f32]> = body.chunks_exact(8).take(total).enumerate().map(number).collect();
    let mut params = Params::new();
    params.push("values", Value::Floats(values), Span::NONE);
    params.push("size", Value::Ints(size.into()), Span::NONE);
    Ok(params)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_read_and_broken_ones_are_refused() {
        let mut bytes: Vec<u8> = [1_i32, 2, 1].iter().flat_map(|n| n.to_le_bytes()).collect();
        bytes.extend([1500.0_f64, -1.0, 0.0, 0.0, 0.0, 1500.0].iter().flat_map(|x| x.to_le_bytes()));
        let params = decode(&bytes, &Limits::default()).unwrap();
        let Some(Value::Floats(values)) = params.get("values") else { panic!("no values") };
        assert_eq!(&values[..], [1.0, 0.0, 0.0, 0.0, 0.0, 1.66]);
        for end in 0..bytes.len() {
            assert!(decode(&bytes[..end], &Limits::default()).is_err(), "{end}");
        }
        bytes[0..12].fill(0x7f);
        assert!(matches!(decode(&bytes, &Limits::default()), Err(MeshError::Limit { .. })));
    }
}

//! Colours as files write them.

/// The value of full colour: 1, or where colours are whole numbers beyond that, the largest of 8 bits, of 16 bits, or of their type.
pub(crate) fn span(values: impl Iterator<Item = f32>, largest: f32) -> f32 {
    let mut most = 0.0_f32;
    for value in values.filter(|value| !value.is_nan()) {
        if value.fract() != 0.0 || value.is_infinite() {
            return 1.0;
        }
        most = most.max(value);
    }
    match most {
        ..=1.0 => 1.0,
        ..=255.0 => 255.0,
        ..=65_535.0 => 65_535.0,
        _ => largest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_bytes_and_fractions_are_fractions() {
        let of = |values: &[f32]| span(values.iter().copied(), 1e9);
        assert_eq!(of(&[0.0, 1.0, f32::NAN]), 1.0);
        assert_eq!(of(&[0.25, 2.0]), 1.0, "brighter than white");
        assert_eq!(of(&[0.0, 2.0]), 255.0);
        assert_eq!(of(&[255.0, 256.0]), 65_535.0);
        assert_eq!(of(&[0.0, 65_536.0]), 1e9);
    }
}

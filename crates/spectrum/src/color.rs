//! Colour spaces: linear Rec. 709 (sRGB primaries, D65 white), CIE XYZ, and the sRGB transfer curve.

/// Relative luminance of a linear Rec. 709 colour (ITU-R BT.709).
#[inline]
pub fn luminance([r, g, b]: [f32; 3]) -> f32 {
    0.212671 * r + 0.715160 * g + 0.072169 * b
}

/// Linear Rec. 709 to CIE XYZ (ITU-R BT.709 primaries, D65 white).
pub fn xyz_from_srgb([r, g, b]: [f32; 3]) -> [f32; 3] {
    [
        0.412453 * r + 0.357580 * g + 0.180423 * b,
        0.212671 * r + 0.715160 * g + 0.072169 * b,
        0.019334 * r + 0.119193 * g + 0.950227 * b,
    ]
}

/// CIE XYZ to linear Rec. 709.
pub fn srgb_from_xyz([x, y, z]: [f32; 3]) -> [f32; 3] {
    [
        3.240479 * x - 1.53715 * y - 0.498535 * z,
        -0.969256 * x + 1.875991 * y + 0.041556 * z,
        0.055648 * x - 0.204043 * y + 1.057311 * z,
    ]
}

/// The sRGB transfer curve, linear to encoded (IEC 61966-2-1). Values below zero give zero.
#[inline]
pub fn srgb_from_linear(x: f32) -> f32 {
    if x <= 0.0031308 { 12.92 * x.max(0.0) } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

/// The sRGB transfer curve, encoded to linear (IEC 61966-2-1).
#[inline]
pub fn srgb_to_linear(x: f32) -> f32 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_matrices_are_inverses() {
        for rgb in [[1.0, 0.0, 0.0], [0.2, 0.7, 0.1], [1.0, 1.0, 1.0]] {
            let back = srgb_from_xyz(xyz_from_srgb(rgb));
            for c in 0..3 {
                assert!((back[c] - rgb[c]).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn the_transfer_curve_round_trips() {
        for i in 0..=255 {
            let x = i as f32 / 255.0;
            assert!((srgb_from_linear(srgb_to_linear(x)) - x).abs() < 1e-5);
        }
    }
}

//! The filmic curve of Uncharted 2.
//!
//! [Hable 2010] J. Hable, "Filmic Tonemapping Operators" and "Uncharted 2: HDR Lighting" (GDC 2010).

/// Shoulder strength, linear strength, linear angle, toe strength, toe numerator, toe denominator (Hable's A to F).
const A: f32 = 0.15;
const B: f32 = 0.50;
const C: f32 = 0.10;
const D: f32 = 0.20;
const E: f32 = 0.02;
const F: f32 = 0.30;
/// The linear value that becomes white.
const WHITE: f32 = 11.2;
/// Hable's exposure bias, which brings middle grey back to where it was.
const EXPOSURE_BIAS: f32 = 2.0;

fn curve(x: f32) -> f32 {
    ((x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F)) - E / F
}

/// Exposed linear colours to linear display colours in [0, 1].
pub(super) fn tone(rgb: [f32; 3]) -> [f32; 3] {
    let white = curve(WHITE);
    // Beyond white nothing changes; the bound keeps the squares finite.
    rgb.map(|x| (curve((EXPOSURE_BIAS * x).min(WHITE)) / white).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_and_white_keep_their_places() {
        assert!(tone([0.0; 3])[0].abs() < 1e-6);
        assert_eq!(tone([WHITE / EXPOSURE_BIAS, 1e30, 100.0]), [1.0; 3]);
        assert!((0.1..0.25).contains(&tone([0.18; 3])[0]));
    }
}

//! `ColorSpace`: the primaries that colours are given in, and the way from there to linear Rec. 709.
//!
//! References: ITU-R BT.709 and BT.2020; SMPTE EG 432-1 (P3 with the white of D65); SMPTE ST 2065-1 (ACES).

use aureole_spectrum::{Primaries, WhitePoint};

/// The spaces that the file format names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum ColorSpace {
    #[default]
    Srgb,
    DciP3,
    Rec2020,
    Aces2065,
}

/// Their names, for "did you mean".
pub(super) const NAMES: [&str; 4] = ["aces2065-1", "dci-p3", "rec2020", "srgb"];

/// Whites by their chromaticity x, y.
const D65: [f64; 2] = Primaries::REC709.white;
const D60: [f64; 2] = [0.32168, 0.33767];

impl ColorSpace {
    /// A space by its name; capitals do not count.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name.to_ascii_lowercase().as_str() {
            "srgb" => Self::Srgb,
            "dci-p3" => Self::DciP3,
            "rec2020" => Self::Rec2020,
            "aces2065-1" => Self::Aces2065,
            _ => return None,
        })
    }

    fn primaries(self) -> Primaries {
        let (colors, white) = match self {
            Self::Srgb => return Primaries::REC709,
            Self::DciP3 => ([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], D65),
            Self::Rec2020 => ([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], D65),
            Self::Aces2065 => ([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]], D60),
        };
        Primaries { colors, white }
    }

    /// The colour of light: equal numbers are the space's own white. What no mixture of our primaries gives is cut off.
    pub(super) fn light(self, rgb: [f32; 3]) -> [f32; 3] {
        if self == Self::Srgb { rgb } else { self.convert(rgb, WhitePoint::Keep) }
    }

    /// The colour of a surface, or another quantity: equal numbers stay equal.
    pub(super) fn surface(self, rgb: [f32; 3]) -> [f32; 3] {
        if self == Self::Srgb { rgb } else { self.convert(rgb, WhitePoint::Adapt) }
    }

    fn convert(self, rgb: [f32; 3], white: WhitePoint) -> [f32; 3] {
        let matrix = self.primaries().to_rec709(white).expect("these are spaces (tested)");
        matrix.map(|row| row.iter().zip(rgb).map(|(m, x)| m * f64::from(x)).sum::<f64>().max(0.0) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f32; 3], b: [f32; 3]) -> bool {
        (0..3).all(|i| (a[i] - b[i]).abs() < 2e-3)
    }

    #[test]
    fn white_stays_white_and_primaries_are_known() {
        for name in NAMES {
            let space = ColorSpace::named(name).unwrap();
            assert!(near(space.surface([0.5; 3]), [0.5; 3]), "{name}");
            // The computed way through XYZ is the identity for our own primaries.
            assert!(near(ColorSpace::Srgb.convert([0.2, 0.5, 0.7], WhitePoint::Adapt), [0.2, 0.5, 0.7]));
        }
        assert!(ColorSpace::named("Rec2020").is_some() && ColorSpace::named("adobe").is_none());
        // ITU-R BT.2087: Rec. 2020 into Rec. 709.
        let rec2020 = |rgb| ColorSpace::Rec2020.light(rgb);
        assert!(near(rec2020([1.0, 0.5, 0.5]), [1.3302, 0.4377, 0.4909]));
        assert!(near(ColorSpace::DciP3.light([0.5, 1.0, 0.5]), [0.3875, 1.0211, 0.4607]));
    }

    /// The white of ACES is redder than ours as light, and white as paint.
    #[test]
    fn whites_differ_in_light_only() {
        let [r, g, b] = ColorSpace::Aces2065.light([1.0; 3]);
        assert!(r > 1.01 && b < 0.95 && (g - 1.0).abs() < 0.02, "{r} {g} {b}");
        assert!(near(ColorSpace::Aces2065.surface([1.0; 3]), [1.0; 3]));
    }
}

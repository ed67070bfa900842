//! `ColorSpace`: the primaries that colours are given in, and the way from there to linear Rec. 709.
//!
//! References: ITU-R BT.709 and BT.2020; SMPTE EG 432-1 (P3 with the white of D65); SMPTE ST 2065-1 (ACES);
//! [Lam 1985] for the Bradford transform, by which neutral colours stay neutral where whites differ.

use aureole_spectrum::srgb_from_xyz;

type Matrix = [[f64; 3]; 3];

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
const D65: [f64; 2] = [0.3127, 0.3290];
const D60: [f64; 2] = [0.32168, 0.33767];

/// From XYZ to the responses of cones that are adapted one by one.
const BRADFORD: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

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

    /// Chromaticities of red, green and blue, and of white.
    fn primaries(self) -> ([[f64; 2]; 3], [f64; 2]) {
        match self {
            Self::Srgb => ([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], D65),
            Self::DciP3 => ([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]], D65),
            Self::Rec2020 => ([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], D65),
            Self::Aces2065 => ([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]], D60),
        }
    }

    /// The colour of light: equal numbers are the space's own white. What no mixture of our primaries gives is cut off.
    pub(super) fn light(self, rgb: [f32; 3]) -> [f32; 3] {
        if self == Self::Srgb { rgb } else { self.convert(rgb, false) }
    }

    /// The colour of a surface, or another quantity: equal numbers stay equal.
    pub(super) fn surface(self, rgb: [f32; 3]) -> [f32; 3] {
        if self == Self::Srgb { rgb } else { self.convert(rgb, true) }
    }

    fn convert(self, rgb: [f32; 3], keep_neutral: bool) -> [f32; 3] {
        let (primaries, white) = self.primaries();
        let mut xyz = apply(&to_xyz(primaries, white), rgb.map(f64::from));
        if keep_neutral && white != D65 {
            let cones = |xyz| apply(&BRADFORD, xyz);
            let (from, to) = (cones(xyz_of(white)), cones(xyz_of(D65)));
            let seen = cones(xyz);
            xyz = apply(&inverse(&BRADFORD), std::array::from_fn(|i| seen[i] * to[i] / from[i]));
        }
        srgb_from_xyz(xyz.map(|x| x as f32)).map(|c| c.max(0.0))
    }
}

/// The colour of a chromaticity at luminance one.
fn xyz_of([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// The matrix whose columns are the primaries, as bright as they must be for their sum to be white.
fn to_xyz(primaries: [[f64; 2]; 3], white: [f64; 2]) -> Matrix {
    let columns = primaries.map(|[x, y]| [x, y, 1.0 - x - y]);
    let matrix: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
    let share = apply(&inverse(&matrix), xyz_of(white));
    matrix.map(|row| std::array::from_fn(|j| row[j] * share[j]))
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// By cofactors.
fn inverse(m: &Matrix) -> Matrix {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant))
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
            assert!(near(ColorSpace::Srgb.convert([0.2, 0.5, 0.7], true), [0.2, 0.5, 0.7]));
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

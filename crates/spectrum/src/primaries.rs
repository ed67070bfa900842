//! Spaces of red, green and blue by their chromaticities, and the way from there to linear Rec. 709.
//!
//! References: ITU-R BT.709; [Lam 1985] for the Bradford transform, by which neutral colours stay neutral where whites differ.

/// A matrix by rows.
type Matrix = [[f64; 3]; 3];

/// The chromaticities x, y of a space's primaries and of its white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries {
    /// Of red, green and blue.
    pub colors: [[f64; 2]; 3],
    /// Of equal parts of all three.
    pub white: [f64; 2],
}

/// What becomes of a white that is not that of Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhitePoint {
    /// It stays the colour that it is: for light.
    Keep,
    /// It becomes our white, as eyes take it that are used to it: for surfaces and pictures.
    Adapt,
}

/// From XYZ to the responses of cones that are adapted one by one.
const BRADFORD: Matrix = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

impl Primaries {
    /// ITU-R BT.709, with the white of D65.
    pub const REC709: Self =
        Self { colors: [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06]], white: [0.3127, 0.3290] };
    /// CIE XYZ as if it were a space of colours, with the white of equal energy.
    pub const XYZ: Self = Self { colors: [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], white: [1.0 / 3.0; 2] };

    /// Whether these are another's, up to the digits that files give.
    pub fn is_near(&self, other: &Self) -> bool {
        let pairs = self.colors.iter().zip(&other.colors).chain([(&self.white, &other.white)]);
        pairs.flat_map(|(a, b)| a.iter().zip(b)).all(|(a, b)| (a - b).abs() < 2e-3)
    }

    /// How much of a colour's luminance is its red, green and blue; `None` as for [`to_rec709`](Self::to_rec709).
    pub fn luminance(&self) -> Option<[f64; 3]> {
        self.to_xyz().map(|rows| rows[1])
    }

    /// The matrix from this space to linear Rec. 709; `None` where three such primaries do not make such a white.
    pub fn to_rec709(&self, white: WhitePoint) -> Option<[[f64; 3]; 3]> {
        let mut matrix = self.to_xyz()?;
        if white == WhitePoint::Adapt {
            let cones = |white| apply(&BRADFORD, xyz_of(white));
            let (from, to) = (cones(self.white), cones(Self::REC709.white));
            let bradford = multiply(&BRADFORD, &matrix);
            let adapted = std::array::from_fn(|i| bradford[i].map(|x| x * to[i] / from[i]));
            matrix = multiply(&inverse(&BRADFORD)?, &adapted);
        }
        let matrix = multiply(&inverse(&Self::REC709.to_xyz()?)?, &matrix);
        matrix.as_flattened().iter().all(|x| x.is_finite()).then_some(matrix)
    }

    /// The matrix whose columns are the primaries, as bright as they must be for their sum to be white.
    fn to_xyz(self) -> Option<Matrix> {
        let columns = self.colors.map(|[x, y]| [x, y, 1.0 - x - y]);
        let matrix: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]));
        let share = apply(&inverse(&matrix)?, xyz_of(self.white));
        let scaled = matrix.map(|row| std::array::from_fn(|j| row[j] * share[j]));
        scaled.as_flattened().iter().all(|x| x.is_finite()).then_some(scaled)
    }
}

/// The colour of a chromaticity at luminance one.
fn xyz_of([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn multiply(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| std::array::from_fn(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

/// By cofactors; `None` for a matrix that has none, or hardly one.
fn inverse(m: &Matrix) -> Option<Matrix> {
    let minor = |i: usize, j: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    let is_usable = determinant.is_finite() && determinant.abs() > 1e-9;
    is_usable.then(|| std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const REC2020: Primaries =
        Primaries { colors: [[0.708, 0.292], [0.17, 0.797], [0.131, 0.046]], white: [0.3127, 0.3290] };
    const ACESCG: Primaries =
        Primaries { colors: [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044]], white: [0.32168, 0.33767] };

    fn assert_near(found: [f64; 3], expected: [f64; 3]) {
        assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-3), "{found:?}, not {expected:?}");
    }

    /// ITU-R BT.2087 for Rec. 2020; the published matrix from ACEScg (AP1, D60) to Rec. 709 with Bradford.
    #[test]
    fn matrices_are_those_that_are_published() {
        let rec2020 = REC2020.to_rec709(WhitePoint::Keep).unwrap();
        assert_near(rec2020[0], [1.6605, -0.5876, -0.0728]);
        assert_near(rec2020[1], [-0.1246, 1.1329, -0.0083]);
        assert_near(rec2020[2], [-0.0182, -0.1006, 1.1187]);
        let acescg = ACESCG.to_rec709(WhitePoint::Adapt).unwrap();
        assert_near(acescg[0], [1.7051, -0.6218, -0.0833]);
        assert_near(acescg[1], [-0.1303, 1.1408, -0.0105]);
        assert_near(acescg[2], [-0.0240, -0.1290, 1.1530]);
    }

    #[test]
    fn white_stays_white_or_is_kept() {
        for space in [Primaries::REC709, REC2020, ACESCG, Primaries::XYZ] {
            assert_near(apply(&space.to_rec709(WhitePoint::Adapt).unwrap(), [0.5; 3]), [0.5; 3]);
            assert!((space.luminance().unwrap().iter().sum::<f64>() - 1.0).abs() < 1e-9);
        }
        let [r, _, b] = apply(&ACESCG.to_rec709(WhitePoint::Keep).unwrap(), [1.0; 3]);
        assert!(r > 1.01 && b < 0.95, "{r} {b}");
        assert_near(Primaries::REC709.luminance().unwrap(), [0.2126, 0.7152, 0.0722]);
    }

    #[test]
    fn primaries_that_make_no_space_are_refused() {
        let [r, g, _] = Primaries::REC709.colors;
        let white = Primaries::REC709.white;
        for bad in [
            Primaries { colors: [r, g, g], white },
            Primaries { white: [0.3, 0.0], ..Primaries::REC709 },
            Primaries { colors: [[f64::NAN; 2], r, g], white },
        ] {
            assert_eq!(bad.to_rec709(WhitePoint::Adapt), None, "{bad:?}");
        }
    }
}

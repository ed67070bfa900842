//! The AgX picture formation.
//!
//! [Sobotka 2022] T. Sobotka, "AgX", an OpenColorIO configuration; the base look. The sixth-degree polynomial that stands for
//! its contrast curve, and the matrices for Rec. 709 primaries, are those of [Wrensch 2023] B. Wrensch,
//! "Minimal AgX Implementation".

use super::transform;

/// Rec. 709 to AgX's narrowed primaries, by rows.
const INSET: [[f32; 3]; 3] = [
    [0.842_479_06, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_64, 0.079_166_13],
    [0.042_375_654, 0.078_433_6, 0.879_143],
];
/// The way back.
const OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];
/// The range of the logarithmic encoding, in stops.
const MIN_EV: f32 = -12.473_93;
const MAX_EV: f32 = 4.026_069;

fn contrast(x: f32) -> f32 {
    const COEFFICIENTS: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];
    COEFFICIENTS.iter().fold(0.0, |sum, c| sum * x + c)
}

/// Exposed linear colours to display values in [0, 1].
///
/// The curve's output is already encoded for a display, so no transfer curve follows.
pub(super) fn tone(rgb: [f32; 3]) -> [f32; 3] {
    let stops = transform(INSET, rgb).map(|x| x.max(1e-10).log2().clamp(MIN_EV, MAX_EV));
    let encoded = stops.map(|ev| contrast((ev - MIN_EV) / (MAX_EV - MIN_EV)));
    transform(OUTSET, encoded).map(|x| x.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greys_stay_grey_and_the_matrices_are_inverses() {
        let [r, g, b] = tone([0.18; 3]);
        assert!((r - g).abs() < 2e-3 && (g - b).abs() < 2e-3);
        // The contrast curve turns about middle grey, which a display of power 2.4 shows as such.
        assert!((g - 0.18_f32.powf(1.0 / 2.4)).abs() < 0.01, "{g}");
        let back = transform(OUTSET, transform(INSET, [0.3, 0.6, 0.1]));
        for (x, y) in back.into_iter().zip([0.3, 0.6, 0.1]) {
            assert!((x - y).abs() < 1e-3);
        }
    }
}

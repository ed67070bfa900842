//! The colour spaces of the metric.

use aureole_spectrum::srgb_to_linear;

use crate::ToneMapping;

/// Linear Rec. 709 to XYZ, by rows, and back: the unrounded numbers that the metric was published with.
const XYZ_FROM_RGB: [[f32; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
const RGB_FROM_XYZ: [[f32; 3]; 3] = [
    [3.241_003_3, -1.537_399, -0.498_615_86],
    [-0.969_224_33, 1.875_93, 0.041_554_224],
    [0.055_639_423, -0.204_011_2, 1.057_148_9],
];
/// The white point D65.
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

fn transform(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// The linear light that a display sends for a colour.
pub(super) fn displayed(rgb: [f32; 3], tone: &ToneMapping) -> [f32; 3] {
    tone.apply(rgb).map(srgb_to_linear)
}

/// XYZ over white's.
fn relative_xyz(rgb: [f32; 3]) -> [f32; 3] {
    let xyz = transform(&XYZ_FROM_RGB, rgb);
    [0, 1, 2].map(|c| xyz[c] / WHITE[c])
}

/// Linear RGB to the opponent space YCxCz, a linearised L*a*b* (section 3.1).
pub(super) fn opponent_from_linear(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// And back.
pub(super) fn linear_from_opponent([luma, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (luma + 16.0) / 116.0;
    let relative = [y + cx / 500.0, y, y - cz / 200.0];
    transform(&RGB_FROM_XYZ, [0, 1, 2].map(|c| relative[c] * WHITE[c]))
}

/// The achromatic part of an opponent colour, from 0 (black) to 1.
pub(super) fn achromatic([luma, ..]: [f32; 3]) -> f32 {
    (luma + 16.0) / 116.0
}

/// L*a*b* with the Hunt effect: chroma fades with lightness (section 4.1.2).
pub(super) fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    const DELTA: f32 = 6.0 / 29.0;
    let f =
        |t: f32| if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 };
    let [x, y, z] = relative_xyz(rgb).map(f);
    let lightness = 116.0 * y - 16.0;
    let fade = 0.01 * lightness;
    [lightness, fade * 500.0 * (x - y), fade * 200.0 * (y - z)]
}

/// The HyAB distance, which suits large differences better than Euclid's (section 4.1.2).
pub(super) fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

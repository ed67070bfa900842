//! False colours.

use aureole_spectrum::srgb_to_linear;

/// Colours whose lightness grows evenly with a number, fit for colour-blind eyes.
///
/// The maps are those of [Smith & van der Walt 2015], "A Better Default Colormap for Matplotlib", approximated by the
/// sixth-degree polynomials of [Zucker 2019].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colormap {
    /// Black over purple and orange to a pale yellow.
    #[default]
    Magma,
    /// Dark violet over green to yellow.
    Viridis,
}

/// Coefficients by rising power, each for red, green and blue.
type Polynomial = [[f32; 3]; 7];

const MAGMA: Polynomial = [
    [-0.002_136_485, -0.000_749_655, -0.005_386_128],
    [0.251_660_54, 0.677_523_26, 2.494_026_7],
    [8.353_717, -3.577_719_5, 0.314_467_9],
    [-27.668_733, 14.264_731, -13.649_213],
    [52.176_14, -27.943_605, 12.944_169],
    [-50.768_524, 29.046_583, 4.234_153],
    [18.655_706, -11.489_774, -5.601_961_6],
];

const VIRIDIS: Polynomial = [
    [0.277_727_34, 0.005_407_345, 0.334_099_8],
    [0.105_093_04, 1.404_613_5, 1.384_590_1],
    [-0.330_861_84, 0.214_847_56, 0.095_095_165],
    [-4.634_230_6, -5.799_101, -19.332_441],
    [6.228_27, 14.179_934, 56.690_55],
    [4.776_385, -13.745_145, -65.353_035],
    [-5.435_456, 4.645_852_6, 26.312_435],
];

impl Colormap {
    /// The display colour (sRGB-encoded) of a number in [0, 1].
    pub fn display(self, t: f32) -> [f32; 3] {
        let polynomial = match self {
            Self::Magma => &MAGMA,
            Self::Viridis => &VIRIDIS,
        };
        let t = t.clamp(0.0, 1.0);
        let horner = |c: usize| polynomial.iter().rev().fold(0.0, |sum, row| sum * t + row[c]);
        [0, 1, 2].map(|c| horner(c).clamp(0.0, 1.0))
    }

    /// The linear colour of a number in [0, 1], so that an sRGB file shows the display colour.
    pub fn linear(self, t: f32) -> [f32; 3] {
        self.display(t).map(srgb_to_linear)
    }
}

#[cfg(test)]
mod tests {
    use aureole_spectrum::luminance;

    use super::*;

    #[test]
    fn the_maps_meet_their_published_ends_and_grow_lighter() {
        // First and last rows of Matplotlib's tables.
        let ends = [
            (Colormap::Magma, [0.001, 0.000, 0.014], [0.987, 0.991, 0.750]),
            (Colormap::Viridis, [0.267, 0.005, 0.329], [0.993, 0.906, 0.144]),
        ];
        for (map, first, last) in ends {
            for c in 0..3 {
                assert!((map.display(0.0)[c] - first[c]).abs() < 0.025);
                assert!((map.display(1.0)[c] - last[c]).abs() < 0.025, "{:?}", map.display(1.0));
            }
            let lightness = |i: usize| luminance(map.linear(i as f32 / 64.0));
            assert!((0..64).all(|i| lightness(i + 1) >= lightness(i)));
        }
        assert_eq!(Colormap::Magma.display(f32::INFINITY), Colormap::Magma.display(1.0));
    }
}

//! From linear radiance to eight-bit pictures.

use aureole_spectrum::srgb_from_linear;
use rayon::prelude::*;

use crate::Image;

/// How radiance beyond white is treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneCurve {
    /// The sRGB curve; what is brighter than white is clipped.
    #[default]
    Srgb,
    /// A film-like shoulder: [Narkowicz 2015] "ACES Filmic Tone Mapping Curve".
    Filmic,
    /// AgX (T. Sobotka 2022), which keeps hues of bright colours; polynomial fit by B. Wrensch (2023).
    Agx,
    /// No curve at all.
    Linear,
}

/// Exposure and curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToneMapping {
    /// Stops: each doubles the brightness.
    pub exposure: f32,
    /// The curve.
    pub curve: ToneCurve,
}

impl ToneMapping {
    /// Linear Rec. 709 to display values in [0, 1].
    pub fn apply(&self, rgb: [f32; 3]) -> [f32; 3] {
        let gain = self.exposure.exp2();
        let exposed = rgb.map(|x| if x.is_nan() { 0.0 } else { (x * gain).clamp(0.0, 1e30) });
        match self.curve {
            ToneCurve::Srgb => exposed.map(|x| srgb_from_linear(x.min(1.0))),
            ToneCurve::Linear => exposed.map(|x| x.min(1.0)),
            ToneCurve::Filmic => exposed.map(|x| srgb_from_linear(narkowicz(x.min(1e6)))),
            ToneCurve::Agx => agx(exposed),
        }
    }

    /// The picture as bytes, three a pixel.
    pub fn to_bytes(&self, image: &Image) -> Vec<u8> {
        let rgb = image.to_rgb();
        rgb.par_iter().flat_map_iter(|&pixel| self.apply(pixel).map(|x| (x * 255.0 + 0.5) as u8)).collect()
    }
}

fn narkowicz(x: f32) -> f32 {
    (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0)
}

/// Multiplies a matrix given by rows.
fn transform(m: [[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn agx(rgb: [f32; 3]) -> [f32; 3] {
    const INSET: [[f32; 3]; 3] = [
        [0.842_479_06, 0.078_433_6, 0.079_223_75],
        [0.042_328_24, 0.878_468_64, 0.079_166_13],
        [0.042_375_65, 0.078_433_6, 0.879_142_97],
    ];
    const OUTSET: [[f32; 3]; 3] = [
        [1.196_879, -0.098_020_88, -0.099_029_74],
        [-0.052_896_85, 1.151_903_1, -0.098_961_18],
        [-0.052_971_64, -0.098_043_45, 1.151_073_7],
    ];
    const MIN_EV: f32 = -12.473_93;
    const MAX_EV: f32 = 4.026_069;
    let contrast = |x: f32| {
        let x2 = x * x;
        let x4 = x2 * x2;
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232
    };
    let log = transform(INSET, rgb)
        .map(|x| (x.max(1e-10).log2().clamp(MIN_EV, MAX_EV) - MIN_EV) / (MAX_EV - MIN_EV));
    transform(OUTSET, log.map(contrast)).map(|x| x.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_monotonic_and_bounded() {
        for curve in [ToneCurve::Srgb, ToneCurve::Filmic, ToneCurve::Agx, ToneCurve::Linear] {
            let mapping = ToneMapping { exposure: 0.0, curve };
            let mut last = -1.0;
            for i in 0..200 {
                let y = mapping.apply([i as f32 * 0.1; 3])[1];
                assert!((0.0..=1.0).contains(&y) && y >= last - 2e-3, "{curve:?} at {i}");
                last = y;
            }
            assert!(mapping.apply([f32::NAN, f32::INFINITY, -1.0]).iter().all(|x| (0.0..=1.0).contains(x)));
        }
    }

    #[test]
    fn a_stop_doubles() {
        let mapping = ToneMapping { exposure: 1.0, curve: ToneCurve::Linear };
        assert_eq!(mapping.apply([0.25, 0.1, 0.0]), [0.5, 0.2, 0.0]);
    }
}

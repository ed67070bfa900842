//! The sky and sun of Hošek and Wilkie, from their published coefficients.
//!
//! The table (`hosek_wilkie.bin`, little-endian f32; its licence is beside it) holds for each of ten turbidities and two
//! albedos of the ground six Bézier control points over the sun's elevation, for each of three channels nine parameters and
//! the mean radiance; then for each turbidity and thirty elevations (2°, 5° .. 89°) the mean radiance of the sun's disk: their
//! spectral solar radiance with limb darkening, integrated against the CIE 1931 curves at their eleven wavelengths.
//!
//! Radiance is in W·sr⁻¹·m⁻² per nanometre over the luminance curve's integral (106.75 nm), linear Rec. 709.
//!
//! References: [Hošek and Wilkie 2012] "An Analytic Model for Full Spectral Sky-Dome Radiance"; [Hošek and Wilkie 2013]
//! "Adding a Solar-Radiance Function to the Hošek-Wilkie Skylight Model".

use std::f32::consts::FRAC_PI_2;

static TABLE: &[u8] = include_bytes!("hosek_wilkie.bin");

const TURBIDITIES: usize = 10;
const ALBEDOS: usize = 2;
const CONTROL_POINTS: usize = 6;
/// Nine parameters and the mean radiance.
const PER_CHANNEL: usize = 10;
const SUN: usize = TURBIDITIES * ALBEDOS * CONTROL_POINTS * 3 * PER_CHANNEL;
const SUN_ELEVATIONS: usize = 30;

/// Half the angle under which the sun is seen, in radians.
pub(super) const SUN_HALF_ANGLE: f32 = 0.5 * 0.5358 * std::f32::consts::PI / 180.0;

fn table(index: usize) -> f32 {
    let bytes = TABLE.get(4 * index..4 * index + 4).and_then(|b| b.try_into().ok());
    bytes.map_or(0.0, f32::from_le_bytes)
}

/// The two entries of a table of `n` around `x`, and the share of the second.
fn neighbours(x: f32, n: usize) -> ([usize; 2], f32) {
    let x = x.clamp(0.0, (n - 1) as f32);
    let low = (x as usize).min(n - 2);
    ([low, low + 1], x - low as f32)
}

fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// The sky over one place at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sky {
    channels: [[f32; PER_CHANNEL]; 3],
}

impl Sky {
    /// The sky for a turbidity in [1, 10], the ground's albedo by channel, and the sun's elevation in radians.
    pub(super) fn new(turbidity: f32, albedo: [f32; 3], elevation: f32) -> Self {
        let (turbid, t) = neighbours(turbidity - 1.0, TURBIDITIES);
        let x = (elevation.max(0.0) / FRAC_PI_2).min(1.0).cbrt();
        let weights = bernstein(x);
        let value = |turbidity: usize, albedo: usize, channel: usize, i: usize| -> f32 {
            let at = |point: usize| {
                let row = ((turbidity * ALBEDOS + albedo) * CONTROL_POINTS + point) * 3 + channel;
                table(row * PER_CHANNEL + i)
            };
            weights.iter().enumerate().map(|(point, w)| w * at(point)).sum()
        };
        let channels = std::array::from_fn(|c| {
            std::array::from_fn(|i| {
                let [clear, hazy] = turbid.map(|turbidity| {
                    lerp(value(turbidity, 0, c, i), value(turbidity, 1, c, i), albedo[c].clamp(0.0, 1.0))
                });
                lerp(clear, hazy, t)
            })
        });
        Self { channels }
    }

    /// Radiance from a direction given by its cosines with the zenith and with the sun [Hošek and Wilkie 2012, eq. 8].
    pub(super) fn radiance(&self, cos_theta: f32, cos_gamma: f32) -> [f32; 3] {
        let cos_gamma = cos_gamma.clamp(-1.0, 1.0);
        let gamma = cos_gamma.acos();
        let cos2 = cos_gamma * cos_gamma;
        self.channels.map(|[a, b, c, d, e, f, g, i, h, mean]| {
            let chi = (1.0 + cos2) / (1.0 + h * h - 2.0 * h * cos_gamma).max(1e-6).powf(1.5);
            let gradation = 1.0 + a * (b / (cos_theta + 0.01)).exp();
            let glow = c + d * (e * gamma).exp() + f * cos2 + g * chi + i * cos_theta.max(0.0).sqrt();
            gradation * glow * mean
        })
    }
}

/// The six Bernstein polynomials of degree five.
fn bernstein(x: f32) -> [f32; CONTROL_POINTS] {
    const BINOMIAL: [f32; CONTROL_POINTS] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    std::array::from_fn(|i| BINOMIAL[i] * x.powi(i as i32) * (1.0 - x).powi((CONTROL_POINTS - 1 - i) as i32))
}

/// Mean radiance of the sun's disk of [natural size](SUN_HALF_ANGLE) at an elevation in radians.
pub(super) fn sun_radiance(turbidity: f32, elevation: f32) -> [f32; 3] {
    let (turbid, t) = neighbours(turbidity - 1.0, TURBIDITIES);
    let (high, h) = neighbours((elevation.to_degrees() - 2.0) / 3.0, SUN_ELEVATIONS);
    std::array::from_fn(|c| {
        let at = |i: usize, j: usize| table(SUN + (turbid[i] * SUN_ELEVATIONS + high[j]) * 3 + c);
        lerp(lerp(at(0, 0), at(0, 1), h), lerp(at(1, 0), at(1, 1), h), t)
    })
}

/// Radiance at a place of the sun's disk over the disk's mean, for the squared cosine of the angle between the line of sight
/// and the sun's surface there.
///
/// The model's own darkening, a polynomial for each wavelength, in Rec. 709 through an atmosphere of turbidity 3; others
/// differ from it by less than 0.007.
pub(super) fn limb_darkening(cos2: f32) -> [f32; 3] {
    const COEFFICIENTS: [[f32; 6]; 3] = [
        [0.40106, 1.63411, -2.33008, 3.10878, -2.29228, 0.68386],
        [0.31719, 1.65891, -1.82593, 2.11424, -1.39384, 0.38033],
        [0.20824, 1.63855, -1.21494, 1.27234, -0.77936, 0.19857],
    ];
    let cos = cos2.clamp(0.0, 1.0).sqrt();
    COEFFICIENTS.map(|coefficients| coefficients.iter().rev().fold(0.0, |sum, c| sum * cos + c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Vector3;

    #[test]
    fn the_table_is_whole() {
        assert_eq!(TABLE.len(), 4 * (SUN + TURBIDITIES * SUN_ELEVATIONS * 3));
    }

    /// Values of another implementation of the model (Mitsuba 3.9.1, RGB).
    #[test]
    fn the_sky_is_that_of_others() {
        let sun = Vector3::new(0.2, 0.3, 0.5).normalized();
        let clear = Sky::new(3.0, [0.3; 3], sun.z.asin());
        let hazy = Sky::new(6.3, [0.1, 0.5, 0.9], sun.z.asin());
        let low = Vector3::new(0.1, -0.99, 0.05).normalized();
        for (sky, w, expected) in [
            (clear, Vector3::Z, [0.029_990_6, 0.049_319_2, 0.097_193_9]),
            (clear, low, [0.145_048, 0.201_358, 0.259_494]),
            (hazy, Vector3::new(0.6, 0.0, 0.8), [0.098_658_5, 0.137_606, 0.209_191]),
            (hazy, low, [0.112, 0.216_952, 0.351_599]),
        ] {
            let found = sky.radiance(w.z, w.dot(sun));
            for c in 0..3 {
                assert!((found[c] / expected[c] - 1.0).abs() < 1e-3, "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn the_sun_is_that_of_others() {
        let found = sun_radiance(3.0, (0.5_f32 / 0.38_f32.sqrt()).asin());
        let expected = [21_721.2, 18_083.0, 13_739.4];
        for c in 0..3 {
            assert!((found[c] / expected[c] - 1.0).abs() < 1e-3, "{found:?} {expected:?}");
        }
    }

    /// Over a disk the squared cosine is spread evenly.
    #[test]
    fn a_dark_limb_takes_nothing_away() {
        let n = 10_000;
        let mut mean = [0.0_f64; 3];
        for i in 0..n {
            let darkness = limb_darkening((i as f32 + 0.5) / n as f32);
            (0..3).for_each(|c| mean[c] += f64::from(darkness[c]) / f64::from(n));
        }
        assert!(mean.iter().all(|m| (m - 1.0).abs() < 1e-3), "{mean:?}");
        assert!(limb_darkening(1.0)[2] > 1.3 && limb_darkening(0.0)[2] < 0.25);
    }
}

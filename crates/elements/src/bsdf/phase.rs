//! Henyey and Greenstein's phase function.

use std::f32::consts::{FRAC_1_PI, PI};

use aureole_math::{Frame, Point2, Vector3};

/// Scattering by small particles; directions are those of travel.
///
/// # References
/// [Henyey and Greenstein 1941] "Diffuse radiation in the galaxy".
#[derive(Clone, Copy, Debug)]
pub(super) struct HenyeyGreenstein {
    /// Mean cosine, in (-1, 1): positive scatters forward.
    pub g: f32,
}

impl HenyeyGreenstein {
    /// The density per steradian of turning `from` into `to`.
    #[inline]
    pub(super) fn p(&self, from: Vector3, to: Vector3) -> f32 {
        let g = self.g;
        let denominator = (1.0 + g * g - 2.0 * g * from.dot(to)).max(1e-8);
        0.25 * FRAC_1_PI * (1.0 - g * g) / (denominator * denominator.sqrt())
    }

    /// Draws a direction in proportion to the phase function.
    #[inline]
    pub(super) fn sample(&self, from: Vector3, u: Point2) -> Vector3 {
        let g = self.g;
        let cos = if g.abs() < 1e-3 {
            1.0 - 2.0 * u.x
        } else {
            let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u.x);
            ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0)
        };
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (2.0 * PI * u.y).sin_cos();
        Frame::from_normal(from).to_world(Vector3::new(sin * cos_phi, sin * sin_phi, cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Pcg32;

    #[test]
    fn the_mean_cosine_is_g() {
        let mut rng = Pcg32::new(1);
        for g in [-0.7_f32, 0.0, 0.4, 0.9] {
            let phase = HenyeyGreenstein { g };
            let n = 100_000;
            let mean = (0..n).map(|_| f64::from(phase.sample(Vector3::X, rng.point2()).x)).sum::<f64>()
                / f64::from(n);
            assert!((mean - f64::from(g)).abs() < 0.01, "{g}: {mean}");
        }
    }
}

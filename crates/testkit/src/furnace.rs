//! The white furnace: under light of one from everywhere, no surface sends back more than one.

use aureole_math::{Pcg32, Vector3};

use crate::quadrature::integrate_sphere;
use crate::{Mean, mean_with_error};

/// The energy that a sampler returns in the furnace: the mean of its weights `value · |cos| / pdf`.
///
/// `weight` draws one direction and returns the weight, or `None` for an absorbed path. Compare with
/// [`Mean::is_at_most`], whose documentation states the false-alarm rate, or by [`crate::z_test`] with a known albedo.
/// This covers delta lobes, which [`directional_albedo`] cannot see.
pub fn furnace(count: usize, seed: u64, mut weight: impl FnMut(&mut Pcg32) -> Option<f64>) -> Mean {
    mean_with_error(count, seed, |rng| weight(rng).unwrap_or(0.0))
}

/// The energy that a function returns in the furnace: ∫ f(wi) |cos θi| dωi over the sphere, by quadrature.
///
/// `f` is the value without cosine, +Z the normal. Accurate to about 1e-4; deterministic, so never a false alarm.
pub fn directional_albedo(f: impl Fn(Vector3) -> f32) -> f64 {
    integrate_sphere(1e-5, |wi| f64::from(f(wi)) * f64::from(wi.z.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::z_test;
    use aureole_math::warp;
    use std::f32::consts::FRAC_1_PI;

    #[test]
    fn a_lambertian_surface_returns_its_reflectance() {
        let f = |wi: Vector3| if wi.z > 0.0 { 0.7 * FRAC_1_PI } else { 0.0 };
        assert!((directional_albedo(f) - 0.7).abs() < 1e-5);
        let mean = furnace(20_000, 0, |rng| {
            let wi = warp::square_to_uniform_hemisphere(rng.point2());
            Some(f64::from(f(wi) * wi.z / warp::UNIFORM_HEMISPHERE_PDF))
        });
        // False alarm in one of a thousand seeds.
        assert!(z_test(&mean, 0.7) > 1e-3, "{mean:?}");
        assert!(mean.is_at_most(1.0, 3.0));
    }
}

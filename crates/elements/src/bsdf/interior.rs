//! What fills a body: a homogeneous medium behind a boundary, entered and left by refraction.
//!
//! Integrators ask [`Bsdf::interior`](super::Bsdf::interior) where a path has gone through a surface, and walk from there:
//! draw a free flight, and either turn by the phase function or meet the boundary again.
//!
//! # References
//! - [Henyey and Greenstein 1941] "Diffuse radiation in the galaxy".
//! - [Wilkie et al. 2014] "Hero Wavelength Spectral Sampling": the balance heuristic over channels.

use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::phase::HenyeyGreenstein;

/// A homogeneous medium inside a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Events per unit of the world's length: absorption and scattering.
    pub extinction: Spectrum,
    /// The share of events that scatter, in [0, 1].
    pub albedo: Spectrum,
    /// Mean cosine of scattering, in (-1, 1).
    pub g: f32,
}

impl Interior {
    /// Nothing at all.
    pub const CLEAR: Self = Self { extinction: Spectrum::ZERO, albedo: Spectrum::ZERO, g: 0.0 };

    /// A medium by its coefficients of absorption and scattering per unit length.
    pub fn from_coefficients(absorption: Spectrum, scattering: Spectrum, g: f32) -> Self {
        let (absorption, scattering) = (absorption.max_zero(), scattering.max_zero());
        let extinction = absorption + scattering;
        let albedo = scattering / extinction.clamp(f32::MIN_POSITIVE, f32::MAX);
        Self { extinction, albedo, g: g.clamp(-0.99, 0.99) }
    }

    /// Whether light may change its direction here; otherwise it is only absorbed.
    #[inline]
    pub fn scatters(&self) -> bool {
        !(self.albedo * self.extinction).is_black()
    }

    /// The share of light that flies so far without an event.
    #[inline]
    pub fn transmittance(&self, distance: f32) -> Spectrum {
        (self.extinction * -distance).exp()
    }

    /// Draws a free flight by the extinction of a channel, which `uc` chooses in proportion to the light that is left in
    /// each. Infinite where that channel is never stopped.
    #[inline]
    pub fn sample_flight(&self, throughput: Spectrum, uc: f32, u: f32) -> f32 {
        let shares = throughput.rgb();
        let mut rest = uc * sum(throughput);
        let last = shares.len() - 1;
        let chosen = shares.iter().position(|share| {
            rest -= share;
            rest < 0.0
        });
        let rate = self.extinction[chosen.unwrap_or(last)];
        if rate > 0.0 { -(1.0 - u).max(f32::MIN_POSITIVE).ln() / rate } else { f32::INFINITY }
    }

    /// What is left of `throughput` after a drawn flight that ended in scattering.
    #[inline]
    pub fn after_scattering(&self, throughput: Spectrum, distance: f32) -> Spectrum {
        let arrived = throughput * self.transmittance(distance);
        let density = sum(arrived * self.extinction) / sum(throughput);
        if density > 0.0 { arrived * self.extinction * self.albedo / density } else { Spectrum::ZERO }
    }

    /// What is left of `throughput` after a drawn flight that met a surface at `distance`.
    #[inline]
    pub fn after_passage(&self, throughput: Spectrum, distance: f32) -> Spectrum {
        let arrived = throughput * self.transmittance(distance);
        let probability = sum(arrived) / sum(throughput);
        if probability > 0.0 { arrived / probability } else { Spectrum::ZERO }
    }

    /// Draws the direction of travel after scattering; its density is the phase function itself.
    #[inline]
    pub fn turn(&self, direction: Vector3, u: Point2) -> Vector3 {
        HenyeyGreenstein { g: self.g }.sample(direction, u)
    }
}

/// The lanes that have a meaning together.
#[inline]
fn sum(s: Spectrum) -> f32 {
    s.rgb().iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Pcg32;

    /// Scattering before a distance and passing it are all that may happen: with albedo one, every channel's light is
    /// kept on average, whatever the extinctions. Five standard errors of 200,000 draws.
    #[test]
    fn flights_keep_the_light_of_every_channel() {
        let interior =
            Interior { extinction: Spectrum::new([0.3, 1.0, 4.0, 1.5]), albedo: Spectrum::ONE, g: 0.0 };
        let throughput = Spectrum::new([0.2, 0.9, 0.5, 0.7]);
        let (mut rng, n) = (Pcg32::new(3), 200_000);
        let mut totals = [0.0_f64; 4];
        for _ in 0..n {
            let flight = interior.sample_flight(throughput, rng.next_f32(), rng.next_f32());
            let left = if flight < 0.8 {
                interior.after_scattering(throughput, flight)
            } else {
                interior.after_passage(throughput, 0.8)
            };
            for (total, lane) in totals.iter_mut().zip(left.to_array()) {
                *total += f64::from(lane) / f64::from(n);
            }
        }
        for (total, lane) in totals.iter().zip(throughput.to_array()) {
            assert!((total - f64::from(lane)).abs() < 0.012, "{totals:?}");
        }
    }

    #[test]
    fn empty_space_stops_nothing() {
        assert!(Interior::CLEAR.sample_flight(Spectrum::ONE, 0.3, 0.0).is_infinite());
        assert_eq!(Interior::CLEAR.after_passage(Spectrum::ONE, 1e9), Spectrum::ONE);
        let clear = Interior::from_coefficients(Spectrum::ZERO, Spectrum::ZERO, 0.0);
        assert!(!clear.scatters() && clear.albedo.is_finite());
    }
}

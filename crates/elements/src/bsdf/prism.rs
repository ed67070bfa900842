//! Glass that breaks colours apart: three indices, one a colour.

use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::dielectric::Glass;
use super::lobe::Sides;
use super::microfacet::Microfacet;
use super::{DielectricLobe, LobeFlags, LobeOps, LobeSample, RoughDielectricLobe, TransportMode, fresnel};

/// Mirror reflection and refraction with an index of its own for red, green and blue.
///
/// Refraction draws a colour, and only that one goes on. What is mirrored keeps all colours.
///
/// # References
/// [Evans and McCool 1999] "Stratified Wavelength Clusters for Efficient Spectral Monte Carlo Rendering": splitting by colour.
#[derive(Clone, Copy, Debug)]
pub struct PrismLobe {
    /// The boundary; its index is the middle one.
    pub glass: Glass,
    /// Indices of red, green and blue over the middle one.
    pub spread: [f32; 3],
}

/// The same boundary with another index.
fn with_index(glass: &Glass, factor: f32) -> Glass {
    Glass { eta: glass.eta * factor, ..*glass }
}

impl PrismLobe {
    fn colored(&self, c: usize) -> DielectricLobe {
        DielectricLobe { glass: with_index(&self.glass, self.spread[c]) }
    }
}

impl LobeOps for PrismLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    fn sample(&self, wo: Vector3, uc: f32, _: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z == 0.0 {
            return None;
        }
        let reflectance = [0, 1, 2].map(|c| self.colored(c).glass.fresnel(wo.z).0[c]);
        let mean = reflectance.iter().sum::<f32>() / 3.0;
        if uc < mean {
            let mirrored = Vector3::new(-wo.x, -wo.y, wo.z);
            let value = self.glass.reflectance * Spectrum::from_rgb(reflectance) / wo.z.abs();
            let flags = LobeFlags::DELTA_REFLECTION;
            return Some(LobeSample { wi: mirrored, value, pdf_omega: mean, flags, eta: 1.0 });
        }
        let c = (((uc - mean) / (1.0 - mean) * 3.0) as usize).min(2);
        let lobe = self.colored(c);
        let bare = fresnel::dielectric(wo.z, lobe.glass.eta);
        if bare.cos_t == 0.0 {
            return None;
        }
        let through = lobe.sample_from(Sides::Transmission, wo, uc, mode)?;
        let only = Spectrum::new([0, 1, 2, 3].map(|lane| f32::from(u8::from(lane == c))));
        Some(LobeSample { value: through.value * only, pdf_omega: (1.0 - mean) / 3.0, ..through })
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.glass.albedo(wo.z)
    }
}

/// Reflection and refraction by facets with an index of its own for red, green and blue.
///
/// A colour is chosen to draw by; the facets would send the others there too, but for a colour whose facets refract there
/// less. So the value holds them all, and the density is the mean of theirs.
///
/// # References
/// [Wilkie et al. 2014] "Hero Wavelength Spectral Sampling": the balance heuristic over colours.
#[derive(Clone, Copy, Debug)]
pub struct RoughPrismLobe {
    /// The boundary; its index is the middle one.
    pub glass: Glass,
    /// Its facets.
    pub surface: Microfacet,
    /// Indices of red, green and blue over the middle one.
    pub spread: [f32; 3],
}

impl RoughPrismLobe {
    fn colored(&self, c: usize) -> RoughDielectricLobe {
        RoughDielectricLobe { glass: with_index(&self.glass, self.spread[c]), surface: self.surface }
    }
}

impl LobeOps for RoughPrismLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        Spectrum::from_rgb([0, 1, 2].map(|c| self.colored(c).eval(wo, wi, mode)[c]))
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        let c = ((uc * 3.0) as usize).min(2);
        let rest = (uc * 3.0 - c as f32).min(1.0 - f32::EPSILON);
        let drawn = self.colored(c).sample(wo, rest, u, mode)?;
        let (value, pdf_omega) = (self.eval(wo, drawn.wi, mode), self.pdf_omega(wo, drawn.wi));
        (pdf_omega > 0.0).then_some(LobeSample { value, pdf_omega, ..drawn })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        [0, 1, 2].map(|c| self.colored(c).pdf_omega(wo, wi)).iter().sum::<f32>() / 3.0
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.glass.albedo(wo.z)
    }
}

#[cfg(test)]
mod tests {
    use super::super::microfacet::Distribution;
    use super::*;

    const GLASS: Glass =
        Glass { eta: 1.5, reflectance: Spectrum::ONE, transmittance: Spectrum::ONE, film: None };

    fn direction(theta: f32, phi: f32) -> Vector3 {
        aureole_math::spherical_direction(theta.to_radians(), phi)
    }

    #[test]
    fn without_a_spread_it_is_frosted_glass() {
        let surface = Microfacet::new(Distribution::Ggx, 0.3, 0.3);
        let prism = RoughPrismLobe { glass: GLASS, surface, spread: [1.0; 3] };
        let frosted = RoughDielectricLobe { glass: GLASS, surface };
        for (a, b) in [(20.0, 40.0), (30.0, 150.0), (130.0, 60.0), (110.0, 170.0)] {
            let (wo, wi) = (direction(a, 0.3), direction(b, 2.9));
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                assert_eq!(prism.eval(wo, wi, mode).rgb(), frosted.eval(wo, wi, mode).rgb());
            }
            assert!((prism.pdf_omega(wo, wi) - frosted.pdf_omega(wo, wi)).abs() < 1e-6);
        }
    }

    /// With nearly no roughness the colours leave where the smooth prism sends them.
    #[test]
    fn fine_facets_bend_colours_as_smooth_glass_does() {
        let spread = [0.97, 1.0, 1.04];
        let surface = Microfacet::new(Distribution::Ggx, 2e-3, 2e-3);
        let rough = RoughPrismLobe { glass: GLASS, surface, spread };
        let smooth = PrismLobe { glass: GLASS, spread };
        let wo = direction(50.0, 0.0);
        let u = Point2::new(0.3, 0.2);
        for c in 0..3 {
            let bent = smooth.colored(c).sample_from(Sides::Transmission, wo, 0.9, TransportMode::Radiance);
            let towards = bent.expect("light that is bent").wi;
            let drawn = rough.sample(wo, (c as f32 + 0.99) / 3.0, u, TransportMode::Radiance);
            let drawn = drawn.expect("light that is bent");
            assert!((drawn.wi - towards).length() < 0.02, "{c}: {drawn:?}, not {towards:?}");
            let strongest = drawn.value.rgb().into_iter().fold(0.0, f32::max);
            assert!(drawn.value[c] == strongest && drawn.value[(c + 1) % 3] < 0.1 * strongest, "{drawn:?}");
        }
    }
}

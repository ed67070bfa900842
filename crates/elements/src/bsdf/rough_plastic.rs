//! `rough_plastic`: a matte base under a rough dielectric coat.
//!
//! Parameters: those of `plastic`, and `distribution`, `alpha` (a number).
//!
//! How much light passes the rough coat is integrated once per cosine when the material is built.

use std::f32::consts::FRAC_1_PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::directional::{reflectance, transmittance};
use super::gloss_or_matte::GlossOrMatte;
use super::lobe::reflected;
use super::microfacet::{self, Microfacet};
use super::plastic::{Coat, Coated, PLASTIC_PARAMS};
use super::{Bsdf, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver};

/// Entries of a table over the square root of the cosine, which is steepest at grazing angles.
const ENTRIES: usize = 24;

/// A table of shares in [0, 1], in steps of 1/65535: lobes are copied, so they are kept small.
type Transmittance = [u16; ENTRIES];

/// A rough plastic.
#[derive(Clone, Copy, Debug)]
pub struct RoughPlastic {
    coated: Coated,
    surface: Microfacet,
    transmittance: Transmittance,
    internal: f32,
}

/// The mean reflectance of the rough boundary under even light from below.
///
/// The mean over 64 cosines, both ends included, is one to two percent below the integral. It is Mitsuba's, with which
/// pictures are to agree.
fn internal_reflectance(surface: &Microfacet, eta: f32) -> f32 {
    const STEPS: usize = 64;
    let weighted = |i: usize| {
        let cos = (i as f32 / (STEPS - 1) as f32).max(1e-6);
        2.0 * cos * reflectance(surface, cos, 1.0 / eta)
    };
    (0..STEPS).map(weighted).sum::<f32>() / STEPS as f32
}

impl RoughPlastic {
    fn new(coated: Coated, surface: Microfacet) -> Self {
        let cos = |i: usize| (i as f32 / (ENTRIES - 1) as f32).powi(2).max(1e-4);
        let transmittance = std::array::from_fn(|i| {
            (transmittance(&surface, cos(i), coated.eta).clamp(0.0, 1.0) * 65535.0 + 0.5) as u16
        });
        let internal = internal_reflectance(&surface, coated.eta);
        Self { coated, surface, transmittance, internal }
    }
}

impl Element for RoughPlastic {
    const SUMMARY: &'static str = "A matte base under a rough dielectric coat.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d, e] = PLASTIC_PARAMS;
        let [f, ..] = microfacet::ROUGHNESS_PARAMS;
        [
            a,
            b,
            c,
            d,
            e,
            f,
            ParamDoc { name: "alpha", ty: "float", default: "0.1", doc: "roughness, in (0, 1]" },
        ]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let coated = Coated::from_params(params, resolver)?;
        let alpha = params.float_in("alpha", 0.1, 0.0, 4.0)?;
        Ok(Self::new(coated, Microfacet::new(microfacet::distribution(params)?, alpha, alpha)))
    }
}

impl MaterialOps for RoughPlastic {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let coat = self.coated.at(&at.texture, self.internal);
        let lobe = RoughPlasticLobe { coat, surface: self.surface, transmittance: self.transmittance };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// A rough coat over a matte base.
#[derive(Clone, Copy, Debug)]
pub struct RoughPlasticLobe {
    /// The colours.
    pub coat: Coat,
    /// The coat's facets.
    pub surface: Microfacet,
    transmittance: Transmittance,
}

impl RoughPlasticLobe {
    #[inline]
    fn through(&self, cos: f32) -> f32 {
        let place = cos.max(0.0).sqrt() * (ENTRIES - 1) as f32;
        let i = (place as usize).min(ENTRIES - 2);
        let t = place - i as f32;
        let [a, b] = [self.transmittance[i], self.transmittance[i + 1]].map(f32::from);
        (a + (b - a) * t) * (1.0 / 65535.0)
    }

    fn draw(&self, wo: Vector3) -> GlossOrMatte<'_> {
        GlossOrMatte { surface: &self.surface, gloss: self.coat_probability(wo) }
    }

    /// The probability of drawing the coat's reflection.
    #[inline]
    fn coat_probability(&self, wo: Vector3) -> f32 {
        let through = self.through(wo.z);
        self.coat.specular_probability(1.0 - through, through)
    }
}

impl LobeOps for RoughPlasticLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let m = (wo + wi).normalized();
        let f = fresnel::dielectric(wo.dot(m), self.coat.eta).reflectance;
        let coat = f * self.surface.d(m) * self.surface.g(wo, wi, m) / (4.0 * wo.z * wi.z);
        let base = self.through(wo.z) * self.through(wi.z) * FRAC_1_PI;
        self.coat.specular * coat + self.coat.base * base
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = self.draw(wo).sample(wo, uc, u);
        reflected(self, wo, wi, mode)
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        self.draw(wo).pdf_omega(wo, wi)
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let through = self.through(wo.z.abs());
        self.coat.specular * (1.0 - through)
            + self.coat.base * (through * self.coat.eta * self.coat.eta * 0.6)
    }
}

#[cfg(test)]
mod tests {
    use super::super::microfacet::Distribution::{Beckmann, Ggx};
    use super::*;

    /// Values read off Mitsuba 3.9's `roughplastic`, by its linear and its nonlinear form.
    #[test]
    fn internal_reflectance_is_that_of_mitsuba() {
        for (distribution, alpha, expected) in [
            (Beckmann, 0.01, 0.5808),
            (Beckmann, 0.1, 0.5747),
            (Beckmann, 0.3, 0.5234),
            (Beckmann, 0.6, 0.3869),
            (Ggx, 0.01, 0.5803),
            (Ggx, 0.1, 0.5455),
            (Ggx, 0.3, 0.4088),
            (Ggx, 0.6, 0.2362),
        ] {
            let found = internal_reflectance(&Microfacet::new(distribution, alpha, alpha), 1.49 / 1.000_277);
            assert!((found - expected).abs() < 2e-3, "{distribution:?} {alpha}: {found}, not {expected}");
        }
    }
}

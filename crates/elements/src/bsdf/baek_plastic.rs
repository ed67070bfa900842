//! `baek_plastic`: a rough coat's reflection, and a matte base that light enters and leaves by smooth refraction.
//!
//! The two are simply added: the coat never reflects more than the refractions take away, so no energy is made, but some
//! is lost. The published model describes polarisation as well; here its mean over polarisations is taken, which is
//! Mitsuba's `pplastic` in colours.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `diffuse_reflectance` | texture | 0.5 | albedo of the base |
//! | `specular_reflectance` | texture | 1 | factor on the coat's reflection |
//! | `int_ior`, `ext_ior` | float or name | polypropylene, air | indices of the coat and outside |
//!
//! and `distribution`, `alpha`, `alpha_u`, `alpha_v`, `shadowing`.
//!
//! References: [Baek et al. 2018] "Simultaneous Acquisition of Polarimetric SVBRDF and Normals".

use std::f32::consts::FRAC_1_PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::dielectric::relative_ior;
use super::gloss_or_matte::GlossOrMatte;
use super::lobe::reflected;
use super::microfacet::{Microfacet, ROUGHNESS_PARAMS, Roughness};
use super::plastic::PLASTIC_PARAMS;
use super::{Bsdf, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver, Texture, spectrum_texture};

/// A plastic of Baek's model.
#[derive(Clone, Copy, Debug)]
pub struct BaekPlastic {
    diffuse: Id<Texture>,
    specular: Id<Texture>,
    eta: f32,
    roughness: Roughness,
}

impl Element for BaekPlastic {
    const SUMMARY: &'static str = "A rough coat added to a matte base that light refracts into and out of.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d, _] = PLASTIC_PARAMS;
        let [e, f, g, h, i] = ROUGHNESS_PARAMS;
        [a, b, c, d, e, f, g, h, i]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let mut albedo =
            |name, default| spectrum_texture(params, resolver, name, default, SpectrumRole::Albedo);
        let (diffuse, specular) = (albedo("diffuse_reflectance", 0.5)?, albedo("specular_reflectance", 1.0)?);
        let eta = relative_ior(params, "polypropylene")?;
        Ok(Self { diffuse, specular, eta, roughness: Roughness::from_params(params, resolver)? })
    }
}

impl MaterialOps for BaekPlastic {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let lobe = BaekPlasticLobe {
            diffuse: at.texture.albedo(self.diffuse),
            specular: at.texture.albedo(self.specular),
            eta: self.eta,
            surface: self.roughness.at(&at.texture),
        };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// A rough coat added to a refracted matte base.
#[derive(Clone, Copy, Debug)]
pub struct BaekPlasticLobe {
    /// Albedo of the base.
    pub diffuse: Spectrum,
    /// Factor on the coat's reflection.
    pub specular: Spectrum,
    /// Index of the coat over that outside.
    pub eta: f32,
    /// The coat's facets.
    pub surface: Microfacet,
}

impl BaekPlasticLobe {
    /// The share of light that a smooth boundary lets pass.
    #[inline]
    fn through(&self, cos: f32) -> f32 {
        1.0 - fresnel::dielectric(cos, self.eta).reflectance
    }

    fn draw(&self, wo: Vector3) -> GlossOrMatte<'_> {
        GlossOrMatte { surface: &self.surface, gloss: self.coat_probability(wo) }
    }

    /// The probability of drawing the coat's reflection.
    #[inline]
    fn coat_probability(&self, wo: Vector3) -> f32 {
        let through = self.through(wo.z);
        let coat = (1.0 - through) * self.specular.average();
        let base = through * self.diffuse.average();
        if coat + base > 0.0 { coat / (coat + base) } else { 0.5 }
    }
}

impl LobeOps for BaekPlasticLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let m = (wo + wi).normalized();
        let f = fresnel::dielectric(wo.dot(m), self.eta).reflectance;
        let coat = f * self.surface.d(m) * self.surface.g(wo, wi, m) / (4.0 * wo.z * wi.z);
        let base = self.through(wo.z) * self.through(wi.z) * FRAC_1_PI;
        self.specular * coat + self.diffuse * base
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
        let leaving = 1.0 - fresnel::diffuse_reflectance(self.eta);
        self.specular * (1.0 - through) + self.diffuse * (through * leaving)
    }
}

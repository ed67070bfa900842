//! `rough_conductor`: a rough metal, by microfacets.
//!
//! Parameters: those of `conductor`; `distribution`, `alpha`, `alpha_u`, `alpha_v`, `shadowing`; and
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `energy_compensation` | bool | false | give back what light loses that meets several facets |
//!
//! References: [Walter et al. 2007] "Microfacet Models for Refraction through Rough Surfaces", equation 20;
//! [Turquin 2019] "Practical multiple scattering compensation for microfacet models".

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector3, reflect};
use aureole_spectrum::Spectrum;

use super::conductor::{METAL_PARAMS, Metal, Metallic};
use super::directional::AlbedoTable;
use super::lobe::reflected;
use super::microfacet::{COMPENSATION_PARAM, Microfacet, ROUGHNESS_PARAMS, Roughness};
use super::{Bsdf, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver};

/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor {
    metal: Metallic,
    roughness: Roughness,
    is_compensated: bool,
}

impl Element for RoughConductor {
    const SUMMARY: &'static str = "A rough metal.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d, e, f, g, h] = METAL_PARAMS;
        let [i, j, k, l, m] = ROUGHNESS_PARAMS;
        [a, b, c, d, e, f, g, h, i, j, k, l, m, COMPENSATION_PARAM]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let metal = Metallic::from_params(params, resolver)?;
        let roughness = Roughness::from_params(params, resolver)?;
        Ok(Self { metal, roughness, is_compensated: params.bool("energy_compensation", false)? })
    }
}

impl MaterialOps for RoughConductor {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let (mut metal, surface) = (self.metal.at(&at.texture), self.roughness.at(&at.texture));
        if self.is_compensated {
            metal = compensated(metal, &surface, at.wo.dot(at.frame.n));
        }
        let lobe = RoughConductorLobe { metal, surface };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// A metal tinted so that it returns what met several facets: seen from one side, light loses some of it at each.
pub(super) fn compensated(metal: Metal, surface: &Microfacet, cos: f32) -> Metal {
    let once = AlbedoTable::mirror(surface.distribution, surface.shadowing).at(surface, cos);
    let gain = metal.reflectance(1.0) * ((1.0 - once) / once) + 1.0;
    Metal { tint: metal.tint * gain, ..metal }
}

/// Reflection by the facets of a metal.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductorLobe {
    /// The metal.
    pub metal: Metal,
    /// Its facets.
    pub surface: Microfacet,
}

impl LobeOps for RoughConductorLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        let m = (wo + wi).normalized();
        let facets = self.surface.d(m) * self.surface.g(wo, wi, m) / (4.0 * wo.z * wi.z);
        self.metal.reflectance(wo.dot(m)) * facets
    }

    #[inline]
    fn sample(&self, wo: Vector3, _: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = reflect(wo, self.surface.sample_visible(wo, u));
        reflected(self, wo, wi, mode)
    }

    #[inline]
    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        self.surface.pdf_mirrored(wo, wi)
    }

    #[inline]
    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.metal.reflectance(wo.z.abs())
    }
}

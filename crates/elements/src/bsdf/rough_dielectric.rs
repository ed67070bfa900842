//! `rough_dielectric`: frosted glass, by microfacets.
//!
//! Parameters: those of `dielectric`; `distribution`, `alpha`, `alpha_u`, `alpha_v`, `shadowing`; and
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `energy_compensation` | bool | false | give back what light loses that meets several facets |
//!
//! References: [Walter et al. 2007] "Microfacet Models for Refraction through Rough Surfaces", equations 20, 21.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector3, reflect, refract};
use aureole_spectrum::Spectrum;

use super::dielectric::{BOUNDARY_PARAMS, Boundary, Glass};
use super::directional::AlbedoTable;
use super::lobe::Sides;
use super::microfacet::{COMPENSATION_PARAM, Microfacet, ROUGHNESS_PARAMS, Roughness};
use super::thin_film::{FILM_PARAMS, FilmTexture};
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver};

/// Frosted glass.
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    boundary: Boundary,
    film: Option<FilmTexture>,
    roughness: Roughness,
    /// What leaves after one scattering, seen from above and from below; none unless that is made up for.
    once: Option<[AlbedoTable; 2]>,
}

impl Element for RoughDielectric {
    const SUMMARY: &'static str = "Frosted glass.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d] = BOUNDARY_PARAMS;
        let [e, f] = FILM_PARAMS;
        let [g, h, i, j, k] = ROUGHNESS_PARAMS;
        [a, b, c, d, e, f, g, h, i, j, k, COMPENSATION_PARAM]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let boundary = Boundary::from_params(params, resolver)?;
        let roughness = Roughness::from_params(params, resolver)?;
        let table = |eta| AlbedoTable::boundary(roughness.distribution, roughness.shadowing, eta);
        let is_compensated = params.bool("energy_compensation", false)?;
        let once = is_compensated.then(|| [table(boundary.eta), table(1.0 / boundary.eta)]);
        Ok(Self { boundary, film: FilmTexture::from_params(params, resolver)?, roughness, once })
    }
}

impl MaterialOps for RoughDielectric {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let (mut glass, surface) = (self.boundary.at(&at.texture), self.roughness.at(&at.texture));
        glass.film = self.film.and_then(|film| film.at(&at.texture));
        if let Some([above, below]) = &self.once {
            let cos = at.wo.dot(at.frame.n);
            let once = if cos > 0.0 { above } else { below }.at(&surface, cos.abs());
            (glass.reflectance, glass.transmittance) = (glass.reflectance / once, glass.transmittance / once);
        }
        let lobe = RoughDielectricLobe { glass, surface };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// Reflection and refraction by facets.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectricLobe {
    /// The boundary.
    pub glass: Glass,
    /// Its facets.
    pub surface: Microfacet,
}

/// The facet that turns one direction into the other.
struct Facet {
    /// Its normal, on the upper side.
    m: Vector3,
    is_reflection: bool,
    /// Relative index along the path.
    eta_path: f32,
}

impl RoughDielectricLobe {
    #[inline]
    fn facet(&self, wo: Vector3, wi: Vector3) -> Option<Facet> {
        if wo.z == 0.0 || wi.z == 0.0 {
            return None;
        }
        let is_reflection = wo.z * wi.z > 0.0;
        let eta_path = if wo.z > 0.0 { self.glass.eta } else { 1.0 / self.glass.eta };
        let m = if is_reflection { wo + wi } else { wo + wi * eta_path }.try_normalized()?;
        let m = if m.z < 0.0 { -m } else { m };
        // Back-facing facets do not count.
        (m.dot(wo) * wo.z > 0.0 && m.dot(wi) * wi.z > 0.0).then_some(Facet { m, is_reflection, eta_path })
    }

    /// `wo` seen from the upper side, as the visible normals want it.
    #[inline]
    fn above(wo: Vector3) -> Vector3 {
        if wo.z < 0.0 { -wo } else { wo }
    }
}

impl LobeOps for RoughDielectricLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        let Some(facet) = self.facet(wo, wi) else { return Spectrum::ZERO };
        let m = facet.m;
        let f = self.glass.fresnel(wo.dot(m)).0;
        let facets = self.surface.d(m) * self.surface.g(wo, wi, m) / (wo.z * wi.z).abs();
        if facet.is_reflection {
            return self.glass.reflectance * f * (facets * 0.25);
        }
        let denominator = (wo.dot(m) / facet.eta_path + wi.dot(m)).powi(2);
        let squeeze = if mode == TransportMode::Radiance { facet.eta_path.powi(-2) } else { 1.0 };
        self.glass.transmittance
            * (Spectrum::ONE - f)
            * (facets * (wo.dot(m) * wi.dot(m)).abs() / denominator * squeeze)
    }

    #[inline]
    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        self.sample_from(Sides::Both, wo, uc, u, mode)
    }

    #[inline]
    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        self.pdf_from(Sides::Both, wo, wi)
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.glass.albedo(wo.z)
    }
}

impl RoughDielectricLobe {
    /// Draws from some sides.
    #[inline]
    pub(super) fn sample_from(
        &self,
        sides: Sides,
        wo: Vector3,
        uc: f32,
        u: Point2,
        mode: TransportMode,
    ) -> Option<LobeSample> {
        if wo.z == 0.0 {
            return None;
        }
        let m = self.surface.sample_visible(Self::above(wo), u);
        let f = self.glass.fresnel(wo.dot(m)).0.average();
        let (wi, flags, eta) = if uc < sides.reflection_probability(f)? {
            (reflect(wo, m), LobeFlags::REFLECTION, 1.0)
        } else {
            let refraction = refract(wo, m, self.glass.eta)?;
            (refraction.wt, LobeFlags::TRANSMISSION, refraction.eta)
        };
        if (wi.z * wo.z > 0.0) == flags.transmission {
            return None;
        }
        let pdf_omega = self.pdf_from(sides, wo, wi);
        (pdf_omega > 0.0).then(|| LobeSample { wi, value: self.eval(wo, wi, mode), pdf_omega, flags, eta })
    }

    /// The density of [`sample_from`](Self::sample_from).
    #[inline]
    pub(super) fn pdf_from(&self, sides: Sides, wo: Vector3, wi: Vector3) -> f32 {
        let Some(facet) = self.facet(wo, wi) else { return 0.0 };
        let m = facet.m;
        let f = self.glass.fresnel(wo.dot(m)).0.average();
        let Some(p) = sides.reflection_probability(f) else { return 0.0 };
        let pdf_m = self.surface.pdf_visible(Self::above(wo), m);
        if facet.is_reflection {
            return p * pdf_m / (4.0 * wo.abs_dot(m));
        }
        let denominator = (wo.dot(m) / facet.eta_path + wi.dot(m)).powi(2);
        (1.0 - p) * pdf_m * wi.abs_dot(m) / denominator
    }
}

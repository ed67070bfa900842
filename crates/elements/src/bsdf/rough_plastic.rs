//! `rough_plastic`: a matte base under a rough dielectric coat.
//!
//! Parameters: those of `plastic`, and `distribution`, `alpha` (a number).
//!
//! How much light passes the rough coat is integrated once per cosine when the material is built.

use std::f32::consts::FRAC_1_PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector3, reflect, refract, warp};
use aureole_spectrum::Spectrum;

use super::microfacet::{self, Microfacet};
use super::plastic::{Coat, Coated, PLASTIC_PARAMS};
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver};

/// Entries of a table over the square root of the cosine, which is steepest at grazing angles.
const ENTRIES: usize = 24;
/// Points of the quadrature in each dimension.
const QUADRATURE: usize = 32;

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

/// The mean over visible normals of what one facet passes on, for light from `wo`.
fn average(surface: &Microfacet, wo: Vector3, facet: impl Fn(Vector3) -> f32) -> f32 {
    let mut sum = 0.0;
    for i in 0..QUADRATURE {
        for j in 0..QUADRATURE {
            let middle = |k: usize| (k as f32 + 0.5) / QUADRATURE as f32;
            sum += facet(surface.sample_visible(wo, Point2::new(middle(i), middle(j))));
        }
    }
    sum / (QUADRATURE * QUADRATURE) as f32
}

fn direction(cos: f32) -> Vector3 {
    Vector3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// The share of light from above that gets below the rough boundary.
fn transmittance(surface: &Microfacet, cos: f32, eta: f32) -> f32 {
    let wo = direction(cos);
    average(surface, wo, |m| match refract(wo, m, eta) {
        Some(refraction) if refraction.wt.z < 0.0 => {
            let f = fresnel::dielectric(wo.dot(m), eta).reflectance;
            (1.0 - f) * surface.g1(refraction.wt, m)
        }
        _ => 0.0,
    })
}

/// The share of light that the rough boundary reflects.
fn reflectance(surface: &Microfacet, cos: f32, eta: f32) -> f32 {
    let wo = direction(cos);
    average(surface, wo, |m| {
        let wi = reflect(wo, m);
        if wi.z <= 0.0 { 0.0 } else { fresnel::dielectric(wo.dot(m), eta).reflectance * surface.g1(wi, m) }
    })
}

impl RoughPlastic {
    fn new(coated: Coated, surface: Microfacet) -> Self {
        let cos = |i: usize| (i as f32 / (ENTRIES - 1) as f32).powi(2).max(1e-4);
        let transmittance = std::array::from_fn(|i| {
            (transmittance(&surface, cos(i), coated.eta).clamp(0.0, 1.0) * 65535.0 + 0.5) as u16
        });
        const STEPS: usize = 32;
        let middle = |i: usize| (i as f32 + 0.5) / STEPS as f32;
        let internal = (0..STEPS)
            .map(|i| 2.0 * middle(i) * reflectance(&surface, middle(i), 1.0 / coated.eta))
            .sum::<f32>()
            / STEPS as f32;
        Self { coated, surface, transmittance, internal }
    }
}

impl Element for RoughPlastic {
    const SUMMARY: &'static str = "A matte base under a rough dielectric coat.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d, e] = PLASTIC_PARAMS;
        let [f, _, _, _] = microfacet::ROUGHNESS_PARAMS;
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
        let wi = if uc < self.coat_probability(wo) {
            reflect(wo, self.surface.sample_visible(wo, u))
        } else {
            warp::square_to_cosine_hemisphere(u)
        };
        let pdf_omega = self.pdf_omega(wo, wi);
        (wi.z > 0.0 && pdf_omega > 0.0).then(|| LobeSample {
            wi,
            value: self.eval(wo, wi, mode),
            pdf_omega,
            flags: LobeFlags::REFLECTION,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let m = (wo + wi).normalized();
        let p = self.coat_probability(wo);
        let coat = self.surface.pdf_visible(wo, m) / (4.0 * wo.abs_dot(m));
        p * coat + (1.0 - p) * warp::cosine_hemisphere_pdf(wi.z)
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let through = self.through(wo.z.abs());
        self.coat.specular * (1.0 - through)
            + self.coat.base * (through * self.coat.eta * self.coat.eta * 0.6)
    }
}

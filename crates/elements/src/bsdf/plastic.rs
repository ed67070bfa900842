//! `plastic`: a matte base under a smooth dielectric coat.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `diffuse_reflectance` | texture | 0.5 | albedo of the base |
//! | `specular_reflectance` | texture | 1 | factor on the coat's reflection |
//! | `int_ior`, `ext_ior` | float or name | polypropylene, air | indices of the coat and outside |
//! | `nonlinear` | bool | false | let the base's colour deepen by reflections below the coat |

use std::f32::consts::FRAC_1_PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3, warp};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::dielectric::relative_ior;
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver, Texture, TextureContext, spectrum_texture};

/// Documentation of the parameters of plastics.
pub(super) const PLASTIC_PARAMS: [ParamDoc; 5] = [
    ParamDoc { name: "diffuse_reflectance", ty: "texture", default: "0.5", doc: "albedo of the base" },
    ParamDoc {
        name: "specular_reflectance",
        ty: "texture",
        default: "1",
        doc: "factor on the coat's reflection",
    },
    ParamDoc { name: "int_ior", ty: "float or name", default: "polypropylene", doc: "index of the coat" },
    ParamDoc { name: "ext_ior", ty: "float or name", default: "air", doc: "index outside" },
    ParamDoc {
        name: "nonlinear",
        ty: "bool",
        default: "false",
        doc: "deepen the base's colour by inner reflections",
    },
];

/// What smooth and rough plastics share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coated {
    pub eta: f32,
    diffuse: Id<Texture>,
    specular: Id<Texture>,
    nonlinear: bool,
}

impl Coated {
    pub(super) fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let mut albedo =
            |name, default| spectrum_texture(params, resolver, name, default, SpectrumRole::Albedo);
        let (diffuse, specular) = (albedo("diffuse_reflectance", 0.5)?, albedo("specular_reflectance", 1.0)?);
        let eta = relative_ior(params, "polypropylene")?;
        Ok(Self { eta, diffuse, specular, nonlinear: params.bool("nonlinear", false)? })
    }

    /// Colours at a point; `internal` is the coat's mean reflectance from below.
    #[inline]
    pub(super) fn at(&self, at: &TextureContext<'_>, internal: f32) -> Coat {
        let diffuse = at.albedo(self.diffuse);
        let lost = if self.nonlinear { diffuse * internal } else { Spectrum::splat(internal) };
        Coat {
            base: diffuse / (Spectrum::ONE - lost) / (self.eta * self.eta),
            specular: at.albedo(self.specular),
            eta: self.eta,
            diffuse_mean: diffuse.average(),
        }
    }
}

/// A coated base at a point.
#[derive(Clone, Copy, Debug)]
pub struct Coat {
    /// The base's albedo, with all reflections below the coat, over eta² for leaving the denser medium.
    pub base: Spectrum,
    /// Factor on the coat's reflection.
    pub specular: Spectrum,
    /// Index of the coat over that outside.
    pub eta: f32,
    /// Mean albedo of the bare base.
    diffuse_mean: f32,
}

impl Coat {
    /// With which probability the coat's reflection is drawn, where it reflects `specular` and lets `through` pass.
    #[inline]
    pub(super) fn specular_probability(&self, specular: f32, through: f32) -> f32 {
        let s = specular * self.specular.average();
        let d = through * self.diffuse_mean;
        if s + d > 0.0 { s / (s + d) } else { 0.5 }
    }
}

/// A smooth plastic.
#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    coated: Coated,
    internal: f32,
}

impl Element for Plastic {
    const SUMMARY: &'static str = "A matte base under a smooth dielectric coat.";
    const PARAMS: &'static [ParamDoc] = &PLASTIC_PARAMS;

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let coated = Coated::from_params(params, resolver)?;
        Ok(Self { coated, internal: fresnel::diffuse_reflectance(1.0 / coated.eta) })
    }
}

impl MaterialOps for Plastic {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(
            PlasticLobe { coat: self.coated.at(&at.texture, self.internal) },
            weight,
            at.frame,
            at.frame.n,
        );
    }
}

/// A mirror-like coat over a matte base.
#[derive(Clone, Copy, Debug)]
pub struct PlasticLobe {
    /// The colours.
    pub coat: Coat,
}

impl PlasticLobe {
    #[inline]
    fn fresnel(&self, cos: f32) -> f32 {
        fresnel::dielectric(cos, self.coat.eta).reflectance
    }

    /// The probability of drawing the mirror direction.
    #[inline]
    fn mirror_probability(&self, f: f32) -> f32 {
        self.coat.specular_probability(f, 1.0 - f)
    }
}

impl LobeOps for PlasticLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::ZERO;
        }
        self.coat.base * ((1.0 - self.fresnel(wo.z)) * (1.0 - self.fresnel(wi.z)) * FRAC_1_PI)
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let f = self.fresnel(wo.z);
        let mirror = self.mirror_probability(f);
        if uc < mirror {
            return Some(LobeSample {
                wi: Vector3::new(-wo.x, -wo.y, wo.z),
                value: self.coat.specular * (f / wo.z),
                pdf_omega: mirror,
                flags: LobeFlags::DELTA_REFLECTION,
                eta: 1.0,
            });
        }
        let wi = warp::square_to_cosine_hemisphere(u);
        Some(LobeSample {
            wi,
            value: self.eval(wo, wi, mode),
            pdf_omega: warp::cosine_hemisphere_pdf(wi.z) * (1.0 - mirror),
            flags: LobeFlags::REFLECTION,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        warp::cosine_hemisphere_pdf(wi.z) * (1.0 - self.mirror_probability(self.fresnel(wo.z)))
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let f = self.fresnel(wo.z.abs());
        self.coat.specular * f + self.coat.base * ((1.0 - f) * self.coat.eta * self.coat.eta * 0.6)
    }
}

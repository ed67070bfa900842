//! `diffuse`: Lambert's ideal matte surface; black from behind.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `reflectance` | texture | 0.5 | albedo, in [0, 1] |

use std::f32::consts::FRAC_1_PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3, warp};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver, Texture, spectrum_texture};

/// A matte surface.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    reflectance: Id<Texture>,
}

impl Diffuse {
    /// A matte surface of an albedo.
    pub fn new(reflectance: Id<Texture>) -> Self {
        Self { reflectance }
    }
}

impl Element for Diffuse {
    const SUMMARY: &'static str = "An ideal matte surface; black from behind.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "reflectance", ty: "texture", default: "0.5", doc: "albedo, in [0, 1]" }];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self::new(spectrum_texture(params, resolver, "reflectance", 0.5, SpectrumRole::Albedo)?))
    }
}

impl MaterialOps for Diffuse {
    #[inline]
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(
            DiffuseLobe { reflectance: at.texture.albedo(self.reflectance) },
            weight,
            at.frame,
            at.frame.n,
        );
    }
}

/// Lambert's lobe.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseLobe {
    /// Albedo.
    pub reflectance: Spectrum,
}

impl LobeOps for DiffuseLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        if wo.z > 0.0 && wi.z > 0.0 { self.reflectance * FRAC_1_PI } else { Spectrum::ZERO }
    }

    #[inline]
    fn sample(&self, wo: Vector3, _: f32, u: Point2, _: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = warp::square_to_cosine_hemisphere(u);
        Some(LobeSample {
            wi,
            value: self.reflectance * FRAC_1_PI,
            pdf_omega: warp::cosine_hemisphere_pdf(wi.z),
            flags: LobeFlags::REFLECTION,
            eta: 1.0,
        })
    }

    #[inline]
    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z > 0.0 && wi.z > 0.0 { warp::cosine_hemisphere_pdf(wi.z) } else { 0.0 }
    }

    #[inline]
    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, _: Vector3) -> Spectrum {
        self.reflectance
    }
}

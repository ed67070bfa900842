//! `diffuse_transmission`: a thin sheet that scatters light evenly to both sides: paper, leaves, lampshades.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `reflectance` | texture | 0.25 | share scattered back |
//! | `transmittance` | texture | 0.25 | share scattered through |

use std::f32::consts::FRAC_1_PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Id, Point2, Vector3, warp};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver, Texture, spectrum_texture};

/// A thin diffusing sheet.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseTransmission {
    reflectance: Id<Texture>,
    transmittance: Id<Texture>,
}

impl Element for DiffuseTransmission {
    const SUMMARY: &'static str = "A thin sheet that scatters light evenly to both sides.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "reflectance", ty: "texture", default: "0.25", doc: "share scattered back" },
        ParamDoc { name: "transmittance", ty: "texture", default: "0.25", doc: "share scattered through" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let mut share = |name| spectrum_texture(params, resolver, name, 0.25, SpectrumRole::Albedo);
        Ok(Self { reflectance: share("reflectance")?, transmittance: share("transmittance")? })
    }
}

impl MaterialOps for DiffuseTransmission {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let lobe = DiffuseTransmissionLobe {
            reflectance: at.texture.albedo(self.reflectance),
            transmittance: at.texture.albedo(self.transmittance),
        };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// Even scattering to both sides.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseTransmissionLobe {
    /// Share scattered back.
    pub reflectance: Spectrum,
    /// Share scattered through.
    pub transmittance: Spectrum,
}

impl DiffuseTransmissionLobe {
    fn reflection_probability(&self) -> f32 {
        let (r, t) = (self.reflectance.max_element(), self.transmittance.max_element());
        if r + t > 0.0 { r / (r + t) } else { 0.5 }
    }
}

impl LobeOps for DiffuseTransmissionLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        (if wo.z * wi.z > 0.0 { self.reflectance } else { self.transmittance }) * FRAC_1_PI
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        let is_reflection = uc < self.reflection_probability();
        let w = warp::square_to_cosine_hemisphere(u);
        let wi = if is_reflection == (wo.z > 0.0) { w } else { -w };
        let flags = if is_reflection { LobeFlags::REFLECTION } else { LobeFlags::TRANSMISSION };
        let pdf_omega = self.pdf_omega(wo, wi);
        (wo.z != 0.0 && pdf_omega > 0.0).then(|| LobeSample {
            wi,
            value: self.eval(wo, wi, mode),
            pdf_omega,
            flags,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        let p = self.reflection_probability();
        warp::cosine_hemisphere_pdf(wi.z.abs()) * if wo.z * wi.z > 0.0 { p } else { 1.0 - p }
    }

    fn albedo(&self, _: Vector3) -> Spectrum {
        self.reflectance + self.transmittance
    }
}

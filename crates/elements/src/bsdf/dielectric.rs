//! `dielectric`: smooth glass, water, diamond.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `int_ior` | float or string | bk7 | index inside, or a substance's name |
//! | `ext_ior` | float or string | air | index outside |
//! | `specular_reflectance` | texture | 1 | factor on what is reflected |
//! | `specular_transmittance` | texture | 1 | factor on what passes |

use aureole_desc::{ParamDoc, Params, SceneError, Value};
use aureole_math::{Id, Point2, Vector3};
use aureole_spectrum::{Spectrum, SpectrumRole, dielectric_ior, dielectrics};

use super::lobe::Sides;
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver, Texture, TextureContext, spectrum_texture};

/// Documentation of the parameters of dielectrics.
pub(super) const DIELECTRIC_PARAMS: [ParamDoc; 4] = [
    ParamDoc {
        name: "int_ior",
        ty: "float or name",
        default: "bk7",
        doc: "index inside, or a substance's name",
    },
    ParamDoc { name: "ext_ior", ty: "float or name", default: "air", doc: "index outside" },
    ParamDoc {
        name: "specular_reflectance",
        ty: "texture",
        default: "1",
        doc: "factor on what is reflected",
    },
    ParamDoc { name: "specular_transmittance", ty: "texture", default: "1", doc: "factor on what passes" },
];

/// An index of refraction, by number or by name.
fn ior(params: &mut Params, name: &str, default: &str) -> Result<f32, SceneError> {
    let word = match params.get(name) {
        Some(Value::String(_)) => params.try_string(name)?.unwrap_or_default(),
        Some(_) => return params.float_in(name, 1.0, 0.1, 100.0),
        None => default.to_owned(),
    };
    dielectric_ior(&word).ok_or_else(|| SceneError::UnknownName {
        what: "substance",
        name: word.clone(),
        known: dielectrics().map(|(name, _)| name.to_owned()).collect(),
        at: params.span(name),
    })
}

/// The relative index: inside over outside.
pub(super) fn relative_ior(params: &mut Params, default: &str) -> Result<f32, SceneError> {
    Ok(ior(params, "int_ior", default)? / ior(params, "ext_ior", "air")?)
}

/// What all dielectrics share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary {
    eta: f32,
    reflectance: Id<Texture>,
    transmittance: Id<Texture>,
}

impl Boundary {
    pub(super) fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let eta = relative_ior(params, "bk7")?;
        let mut factor = |name| spectrum_texture(params, resolver, name, 1.0, SpectrumRole::Albedo);
        Ok(Self {
            eta,
            reflectance: factor("specular_reflectance")?,
            transmittance: factor("specular_transmittance")?,
        })
    }

    #[inline]
    pub(super) fn at(&self, at: &TextureContext<'_>) -> Glass {
        Glass {
            eta: self.eta,
            reflectance: at.spectrum(self.reflectance),
            transmittance: at.spectrum(self.transmittance),
        }
    }
}

/// A dielectric boundary at a point.
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    /// Index below the surface over index above.
    pub eta: f32,
    /// Factor on what is reflected.
    pub reflectance: Spectrum,
    /// Factor on what passes.
    pub transmittance: Spectrum,
}

/// Smooth glass.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    boundary: Boundary,
}

impl Element for Dielectric {
    const SUMMARY: &'static str = "Smooth glass, water, diamond.";
    const PARAMS: &'static [ParamDoc] = &DIELECTRIC_PARAMS;

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self { boundary: Boundary::from_params(params, resolver)? })
    }
}

impl MaterialOps for Dielectric {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(DielectricLobe { glass: self.boundary.at(&at.texture) }, weight, at.frame, at.frame.n);
    }
}

/// Mirror reflection and refraction.
#[derive(Clone, Copy, Debug)]
pub struct DielectricLobe {
    /// The boundary.
    pub glass: Glass,
}

impl LobeOps for DielectricLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    #[inline]
    fn sample(&self, wo: Vector3, uc: f32, _: Point2, mode: TransportMode) -> Option<LobeSample> {
        self.sample_from(Sides::Both, wo, uc, mode)
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let f = fresnel::dielectric(wo.z, self.glass.eta).reflectance;
        self.glass.reflectance * f + self.glass.transmittance * (1.0 - f)
    }
}

impl DielectricLobe {
    /// Draws from some sides.
    #[inline]
    pub(super) fn sample_from(
        &self,
        sides: Sides,
        wo: Vector3,
        uc: f32,
        mode: TransportMode,
    ) -> Option<LobeSample> {
        let f = fresnel::dielectric(wo.z, self.glass.eta);
        let p = sides.reflection_probability(f.reflectance)?;
        if wo.z == 0.0 {
            return None;
        }
        if uc < p {
            let wi = Vector3::new(-wo.x, -wo.y, wo.z);
            let value = self.glass.reflectance * (f.reflectance / wi.z.abs());
            return Some(LobeSample {
                wi,
                value,
                pdf_omega: p,
                flags: LobeFlags::DELTA_REFLECTION,
                eta: 1.0,
            });
        }
        let scale = 1.0 / f.eta_path;
        let wi = Vector3::new(-wo.x * scale, -wo.y * scale, f.cos_t);
        // Refraction squeezes a pencil of radiance by the square of the relative index.
        let squeeze = if mode == TransportMode::Radiance { scale * scale } else { 1.0 };
        let value = self.glass.transmittance * (squeeze * (1.0 - f.reflectance) / wi.z.abs());
        let flags = LobeFlags::DELTA_TRANSMISSION;
        Some(LobeSample { wi, value, pdf_omega: 1.0 - p, flags, eta: f.eta_path })
    }
}

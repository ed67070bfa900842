//! `null`: a surface that is not there, or a filter: light passes straight on.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `transmittance` | texture | 1 | factor on the light that passes |
//! | `scale` | float | 1 | another factor, in [0, 1] |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Point2, Vector3};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Bsdf, LobeFlags, LobeOps, LobeSample, Material, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver, Texture, spectrum_texture};

/// No surface, or a filter.
#[derive(Clone, Copy, Debug)]
pub struct Null {
    transmittance: Id<Texture>,
    scale: f32,
}

impl Element for Null {
    const SUMMARY: &'static str = "A surface that is not there, or a filter: light passes straight on.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "transmittance",
            ty: "texture",
            default: "1",
            doc: "factor on the light that passes",
        },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "another factor, in [0, 1]" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let transmittance = spectrum_texture(params, resolver, "transmittance", 1.0, SpectrumRole::Albedo)?;
        Ok(Self { transmittance, scale: params.float_in("scale", 1.0, 0.0, 1.0)? })
    }
}

impl MaterialOps for Null {
    fn is_see_through(&self, _: &Arena<Material>, _: &Arena<Texture>) -> bool {
        true
    }

    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let lobe = NullLobe { transmittance: at.texture.albedo(self.transmittance) * self.scale };
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

/// Straight transmission.
#[derive(Clone, Copy, Debug)]
pub struct NullLobe {
    /// Factor on the light that passes.
    pub transmittance: Spectrum,
}

impl NullLobe {
    /// Nothing at all.
    pub const CLEAR: Self = Self { transmittance: Spectrum::ONE };
}

impl LobeOps for NullLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    fn sample(&self, wo: Vector3, _: f32, _: Point2, _: TransportMode) -> Option<LobeSample> {
        (wo.z != 0.0).then(|| LobeSample {
            wi: -wo,
            value: self.transmittance / wo.z.abs(),
            pdf_omega: 1.0,
            flags: LobeFlags::NULL,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, _: Vector3) -> Spectrum {
        self.transmittance
    }
}

//! `power`: a texture raised to a power, value by value.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `texture` | texture | 1 | the base |
//! | `exponent` | float | 1 | the exponent |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver, spectrum_texture};

/// A power of a texture. Values below zero count as zero.
#[derive(Clone, Debug)]
pub struct Power {
    texture: Id<Texture>,
    exponent: f32,
}

impl Element for Power {
    const SUMMARY: &'static str = "A texture raised to a power.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "texture", ty: "texture", default: "1", doc: "the base" },
        ParamDoc { name: "exponent", ty: "float", default: "1", doc: "the exponent" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let texture = spectrum_texture(params, resolver, "texture", 1.0, SpectrumRole::Unbounded)?;
        Ok(Self { texture, exponent: params.float("exponent", 1.0)? })
    }
}

impl TextureOps for Power {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.texture).map(|x| x.max(0.0).powf(self.exponent))
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        at.float(self.texture).max(0.0).powf(self.exponent)
    }

    fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        textures[self.texture].mean(textures).map(|x| x.max(0.0).powf(self.exponent))
    }
}

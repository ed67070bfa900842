//! `scale`: the product of two textures.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `texture` | texture | 1 | one factor |
//! | `scale` | texture | 1 | the other |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver, spectrum_texture};

/// A product.
#[derive(Clone, Debug)]
pub struct Scale {
    factors: [Id<Texture>; 2],
}

impl Element for Scale {
    const SUMMARY: &'static str = "The product of two textures.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "texture", ty: "texture", default: "1", doc: "one factor" },
        ParamDoc { name: "scale", ty: "texture", default: "1", doc: "the other" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let mut factor = |name| spectrum_texture(params, resolver, name, 1.0, SpectrumRole::Unbounded);
        Ok(Self { factors: [factor("texture")?, factor("scale")?] })
    }
}

impl TextureOps for Scale {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.factors[0]) * at.spectrum(self.factors[1])
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        at.float(self.factors[0]) * at.float(self.factors[1])
    }

    fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        textures[self.factors[0]].mean(textures) * textures[self.factors[1]].mean(textures)
    }
}

//! `mix`: a blend of two textures.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `a` | texture | 0 | at amount 0 |
//! | `b` | texture | 1 | at amount 1 |
//! | `amount` | texture | 0.5 | how much of `b` |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver, float_texture, spectrum_texture};

/// A linear blend.
#[derive(Clone, Debug)]
pub struct Mix {
    a: Id<Texture>,
    b: Id<Texture>,
    amount: Id<Texture>,
}

impl Element for Mix {
    const SUMMARY: &'static str = "A blend of two textures.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "a", ty: "texture", default: "0", doc: "at amount 0" },
        ParamDoc { name: "b", ty: "texture", default: "1", doc: "at amount 1" },
        ParamDoc { name: "amount", ty: "texture", default: "0.5", doc: "how much of `b`" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            a: spectrum_texture(params, resolver, "a", 0.0, SpectrumRole::Unbounded)?,
            b: spectrum_texture(params, resolver, "b", 1.0, SpectrumRole::Unbounded)?,
            amount: float_texture(params, resolver, "amount", 0.5)?,
        })
    }
}

impl TextureOps for Mix {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.a).lerp(at.spectrum(self.b), at.float(self.amount))
    }

    fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        let mean = |id: Id<Texture>| textures[id].mean(textures);
        mean(self.a).lerp(mean(self.b), mean(self.amount)[0])
    }
}

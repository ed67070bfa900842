//! `checkerboard`: squares of half a uv unit, in two textures.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `color0` | texture | 0.4 | where both coordinates' halves agree |
//! | `color1` | texture | 0.2 | elsewhere |
//! | `to_uv` | transform | identity | applied to the surface's uv; one unit holds two squares |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Vector2};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Texture, TextureContext, TextureOps, UvMap};
use crate::{Element, Resolver, spectrum_texture};

/// Two textures in squares.
#[derive(Clone, Debug)]
pub struct Checkerboard {
    colors: [Id<Texture>; 2],
    uv: UvMap,
}

impl Checkerboard {
    #[inline]
    fn pick(&self, at: &TextureContext<'_>) -> Id<Texture> {
        let p = self.uv.apply(at.uv);
        let half = |x: f32| x - x.floor() > 0.5;
        self.colors[usize::from(half(p.x) != half(p.y))]
    }
}

impl Element for Checkerboard {
    const SUMMARY: &'static str = "Squares of half a uv unit, in two textures.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "color0",
            ty: "texture",
            default: "0.4",
            doc: "where both coordinates' halves agree",
        },
        ParamDoc { name: "color1", ty: "texture", default: "0.2", doc: "elsewhere" },
        ParamDoc { name: "to_uv", ty: "transform", default: "identity", doc: "applied to the surface's uv" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            colors: [
                spectrum_texture(params, resolver, "color0", 0.4, SpectrumRole::Albedo)?,
                spectrum_texture(params, resolver, "color1", 0.2, SpectrumRole::Albedo)?,
            ],
            uv: UvMap::new(&params.transform("to_uv")?),
        })
    }
}

impl TextureOps for Checkerboard {
    #[inline]
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.pick(at))
    }

    fn eval_float(&self, at: &TextureContext<'_>) -> f32 {
        at.float(self.pick(at))
    }

    fn gradient(&self, at: &TextureContext<'_>) -> Vector2 {
        at.gradient(self.pick(at))
    }

    fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        (textures[self.colors[0]].mean(textures) + textures[self.colors[1]].mean(textures)) * 0.5
    }
}

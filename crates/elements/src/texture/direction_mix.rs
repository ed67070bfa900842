//! `direction_mix`: a blend of two textures by where the surface faces.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `a` | texture | 0 | where the surface faces `direction`, or away from it |
//! | `b` | texture | 1 | where it is seen edge on |
//! | `direction` | vector | 0, 1, 0 | in the world |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Vector3};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::{Texture, TextureContext, TextureOps};
use crate::{Element, Resolver, spectrum_texture};

/// A blend by direction.
#[derive(Clone, Debug)]
pub struct DirectionMix {
    a: Id<Texture>,
    b: Id<Texture>,
    direction: Vector3,
}

impl Element for DirectionMix {
    const SUMMARY: &'static str = "A blend of two textures by where the surface faces.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "a", ty: "texture", default: "0", doc: "where the surface faces `direction`" },
        ParamDoc { name: "b", ty: "texture", default: "1", doc: "where it is at right angles to it" },
        ParamDoc { name: "direction", ty: "vector", default: "0, 1, 0", doc: "in the world" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let at = params.span("direction");
        let direction = Vector3::from(params.vec3("direction", [0.0, 1.0, 0.0])?);
        Ok(Self {
            a: spectrum_texture(params, resolver, "a", 0.0, SpectrumRole::Unbounded)?,
            b: spectrum_texture(params, resolver, "b", 1.0, SpectrumRole::Unbounded)?,
            direction: direction
                .try_normalized()
                .ok_or_else(|| SceneError::invalid("`direction` must not be zero", at))?,
        })
    }
}

impl TextureOps for DirectionMix {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        at.spectrum(self.b).lerp(at.spectrum(self.a), at.n.abs_dot(self.direction).min(1.0))
    }

    fn mean(&self, textures: &Arena<Texture>) -> Spectrum {
        (textures[self.a].mean(textures) + textures[self.b].mean(textures)) * 0.5
    }
}

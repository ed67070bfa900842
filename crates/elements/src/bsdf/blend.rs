//! `blend`: a mixture of two materials.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `weight` | texture | 0.5 | how much of `b`, in [0, 1] |
//! | `a`, `b` | bsdf | | the materials |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Id;

use super::{Bsdf, Material, MaterialContext, MaterialOps, nested_material};
use crate::{Element, Resolver, Texture, float_texture};

/// A mixture.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    weight: Id<Texture>,
    a: Id<Material>,
    b: Id<Material>,
}

impl Element for Blend {
    const SUMMARY: &'static str = "A mixture of two materials.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "weight", ty: "texture", default: "0.5", doc: "how much of `b`, in [0, 1]" },
        ParamDoc { name: "a", ty: "bsdf", default: "", doc: "the material at weight 0" },
        ParamDoc { name: "b", ty: "bsdf", default: "", doc: "the material at weight 1" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let weight = float_texture(params, resolver, "weight", 0.5)?;
        let a = nested_material(params, resolver, "a", "blend")?;
        Ok(Self { weight, a, b: nested_material(params, resolver, "b", "blend")? })
    }
}

impl MaterialOps for Blend {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let b = at.texture.float(self.weight).clamp(0.0, 1.0);
        if b < 1.0 {
            at.nested(self.a, weight * (1.0 - b), out);
        }
        if b > 0.0 {
            at.nested(self.b, weight * b, out);
        }
    }
}

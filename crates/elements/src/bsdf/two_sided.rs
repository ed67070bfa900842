//! `two_sided`: a material that looks the same, or given so different, from behind.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `bsdf` | bsdf | | the material in front |
//! | `back` | bsdf | `bsdf` | the material behind |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::Spectrum;

use super::{
    Bsdf, EmissionContext, Material, MaterialContext, MaterialOps, nested_material, optional_material,
};
use crate::{Element, Resolver, Texture};

/// A material for both sides.
#[derive(Clone, Copy, Debug)]
pub struct TwoSided {
    front: Id<Material>,
    back: Id<Material>,
}

impl Element for TwoSided {
    const SUMMARY: &'static str = "A material that is the same, or another one, from behind.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "bsdf", ty: "bsdf", default: "", doc: "the material in front" },
        ParamDoc { name: "back", ty: "bsdf", default: "bsdf", doc: "the material behind" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let front = nested_material(params, resolver, "bsdf", "two_sided")?;
        Ok(Self { front, back: optional_material(params, resolver, "back")?.unwrap_or(front) })
    }
}

impl MaterialOps for TwoSided {
    #[inline]
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        if at.wo.dot(at.frame.n) >= 0.0 {
            at.nested(self.front, weight, out);
        } else {
            let behind = MaterialContext { frame: at.frame.flipped(), ng: -at.ng, ..*at };
            behind.nested(self.back, weight, out);
        }
    }

    fn shines(&self, materials: &Arena<Material>) -> bool {
        [self.front, self.back].into_iter().any(|material| materials[material].shines(materials))
    }

    fn is_see_through(&self, materials: &Arena<Material>, textures: &Arena<Texture>) -> bool {
        [self.front, self.back].into_iter().any(|side| materials[side].is_see_through(materials, textures))
    }

    fn emitted(&self, at: &EmissionContext<'_>) -> Spectrum {
        if at.cos >= 0.0 { at.nested(self.front) } else { at.flipped().nested(self.back) }
    }
}

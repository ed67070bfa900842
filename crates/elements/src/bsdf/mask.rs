//! `mask`: a material with holes.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `opacity` | texture | 0.5 | 0 where light passes, 1 where the material is |
//! | `bsdf` | bsdf | | the material |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::Spectrum;

use super::{
    Bsdf, EmissionContext, Material, MaterialContext, MaterialOps, NullLobe, has_holes, nested_material,
};
use crate::{Element, Resolver, Texture, float_texture};

/// A cut-out.
#[derive(Clone, Copy, Debug)]
pub struct Mask {
    opacity: Id<Texture>,
    material: Id<Material>,
}

impl Element for Mask {
    const SUMMARY: &'static str = "A material with holes.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "opacity",
            ty: "texture",
            default: "0.5",
            doc: "0 where light passes, 1 where the material is",
        },
        ParamDoc { name: "bsdf", ty: "bsdf", default: "", doc: "the material" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let opacity = float_texture(params, resolver, "opacity", 0.5)?;
        Ok(Self { opacity, material: nested_material(params, resolver, "bsdf", "mask")? })
    }
}

impl MaterialOps for Mask {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let opacity = at.texture.float(self.opacity).clamp(0.0, 1.0);
        out.push(NullLobe::CLEAR, weight * (1.0 - opacity), at.frame, at.frame.n);
        if opacity > 0.0 {
            at.nested(self.material, weight * opacity, out);
        }
    }

    fn shines(&self, materials: &Arena<Material>) -> bool {
        materials[self.material].shines(materials)
    }

    fn is_see_through(&self, materials: &Arena<Material>, textures: &Arena<Texture>) -> bool {
        has_holes(self.opacity, textures) || materials[self.material].is_see_through(materials, textures)
    }

    fn emitted(&self, at: &EmissionContext<'_>) -> Spectrum {
        at.nested(self.material) * at.texture.float(self.opacity).clamp(0.0, 1.0)
    }
}

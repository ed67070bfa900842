//! `bump`: bends the shading normal as if a texture raised the surface.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `texture` | texture | | height |
//! | `scale` | float | 1 | factor on the height |
//! | `bsdf` | bsdf | | the material |
//! | `flip_invalid_normals` | bool | true | mirror a bent normal that the viewer could only see from behind |
//! | `soften_terminator` | bool | true | fade light towards the true surface's horizon |
//!
//! References: [Blinn 1978] "Simulation of Wrinkled Surfaces".

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::Spectrum;

use super::bend::{BEND_PARAMS, Bend};
use super::{Bsdf, EmissionContext, Material, MaterialContext, MaterialOps};
use crate::{Element, Resolver, Texture, float_texture};

/// A bumpy material.
#[derive(Clone, Copy, Debug)]
pub struct Bump {
    height: Id<Texture>,
    scale: f32,
    bend: Bend,
}

impl Element for Bump {
    const SUMMARY: &'static str = "Bends the shading normal as if a texture raised the surface.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c] = BEND_PARAMS;
        [
            ParamDoc { name: "texture", ty: "texture", default: "0", doc: "height" },
            ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor on the height" },
            a,
            b,
            c,
        ]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let height = float_texture(params, resolver, "texture", 0.0)?;
        let scale = params.float("scale", 1.0)?;
        Ok(Self { height, scale, bend: Bend::from_params(params, resolver, "bump")? })
    }
}

impl MaterialOps for Bump {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let slope = at.texture.gradient(self.height) * self.scale;
        let n = at.frame.n;
        // The displaced surface's tangents, without the second derivatives of the base surface.
        let du = at.dp_du + n * (slope.x - n.dot(at.dp_du));
        let dv = at.dp_dv + n * (slope.y - n.dot(at.dp_dv));
        let bent = du.cross(dv).try_normalized().map_or(n, |bent| bent.face_forward(at.ng));
        self.bend.evaluate(bent, at, weight, out);
    }

    fn shines(&self, materials: &Arena<Material>) -> bool {
        materials[self.bend.material].shines(materials)
    }

    fn is_see_through(&self, materials: &Arena<Material>, textures: &Arena<Texture>) -> bool {
        materials[self.bend.material].is_see_through(materials, textures)
    }

    fn emitted(&self, at: &EmissionContext<'_>) -> Spectrum {
        at.nested(self.bend.material)
    }
}

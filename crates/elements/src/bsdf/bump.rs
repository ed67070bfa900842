//! `bump`: bends the shading normal as if a texture raised the surface.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `texture` | texture | | height |
//! | `scale` | float | 1 | factor on the height |
//! | `bsdf` | bsdf | | the material |
//!
//! References: [Blinn 1978] "Simulation of Wrinkled Surfaces".

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Frame, Id};

use super::{Bsdf, Material, MaterialContext, MaterialOps, nested_material};
use crate::{Element, Resolver, Texture, float_texture};

/// A bumpy material.
#[derive(Clone, Copy, Debug)]
pub struct Bump {
    height: Id<Texture>,
    scale: f32,
    material: Id<Material>,
}

impl Element for Bump {
    const SUMMARY: &'static str = "Bends the shading normal as if a texture raised the surface.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "texture", ty: "texture", default: "0", doc: "height" },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor on the height" },
        ParamDoc { name: "bsdf", ty: "bsdf", default: "", doc: "the material" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let height = float_texture(params, resolver, "texture", 0.0)?;
        let scale = params.float("scale", 1.0)?;
        Ok(Self { height, scale, material: nested_material(params, resolver, "bsdf", "bump")? })
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
        let first = out.len();
        let frame = Frame::from_normal_and_tangent(bent, at.dp_du);
        MaterialContext { frame, ..*at }.nested(self.material, weight, out);
        out.rebase(first, n);
    }
}

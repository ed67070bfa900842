//! `bump`: bends the shading normal as if a texture raised the surface.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `texture` | texture | | height |
//! | `scale` | float | 1 | factor on the height |
//! | `bsdf` | bsdf | | the material |
//! | `tangents` | string | projected | the surface's `projected` to its shading normals, or `displaced` with them |
//! | `keep_sides` | bool | true | no light where the bent normal and the true one take it to be on different sides |
//! | `flip_invalid_normals` | bool | true | mirror a bent normal that the viewer could only see from behind |
//! | `soften_terminator` | bool | true | fade light towards the true surface's horizon |
//!
//! With `displaced`, the height moves the surface along its shading normals, which turn: tangents change with the height itself,
//! not only with its slope; and where shading normals are interpolated between vertices, v's tangent stands upright on u's. pbrt
//! does so, and Mitsuba neither.
//!
//! References: [Blinn 1978] "Simulation of Wrinkled Surfaces".

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Vector3};
use aureole_spectrum::Spectrum;

use super::bend::{BEND_PARAMS, Bend};
use super::{Bsdf, EmissionContext, Material, MaterialContext, MaterialOps};
use crate::{Element, Resolver, Texture, float_texture};

/// A bumpy material.
#[derive(Clone, Copy, Debug)]
pub struct Bump {
    height: Id<Texture>,
    scale: f32,
    /// Whether tangents are `displaced`.
    is_displaced: bool,
    bend: Bend,
}

impl Bump {
    /// Whether it asks how shading normals change.
    pub fn follows_normals(&self) -> bool {
        self.is_displaced
    }
}

impl Element for Bump {
    const SUMMARY: &'static str = "Bends the shading normal as if a texture raised the surface.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d] = BEND_PARAMS;
        [
            ParamDoc { name: "texture", ty: "texture", default: "0", doc: "height" },
            ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor on the height" },
            a,
            b,
            c,
            d,
            ParamDoc {
                name: "tangents",
                ty: "string",
                default: "projected",
                doc: "the surface's, `projected` to its shading normals or `displaced` with them",
            },
        ]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let height = float_texture(params, resolver, "texture", 0.0)?;
        let scale = params.float("scale", 1.0)?;
        let is_displaced = params.one_of("tangents", &[("projected", false), ("displaced", true)])?;
        Ok(Self { height, scale, is_displaced, bend: Bend::from_params(params, resolver, "bump")? })
    }
}

impl MaterialOps for Bump {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let slope = at.texture.gradient(self.height) * self.scale;
        let n = at.frame.n;
        // The displaced surface's tangents.
        let project = |tangent: Vector3| tangent - n * n.dot(tangent);
        let [mut du, mut dv] = [at.dp_du, at.dp_dv].map(project);
        if self.is_displaced {
            let height = at.texture.float(self.height) * self.scale;
            if at.has_vertex_normals {
                dv = n.cross(du);
            }
            du += at.dn_duv[0] * height;
            dv += at.dn_duv[1] * height;
        }
        du += n * slope.x;
        dv += n * slope.y;
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

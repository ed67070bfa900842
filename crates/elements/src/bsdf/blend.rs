//! `blend`: a mixture of two materials.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `weight` | texture | 0.5 | how much of `b`, in [0, 1] |
//! | `a`, `b` | bsdf | | the materials |
//! | `dirac` | string | exact | how a mirror or window counts beside what scatters: `exact`, or `density_one` |
//!
//! A blend is the weighted mean of its parts. With `density_one` a direction that a smooth part draws is weighed as if
//! its Dirac were a density of one per steradian beside the density of the other part, and has that part's value too. That is no
//! scattering that could be written down, and loses light; Mitsuba 3.9 does so, and its scenes are tuned to it.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id};
use aureole_spectrum::Spectrum;

use super::{Bsdf, EmissionContext, Material, MaterialContext, MaterialOps, nested_material};
use crate::{Element, Resolver, Texture, float_texture};

/// A mixture.
#[derive(Clone, Copy, Debug)]
pub struct Blend {
    weight: Id<Texture>,
    a: Id<Material>,
    b: Id<Material>,
    dirac: Dirac,
}

/// How Dirac distributions count beside densities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dirac {
    Exact,
    DensityOne,
}

impl Element for Blend {
    const SUMMARY: &'static str = "A mixture of two materials.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "weight", ty: "texture", default: "0.5", doc: "how much of `b`, in [0, 1]" },
        ParamDoc { name: "a", ty: "bsdf", default: "", doc: "the material at weight 0" },
        ParamDoc { name: "b", ty: "bsdf", default: "", doc: "the material at weight 1" },
        ParamDoc {
            name: "dirac",
            ty: "string",
            default: "exact",
            doc: "`exact`, or `density_one` as in Mitsuba",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let weight = float_texture(params, resolver, "weight", 0.5)?;
        let a = nested_material(params, resolver, "a", "blend")?;
        let dirac = params.one_of("dirac", &[("exact", Dirac::Exact), ("density_one", Dirac::DensityOne)])?;
        Ok(Self { weight, a, b: nested_material(params, resolver, "b", "blend")?, dirac })
    }
}

impl MaterialOps for Blend {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let b = at.texture.float(self.weight).clamp(0.0, 1.0);
        let first = out.len();
        if b < 1.0 {
            at.nested(self.a, weight * (1.0 - b), out);
        }
        if b > 0.0 {
            at.nested(self.b, weight * b, out);
        }
        if self.dirac == Dirac::DensityOne {
            out.count_diracs(first);
        }
    }

    fn shines(&self, materials: &Arena<Material>) -> bool {
        [self.a, self.b].into_iter().any(|material| materials[material].shines(materials))
    }

    fn is_see_through(&self, materials: &Arena<Material>, textures: &Arena<Texture>) -> bool {
        [self.a, self.b].into_iter().any(|part| materials[part].is_see_through(materials, textures))
    }

    fn emitted(&self, at: &EmissionContext<'_>) -> Spectrum {
        at.nested(self.a).lerp(at.nested(self.b), at.texture.float(self.weight).clamp(0.0, 1.0))
    }
}

//! `coated_conductor`: a metal under a dielectric coat, by a random walk between the two: lacquered brass, car paint.
//!
//! Parameters: those of `coated_diffuse` for the coat and the medium; those of `conductor` for the base (with `Cu` as
//! default), whose index is taken relative to the coat's; and
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `base_alpha`, `base_alpha_u`, `base_alpha_v` | texture | 0 | the base's GGX roughness |
//!
//! References: see [`layered`](super::layered).

use aureole_desc::{ParamDoc, Params, SceneError};

use super::coated_diffuse::{COATING_PARAMS, Coating};
use super::conductor::{METAL_PARAMS, Metallic};
use super::layered::Base;
use super::microfacet::Finish;
use super::{Bsdf, MaterialContext, MaterialOps};
use crate::{Element, Resolver};

/// A coated metal.
#[derive(Clone, Copy, Debug)]
pub struct CoatedConductor {
    coating: Coating,
    metal: Metallic,
    finish: Finish,
}

impl Element for CoatedConductor {
    const SUMMARY: &'static str = "A metal under a dielectric coat, by a random walk between them.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d, e, f, g, h, i, j] = COATING_PARAMS;
        let [k, l, m, n, o, p, q, r] = METAL_PARAMS;
        let s = ParamDoc { name: "base_alpha", ty: "texture", default: "0", doc: "the base's roughness" };
        let t = ParamDoc { name: "base_alpha_u", default: "base_alpha", doc: "along the tangent", ..s };
        let u = ParamDoc { name: "base_alpha_v", default: "base_alpha", doc: "across it", ..s };
        [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let coating = Coating::from_params(params, resolver)?;
        let metal = Metallic::from_params(params, resolver)?;
        Ok(Self { coating, metal, finish: Finish::from_params(params, resolver, "base_alpha")? })
    }
}

impl MaterialOps for CoatedConductor {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let metal = self.metal.at(&at.texture);
        let facets = self.finish.at(&at.texture);
        let lobe = self.coating.at(&at.texture, |eta| Base::Metal(metal.below(eta), facets));
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

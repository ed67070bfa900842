//! `coated_diffuse`: a matte base under a dielectric coat, by a random walk between the two: paint, varnished wood.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `reflectance` | texture | 0.5 | albedo of the base |
//! | `alpha`, `alpha_u`, `alpha_v` | texture | 0 | the coat's GGX roughness |
//! | `int_ior`, `ext_ior` | float or name | bk7, air | indices of the coat and outside |
//! | `thickness` | texture | 0.01 | of the medium below the coat, in mean free paths |
//! | `albedo` | texture | 0 | of that medium; 0: it only absorbs |
//! | `g` | texture | 0 | mean cosine of its scattering, in (-1, 1) |
//! | `max_depth` | int | 10 | how often light may meet a layer |
//! | `sample_count` | int | 1 | walks per evaluation |
//!
//! `plastic` is the same without noise, without a medium, and nearly so for rough coats.
//!
//! References: see [`layered`](super::layered).

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::Id;
use aureole_spectrum::SpectrumRole;

use super::dielectric::relative_ior;
use super::layered::{Base, LayeredLobe};
use super::microfacet::Finish;
use super::{Bsdf, MaterialContext, MaterialOps};
use crate::{Element, Resolver, Texture, TextureContext, float_texture, spectrum_texture};

/// What coated materials share: the coat and what lies between it and the base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coating {
    eta: f32,
    finish: Finish,
    thickness: Id<Texture>,
    albedo: Id<Texture>,
    g: Id<Texture>,
    max_depth: u16,
    sample_count: u16,
}

/// Documentation of those parameters.
pub(super) const COATING_PARAMS: [ParamDoc; 10] = [
    ParamDoc { name: "alpha", ty: "texture", default: "0", doc: "the coat's roughness in both directions" },
    ParamDoc { name: "alpha_u", ty: "texture", default: "alpha", doc: "roughness along the tangent" },
    ParamDoc { name: "alpha_v", ty: "texture", default: "alpha", doc: "roughness across it" },
    ParamDoc { name: "int_ior", ty: "float or name", default: "bk7", doc: "index of the coat" },
    ParamDoc { name: "ext_ior", ty: "float or name", default: "air", doc: "index outside" },
    ParamDoc {
        name: "thickness",
        ty: "texture",
        default: "0.01",
        doc: "distance to the base, in mean free paths",
    },
    ParamDoc {
        name: "albedo",
        ty: "texture",
        default: "0",
        doc: "of the medium between; 0: it only absorbs",
    },
    ParamDoc { name: "g", ty: "texture", default: "0", doc: "mean cosine of its scattering" },
    ParamDoc { name: "max_depth", ty: "int", default: "10", doc: "how often light may meet a layer" },
    ParamDoc { name: "sample_count", ty: "int", default: "1", doc: "walks per evaluation" },
];

impl Coating {
    pub(super) fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            eta: relative_ior(params, "bk7")?,
            finish: Finish::from_params(params, resolver, "alpha")?,
            thickness: float_texture(params, resolver, "thickness", 0.01)?,
            albedo: spectrum_texture(params, resolver, "albedo", 0.0, SpectrumRole::Albedo)?,
            g: float_texture(params, resolver, "g", 0.0)?,
            max_depth: params.int_in("max_depth", 10, 1, 1000)? as u16,
            sample_count: params.int_in("sample_count", 1, 1, 1000)? as u16,
        })
    }

    /// The coated base at a point; `base` is asked for with the coat's index.
    pub(super) fn at(&self, at: &TextureContext<'_>, base: impl Fn(f32) -> Base) -> LayeredLobe {
        LayeredLobe {
            eta: self.eta,
            coat: self.finish.at(at),
            base: base(self.eta),
            thickness: at.float(self.thickness).max(f32::MIN_POSITIVE),
            g: at.float(self.g).clamp(-0.99, 0.99),
            albedo: at.albedo(self.albedo),
            max_depth: self.max_depth,
            sample_count: self.sample_count,
        }
    }
}

/// A coated matte base.
#[derive(Clone, Copy, Debug)]
pub struct CoatedDiffuse {
    coating: Coating,
    reflectance: Id<Texture>,
}

impl Element for CoatedDiffuse {
    const SUMMARY: &'static str = "A matte base under a dielectric coat, by a random walk between them.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d, e, f, g, h, i, j] = COATING_PARAMS;
        let reflectance =
            ParamDoc { name: "reflectance", ty: "texture", default: "0.5", doc: "albedo of the base" };
        [reflectance, a, b, c, d, e, f, g, h, i, j]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let coating = Coating::from_params(params, resolver)?;
        let reflectance = spectrum_texture(params, resolver, "reflectance", 0.5, SpectrumRole::Albedo)?;
        Ok(Self { coating, reflectance })
    }
}

impl MaterialOps for CoatedDiffuse {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let albedo = at.texture.albedo(self.reflectance);
        let lobe = self.coating.at(&at.texture, |_| Base::Matte(albedo));
        out.push(lobe, weight, at.frame, at.frame.n);
    }
}

//! `normal_map`: takes the shading normal from a picture.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `texture` | texture | | normal in the shading frame, each coordinate mapped from [-1, 1] to [0, 1]; raw data |
//! | `bsdf` | bsdf | | the material |
//! | `keep_sides` | bool | true | no light where the bent normal and the true one take it to be on different sides |
//! | `flip_invalid_normals` | bool | true | mirror a bent normal that the viewer could only see from behind |
//! | `soften_terminator` | bool | true | fade light towards the true surface's horizon |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Arena, Id, Vector3};
use aureole_spectrum::{Spectrum, SpectrumRole};

use super::bend::{BEND_PARAMS, Bend};
use super::{Bsdf, EmissionContext, Material, MaterialContext, MaterialOps};
use crate::{Element, Resolver, Texture, spectrum_texture};

/// A material with mapped normals.
#[derive(Clone, Copy, Debug)]
pub struct NormalMap {
    normals: Id<Texture>,
    bend: Bend,
}

impl Element for NormalMap {
    const SUMMARY: &'static str = "Takes the shading normal from a picture.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d] = BEND_PARAMS;
        [
            ParamDoc {
                name: "texture",
                ty: "texture",
                default: "",
                doc: "normal in the shading frame, [-1, 1] as [0, 1]",
            },
            a,
            b,
            c,
            d,
        ]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let normals = spectrum_texture(params, resolver, "texture", 1.0, SpectrumRole::Unbounded)?;
        Ok(Self { normals, bend: Bend::from_params(params, resolver, "normal_map")? })
    }
}

impl MaterialOps for NormalMap {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let [x, y, z] = at.texture.spectrum(self.normals).rgb().map(|c| 2.0 * c - 1.0);
        let bent = at.frame.to_world(Vector3::new(x, y, z)).try_normalized().unwrap_or(at.frame.n);
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

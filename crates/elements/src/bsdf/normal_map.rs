//! `normal_map`: takes the shading normal from a picture.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `texture` | texture | | normal in the shading frame, each coordinate mapped from [-1, 1] to [0, 1]; raw data |
//! | `bsdf` | bsdf | | the material |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Frame, Id, Vector3};
use aureole_spectrum::SpectrumRole;

use super::{Bsdf, Material, MaterialContext, MaterialOps, nested_material};
use crate::{Element, Resolver, Texture, spectrum_texture};

/// A material with mapped normals.
#[derive(Clone, Copy, Debug)]
pub struct NormalMap {
    normals: Id<Texture>,
    material: Id<Material>,
}

impl Element for NormalMap {
    const SUMMARY: &'static str = "Takes the shading normal from a picture.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "texture",
            ty: "texture",
            default: "",
            doc: "normal in the shading frame, [-1, 1] as [0, 1]",
        },
        ParamDoc { name: "bsdf", ty: "bsdf", default: "", doc: "the material" },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let normals = spectrum_texture(params, resolver, "texture", 1.0, SpectrumRole::Unbounded)?;
        Ok(Self { normals, material: nested_material(params, resolver, "bsdf", "normal_map")? })
    }
}

impl MaterialOps for NormalMap {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        let [x, y, z] = at.texture.spectrum(self.normals).rgb().map(|c| 2.0 * c - 1.0);
        let bent = at.frame.to_world(Vector3::new(x, y, z)).try_normalized().unwrap_or(at.frame.n);
        let first = out.len();
        let frame = Frame::from_normal_and_tangent(bent, at.dp_du);
        MaterialContext { frame, ..*at }.nested(self.material, weight, out);
        out.rebase(first, at.frame.n);
    }
}

//! `mesh_attribute`: a quantity stored on a mesh's vertices or faces.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `name` | string | vertex_color | the attribute |
//! | `scale` | float | 1 | factor |
//!
//! Zero on surfaces without that attribute, with a warning.

use aureole_desc::{Attribute, AttributeDomain, ParamDoc, Params, SceneError};
use aureole_math::Arena;
use aureole_spectrum::Spectrum;

use super::{MeshPoint, Texture, TextureContext, TextureOps};
use crate::{Element, Resolver};

/// A mesh's own quantity.
#[derive(Clone, Debug)]
pub struct MeshAttribute {
    name: String,
    scale: f32,
}

impl Element for MeshAttribute {
    const SUMMARY: &'static str = "A quantity stored on a mesh's vertices or faces.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "name", ty: "string", default: "vertex_color", doc: "the attribute" },
        ParamDoc { name: "scale", ty: "float", default: "1", doc: "factor" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let name = params.try_string("name")?.unwrap_or_else(|| "vertex_color".to_owned());
        Ok(Self { name, scale: params.float("scale", 1.0)? })
    }
}

fn read(attribute: &Attribute, point: &MeshPoint<'_>) -> [f32; 3] {
    let n = attribute.channels;
    let value = |index: u32, c: usize| attribute.data[index as usize * n + c.min(n - 1)];
    std::array::from_fn(|c| match attribute.domain {
        AttributeDomain::Face => value(point.face, c),
        AttributeDomain::Vertex => (0..3).map(|i| point.barycentric[i] * value(point.vertices[i], c)).sum(),
    })
}

impl TextureOps for MeshAttribute {
    fn eval(&self, at: &TextureContext<'_>) -> Spectrum {
        let found = at.mesh.and_then(|point| {
            let attribute = point.attributes.iter().find(|a| a.name == self.name)?;
            Some(Spectrum::from_rgb(read(attribute, &point)) * self.scale)
        });
        found.unwrap_or(Spectrum::ZERO)
    }

    fn mean(&self, _: &Arena<Texture>) -> Spectrum {
        Spectrum::splat(0.5 * self.scale)
    }
}

//! Light that a material sends out by itself.

use aureole_math::{Arena, Id};
use aureole_spectrum::Spectrum;

use super::Material;
use crate::TextureContext;

/// Where a material is asked for its own light.
#[derive(Clone, Copy, Debug)]
pub struct EmissionContext<'a> {
    /// What textures need to know; all but a mesh's attributes.
    pub texture: TextureContext<'a>,
    /// All materials of the scene.
    pub materials: &'a Arena<Material>,
    /// Cosine between the direction and the geometric normal; negative behind the surface.
    pub cos: f32,
}

impl EmissionContext<'_> {
    /// The light of a nested material.
    pub fn nested(&self, material: Id<Material>) -> Spectrum {
        self.materials[material].emitted(self)
    }

    /// The same place, seen from the other side.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let texture = TextureContext { n: -self.texture.n, ..self.texture };
        Self { texture, cos: -self.cos, ..*self }
    }
}

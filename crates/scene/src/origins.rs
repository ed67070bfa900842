//! Which node of the description each element was built from, so that messages about a render can point into its files.

use aureole_desc::NodeId;
use aureole_elements::{Light, Material, Shape};
use aureole_math::Id;
use rustc_hash::FxHashMap;

/// The nodes of a scene's elements.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    pub(crate) shapes: Vec<NodeId>,
    pub(crate) materials: FxHashMap<Id<Material>, NodeId>,
    pub(crate) lights: Vec<NodeId>,
}

impl Origins {
    /// Where a shape comes from.
    pub fn shape(&self, id: Id<Shape>) -> Option<NodeId> {
        self.shapes.get(id.index()).copied()
    }

    /// Where a material comes from; none for the one that shapes without a material have.
    pub fn material(&self, id: Id<Material>) -> Option<NodeId> {
        self.materials.get(&id).copied()
    }

    /// Where a light comes from.
    pub fn light(&self, id: Id<Light>) -> Option<NodeId> {
        self.lights.get(id.index()).copied()
    }
}

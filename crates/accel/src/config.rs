//! How acceleration structures are built.

/// The structure that finds hits. All of them find the same ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Structure {
    /// Every primitive, every ray: the oracle.
    List,
    /// A hierarchy of bounding volumes, eight children a node.
    #[default]
    Hierarchy,
}

/// Options of a build.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// The structure.
    pub structure: Structure,
    /// Bins of the surface-area heuristic.
    pub bins: usize,
    /// Primitives in a leaf at most.
    pub max_leaf_size: usize,
    /// Cost of visiting a node over that of testing a primitive.
    pub traversal_cost: f32,
}

impl Default for Config {
    fn default() -> Self {
        Self { structure: Structure::Hierarchy, bins: 16, max_leaf_size: 8, traversal_cost: 1.0 }
    }
}

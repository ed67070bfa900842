//! How acceleration structures are built.

pub use crate::grid::GridConfig;

/// The structure that finds hits. All of them find the same ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Structure {
    /// Every primitive, every ray: the oracle.
    List,
    /// Equal cells, each with a list of what is in it.
    Grid,
    /// A plain hierarchy of bounding volumes: two children a node.
    Binary,
    /// A hierarchy of bounding volumes, eight children a node.
    #[default]
    Hierarchy,
}

/// Children of a node of [`Structure::Hierarchy`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Width {
    /// What was fastest where it was measured: eight.
    #[default]
    Auto,
    /// Eight: a register of AVX2.
    Eight,
    /// Sixteen: a register of AVX-512. Slices of rays are walked one by one.
    Sixteen,
}

/// What [`Structure::Hierarchy`] keeps in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Whole planes, triangles ready for the test.
    #[default]
    Fast,
    /// Planes of eight bits, and of triangles only their numbers: the meshes' own arrays are read. Nodes have eight children.
    Compact,
}

/// How rays are tested against triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accuracy {
    /// No ray slips through between triangles that share an edge, and none hits the triangle that it starts on.
    #[default]
    Watertight,
    /// The fewest operations.
    Fast,
}

/// How much time a build takes for how good a hierarchy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Along a space-filling curve: for what changes with every frame.
    Fast,
    /// By the surface-area heuristic over bins.
    #[default]
    Medium,
    /// Large primitives split, and the tree optimised afterwards.
    High,
}

/// Options of a build.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Config {
    /// The structure.
    pub structure: Structure,
    /// The triangle test.
    pub accuracy: Accuracy,
    /// The hierarchy's quality.
    pub quality: Quality,
    /// The hierarchy's nodes.
    pub width: Width,
    /// The hierarchy's memory.
    pub layout: Layout,
    /// The grid's layout.
    pub grid: GridConfig,
}

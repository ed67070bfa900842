//! Figures about structures.

/// Figures about the structures of a level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Expected cost of a ray that meets the root, in visits of a node or tests of a group of primitives [MacDonald and Booth
    /// 1990]. Zero for lists and grids.
    pub sah_cost: f32,
    /// What it was when the level was built: a refit makes the other one larger.
    pub built_sah_cost: f32,
    /// Nodes that have children.
    pub nodes: usize,
    /// Leaves, or cells of a grid.
    pub leaves: usize,
    /// Children of all nodes together.
    pub children: usize,
    /// Nodes on the longest way from the root to a leaf.
    pub depth: usize,
    /// Primitives.
    pub primitives: usize,
    /// Primitives, counted once for each leaf that holds them.
    pub references: usize,
    /// Bytes of nodes and leaves.
    pub bytes: usize,
}

impl Stats {
    /// Children a node, on average.
    pub fn mean_children(&self) -> f32 {
        self.children as f32 / self.nodes.max(1) as f32
    }

    /// Bytes a primitive.
    pub fn bytes_a_primitive(&self) -> f32 {
        self.bytes as f32 / self.primitives.max(1) as f32
    }

    /// How much more a ray is expected to cost than when the level was built: 1 before any refit.
    pub fn degradation(&self) -> f32 {
        if self.built_sah_cost > 0.0 { self.sah_cost / self.built_sah_cost } else { 1.0 }
    }

    /// Both structures together.
    pub(crate) fn merged(self, other: Self) -> Self {
        Self {
            sah_cost: self.sah_cost + other.sah_cost,
            built_sah_cost: self.built_sah_cost + other.built_sah_cost,
            nodes: self.nodes + other.nodes,
            leaves: self.leaves + other.leaves,
            children: self.children + other.children,
            depth: self.depth.max(other.depth),
            primitives: self.primitives + other.primitives,
            references: self.references + other.references,
            bytes: self.bytes + other.bytes,
        }
    }
}

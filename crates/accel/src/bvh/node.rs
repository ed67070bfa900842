//! The layout: nodes of eight children, each axis's planes side by side.

/// Children per node.
pub(crate) const WIDTH: usize = 8;
/// Levels of the deepest tree.
pub(crate) const MAX_LEVELS: usize = 128;
/// Marks a leaf in a child's reference.
pub(crate) const LEAF: u32 = 1 << 31;
/// Bits of a leaf's reference that count its items.
pub(crate) const COUNT_BITS: u32 = 4;

/// Eight boxes and what is inside them. An empty slot has a box that no ray meets.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// `planes[axis][side]`: side 0 the lower, 1 the upper planes of the eight boxes.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    /// A node's index, or a leaf: [`LEAF`], first item, number of items.
    pub children: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Self =
        Self { planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], children: [LEAF; WIDTH] };
}

/// A hierarchy over items that its owner keeps in leaf order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bvh8 {
    pub nodes: Vec<Node>,
    pub stats: Stats,
}

/// Figures about a hierarchy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Expected cost of a ray that meets the root, in primitive tests [MacDonald and Booth 1990].
    pub sah_cost: f32,
    /// Nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Longest way from the root to a leaf.
    pub depth: usize,
    /// Primitives, counted once for each leaf that holds them.
    pub primitives: usize,
    /// Bytes of nodes and leaves.
    pub bytes: usize,
}

impl Stats {
    /// Both structures together.
    pub(crate) fn merged(self, other: Self) -> Self {
        Self {
            sah_cost: self.sah_cost + other.sah_cost,
            nodes: self.nodes + other.nodes,
            leaves: self.leaves + other.leaves,
            depth: self.depth.max(other.depth),
            primitives: self.primitives + other.primitives,
            bytes: self.bytes + other.bytes,
        }
    }
}

//! The binary tree that all builders make and the collapse turns into nodes.

use aureole_math::{Bounds3, Point3};
use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::Stats;
use crate::big::Big;

/// Larger areas count as this one, so that no sum of costs becomes infinite.
pub(super) const MAX_AREA: f32 = 1e28;
/// Marks a leaf.
const LEAF: u32 = 1 << 31;
/// Levels of the binary tree that may be cut anywhere; below them lists are halved, since a hostile input could make a tree
/// as deep as it is long.
pub(crate) const FREE_LEVELS: usize = 40;

/// The box of a primitive on its way through a builder: its smaller corner and the negative of its larger one, so that one
/// minimum unites two boxes. The fourth number carries the bits of the primitive's number.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Item {
    pub numbers: [f32; 8],
}

impl Item {
    pub(crate) fn new(bounds: &Bounds3, index: u32) -> Self {
        let (min, max) = (bounds.min, -bounds.max.to_vector());
        // The last one keeps the fourth of the center from being a subnormal number, which some processors are slow with.
        Self { numbers: [min.x, min.y, min.z, f32::from_bits(index), max.x, max.y, max.z, 1.0] }
    }

    pub(crate) fn index(&self) -> u32 {
        self.numbers[3].to_bits()
    }

    /// Twice the centroid; the fourth lane means nothing.
    #[inline(always)]
    pub(crate) fn center(&self) -> Vec4 {
        let [min, negative_max]: [Vec4; 2] = bytemuck::cast(self.numbers);
        min - negative_max
    }

    /// One component of it.
    #[inline(always)]
    pub(crate) fn center_on(&self, axis: usize) -> f32 {
        self.numbers[axis % 4] - self.numbers[4 + axis % 4]
    }

    #[inline(always)]
    pub(crate) fn bounds(&self) -> Extent {
        Extent::from_numbers(&self.numbers)
    }
}

/// A box in registers; the fourth lanes mean nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub min: Vec4,
    pub max: Vec4,
}

impl Extent {
    pub(crate) const EMPTY: Self = Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY };

    /// From the smaller corner and the negative of the larger one.
    #[inline(always)]
    pub(crate) fn from_numbers(numbers: &[f32; 8]) -> Self {
        let [min, negative_max]: [Vec4; 2] = bytemuck::cast(*numbers);
        Self { min, max: -negative_max }
    }

    pub(crate) fn from(bounds: &Bounds3) -> Self {
        Item::new(bounds, 0).bounds()
    }

    #[inline(always)]
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    #[inline(always)]
    pub(crate) fn with(&self, point: Vec4) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// Half the surface; zero for the empty box.
    #[inline(always)]
    pub(crate) fn half_area(&self) -> f32 {
        let d = (self.max - self.min).max(Vec4::ZERO);
        (d.x * (d.y + d.z) + d.y * d.z).min(MAX_AREA)
    }

    /// Twice as far from the origin.
    pub(crate) fn doubled(&self) -> Self {
        Self { min: self.min * 2.0, max: self.max * 2.0 }
    }

    /// What is in both.
    pub(crate) fn intersection(&self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.min.truncate().cmpgt(self.max.truncate()).any()
    }

    pub(crate) fn bounds(&self) -> Bounds3 {
        Bounds3 {
            min: Point3::new(self.min.x, self.min.y, self.min.z),
            max: Point3::new(self.max.x, self.max.y, self.max.z),
        }
    }
}

/// A node of a binary tree.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BinaryNode {
    pub bounds: Bounds3,
    /// The children, or the first item and the number of items with [`LEAF`].
    links: [u32; 2],
}

/// What is below a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Below {
    /// Two nodes.
    Nodes(usize, usize),
    /// Items of the tree's order.
    Items { first: usize, count: usize },
}

impl BinaryNode {
    pub(crate) fn inner(bounds: Bounds3, left: usize, right: usize) -> Self {
        Self { bounds, links: [left as u32, right as u32] }
    }

    pub(crate) fn leaf(bounds: Bounds3, first: usize, count: usize) -> Self {
        Self { bounds, links: [first as u32, count as u32 | LEAF] }
    }

    /// The same node in a tree whose numbers are higher by `offset`.
    pub(crate) fn moved(self, offset: usize) -> Self {
        match self.below() {
            Below::Nodes(left, right) => Self::inner(self.bounds, left + offset, right + offset),
            Below::Items { .. } => self,
        }
    }

    /// The same node in a tree that has more nodes and more items before it.
    pub(crate) fn moved_by(self, nodes: usize, items: usize) -> Self {
        match self.below() {
            Below::Nodes(left, right) => Self::inner(self.bounds, left + nodes, right + nodes),
            Below::Items { first, count } => Self::leaf(self.bounds, first + items, count),
        }
    }

    #[inline]
    pub(crate) fn below(&self) -> Below {
        let [a, b] = self.links.map(|link| link as usize);
        if self.links[1] & LEAF == 0 {
            Below::Nodes(a, b)
        } else {
            Below::Items { first: a, count: b & !(LEAF as usize) }
        }
    }

    /// Half the surface.
    #[inline]
    pub(crate) fn half_area(&self) -> f32 {
        let d = self.bounds.max - self.bounds.min;
        (d.x * (d.y + d.z) + d.y * d.z).min(MAX_AREA)
    }
}

/// A binary tree in depth-first order: the root is node 0, the left child comes right after its parent, and whatever is below
/// a node is between it and what comes after it. The items of the leaves are in the same order.
#[derive(Clone, Debug, Default)]
pub(crate) struct BinaryTree {
    pub nodes: Big<BinaryNode>,
    /// The primitives of the leaves.
    pub order: Big<u32>,
    /// Whether some primitives are in several leaves.
    pub copies: bool,
    /// What a ray was expected to cost when the tree was built.
    pub built_sah_cost: f32,
}

impl BinaryTree {
    /// Figures about it, when each leaf holds one group.
    pub(crate) fn stats(&self) -> Stats {
        let mut depths = vec![1; self.nodes.len()];
        let mut stats = Stats { bytes: size_of_val(&self.nodes[..]), ..Stats::default() };
        for (i, node) in self.nodes.iter().enumerate() {
            stats.sah_cost += node.half_area();
            stats.depth = stats.depth.max(depths[i]);
            match node.below() {
                Below::Nodes(left, right) => {
                    stats.nodes += 1;
                    depths[left] = depths[i] + 1;
                    depths[right] = depths[i] + 1;
                }
                Below::Items { .. } => stats.leaves += 1,
            }
        }
        stats.sah_cost /= self.nodes.first().map_or(1.0, BinaryNode::half_area).max(f32::MIN_POSITIVE);
        stats
    }
}

//! The layout: nodes of eight children, each axis's planes side by side.

use aureole_math::{Bounds3, Point3};
use bytemuck::{Pod, Zeroable};

use super::wide::Wide;
use crate::Stats;
use crate::big::Big;

/// Children per node.
pub(crate) const WIDTH: usize = 8;
/// Levels of the deepest tree.
pub(crate) const MAX_LEVELS: usize = 128;
/// Marks a leaf in a child's reference.
pub(crate) const LEAF: u32 = 1 << 31;
/// Bits of a leaf's reference that count its items.
pub(crate) const COUNT_BITS: u32 = 4;

/// Eight boxes and what is inside them. An empty slot has a box that no ray meets.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// `planes[axis][side]`: side 0 the lower, 1 the upper planes of the eight boxes.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    /// A node's index, or a leaf: [`LEAF`], first item, number of items.
    pub children: [u32; WIDTH],
    /// Makes four cache lines full.
    unused: [u32; WIDTH],
}

impl Node {
    pub(crate) const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [LEAF; WIDTH],
        unused: [0; WIDTH],
    };

    pub(crate) fn set_bounds(&mut self, slot: usize, bounds: &Bounds3) {
        for axis in 0..3 {
            self.planes[axis][0][slot] = bounds.min[axis];
            self.planes[axis][1][slot] = bounds.max[axis];
        }
    }

    /// The box in a slot.
    pub(crate) fn bounds(&self, slot: usize) -> Bounds3 {
        let side = |side: usize| Point3::from([0, 1, 2].map(|axis| self.planes[axis][side][slot]));
        Bounds3 { min: side(0), max: side(1) }
    }

    /// The same node in a hierarchy in which nodes and packed things have higher numbers.
    pub(crate) fn moved(mut self, nodes: u32, packed: u32) -> Self {
        for child in &mut self.children {
            *child += match *child {
                LEAF => 0, // an empty slot
                leaf if leaf & LEAF != 0 => packed << COUNT_BITS,
                _ => nodes,
            };
        }
        self
    }
}

/// A hierarchy over items that its owner keeps in leaf order.
#[derive(Clone, Debug)]
pub(crate) struct Bvh<N: Pod> {
    pub nodes: Big<N>,
    pub stats: Stats,
}

/// What builders make.
pub(crate) type Bvh8 = Bvh<Node>;

impl<N: Pod> Bvh<N> {
    /// The box around everything.
    pub(crate) fn bounds<const W: usize>(&self) -> Bounds3
    where
        N: Wide<W>,
    {
        let Some(root) = self.nodes.first() else { return Bounds3::EMPTY };
        (0..W).filter(|&slot| root.child(slot) != LEAF).fold(Bounds3::EMPTY, |bounds, slot| {
            let [min, max] =
                [0, 1].map(|side| Point3::from([0, 1, 2].map(|axis| root.plane(axis, side, slot))));
            bounds.union(Bounds3 { min, max })
        })
    }
}

//! What walks need to know of nodes: the boxes of their children, several at a time.

use bytemuck::{Pod, Zeroable};

use super::node::{Bvh, Bvh8, LEAF, Node};
use crate::simd::{Floats, Simd};

/// Boxes side by side.
pub(crate) trait Boxes<const N: usize> {
    /// A number for each.
    type Floats<S: Simd>: Floats<N>;

    /// The lower planes (side 0) or the upper ones (side 1).
    fn planes<S: Simd>(&self, axis: usize, side: usize) -> Self::Floats<S>;

    /// One of them.
    fn plane(&self, axis: usize, side: usize, slot: usize) -> f32;
}

/// A node: boxes with something in them.
pub(crate) trait Wide<const N: usize>: Boxes<N> + Pod {
    /// What is in a box: a node's index, or a leaf.
    fn child(&self, slot: usize) -> u32;
}

impl Boxes<8> for Node {
    type Floats<S: Simd> = S::F8;

    #[inline(always)]
    fn planes<S: Simd>(&self, axis: usize, side: usize) -> S::F8 {
        S::F8::load(&self.planes[axis][side])
    }

    #[inline(always)]
    fn plane(&self, axis: usize, side: usize, slot: usize) -> f32 {
        self.planes[axis][side][slot % 8]
    }
}

impl Wide<8> for Node {
    #[inline(always)]
    fn child(&self, slot: usize) -> u32 {
        self.children[slot % 8]
    }
}

/// Sixteen boxes: a register of AVX-512.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Node16 {
    planes: [[[f32; 16]; 2]; 3],
    children: [u32; 16],
}

impl Boxes<16> for Node16 {
    type Floats<S: Simd> = S::F16;

    #[inline(always)]
    fn planes<S: Simd>(&self, axis: usize, side: usize) -> S::F16 {
        S::F16::load(&self.planes[axis][side])
    }

    #[inline(always)]
    fn plane(&self, axis: usize, side: usize, slot: usize) -> f32 {
        self.planes[axis][side][slot % 16]
    }
}

impl Wide<16> for Node16 {
    #[inline(always)]
    fn child(&self, slot: usize) -> u32 {
        self.children[slot % 16]
    }
}

impl Node16 {
    const EMPTY: Self =
        Self { planes: [[[f32::INFINITY; 16], [f32::NEG_INFINITY; 16]]; 3], children: [LEAF; 16] };

    /// The node at `at`, with the children of some of its children in their place: always of the one with the largest
    /// box whose children still fit.
    fn gather(bvh: &Bvh8, at: usize) -> Self {
        // Each child's node and slot there.
        let mut slots: arrayvec::ArrayVec<(usize, usize), 16> =
            used(&bvh.nodes[at]).map(|i| (at, i)).collect();
        loop {
            let opened = slots.iter().enumerate().filter_map(|(place, &(node, slot))| {
                let child = bvh.nodes[node].children[slot];
                let fits = child & LEAF == 0
                    && slots.len() - 1 + used(&bvh.nodes[child as usize]).count() <= slots.capacity();
                fits.then(|| (half_area(&bvh.nodes[node], slot), place, child as usize))
            });
            let Some((_, place, child)) = opened.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            slots.swap_remove(place);
            slots.extend(used(&bvh.nodes[child]).map(|i| (child, i)));
        }
        let mut node = Self::EMPTY;
        for (to, &(from, slot)) in slots.iter().enumerate() {
            for axis in 0..3 {
                for side in 0..2 {
                    node.planes[axis][side][to] = bvh.nodes[from].planes[axis][side][slot];
                }
            }
            node.children[to] = bvh.nodes[from].children[slot];
        }
        node
    }
}

/// The slots of a node with something in them.
fn used(node: &Node) -> impl Iterator<Item = usize> + '_ {
    (0..8).filter(|&slot| node.children[slot] != LEAF)
}

fn half_area(node: &Node, slot: usize) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|axis| node.planes[axis][1][slot] - node.planes[axis][0][slot]);
    x * (y + z) + y * z
}

impl Bvh<Node16> {
    /// The same leaves below wider nodes.
    pub(crate) fn widened(bvh: &Bvh8) -> Self {
        let mut nodes: Vec<Node16> = Vec::new();
        if !bvh.nodes.is_empty() {
            nodes.push(Node16::gather(bvh, 0));
        }
        // Children come after their parents; a node's references to the old nodes are replaced when its turn comes.
        let mut at = 0;
        while at < nodes.len() {
            for slot in 0..16 {
                let child = nodes[at].children[slot];
                if child & LEAF == 0 {
                    nodes[at].children[slot] = nodes.len() as u32;
                    nodes.push(Node16::gather(bvh, child as usize));
                }
            }
            at += 1;
        }
        let nodes = crate::big::Big::from(nodes);
        Self { stats: crate::Stats { nodes: nodes.len(), ..bvh.stats }, nodes }
    }
}

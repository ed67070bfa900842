//! Nodes of eight children in 104 bytes: planes in 255ths of the box around them.
//!
//! # References
//! [Ylitie, Karras and Laine 2017] "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.1.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::node::{Bvh, Bvh8, LEAF, Node, WIDTH};
use super::wide::{Boxes, Wide};
use crate::big::Big;
use crate::simd::{Floats, Simd};

/// Eight boxes, rounded outwards.
///
/// # Maths
/// The plane of number `q` is at `origin + scale · q`, the product and the sum rounded: what a builder has checked to hold the
/// box is what a walk computes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CompactNode {
    origin: [f32; 3],
    scale: [f32; 3],
    /// `[axis][side]`, as in [`Node`].
    planes: [[[u8; WIDTH]; 2]; 3],
    children: [u32; WIDTH],
}

impl Boxes<8> for CompactNode {
    type Floats<S: Simd> = S::F8;

    #[inline(always)]
    fn planes<S: Simd>(&self, axis: usize, side: usize) -> S::F8 {
        let numbers = S::numbers(&self.planes[axis][side]);
        numbers * S::F8::splat(self.scale[axis]) + S::F8::splat(self.origin[axis])
    }

    #[inline(always)]
    fn plane(&self, axis: usize, side: usize, slot: usize) -> f32 {
        at(self.origin[axis], self.scale[axis], self.planes[axis][side][slot % WIDTH])
    }
}

impl Wide<8> for CompactNode {
    #[inline(always)]
    fn child(&self, slot: usize) -> u32 {
        self.children[slot % WIDTH]
    }
}

/// Where the plane of a number is.
#[inline(always)]
fn at(origin: f32, scale: f32, number: u8) -> f32 {
    f32::from(number) * scale + origin
}

impl From<&Node> for CompactNode {
    fn from(node: &Node) -> Self {
        let mut compact = Self {
            origin: [0.0; 3],
            scale: [0.0; 3],
            planes: [[[u8::MAX; 8], [0; 8]]; 3],
            children: node.children,
        };
        let used = |&slot: &usize| node.children[slot] != LEAF;
        for axis in 0..3 {
            let [low, high] = &node.planes[axis];
            let least = (0..WIDTH).filter(used).fold(f32::INFINITY, |least, slot| least.min(low[slot]));
            let largest = (0..WIDTH).filter(used).fold(f32::NEG_INFINITY, |most, slot| most.max(high[slot]));
            if least > largest {
                continue; // a node without children
            }
            // A box as large as numbers can be is measured by its halves. A little more than needed, so that rounding
            // leaves the last plane outside.
            let mut scale = (largest * 0.5 - least * 0.5) / 127.5;
            while at(least, scale, u8::MAX) < largest {
                scale = (scale * (1.0 + 4.0 * f32::EPSILON)).next_up();
            }
            (compact.origin[axis], compact.scale[axis]) = (least, scale);
            for slot in (0..WIDTH).filter(used) {
                let guess = |x: f32| if scale > 0.0 { ((x - least) / scale) as u8 } else { 0 };
                let (mut below, mut above) = (guess(low[slot]), guess(high[slot]));
                while at(least, scale, below) > low[slot] {
                    below -= 1; // number 0 is the least plane itself
                }
                while at(least, scale, above) < high[slot] {
                    above += 1; // number 255 is beyond the largest plane
                }
                (compact.planes[axis][0][slot], compact.planes[axis][1][slot]) = (below, above);
            }
        }
        compact
    }
}

impl Bvh<CompactNode> {
    /// The same hierarchy with boxes a little larger.
    pub(crate) fn compacted(bvh: &Bvh8) -> Self {
        let mut nodes = Big::<CompactNode>::zeroed(bvh.nodes.len());
        nodes.par_iter_mut().zip(bvh.nodes.par_iter()).for_each(|(compact, node)| *compact = node.into());
        Self { nodes, stats: bvh.stats }
    }
}

#[cfg(test)]
mod tests {
    use aureole_math::{Bounds3, Pcg32, Point3};

    use super::*;

    #[test]
    fn boxes_hold_what_they_held() {
        let mut rng = Pcg32::new(5);
        let sizes = [1.0, 1e-30, 1e30, 0.0, 1e-42, 3e38];
        for round in 0..2000 {
            let (size, offset) = (sizes[round % 6], sizes[round / 6 % 6]);
            let mut number = || (rng.next_f32() - 0.5) * size + if offset < 1e38 { offset } else { 0.0 };
            let mut node = Node::EMPTY;
            for slot in 0..round % 9 {
                let mut point = || Point3::new(number(), number(), number());
                node.set_bounds(slot, &Bounds3::around([point(), point()]));
                node.children[slot] = LEAF | 17;
            }
            let compact = CompactNode::from(&node);
            for slot in 0..round % 9 {
                for axis in 0..3 {
                    assert!(compact.plane(axis, 0, slot) <= node.planes[axis][0][slot], "{node:?}");
                    assert!(compact.plane(axis, 1, slot) >= node.planes[axis][1][slot], "{node:?}");
                }
            }
        }
    }
}

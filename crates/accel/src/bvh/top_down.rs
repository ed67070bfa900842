//! Trees from the root down: cut the items in two, and each half again.

use aureole_math::Bounds3;
use bytemuck::Pod;
use rayon::prelude::*;

use super::tree::{BinaryNode, BinaryTree, Extent, FREE_LEVELS};
use crate::big::Big;

/// Items from which two threads pay.
pub(super) const PARALLEL: usize = 1 << 14;

/// A way to cut.
pub(super) trait Cut: Sync {
    /// What stands for a thing.
    type Item: Pod + Send + Sync;

    /// What a cut knows of the items on each side beforehand.
    type Hint: Copy + Send + Sync;

    /// The number of the thing.
    fn index(item: &Self::Item) -> u32;

    /// The box around it.
    fn bounds(&self, item: &Self::Item) -> Extent;

    /// What is known of all items.
    fn hint(&self, items: &[Self::Item]) -> Self::Hint;

    /// Moves the items of one side to the front; their number, or none where there is nothing to choose.
    fn cut(&self, items: &mut [Self::Item], hint: &Self::Hint) -> (usize, [Self::Hint; 2]);
}

/// Builds a tree whose leaves have at most `leaf_size` items.
pub(super) fn build<C: Cut>(mut items: Big<C::Item>, leaf_size: usize, cut: &C) -> BinaryTree {
    if items.is_empty() {
        return BinaryTree::default();
    }
    let hint = cut.hint(&items);
    let top = Builder { leaf_size, cut }.split_parallel(&mut items, 0, 0, &hint);
    let mut nodes = Big::zeroed(top.size());
    top.place(&mut nodes, 0);
    let mut order = Big::zeroed(items.len());
    order.par_iter_mut().zip(&items[..]).for_each(|(number, item)| *number = C::index(item));
    BinaryTree { nodes, order, ..BinaryTree::default() }
}

/// The upper part of a tree, whose halves come from different threads.
enum Top {
    /// A whole subtree; its root is number 0.
    Nodes(Vec<BinaryNode>),
    Halves {
        bounds: Bounds3,
        size: usize,
        halves: Box<[Top; 2]>,
    },
}

impl Top {
    fn bounds(&self) -> Bounds3 {
        match self {
            Self::Nodes(nodes) => nodes.first().map_or(Bounds3::EMPTY, |root| root.bounds),
            Self::Halves { bounds, .. } => *bounds,
        }
    }

    fn size(&self) -> usize {
        match self {
            Self::Nodes(nodes) => nodes.len(),
            Self::Halves { size, .. } => *size,
        }
    }

    /// Puts the nodes where they belong; the first is number `offset` of the tree.
    fn place(self, into: &mut [BinaryNode], offset: usize) {
        match self {
            Self::Nodes(nodes) => {
                for (place, node) in into.iter_mut().zip(nodes) {
                    *place = node.moved(offset);
                }
            }
            Self::Halves { bounds, halves, .. } => {
                let [left, right] = *halves;
                let (top, rest) = into.split_at_mut(1);
                let (left_into, right_into) = rest.split_at_mut(left.size());
                let right_offset = offset + 1 + left.size();
                top[0] = BinaryNode::inner(bounds, offset + 1, right_offset);
                rayon::join(|| left.place(left_into, offset + 1), || right.place(right_into, right_offset));
            }
        }
    }
}

pub(super) struct Builder<'a, C> {
    pub leaf_size: usize,
    pub cut: &'a C,
}

impl<C: Cut> Builder<'_, C> {
    /// The tree over items that begin at `first` in the order.
    fn split_parallel(&self, items: &mut [C::Item], first: usize, depth: usize, hint: &C::Hint) -> Top {
        if items.len() <= PARALLEL {
            let mut nodes = Vec::with_capacity(items.len());
            self.split(items, first, depth, hint, &mut nodes);
            return Top::Nodes(nodes);
        }
        let (middle, hints) = self.middle(items, depth, hint);
        let (left, right) = items.split_at_mut(middle);
        let (left, right) = rayon::join(
            || self.split_parallel(left, first, depth + 1, &hints[0]),
            || self.split_parallel(right, first + middle, depth + 1, &hints[1]),
        );
        let (size, bounds) = (1 + left.size() + right.size(), left.bounds().union(right.bounds()));
        Top::Halves { bounds, size, halves: Box::new([left, right]) }
    }

    /// Appends the tree over items; the box around them.
    pub(super) fn split(
        &self,
        items: &mut [C::Item],
        first: usize,
        depth: usize,
        hint: &C::Hint,
        nodes: &mut Vec<BinaryNode>,
    ) -> Extent {
        if items.len() <= self.leaf_size {
            let extent =
                items.iter().fold(Extent::EMPTY, |extent, item| extent.union(&self.cut.bounds(item)));
            nodes.push(BinaryNode::leaf(extent.bounds(), first, items.len()));
            return extent;
        }
        let (middle, hints) = self.middle(items, depth, hint);
        let (left, right) = items.split_at_mut(middle);
        let node = nodes.len();
        nodes.push(BinaryNode::leaf(Bounds3::EMPTY, first, 0));
        let left_extent = self.split(left, first, depth + 1, &hints[0], nodes);
        let right_node = nodes.len();
        let extent = left_extent.union(&self.split(right, first + middle, depth + 1, &hints[1], nodes));
        nodes[node] = BinaryNode::inner(extent.bounds(), node + 1, right_node);
        extent
    }

    /// Where the right half begins. Where there is nothing to choose, or the tree is too deep, the list is halved.
    fn middle(&self, items: &mut [C::Item], depth: usize, hint: &C::Hint) -> (usize, [C::Hint; 2]) {
        let (middle, hints) = if depth < FREE_LEVELS { self.cut.cut(items, hint) } else { (0, [*hint; 2]) };
        if middle == 0 || middle == items.len() { (items.len() / 2, [*hint; 2]) } else { (middle, hints) }
    }
}

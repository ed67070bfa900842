//! Makes a binary tree better: takes subtrees out and puts them back where they cost least.
//!
//! # References
//! [Bittner, Hapala and Havran 2013] "Fast Insertion-Based Optimization of Bounding Volume Hierarchies".

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::tree::{Below, BinaryNode, BinaryTree, Extent};
use crate::big::Big;

/// Takes out and puts back the `share` of the nodes with the largest boxes, `passes` times.
pub(crate) fn optimize(tree: BinaryTree, share: f32, passes: usize) -> BinaryTree {
    if tree.nodes.len() < 7 {
        return tree;
    }
    let mut linked = Linked::new(&tree);
    let mut queue = BinaryHeap::new();
    for _ in 0..passes {
        for node in linked.largest((linked.nodes.len() as f32 * share) as usize) {
            linked.reinsert(node, &mut queue);
        }
    }
    linked.into_tree(&tree)
}

/// No node.
const NONE: u32 = u32::MAX;

#[derive(Clone, Copy)]
struct LinkedNode {
    extent: Extent,
    parent: u32,
    /// [`NONE`] for leaves.
    children: [u32; 2],
}

/// A tree whose nodes know their parents. The root stays number 0.
struct Linked {
    nodes: Vec<LinkedNode>,
}

/// A place for a subtree, by the cost that it would have at least (the bits of a number that is not negative).
type Place = Reverse<(u32, u32)>;

impl Linked {
    fn new(tree: &BinaryTree) -> Self {
        let empty = LinkedNode { extent: Extent::EMPTY, parent: NONE, children: [NONE; 2] };
        let mut nodes = vec![empty; tree.nodes.len()];
        for (i, node) in tree.nodes.iter().enumerate() {
            nodes[i].extent = Extent::from(&node.bounds);
            if let Below::Nodes(left, right) = node.below() {
                nodes[i].children = [left as u32, right as u32];
                nodes[left].parent = i as u32;
                nodes[right].parent = i as u32;
            }
        }
        Self { nodes }
    }

    /// The nodes with the largest boxes, largest first.
    fn largest(&self, count: usize) -> Vec<u32> {
        let mut order: Vec<(Reverse<u32>, u32)> = (1..self.nodes.len() as u32)
            .map(|i| (Reverse(self.node(i).extent.half_area().to_bits()), i))
            .collect();
        let count = count.min(order.len());
        if count < order.len() {
            order.select_nth_unstable(count);
            order.truncate(count);
        }
        order.sort_unstable();
        order.into_iter().map(|(_, node)| node).collect()
    }

    fn node(&self, i: u32) -> &LinkedNode {
        &self.nodes[i as usize]
    }

    fn sibling(&self, i: u32) -> u32 {
        let [a, b] = self.node(self.node(i).parent).children;
        if a == i { b } else { a }
    }

    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        let children = &mut self.nodes[parent as usize].children;
        children[usize::from(children[1] == old)] = new;
        self.nodes[new as usize].parent = parent;
    }

    fn refit_from(&mut self, mut i: u32) {
        while i != NONE {
            let [a, b] = self.node(i).children;
            self.nodes[i as usize].extent = self.node(a).extent.union(&self.node(b).extent);
            i = self.node(i).parent;
        }
    }

    fn reinsert(&mut self, node: u32, queue: &mut BinaryHeap<Place>) {
        let parent = self.node(node).parent;
        let above = if parent == NONE { NONE } else { self.node(parent).parent };
        if above == NONE {
            return; // the root and its children stay
        }
        // Out: the sibling takes the parent's place.
        let sibling = self.sibling(node);
        self.replace_child(above, parent, sibling);
        self.refit_from(above);
        // In: the parent comes between the best place and what is above it.
        let place = self.best_place(&self.node(node).extent, queue);
        self.replace_child(self.node(place).parent, place, parent);
        self.nodes[parent as usize].children = [place, node];
        self.nodes[place as usize].parent = parent;
        self.refit_from(parent);
    }

    /// The node beside which a box adds least to the areas of all boxes; not the root.
    fn best_place(&self, extent: &Extent, queue: &mut BinaryHeap<Place>) -> u32 {
        let own_area = extent.half_area();
        let mut best = (f32::INFINITY, self.node(0).children[0]);
        queue.clear();
        queue.push(Reverse((0, 0)));
        while let Some(Reverse((inherited, i))) = queue.pop() {
            let inherited = f32::from_bits(inherited);
            if inherited + own_area >= best.0 {
                break;
            }
            let node = self.node(i);
            let together = node.extent.union(extent).half_area();
            if i != 0 && inherited + together < best.0 {
                best = (inherited + together, i);
            }
            let passed_on = inherited + (together - node.extent.half_area()).max(0.0);
            if node.children[0] != NONE && passed_on + own_area < best.0 {
                queue.extend(node.children.map(|child| Reverse((passed_on.to_bits(), child))));
            }
        }
        best.1
    }

    /// The tree in depth-first order again.
    fn into_tree(self, before: &BinaryTree) -> BinaryTree {
        let mut nodes = Vec::with_capacity(self.nodes.len());
        let mut order = Vec::with_capacity(before.order.len());
        // What is still to be written, and the node whose right child it is.
        let mut stack = vec![(0_u32, None)];
        while let Some((i, right_of)) = stack.pop() {
            let at = nodes.len();
            if let Some(parent) = right_of {
                let parent: &mut BinaryNode = &mut nodes[parent];
                *parent = BinaryNode::inner(parent.bounds, 0, at);
            }
            let bounds = self.node(i).extent.bounds();
            match before.nodes[i as usize].below() {
                Below::Items { first, count } => {
                    nodes.push(BinaryNode::leaf(bounds, order.len(), count));
                    order.extend_from_slice(&before.order[first..first + count]);
                }
                Below::Nodes(..) => {
                    let [left, right] = self.node(i).children;
                    nodes.push(BinaryNode::leaf(bounds, 0, 0));
                    stack.push((right, Some(at)));
                    stack.push((left, None));
                }
            }
        }
        for (i, node) in nodes.iter_mut().enumerate() {
            if let Below::Nodes(_, right) = node.below() {
                *node = BinaryNode::inner(node.bounds, i + 1, right);
            }
        }
        BinaryTree {
            nodes: Big::from(nodes),
            order: Big::from(order),
            copies: before.copies,
            ..BinaryTree::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use aureole_math::{Bounds3, Pcg32, Point3, Vector3};

    use super::super::{binned::Binned, top_down, tree::Item};
    use super::*;

    fn area(tree: &BinaryTree) -> f32 {
        tree.nodes.iter().map(BinaryNode::half_area).sum()
    }

    #[test]
    fn keeps_every_item_and_shrinks_the_boxes() {
        let mut rng = Pcg32::new(5);
        let mut boxes = Vec::new();
        for _ in 0..2000 {
            let mut number = || rng.next_f32();
            let p = Point3::new(number(), number(), number());
            let size = Vector3::new(number(), number(), number()) * (0.3 * number().powi(4));
            boxes.push(Bounds3::new(p, p + size));
        }
        let items: Vec<Item> = boxes.iter().zip(0..).map(|(b, i)| Item::new(b, i)).collect();
        let before = top_down::build(Big::from(items), 1, &Binned);
        let before_area = area(&before);
        let after = optimize(before, 1.0, 2);
        assert!(area(&after) < 0.95 * before_area, "{} of {before_area}", area(&after));
        let mut order = after.order.to_vec();
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..2000));
        for (i, node) in after.nodes.iter().enumerate() {
            match node.below() {
                Below::Nodes(left, right) => {
                    assert_eq!(left, i + 1);
                    let both = after.nodes[left].bounds.union(after.nodes[right].bounds);
                    assert_eq!(node.bounds, both);
                }
                Below::Items { first, count } => {
                    assert_eq!(count, 1);
                    assert_eq!(node.bounds, boxes[after.order[first] as usize]);
                }
            }
        }
    }
}

//! New boxes for the same hierarchy.

use arrayvec::ArrayVec;
use aureole_math::Bounds3;
use rayon::prelude::*;

use super::node::{Bvh8, COUNT_BITS, LEAF, Node, WIDTH};
use super::tree::{Below, BinaryTree};

/// Nodes from which two threads pay.
const PARALLEL: usize = 1 << 11;

impl Bvh8 {
    /// Fits all boxes to those of the groups in the leaves.
    pub(crate) fn refit(&mut self, groups: &[Bounds3]) {
        if !self.nodes.is_empty() {
            refit(&mut self.nodes, 0, groups);
        }
    }
}

/// Fits a subtree, whose nodes are together and whose root comes first, with number `at` in the hierarchy; the box around it.
fn refit(nodes: &mut [Node], at: usize, groups: &[Bounds3]) -> Bounds3 {
    let large = nodes.len() >= PARALLEL;
    let (top, mut rest) = nodes.split_at_mut(1);
    let top = &mut top[0];
    // The subtrees of the children follow one another.
    let mut begun = at + 1;
    let mut subtrees = ArrayVec::<(usize, usize, &mut [Node]), WIDTH>::new();
    let inner: ArrayVec<usize, WIDTH> = (0..WIDTH).filter(|&slot| top.children[slot] & LEAF == 0).collect();
    for (i, &slot) in inner.iter().enumerate() {
        let end = inner.get(i + 1).map_or(begun + rest.len(), |&next| top.children[next] as usize);
        let (subtree, others) = rest.split_at_mut(end - begun);
        subtrees.push((slot, begun, subtree));
        (begun, rest) = (end, others);
    }
    let fit = |(slot, at, subtree): (usize, usize, &mut [Node])| (slot, refit(subtree, at, groups));
    let fitted: ArrayVec<(usize, Bounds3), WIDTH> = if large {
        subtrees
            .into_iter()
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(fit)
            .collect::<Vec<_>>()
            .into_iter()
            .collect()
    } else {
        subtrees.into_iter().map(fit).collect()
    };
    for (slot, bounds) in fitted {
        top.set_bounds(slot, &bounds);
    }
    let mut all = Bounds3::EMPTY;
    for slot in 0..WIDTH {
        let child = top.children[slot];
        if child == LEAF {
            continue; // an empty slot
        }
        if child & LEAF != 0 {
            let first = ((child & !LEAF) >> COUNT_BITS) as usize;
            let count = (child & ((1 << COUNT_BITS) - 1)) as usize;
            let bounds = groups[first..first + count].iter().fold(Bounds3::EMPTY, |all, b| all.union(*b));
            top.set_bounds(slot, &bounds);
        }
        all = all.union(top.bounds(slot));
    }
    all
}

impl BinaryTree {
    /// Fits all boxes to those of the groups, of which each leaf holds one.
    pub(crate) fn refit(&mut self, groups: &[Bounds3]) {
        for i in (0..self.nodes.len()).rev() {
            self.nodes[i].bounds = match self.nodes[i].below() {
                Below::Items { first, .. } => groups[first],
                Below::Nodes(left, right) => self.nodes[left].bounds.union(self.nodes[right].bounds),
            };
        }
    }
}

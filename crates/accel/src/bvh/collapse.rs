//! From two children a node to eight, at the least expected cost.
//!
//! # References
//! [Ylitie, Karras and Laine 2017] "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.

use super::build::Built;
use super::node::{Bvh8, COUNT_BITS, LEAF, Node, Stats, WIDTH};
use super::tree::{Below, BinaryTree};

/// What things cost, in visits of a node.
pub(crate) struct Costs {
    /// Primitives tested at once.
    lanes: usize,
    /// Testing that many.
    group: f32,
    /// Groups in a leaf at most.
    max_groups: usize,
}

impl Costs {
    pub(crate) fn new(lanes: usize) -> Self {
        Self { lanes, group: 1.0, max_groups: 2 }
    }

    fn leaf(&self, half_area: f32, count: usize) -> f32 {
        let groups = count.div_ceil(self.lanes);
        if groups <= self.max_groups { half_area * groups as f32 * self.group } else { f32::INFINITY }
    }
}

/// Of a subtree of the binary tree.
#[derive(Clone, Copy, Default)]
struct Subtree {
    /// `cost[i]`: the least cost of standing for it by at most `i + 1` children of a wide node.
    cost: [f32; WIDTH - 1],
    /// Where its items begin in the order.
    first: u32,
    /// How many there are.
    count: u32,
}

/// Chooses the nodes and leaves of the wide hierarchy.
pub(crate) fn collapse(tree: &BinaryTree, costs: &Costs) -> Built {
    let mut built = Built { bvh: Bvh8::default(), order: tree.order.clone(), leaves: Vec::new() };
    let Some(root) = tree.nodes.first() else { return built };
    let subtrees = evaluate(tree, costs);
    built.bvh.nodes.push(Node::EMPTY);
    let mut collapse = Collapse { tree, costs, subtrees: &subtrees, built: &mut built, groups: 0 };
    collapse.fill(0, 0, 1);
    let stats = &mut built.bvh.stats;
    stats.nodes = built.bvh.nodes.len();
    let scale = 1.0 / root.half_area().max(f32::MIN_POSITIVE);
    stats.sah_cost *= scale;
    built
}

/// The subtrees of all nodes. Children come after their parents, so one pass from the end suffices.
fn evaluate(tree: &BinaryTree, costs: &Costs) -> Vec<Subtree> {
    let mut subtrees = vec![Subtree::default(); tree.nodes.len()];
    for (i, node) in tree.nodes.iter().enumerate().rev() {
        let area = node.half_area();
        subtrees[i] = match node.below() {
            Below::Items { first, count } => Subtree {
                cost: [costs.leaf(area, count); WIDTH - 1],
                first: first as u32,
                count: count as u32,
            },
            Below::Nodes(left, right) => {
                let (left, right) = (&subtrees[left], &subtrees[right]);
                let count = left.count + right.count;
                let mut cost = [0.0; WIDTH - 1];
                cost[0] = costs.leaf(area, count as usize).min(area + cheapest_shares(left, right, WIDTH).0);
                for children in 2..WIDTH {
                    cost[children - 1] = cost[children - 2].min(cheapest_shares(left, right, children).0);
                }
                Subtree { cost, first: left.first, count }
            }
        };
    }
    subtrees
}

/// The least cost of sharing out `children` children to two subtrees, and how many the left one gets.
#[inline(always)]
fn cheapest_shares(left: &Subtree, right: &Subtree, children: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for share in 1..children {
        let cost = left.cost[share - 1] + right.cost[children - share - 1];
        if cost < best.0 {
            best = (cost, share);
        }
    }
    best
}

struct Collapse<'a> {
    tree: &'a BinaryTree,
    costs: &'a Costs,
    subtrees: &'a [Subtree],
    built: &'a mut Built,
    /// Groups of primitives handed out so far.
    groups: usize,
}

impl Collapse<'_> {
    /// Fills the wide node `index` with what is below a binary node.
    fn fill(&mut self, index: usize, binary: usize, depth: usize) {
        let area = self.tree.nodes[binary].half_area();
        let stats = &mut self.built.bvh.stats;
        stats.depth = stats.depth.max(depth);
        stats.sah_cost += area;
        let mut children = arrayvec::ArrayVec::<usize, WIDTH>::new();
        match self.tree.nodes[binary].below() {
            Below::Nodes(..) => self.gather(binary, WIDTH, &mut children),
            Below::Items { .. } => children.push(binary), // the whole tree is one leaf
        }
        for (slot, &child) in children.iter().enumerate() {
            let bounds = &self.tree.nodes[child].bounds;
            for axis in 0..3 {
                self.built.bvh.nodes[index].planes[axis][0][slot] = bounds.min[axis];
                self.built.bvh.nodes[index].planes[axis][1][slot] = bounds.max[axis];
            }
            let subtree = &self.subtrees[child];
            let leaf_cost = self.costs.leaf(self.tree.nodes[child].half_area(), subtree.count as usize);
            let is_leaf =
                matches!(self.tree.nodes[child].below(), Below::Items { .. }) || leaf_cost <= subtree.cost[0];
            self.built.bvh.nodes[index].children[slot] = if is_leaf {
                self.leaf(subtree, leaf_cost)
            } else {
                let next = self.built.bvh.nodes.len();
                self.built.bvh.nodes.push(Node::EMPTY);
                self.fill(next, child, depth + 1);
                next as u32
            };
        }
    }

    /// The binary nodes that become the children, at most `children` of them.
    fn gather(&self, binary: usize, children: usize, into: &mut arrayvec::ArrayVec<usize, WIDTH>) {
        let Below::Nodes(left, right) = self.tree.nodes[binary].below() else {
            into.push(binary);
            return;
        };
        let share = cheapest_shares(&self.subtrees[left], &self.subtrees[right], children).1;
        for (node, mut share) in [(left, share), (right, children - share)] {
            let cost = &self.subtrees[node].cost;
            while share > 1 && cost[share - 2] <= cost[share - 1] {
                share -= 1;
            }
            if share == 1 { into.push(node) } else { self.gather(node, share, into) }
        }
    }

    fn leaf(&mut self, subtree: &Subtree, cost: f32) -> u32 {
        let groups = (subtree.count as usize).div_ceil(self.costs.lanes);
        let stats = &mut self.built.bvh.stats;
        stats.leaves += 1;
        stats.primitives += subtree.count as usize;
        stats.sah_cost += cost;
        self.built.leaves.push([subtree.first, subtree.count]);
        let place = self.groups as u32;
        self.groups += groups;
        LEAF | place << COUNT_BITS | groups as u32
    }
}

//! From two children a node to eight, at the least expected cost.
//!
//! # References
//! [Ylitie, Karras and Laine 2017] "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use super::build::Built;
use super::node::{Bvh8, COUNT_BITS, LEAF, Node, WIDTH};
use super::tree::{Below, BinaryTree};
use crate::Stats;
use crate::big::Big;

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

/// Items from which two threads pay.
const PARALLEL: u32 = 1 << 14;

/// Of a subtree of the binary tree.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Subtree {
    /// `cost[i]`: the least cost of standing for it by at most `i + 1` children of a wide node.
    cost: [f32; WIDTH - 1],
    /// Where its items begin in the order.
    first: u32,
    /// How many there are.
    count: u32,
}

/// Chooses the nodes and leaves of the wide hierarchy.
pub(crate) fn collapse(tree: BinaryTree, costs: &Costs) -> Built {
    let mut part = Part::default();
    if let Some(root) = tree.nodes.first() {
        let mut subtrees = Big::<Subtree>::zeroed(tree.nodes.len());
        evaluate(&tree, 0, costs, &mut subtrees);
        part = Collapse { tree: &tree, costs, subtrees: &subtrees }.part(0);
        part.stats.nodes = part.nodes.len();
        part.stats.sah_cost /= root.half_area().max(f32::MIN_POSITIVE);
    }
    Built {
        bvh: Bvh8 { nodes: part.nodes.into(), stats: part.stats },
        order: if tree.copies { part.order.into() } else { tree.order },
        groups: part.groups,
    }
}

/// Evaluates the subtree of node `at` and all in it; `into` is for them alone.
fn evaluate(tree: &BinaryTree, at: usize, costs: &Costs, into: &mut [Subtree]) {
    let nodes = &tree.nodes;
    let area = nodes[at].half_area();
    let (top, rest) = into.split_at_mut(1);
    top[0] = match nodes[at].below() {
        Below::Items { first, count } => {
            Subtree { cost: [costs.leaf(area, count); WIDTH - 1], first: first as u32, count: count as u32 }
        }
        Below::Nodes(left, right) => {
            let (left_into, right_into) = rest.split_at_mut(right - left);
            if left_into.len().min(right_into.len()) > PARALLEL as usize {
                rayon::join(
                    || evaluate(tree, left, costs, left_into),
                    || evaluate(tree, right, costs, right_into),
                );
            } else {
                evaluate(tree, left, costs, left_into);
                evaluate(tree, right, costs, right_into);
            }
            let (left, right) = (&left_into[0], &right_into[0]);
            let count = left.count + right.count;
            let mut cost = [0.0; WIDTH - 1];
            let items = distinct(tree, left.first, count, costs);
            cost[0] = costs.leaf(area, items).min(area + cheapest_shares(left, right, WIDTH).0);
            for children in 2..WIDTH {
                cost[children - 1] = cost[children - 2].min(cheapest_shares(left, right, children).0);
            }
            Subtree { cost, first: left.first, count }
        }
    };
}

/// How many items a leaf over these would have: copies of one item that come together are one again.
#[inline(always)]
fn distinct(tree: &BinaryTree, first: u32, count: u32, costs: &Costs) -> usize {
    // More than twice as many as fit into a leaf are no leaf: an item is not often there more than twice.
    if !tree.copies || count as usize > 2 * costs.lanes * costs.max_groups {
        return count as usize;
    }
    let items = &tree.order[first as usize..(first + count) as usize];
    (0..items.len()).filter(|&i| !items[..i].contains(&items[i])).count()
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

/// A part of the wide hierarchy; its root is node 0, its leaves' groups are numbered from 0.
#[derive(Default)]
struct Part {
    nodes: Vec<Node>,
    groups: Vec<[u32; 2]>,
    /// The items of the leaves, where they are not simply those of the tree.
    order: Vec<u32>,
    stats: Stats,
}

impl Part {
    /// Takes in another part; the number of its root.
    fn append(&mut self, other: Self) -> u32 {
        let (nodes, groups) = (self.nodes.len() as u32, self.groups.len() as u32);
        self.nodes.extend(other.nodes.into_iter().map(|node| node.moved(nodes, groups)));
        let items = self.order.len() as u32;
        self.groups.extend(other.groups.into_iter().map(|[first, count]| [first + items, count]));
        self.order.extend(other.order);
        self.stats = self.stats.merged(other.stats);
        nodes
    }
}

struct Collapse<'a> {
    tree: &'a BinaryTree,
    costs: &'a Costs,
    subtrees: &'a [Subtree],
}

impl Collapse<'_> {
    /// The hierarchy below a binary node.
    fn part(&self, binary: usize) -> Part {
        let mut part = Part::default();
        self.fill(binary, &mut part);
        part
    }

    /// Appends the node for a binary node and what is below it.
    fn fill(&self, binary: usize, part: &mut Part) {
        let mut children = ArrayVec::<usize, WIDTH>::new();
        match self.tree.nodes[binary].below() {
            Below::Nodes(..) => self.gather(binary, WIDTH, &mut children),
            Below::Items { .. } => children.push(binary), // the whole tree is one leaf
        }
        let mut node = Node::EMPTY;
        for (slot, &child) in children.iter().enumerate() {
            node.set_bounds(slot, &self.tree.nodes[child].bounds);
        }
        let index = part.nodes.len();
        part.nodes.push(node);
        part.stats.sah_cost += self.tree.nodes[binary].half_area();
        // The parts of large subtrees come from many threads.
        let parallel = self.subtrees[binary].count > PARALLEL;
        let parts: Vec<Option<Part>> = if parallel {
            let large = |&child: &usize| self.subtrees[child].count > PARALLEL;
            children.par_iter().map(|child| large(child).then(|| self.part(*child))).collect()
        } else {
            Vec::new()
        };
        let mut parts = parts.into_iter();
        let mut deepest = 0;
        for (slot, &child) in children.iter().enumerate() {
            let outer = std::mem::take(&mut part.stats.depth);
            part.nodes[index].children[slot] = match (self.leaf(child), parts.next().flatten()) {
                (Some(cost), _) => self.add_leaf(child, cost, part),
                (None, Some(other)) => part.append(other),
                (None, None) => {
                    let next = part.nodes.len() as u32;
                    self.fill(child, part);
                    next
                }
            };
            deepest = part.stats.depth.max(deepest);
            part.stats.depth = outer;
        }
        part.stats.depth = deepest + 1;
    }

    /// The binary nodes that become the children, at most `children` of them.
    fn gather(&self, binary: usize, children: usize, into: &mut ArrayVec<usize, WIDTH>) {
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

    /// The cost of a child as a leaf, if it is to be one.
    fn leaf(&self, child: usize) -> Option<f32> {
        let (node, subtree) = (&self.tree.nodes[child], &self.subtrees[child]);
        let items = distinct(self.tree, subtree.first, subtree.count, self.costs);
        let cost = self.costs.leaf(node.half_area(), items);
        let pays = cost.is_finite() && cost <= subtree.cost[0];
        (matches!(node.below(), Below::Items { .. }) || pays).then_some(cost)
    }

    fn add_leaf(&self, child: usize, cost: f32, part: &mut Part) -> u32 {
        let Subtree { mut first, mut count, .. } = self.subtrees[child];
        if self.tree.copies {
            let items = &self.tree.order[first as usize..(first + count) as usize];
            first = part.order.len() as u32;
            let is_new = |i: &usize| !items[..*i].contains(&items[*i]);
            part.order.extend((0..items.len()).filter(is_new).map(|i| items[i]));
            count = part.order.len() as u32 - first;
        }
        part.stats.leaves += 1;
        part.stats.references += count as usize;
        part.stats.sah_cost += cost;
        let place = part.groups.len() as u32;
        let (end, lanes) = (first + count, self.costs.lanes);
        part.groups.extend((first..end).step_by(lanes).map(|i| [i, (end - i).min(lanes as u32)]));
        LEAF | (place << COUNT_BITS) | (part.groups.len() as u32 - place)
    }
}

//! Binned builder with the surface-area heuristic, and collapse to eight children a node.
//!
//! # References
//! [Wald 2007] "On fast Construction of SAH-based Bounding Volume Hierarchies"; collapse by area as [Wald et al. 2008]
//! "Getting Rid of Packets".

use aureole_math::Bounds3;

use super::node::{Bvh8, COUNT_BITS, FREE_LEVELS, LEAF, Node, Stats, WIDTH};
use crate::Config;

/// A binary tree, which only the builder sees.
enum Tree {
    Leaf { bounds: Bounds3, first: u32, count: u32 },
    Inner { bounds: Bounds3, children: Box<[Tree; 2]> },
}

impl Tree {
    fn bounds(&self) -> Bounds3 {
        match self {
            Self::Leaf { bounds, .. } | Self::Inner { bounds, .. } => *bounds,
        }
    }
}

/// An item on its way through the builder.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds3,
    index: u32,
}

impl Item {
    /// Twice the centroid.
    #[inline]
    fn center(&self, axis: usize) -> f32 {
        self.bounds.min[axis] + self.bounds.max[axis]
    }
}

/// The subtree size from which two threads pay.
const PARALLEL: usize = 4096;

/// Builds a hierarchy over boxes. `pack` receives each leaf's items, in order, and returns where it put them: first
/// and number of packed things, at most 15.
pub(crate) fn build(
    boxes: &[Bounds3],
    config: &Config,
    pack: &mut dyn FnMut(&[u32]) -> (u32, u32),
    bytes_per_leaf_item: usize,
) -> Bvh8 {
    let mut items: Vec<Item> =
        boxes.iter().enumerate().map(|(i, b)| Item { bounds: *b, index: i as u32 }).collect();
    if items.is_empty() {
        return Bvh8::default();
    }
    let tree = split(&mut items, 0, config, 0);
    let order: Vec<u32> = items.iter().map(|item| item.index).collect();
    let mut bvh = Bvh8 { nodes: vec![Node::EMPTY], stats: Stats::default() };
    let root_area = tree.bounds().surface_area().max(f32::MIN_POSITIVE);
    let mut collapse = Collapse { bvh: &mut bvh, order: &order, pack, root_area, config };
    collapse.fill(0, tree, 1);
    bvh.stats.nodes = bvh.nodes.len();
    bvh.stats.bytes = bvh.nodes.len() * size_of::<Node>() + bvh.stats.primitives * bytes_per_leaf_item;
    bvh
}

fn split(items: &mut [Item], first: u32, config: &Config, depth: usize) -> Tree {
    let bounds = items.iter().fold(Bounds3::EMPTY, |b, item| b.union(item.bounds));
    let leaf = Tree::Leaf { bounds, first, count: items.len() as u32 };
    if items.len() == 1 {
        return leaf;
    }
    let middle = match best_split(items, &bounds, config) {
        Some(split) => partition(items, &split),
        None if items.len() <= config.max_leaf_size => return leaf,
        None => items.len() / 2, // everything in one place: halve the list
    };
    // A hostile input could make a tree as deep as it is long.
    let middle =
        if depth >= FREE_LEVELS || middle == 0 || middle == items.len() { items.len() / 2 } else { middle };
    let (left, right) = items.split_at_mut(middle);
    let right_first = first + middle as u32;
    let children = if left.len() + right.len() > PARALLEL {
        let (a, b) = rayon::join(
            || split(left, first, config, depth + 1),
            || split(right, right_first, config, depth + 1),
        );
        [a, b]
    } else {
        [split(left, first, config, depth + 1), split(right, right_first, config, depth + 1)]
    };
    Tree::Inner { bounds, children: Box::new(children) }
}

/// Where to cut: items whose bin on the axis is below `bin` go left.
struct Split {
    axis: usize,
    bin: usize,
    binning: Binning,
}

#[derive(Clone, Copy)]
struct Binning {
    low: f32,
    scale: f32,
    bins: usize,
}

impl Binning {
    #[inline]
    fn bin(&self, center: f32) -> usize {
        (((center - self.low) * self.scale) as usize).min(self.bins - 1)
    }
}

/// The cheapest cut; `None` when a leaf is cheaper or no cut exists.
fn best_split(items: &[Item], bounds: &Bounds3, config: &Config) -> Option<Split> {
    let mut best: Option<(f32, Split)> = None;
    let mut centers = [[f32::INFINITY, f32::NEG_INFINITY]; 3];
    for item in items {
        for (axis, range) in centers.iter_mut().enumerate() {
            let c = item.center(axis);
            *range = [range[0].min(c), range[1].max(c)];
        }
    }
    let bins = config.bins.clamp(2, 64).min(items.len().max(4));
    for (axis, [low, high]) in centers.into_iter().enumerate() {
        let scale = bins as f32 / (high - low);
        if !(high > low && scale.is_finite()) {
            continue;
        }
        let binning = Binning { low, scale, bins };
        let mut boxes = [Bounds3::EMPTY; 64];
        let mut counts = [0_u32; 64];
        for item in items {
            let bin = binning.bin(item.center(axis));
            boxes[bin] = boxes[bin].union(item.bounds);
            counts[bin] += 1;
        }
        // Cost of everything to the right of each cut, from the right; then the left from the left.
        let mut right_cost = [0.0_f32; 64];
        let (mut b, mut n) = (Bounds3::EMPTY, 0);
        for bin in (1..bins).rev() {
            b = b.union(boxes[bin]);
            n += counts[bin];
            right_cost[bin] = b.surface_area() * n as f32;
        }
        let (mut b, mut n) = (Bounds3::EMPTY, 0);
        for bin in 1..bins {
            b = b.union(boxes[bin - 1]);
            n += counts[bin - 1];
            let cost = b.surface_area() * n as f32 + right_cost[bin];
            let is_proper = n > 0 && n < items.len() as u32;
            if is_proper && best.as_ref().is_none_or(|(c, _)| cost < *c) {
                best = Some((cost, Split { axis, bin, binning }));
            }
        }
    }
    let (cost, split) = best?;
    let area = bounds.surface_area();
    let leaf_cost = items.len() as f32 * area;
    let split_cost = config.traversal_cost * area + cost;
    (items.len() > config.max_leaf_size || split_cost < leaf_cost).then_some(split)
}

/// Moves the items of the left side to the front, keeping their order (so that trees do not depend on chance).
fn partition(items: &mut [Item], split: &Split) -> usize {
    let is_left = |item: &Item| split.binning.bin(item.center(split.axis)) < split.bin;
    let right: Vec<Item> = items.iter().filter(|item| !is_left(item)).copied().collect();
    let mut middle = 0;
    for i in 0..items.len() {
        if is_left(&items[i]) {
            items[middle] = items[i];
            middle += 1;
        }
    }
    items[middle..].copy_from_slice(&right);
    middle
}

struct Collapse<'a> {
    bvh: &'a mut Bvh8,
    order: &'a [u32],
    pack: &'a mut dyn FnMut(&[u32]) -> (u32, u32),
    root_area: f32,
    config: &'a Config,
}

impl Collapse<'_> {
    /// Turns a binary subtree into the node at `index` and those below it.
    fn fill(&mut self, index: usize, tree: Tree, depth: usize) {
        self.bvh.stats.depth = self.bvh.stats.depth.max(depth);
        self.bvh.stats.sah_cost += self.config.traversal_cost * tree.bounds().surface_area() / self.root_area;
        let mut children = vec![tree];
        // Open the largest inner child until there are eight.
        while children.len() < WIDTH {
            let area = |t: &Tree| match t {
                Tree::Inner { bounds, .. } => bounds.surface_area(),
                Tree::Leaf { .. } => -1.0,
            };
            let largest =
                (0..children.len()).max_by(|&a, &b| area(&children[a]).total_cmp(&area(&children[b])));
            match largest.filter(|&i| area(&children[i]) >= 0.0) {
                Some(i) => match children.swap_remove(i) {
                    Tree::Inner { children: pair, .. } => children.extend(*pair),
                    leaf => children.push(leaf),
                },
                None => break,
            }
        }
        for (slot, child) in children.into_iter().enumerate() {
            let b = child.bounds();
            for axis in 0..3 {
                self.bvh.nodes[index].planes[axis][0][slot] = b.min[axis];
                self.bvh.nodes[index].planes[axis][1][slot] = b.max[axis];
            }
            self.bvh.nodes[index].children[slot] = match child {
                Tree::Leaf { first, count, .. } => self.leaf(&b, first, count),
                inner => {
                    let next = self.bvh.nodes.len();
                    self.bvh.nodes.push(Node::EMPTY);
                    self.fill(next, inner, depth + 1);
                    next as u32
                }
            };
        }
    }

    fn leaf(&mut self, bounds: &Bounds3, first: u32, count: u32) -> u32 {
        let stats = &mut self.bvh.stats;
        stats.leaves += 1;
        stats.primitives += count as usize;
        stats.sah_cost += count as f32 * bounds.surface_area() / self.root_area;
        let (place, packed) = (self.pack)(&self.order[first as usize..(first + count) as usize]);
        debug_assert!(packed < 1 << COUNT_BITS && place < 1 << (31 - COUNT_BITS));
        LEAF | place << COUNT_BITS | packed
    }
}

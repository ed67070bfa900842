//! The surface-area heuristic over bins.
//!
//! # References
//! [Wald 2007] "On fast Construction of SAH-based Bounding Volume Hierarchies".

use glam::Vec4;
use rayon::prelude::*;

use super::tree::{BinaryNode, BinaryTree, Extent, FREE_LEVELS, Item};

/// Bins at most.
const BINS: usize = 32;
/// Bins at most of few items, whose tables would take longer to clear than to fill.
const FEW_BINS: usize = 8;
/// Items from which two threads pay.
const PARALLEL: usize = 4096;
/// Items from which the bins of one node are filled by many threads.
const PARALLEL_BINS: usize = 1 << 16;

/// Builds a tree whose leaves have at most `leaf_size` items.
pub(crate) fn build(mut items: Vec<Item>, leaf_size: usize) -> BinaryTree {
    if items.is_empty() {
        return BinaryTree::default();
    }
    // A full subtree of n items has 2 n - 1 nodes: each has its place before its size is known, so threads can work in it.
    let mut nodes = vec![BinaryNode::EMPTY; 2 * items.len() - 1];
    Builder { leaf_size }.split(&mut items, &mut nodes, Place { first: 0, slot: 0, depth: 0 });
    BinaryTree { nodes, order: items.iter().map(Item::index).collect() }
}

struct Builder {
    leaf_size: usize,
}

/// Where a subtree's items and nodes begin.
#[derive(Clone, Copy)]
struct Place {
    first: usize,
    slot: usize,
    depth: usize,
}

impl Builder {
    fn split(&self, items: &mut [Item], nodes: &mut [BinaryNode], at: Place) {
        let (bounds, centers) = extents(items);
        let bounds = bounds.bounds();
        if items.len() <= self.leaf_size {
            nodes[0] = BinaryNode::leaf(bounds, at.first, items.len());
            return;
        }
        let middle = match Binning::new(&centers, items.len()) {
            Some(binning) if at.depth < FREE_LEVELS => binning.cut(items),
            _ => 0,
        };
        // All in one place, too deep, or beyond numbers: halve the list.
        let middle = if middle == 0 || middle == items.len() { items.len() / 2 } else { middle };
        let (left, right) = items.split_at_mut(middle);
        let (top, rest) = nodes.split_at_mut(1);
        let (left_nodes, right_nodes) = rest.split_at_mut(2 * middle - 1);
        let left_at = Place { slot: at.slot + 1, depth: at.depth + 1, ..at };
        let right_at = Place { first: at.first + middle, slot: at.slot + 2 * middle, depth: at.depth + 1 };
        top[0] = BinaryNode::inner(bounds, left_at.slot, right_at.slot);
        if left.len() + right.len() > PARALLEL {
            rayon::join(
                || self.split(left, left_nodes, left_at),
                || self.split(right, right_nodes, right_at),
            );
        } else {
            self.split(left, left_nodes, left_at);
            self.split(right, right_nodes, right_at);
        }
    }
}

/// The box around items and that around their centers.
fn extents(items: &[Item]) -> (Extent, Extent) {
    let of = |items: &[Item]| {
        items.iter().fold((Extent::EMPTY, Extent::EMPTY), |(bounds, centers), item| {
            (bounds.union(&item.bounds()), centers.with(item.center()))
        })
    };
    if items.len() < PARALLEL_BINS {
        return of(items);
    }
    let both = |a: (Extent, Extent), b: (Extent, Extent)| (a.0.union(&b.0), a.1.union(&b.1));
    items.par_chunks(PARALLEL_BINS / 4).map(of).reduce(|| (Extent::EMPTY, Extent::EMPTY), both)
}

/// Maps centers to bins, on all axes at once.
#[derive(Clone, Copy)]
struct Binning {
    low: Vec4,
    scale: Vec4,
    bins: usize,
}

/// Boxes and numbers of the items in each bin of each axis.
struct Bins<const B: usize> {
    boxes: [[Extent; B]; 3],
    counts: [[u32; B]; 3],
}

impl Binning {
    /// `None` when all centers are in one place.
    fn new(centers: &Extent, items: usize) -> Option<Self> {
        let bins = BINS.min(4 + items / 20);
        let size = centers.max - centers.min;
        // A little less than the whole range, so that the largest center falls into the last bin.
        let scale = Vec4::splat(bins as f32 * (1.0 - 1e-6)) / size;
        let axis = |i: usize| size[i] > 0.0 && scale[i].is_finite();
        if !(0..3).any(axis) {
            return None;
        }
        let scale = Vec4::from_array([0, 1, 2, 3].map(|i| if i < 3 && axis(i) { scale[i] } else { 0.0 }));
        Some(Self { low: centers.min, scale, bins })
    }

    #[inline(always)]
    fn bin(&self, item: &Item) -> [usize; 3] {
        let at = (item.center() - self.low) * self.scale;
        [at.x, at.y, at.z].map(|x| (x as usize).min(self.bins - 1))
    }

    /// Moves the items of one side of the cheapest cut to the front; their number.
    fn cut(&self, items: &mut [Item]) -> usize {
        let (axis, bin) = if self.bins > FEW_BINS {
            self.cheapest(&self.fill::<BINS>(items))
        } else {
            self.cheapest(&self.fill::<FEW_BINS>(items))
        };
        let mut middle = 0;
        for i in 0..items.len() {
            let is_left = self.bin(&items[i])[axis] < bin;
            items.swap(i, middle);
            middle += usize::from(is_left);
        }
        middle
    }

    fn fill<const B: usize>(&self, items: &[Item]) -> Bins<B> {
        let of = |items: &[Item]| {
            let mut bins = Bins { boxes: [[Extent::EMPTY; B]; 3], counts: [[0; B]; 3] };
            for item in items {
                for (axis, bin) in self.bin(item).into_iter().enumerate() {
                    bins.boxes[axis][bin] = bins.boxes[axis][bin].union(&item.bounds());
                    bins.counts[axis][bin] += 1;
                }
            }
            bins
        };
        if items.len() < PARALLEL_BINS {
            return of(items);
        }
        let parts: Vec<Bins<B>> = items.par_chunks(PARALLEL_BINS / 4).map(of).collect();
        parts.into_iter().reduce(|a, b| a.merged(&b)).unwrap_or_else(|| of(&[]))
    }

    /// The axis and first bin of the right side with the smallest sum of area times number.
    fn cheapest<const B: usize>(&self, bins: &Bins<B>) -> (usize, usize) {
        let mut best = (f32::INFINITY, 0, 1);
        for axis in (0..3).filter(|&axis| self.scale[axis] > 0.0) {
            let (boxes, counts) = (&bins.boxes[axis][..self.bins], &bins.counts[axis][..self.bins]);
            let mut right_cost = [0.0; B];
            let (mut extent, mut count) = (Extent::EMPTY, 0);
            for bin in (1..self.bins).rev() {
                extent = extent.union(&boxes[bin]);
                count += counts[bin];
                right_cost[bin] = extent.half_area() * count as f32;
            }
            let right = count;
            (extent, count) = (Extent::EMPTY, 0);
            for bin in 1..self.bins {
                extent = extent.union(&boxes[bin - 1]);
                count += counts[bin - 1];
                let cost = extent.half_area() * count as f32 + right_cost[bin];
                if cost < best.0 && count > 0 && count < right + counts[0] {
                    best = (cost, axis, bin);
                }
            }
        }
        (best.1, best.2)
    }
}

impl<const B: usize> Bins<B> {
    fn merged(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..B {
                self.boxes[axis][bin] = self.boxes[axis][bin].union(&other.boxes[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }
}

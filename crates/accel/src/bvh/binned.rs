//! The surface-area heuristic over bins.
//!
//! # References
//! [Wald 2007] "On fast Construction of SAH-based Bounding Volume Hierarchies".

use aureole_math::Bounds3;
use glam::Vec4;
use rayon::prelude::*;

use crate::big::Big;

use super::tree::{BinaryNode, BinaryTree, Extent, FREE_LEVELS, Item};

const MAGIC: f32 = (1 << 23) as f32;
/// Bins at most.
const BINS: usize = 32;
/// Bins at most of few items, whose tables would take longer to clear than to fill.
const FEW_BINS: usize = 8;
/// Items whose cut is sought by sorting.
const FEW_ITEMS: usize = 8;
/// Items from which two threads pay.
const PARALLEL: usize = 1 << 14;
/// Items from which the bins of one node are filled by many threads.
const PARALLEL_BINS: usize = 1 << 16;

/// Builds a tree whose leaves have at most `leaf_size` items.
pub(crate) fn build(mut items: Big<Item>, leaf_size: usize) -> BinaryTree {
    if items.is_empty() {
        return BinaryTree::default();
    }
    let top = Builder { leaf_size }.split_parallel(&mut items, 0, 0);
    let mut nodes = Big::zeroed(top.size());
    top.place(&mut nodes, 0);
    let mut order = Big::zeroed(items.len());
    order.par_iter_mut().zip(&items[..]).for_each(|(number, item)| *number = item.index());
    BinaryTree { nodes, order }
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

struct Builder {
    leaf_size: usize,
}

impl Builder {
    /// The tree over items that begin at `first` in the order.
    fn split_parallel(&self, items: &mut [Item], first: usize, depth: usize) -> Top {
        if items.len() <= PARALLEL {
            let mut nodes = Vec::with_capacity(items.len());
            self.split(items, first, depth, &mut nodes);
            return Top::Nodes(nodes);
        }
        let (bounds, centers) = extents(items);
        let middle = cut(items, &centers, depth);
        let (left, right) = items.split_at_mut(middle);
        let (left, right) = rayon::join(
            || self.split_parallel(left, first, depth + 1),
            || self.split_parallel(right, first + middle, depth + 1),
        );
        let size = 1 + left.size() + right.size();
        Top::Halves { bounds: bounds.bounds(), size, halves: Box::new([left, right]) }
    }

    fn split(&self, items: &mut [Item], first: usize, depth: usize, nodes: &mut Vec<BinaryNode>) {
        let (bounds, centers) = extents(items);
        let bounds = bounds.bounds();
        if items.len() <= self.leaf_size {
            nodes.push(BinaryNode::leaf(bounds, first, items.len()));
            return;
        }
        let middle = cut(items, &centers, depth);
        let (left, right) = items.split_at_mut(middle);
        let node = nodes.len();
        nodes.push(BinaryNode::leaf(bounds, first, 0));
        self.split(left, first, depth + 1, nodes);
        nodes[node] = BinaryNode::inner(bounds, node + 1, nodes.len());
        self.split(right, first + middle, depth + 1, nodes);
    }
}

/// Moves the items of one side to the front; their number, which is neither none nor all.
fn cut(items: &mut [Item], centers: &Extent, depth: usize) -> usize {
    let middle = match Binning::new(centers, items.len()) {
        _ if depth >= FREE_LEVELS => 0,
        _ if items.len() <= FEW_ITEMS => sweep(items, centers),
        Some(binning) => binning.cut(items),
        None => 0,
    };
    // All in one place, too deep, or beyond numbers: halve the list.
    if middle == 0 || middle == items.len() { items.len() / 2 } else { middle }
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

/// Sorts few items along the axis on which their centers differ most, and cuts where it is cheapest; the number on the left.
fn sweep(items: &mut [Item], centers: &Extent) -> usize {
    let size = centers.max - centers.min;
    let axis = (1..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
    items.sort_unstable_by(|a, b| {
        a.center()[axis].total_cmp(&b.center()[axis]).then(a.index().cmp(&b.index()))
    });
    let mut right_cost = [0.0; FEW_ITEMS];
    let mut extent = Extent::EMPTY;
    for i in (1..items.len()).rev() {
        extent = extent.union(&items[i].bounds());
        right_cost[i] = extent.half_area() * (items.len() - i) as f32;
    }
    let mut best = (f32::INFINITY, items.len() / 2);
    extent = Extent::EMPTY;
    for i in 1..items.len() {
        extent = extent.union(&items[i - 1].bounds());
        let cost = extent.half_area() * i as f32 + right_cost[i];
        if cost < best.0 {
            best = (cost, i);
        }
    }
    best.1
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

    /// The bins on all axes. Adding 2²³ to a small number leaves it rounded in the lowest bits, which is much cheaper than a
    /// conversion that watches out for what is no small number.
    #[inline(always)]
    fn bin(&self, item: &Item) -> [usize; 3] {
        let at = (item.center() - self.low) * self.scale - Vec4::splat(0.5);
        let [x, y, z, _] =
            (at.max(Vec4::ZERO) + Vec4::splat(MAGIC)).to_array().map(|x| x.to_bits() as usize % BINS);
        [x, y, z]
    }

    /// The bin on one axis: the same arithmetic.
    #[inline(always)]
    fn bin_on(&self, item: &Item, axis: usize) -> usize {
        let at = (item.center_on(axis) - self.low[axis]) * self.scale[axis] - 0.5;
        (at.max(0.0) + MAGIC).to_bits() as usize % BINS
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
            let is_left = self.bin_on(&items[i], axis) < bin;
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
                    bins.boxes[axis][bin % B] = bins.boxes[axis][bin % B].union(&item.bounds());
                    bins.counts[axis][bin % B] += 1;
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

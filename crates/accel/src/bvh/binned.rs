//! The surface-area heuristic over bins.
//!
//! # References
//! [Wald 2007] "On fast Construction of SAH-based Bounding Volume Hierarchies".

use glam::Vec4;
use rayon::prelude::*;

use super::top_down::Cut;
use super::tree::{Extent, Item};

/// Added to a small number, it leaves that number in the lowest bits.
const MAGIC: f32 = (1 << 23) as f32;
/// Bins at most.
const BINS: usize = 32;
/// Bins at most of few items, whose tables would take longer to clear than to fill.
const FEW_BINS: usize = 8;
/// Items whose cut is sought by sorting.
const FEW_ITEMS: usize = 8;
/// Items from which the bins of one node are filled by many threads.
const PARALLEL_BINS: usize = 1 << 16;

/// Cuts where the sum of area times number is least.
pub(super) struct Binned;

impl Cut for Binned {
    fn cut(&self, items: &mut [Item]) -> usize {
        let centers = centers(items);
        if items.len() <= FEW_ITEMS {
            return sweep(items, &centers);
        }
        Binning::new(&centers, items.len()).map_or(0, |binning| binning.cut(items))
    }
}

/// A cut by bins: what it costs and the boxes of its sides.
pub(super) struct Cheapest {
    pub cost: f32,
    pub extents: [Extent; 2],
    binning: Binning,
    axis: usize,
    bin: usize,
}

/// The cheapest cut of items. `None` when all centers are in one place.
pub(super) fn best(items: &[Item]) -> Option<Cheapest> {
    let binning = Binning::new(&centers(items), items.len())?;
    let bins = binning.fill::<BINS>(items);
    let (cost, axis, bin) = binning.cheapest(&bins);
    let around = |boxes: &[Extent]| boxes.iter().fold(Extent::EMPTY, |all, extent| all.union(extent));
    let (left, right) = bins.boxes[axis].split_at(bin);
    Some(Cheapest { cost, extents: [around(left), around(right)], binning, axis, bin })
}

impl Cheapest {
    /// Moves the items of one side to the front; their number.
    pub(super) fn apply(&self, items: &mut [Item]) -> usize {
        self.binning.partition(items, self.axis, self.bin)
    }
}

/// The box around the items' centers.
fn centers(items: &[Item]) -> Extent {
    let of = |items: &[Item]| items.iter().fold(Extent::EMPTY, |extent, item| extent.with(item.center()));
    if items.len() < PARALLEL_BINS {
        return of(items);
    }
    items.par_chunks(PARALLEL_BINS / 4).map(of).reduce(|| Extent::EMPTY, |a, b| a.union(&b))
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
        let (_, axis, bin) = if self.bins > FEW_BINS {
            self.cheapest(&self.fill::<BINS>(items))
        } else {
            self.cheapest(&self.fill::<FEW_BINS>(items))
        };
        self.partition(items, axis, bin)
    }

    fn partition(&self, items: &mut [Item], axis: usize, bin: usize) -> usize {
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

    /// The smallest sum of area times number, the axis and the first bin of the right side.
    fn cheapest<const B: usize>(&self, bins: &Bins<B>) -> (f32, usize, usize) {
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
        best
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

//! The surface-area heuristic over bins.
//!
//! # References
//! [Wald 2007] "On fast Construction of SAH-based Bounding Volume Hierarchies".

use rayon::prelude::*;

use super::bins::{BINS, BinCut, CutParts, Fill, FillAndCut, Slices};
use super::top_down::Cut;
use super::tree::{Extent, Item};
use crate::simd;

/// Bins at most of few items, whose tables would take longer to clear than to fill.
const FEW_BINS: usize = 8;
/// Items whose cut is sought by sorting.
const FEW_ITEMS: usize = 8;
/// Items from which the bins of one node are filled by many threads.
const PARALLEL_BINS: usize = 1 << 16;
/// Items up to which slices are laid over the centers. Those of more items are laid over the boxes, which are known before:
/// a triangle is small beside so many.
const LOOK_AT_CENTERS: usize = 512;

/// Cuts where the sum of area times number is least.
pub(super) struct Binned;

impl Cut for Binned {
    type Item = Item;
    /// A box around twice the centers.
    type Hint = Extent;

    fn index(item: &Item) -> u32 {
        item.index()
    }

    #[inline(always)]
    fn bounds(&self, item: &Item) -> Extent {
        item.bounds()
    }

    fn hint(&self, items: &[Item]) -> Extent {
        centers(items)
    }

    fn cut(&self, items: &mut [Item], hint: &Extent) -> (usize, [Extent; 2]) {
        let centers = if items.len() <= LOOK_AT_CENTERS { centers(items) } else { *hint };
        if items.len() <= FEW_ITEMS {
            return (sweep(items, &centers), [centers; 2]);
        }
        let Some(slices) = Slices::new(&centers, items.len()) else { return (0, [centers; 2]) };
        let best = cheapest(&slices, items);
        (best.apply(&slices, items), best.extents.map(|extent| extent.doubled()))
    }
}

/// The cheapest cut of items, and the slices between which it lies. `None` when all centers are in one place.
pub(super) fn best(items: &[Item]) -> Option<(BinCut, Slices)> {
    let slices = Slices::new(&centers(items), items.len())?;
    Some((cheapest(&slices, items), slices))
}

fn cheapest(slices: &Slices, items: &[Item]) -> BinCut {
    if items.len() >= PARALLEL_BINS {
        let fill = |items| simd::run(Fill::<BINS> { slices, items });
        let parts: Vec<_> = items.par_chunks(PARALLEL_BINS / 4).map(fill).collect();
        simd::run(CutParts { slices, parts: &parts })
    } else if slices.count() > FEW_BINS {
        simd::run(FillAndCut(Fill::<BINS> { slices, items }))
    } else {
        simd::run(FillAndCut(Fill::<FEW_BINS> { slices, items }))
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

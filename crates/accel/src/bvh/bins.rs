//! Boxes and numbers of the items in each slice of a node, on all axes, and the cheapest cut between two slices.

use super::tree::{Extent, Item, MAX_AREA};
use crate::simd::{self, Floats, Kernel, Simd};

/// Bins of one axis at most.
pub(super) const BINS: usize = 32;
/// Added to a small number, it leaves that number in the lowest bits.
const MAGIC: f32 = (1 << 23) as f32;

/// Maps the centers of items to bins, on all axes at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slices {
    low: [f32; 4],
    /// Zero on axes that are not cut.
    scale: [f32; 4],
    bins: usize,
}

impl Slices {
    /// Slices for so many items, whose centers are in a box. `None` when all centers are in one place.
    pub(super) fn new(centers: &Extent, items: usize) -> Option<Self> {
        let bins = BINS.min(4 + items / 20);
        let size = centers.max - centers.min;
        // A little less than the whole range, so that the largest center falls into the last bin.
        let scale = [0, 1, 2].map(|axis| bins as f32 * (1.0 - 1e-6) / size[axis]);
        let axis = |i: usize| if size[i] > 0.0 && scale[i].is_finite() { scale[i] } else { 0.0 };
        let scale = [axis(0), axis(1), axis(2), 0.0];
        let low = [centers.min.x, centers.min.y, centers.min.z, 0.0];
        (scale != [0.0; 4]).then_some(Self { low, scale, bins })
    }

    /// How many there are on each axis.
    pub(super) fn count(&self) -> usize {
        self.bins
    }

    /// The bins of an item on all axes. Adding 2²³ to a small number leaves it rounded in the lowest bits, which is much cheaper
    /// than a conversion that watches out for what is no small number.
    #[inline(always)]
    fn of<S: Simd>(&self, item: &Item) -> [usize; 3] {
        let [min, negative_max]: &[[f32; 4]; 2] = bytemuck::cast_ref(&item.numbers);
        let center = S::F4::load(min) - S::F4::load(negative_max);
        let at = (center - S::F4::load(&self.low)) * S::F4::load(&self.scale) - S::F4::splat(0.5);
        let [x, y, z, _] = (at.max(S::F4::splat(0.0)) + S::F4::splat(MAGIC)).to_array();
        [x.to_bits() as usize, y.to_bits() as usize, z.to_bits() as usize]
    }
}

/// Moves the items whose bin is below `bin` to the front; their number.
struct Partition<'a> {
    slices: &'a Slices,
    items: &'a mut [Item],
    axis: usize,
    bin: usize,
}

impl Kernel for Partition<'_> {
    type Output = usize;
    #[inline(always)]
    fn run<S: Simd>(self) -> usize {
        let (low, scale) = (self.slices.low[self.axis], self.slices.scale[self.axis]);
        // The arithmetic of `Slices::of`.
        let end = MAGIC + self.bin as f32;
        let mut middle = 0;
        for i in 0..self.items.len() {
            let at = (self.items[i].center_on(self.axis) - low) * scale - 0.5;
            let is_left = at.max(0.0) + MAGIC < end;
            self.items.swap(i, middle);
            middle += usize::from(is_left);
        }
        middle
    }
}

/// The bins, as boxes that one minimum unites.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Bins<const B: usize> {
    boxes: [[[f32; 8]; B]; 3],
    counts: [[u32; B]; 3],
}

/// A cut between two bins.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinCut {
    /// The sum of area times number.
    pub cost: f32,
    axis: usize,
    /// The first on the right side.
    bin: usize,
    /// What is around the items of each side.
    pub extents: [Extent; 2],
}

impl BinCut {
    /// Moves the items of the left side to the front; their number.
    pub(super) fn apply(&self, slices: &Slices, items: &mut [Item]) -> usize {
        simd::run(Partition { slices, items, axis: self.axis, bin: self.bin })
    }
}

impl<const B: usize> Bins<B> {
    const EMPTY: Self = Self { boxes: [[[f32::INFINITY; 8]; B]; 3], counts: [[0; B]; 3] };

    /// Counts items in. Two tables are filled in turn: items that follow each other are often in the same bin, and the second
    /// would wait until the first one's box is written.
    #[inline(always)]
    fn fill<S: Simd>(slices: &Slices, items: &[Item]) -> Self {
        let mut tables = [Self::EMPTY; 2];
        let mut pairs = items.chunks_exact(2);
        for pair in &mut pairs {
            tables[0].add::<S>(slices, &pair[0]);
            tables[1].add::<S>(slices, &pair[1]);
        }
        for item in pairs.remainder() {
            tables[0].add::<S>(slices, item);
        }
        let [mut all, second] = tables;
        all.merge::<S>(&second, slices.bins);
        all
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, slices: &Slices, item: &Item) {
        let numbers = S::F8::load(&item.numbers);
        let bins = slices.of::<S>(item);
        for (axis, bin) in bins.into_iter().enumerate() {
            let bin = bin % B;
            let place = &mut self.boxes[axis][bin];
            *place = S::F8::load(place).min(numbers).to_array();
            self.counts[axis][bin] += 1;
        }
    }

    #[inline(always)]
    fn merge<S: Simd>(&mut self, other: &Self, bins: usize) {
        for axis in 0..3 {
            for bin in 0..bins.min(B) {
                let place = &mut self.boxes[axis][bin];
                *place = S::F8::load(place).min(S::F8::load(&other.boxes[axis][bin])).to_array();
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
    }

    /// The cut at the least sum of area times number.
    #[inline(always)]
    fn cheapest<S: Simd>(&self, slices: &Slices) -> BinCut {
        let empty = || S::F8::splat(f32::INFINITY);
        let bins = slices.bins.min(B);
        let (mut least, mut best) = (f32::INFINITY, (0, 1));
        for axis in 0..3 {
            if slices.scale[axis] == 0.0 {
                continue;
            }
            let (boxes, counts) = (&self.boxes[axis][..bins], &self.counts[axis][..bins]);
            let mut right_cost = [0.0; B];
            let (mut extent, mut count) = (empty(), 0);
            for bin in (1..bins).rev() {
                extent = extent.min(S::F8::load(&boxes[bin]));
                count += counts[bin];
                right_cost[bin] = half_area::<S>(extent) * count as f32;
            }
            let right = count;
            (extent, count) = (empty(), 0);
            for bin in 1..bins {
                extent = extent.min(S::F8::load(&boxes[bin - 1]));
                count += counts[bin - 1];
                let cost = half_area::<S>(extent) * count as f32 + right_cost[bin];
                if cost < least && count > 0 && count < right + counts[0] {
                    (least, best) = (cost, (axis, bin));
                }
            }
        }
        let (axis, bin) = best;
        let around = |boxes: &[[f32; 8]]| {
            let mut all = empty();
            for numbers in boxes {
                all = all.min(S::F8::load(numbers));
            }
            Extent::from_numbers(&all.to_array())
        };
        let (left, right) = self.boxes[axis][..bins].split_at(bin);
        BinCut { cost: least, axis, bin, extents: [around(left), around(right)] }
    }
}

/// Half the surface of a box; zero for the empty one.
#[inline(always)]
fn half_area<S: Simd>(numbers: S::F8) -> f32 {
    let [x0, y0, z0, _, x1, y1, z1, _] = numbers.to_array();
    let (x, y, z) = ((-(x0 + x1)).max(0.0), (-(y0 + y1)).max(0.0), (-(z0 + z1)).max(0.0));
    (x * (y + z) + y * z).min(MAX_AREA)
}

/// Fills bins.
pub(super) struct Fill<'a, const B: usize> {
    pub slices: &'a Slices,
    pub items: &'a [Item],
}

impl<const B: usize> Kernel for Fill<'_, B> {
    type Output = Bins<B>;
    #[inline(always)]
    fn run<S: Simd>(self) -> Bins<B> {
        Bins::fill::<S>(self.slices, self.items)
    }
}

/// Fills bins and cuts between them.
pub(super) struct FillAndCut<'a, const B: usize>(pub Fill<'a, B>);

impl<const B: usize> Kernel for FillAndCut<'_, B> {
    type Output = BinCut;
    #[inline(always)]
    fn run<S: Simd>(self) -> BinCut {
        Bins::<B>::fill::<S>(self.0.slices, self.0.items).cheapest::<S>(self.0.slices)
    }
}

/// Cuts between bins that were filled by several threads.
pub(super) struct CutParts<'a, const B: usize> {
    pub slices: &'a Slices,
    pub parts: &'a [Bins<B>],
}

impl<const B: usize> Kernel for CutParts<'_, B> {
    type Output = BinCut;
    #[inline(always)]
    fn run<S: Simd>(self) -> BinCut {
        let mut all = Bins::EMPTY;
        for part in self.parts {
            all.merge::<S>(part, B);
        }
        all.cheapest::<S>(self.slices)
    }
}

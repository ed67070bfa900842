//! Along a space-filling curve: neighbours on it are neighbours in space.
//!
//! # References
//! [Lauterbach et al. 2009] "Fast BVH Construction on GPUs".

use glam::Vec4;
use rayon::prelude::*;

use super::top_down::Cut;
use super::tree::{Extent, Item};

/// Bits of a Morton code for each axis.
const BITS: u32 = 21;

/// Cuts where the highest bit of the Morton codes changes.
pub(super) struct Linear {
    low: Vec4,
    scale: Vec4,
}

impl Linear {
    /// Sorts the items along the curve.
    pub(super) fn sort(items: &mut [Item]) -> Self {
        let around = items
            .par_iter()
            .map(|item| Extent::EMPTY.with(item.center()))
            .reduce(|| Extent::EMPTY, |a, b| a.union(&b));
        let size = (around.max - around.min).max(Vec4::splat(f32::MIN_POSITIVE));
        let scale = Vec4::splat((1_u32 << BITS) as f32 * (1.0 - 1e-6)) / size;
        let curve = Self { low: around.min, scale };
        // Small pairs are sorted in place of the items, and each code is computed once.
        let mut order: Vec<(u64, u32)> =
            items.par_iter().zip(0..items.len() as u32).map(|(item, i)| (curve.code(item), i)).collect();
        order.par_sort_unstable();
        let sorted: Vec<Item> = order.par_iter().map(|&(_, i)| items[i as usize]).collect();
        items.copy_from_slice(&sorted);
        curve
    }

    /// Where the center is on the curve: the bits of its coordinates, interleaved.
    fn code(&self, item: &Item) -> u64 {
        let [x, y, z, _] = ((item.center() - self.low) * self.scale).to_array().map(|x| spread(x as u64));
        x | (y << 1) | (z << 2)
    }
}

impl Cut for Linear {
    fn cut(&self, items: &mut [Item]) -> usize {
        let [Some(first), Some(last)] = [items.first(), items.last()].map(|item| item.map(|i| self.code(i)))
        else {
            return 0;
        };
        if first == last {
            return 0;
        }
        let highest = 63 - (first ^ last).leading_zeros();
        items.partition_point(|item| (self.code(item) >> highest) & 1 == 0)
    }
}

/// Moves the lowest 21 bits apart, so that two zeros are between them.
fn spread(x: u64) -> u64 {
    let x = x.min((1 << BITS) - 1);
    let x = (x | (x << 32)) & 0x001f_0000_0000_ffff;
    let x = (x | (x << 16)) & 0x001f_0000_ff00_00ff;
    let x = (x | (x << 8)) & 0x100f_00f0_0f00_f00f;
    let x = (x | (x << 4)) & 0x10c3_0c30_c30c_30c3;
    (x | (x << 2)) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_by_three() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }
}

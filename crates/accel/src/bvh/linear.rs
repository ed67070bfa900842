//! Along a space-filling curve: neighbours on it are neighbours in space.
//!
//! # References
//! [Lauterbach et al. 2009] "Fast BVH Construction on GPUs".

use glam::Vec4;
use rayon::prelude::*;

use super::build::MAX_ITEMS;
use super::top_down::Cut;
use super::tree::Extent;
use crate::big::Big;
use crate::things::Things;

/// Bits of a Morton code for each axis: as many as fit into a key beside the number of the thing.
const BITS: u32 = (u64::BITS - INDEX_BITS) / 3;
const INDEX_BITS: u32 = MAX_ITEMS.trailing_zeros();
/// Things that one thread looks at.
const CHUNK: usize = 1 << 12;

/// Cuts where the highest bit of the Morton codes changes. Items are keys: the code, and below it the number of the thing.
pub(super) struct Linear<'a, T>(pub &'a T);

impl<T: Things> Linear<'_, T> {
    /// The keys of things in the order of the curve.
    pub(super) fn keys(&self, count: usize) -> Big<u64> {
        let all = 0..count as u32;
        let around = all
            .clone()
            .into_par_iter()
            .with_min_len(CHUNK)
            .fold(|| Extent::EMPTY, |all, i| all.union(&Extent::from(&self.0.bounds(i))))
            .reduce(|| Extent::EMPTY, |a, b| a.union(&b));
        let size = (around.max - around.min).max(Vec4::splat(f32::MIN_POSITIVE));
        let scale = Vec4::splat((1_u32 << BITS) as f32 * (1.0 - 1e-6)) / size;
        let mut keys = Big::<u64>::zeroed(count);
        keys.par_iter_mut().with_min_len(CHUNK).zip(all).for_each(|(key, i)| {
            let bounds = Extent::from(&self.0.bounds(i));
            let center = (bounds.min + bounds.max) * 0.5 - around.min;
            let [x, y, z, _] = (center * scale).to_array().map(|x| spread(x as u64));
            *key = (x | (y << 1) | (z << 2)) << INDEX_BITS | u64::from(i);
        });
        keys.par_sort_unstable();
        keys
    }
}

impl<T: Things> Cut for Linear<'_, T> {
    type Item = u64;
    type Hint = ();

    fn index(key: &u64) -> u32 {
        (key % MAX_ITEMS as u64) as u32
    }

    fn bounds(&self, key: &u64) -> Extent {
        Extent::from(&self.0.bounds(Self::index(key)))
    }

    fn hint(&self, _: &[u64]) {}

    fn cut(&self, keys: &mut [u64], (): &()) -> (usize, [(); 2]) {
        let [Some(first), Some(last)] = [keys.first(), keys.last()].map(|key| key.map(|k| k >> INDEX_BITS))
        else {
            return (0, [(); 2]);
        };
        if first == last {
            return (0, [(); 2]);
        }
        let highest = INDEX_BITS + (first ^ last).ilog2();
        (keys.partition_point(|key| (key >> highest) & 1 == 0), [(); 2])
    }
}

/// Moves the lowest bits apart, so that two zeros are between them.
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

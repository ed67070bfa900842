//! From boxes to a hierarchy: a binary tree by one of the builders, then the collapse.

use aureole_math::Bounds3;
use rayon::prelude::*;

use super::collapse::{Costs, collapse};
use super::node::Bvh8;
use super::tree::Item;
use super::{binned, reinsert};
use crate::big::Big;
use crate::{Config, Quality};

/// A hierarchy and what its owner must put into its leaves.
pub(crate) struct Built {
    pub bvh: Bvh8,
    /// Primitives in the order of the leaves.
    pub order: Big<u32>,
    /// What is packed together, as the leaves' references count it: the first in `order` and how many.
    pub groups: Vec<[u32; 2]>,
}

/// Builds a hierarchy over boxes, whose leaves hold groups of up to `lanes` primitives.
pub(crate) fn build(
    count: usize,
    bounds: impl Fn(u32) -> Bounds3 + Sync,
    lanes: usize,
    config: &Config,
) -> Built {
    let mut items = Big::<Item>::zeroed(count);
    items.par_iter_mut().zip(0..count as u32).for_each(|(item, i)| *item = Item::new(&bounds(i), i));
    let tree = match config.quality {
        Quality::Fast | Quality::Medium => binned::build(items, lanes),
        Quality::High => {
            let e = |n: &str, d: f32| std::env::var(n).ok().and_then(|s| s.parse().ok()).unwrap_or(d);
            reinsert::optimize(
                binned::build(items, e("AC_L", 1.0) as usize),
                e("AC_S", 0.1),
                e("AC_P", 1.0) as usize,
            )
        }
    };
    collapse(tree, &Costs::new(lanes))
}

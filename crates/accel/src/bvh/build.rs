//! From boxes to a hierarchy: a binary tree by one of the builders, then the collapse.

use aureole_math::Bounds3;
use rayon::prelude::*;

use super::binned::Binned;
use super::collapse::{Costs, collapse};
use super::linear::Linear;
use super::node::Bvh8;
use super::tree::{BinaryTree, Item};
use super::{reinsert, top_down};
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

/// The share of the nodes for which better places are sought.
const REINSERTED: f32 = 0.3;

/// Builds a hierarchy over boxes, whose leaves hold groups of up to `lanes` primitives.
pub(crate) fn build(
    count: usize,
    bounds: impl Fn(u32) -> Bounds3 + Sync,
    lanes: usize,
    config: &Config,
) -> Built {
    let mut items = items(count, bounds);
    let tree = match config.quality {
        Quality::Fast => {
            let curve = Linear::sort(&mut items);
            top_down::build(items, lanes, &curve)
        }
        Quality::Medium => top_down::build(items, lanes, &Binned),
        Quality::High => reinsert::optimize(top_down::build(items, lanes, &Binned), REINSERTED, 1),
    };
    collapse(tree, &Costs::new(lanes))
}

/// Builds the plain binary tree over boxes, with up to `leaf_size` in a leaf.
pub(crate) fn build_binary(
    count: usize,
    bounds: impl Fn(u32) -> Bounds3 + Sync,
    leaf_size: usize,
) -> BinaryTree {
    top_down::build(items(count, bounds), leaf_size, &Binned)
}

fn items(count: usize, bounds: impl Fn(u32) -> Bounds3 + Sync) -> Big<Item> {
    let mut items = Big::<Item>::zeroed(count);
    items.par_iter_mut().zip(0..count as u32).for_each(|(item, i)| *item = Item::new(&bounds(i), i));
    items
}

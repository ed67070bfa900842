//! From boxes to a hierarchy: a binary tree by one of the builders, then the collapse.

use rayon::prelude::*;

use super::binned::Binned;
use super::collapse::{Costs, collapse};
use super::linear::Linear;
use super::node::Bvh8;
use super::presplit::presplit;
use super::tree::{BinaryTree, Extent, Item};
use super::{reinsert, spatial, top_down};
use crate::big::Big;
use crate::things::Things;
use crate::{Config, Quality};

/// A hierarchy and what its owner must put into its leaves.
pub(crate) struct Built {
    pub bvh: Bvh8,
    /// Primitives in the order of the leaves.
    pub order: Big<u32>,
    /// What is packed together, as the leaves' references count it: the first in `order` and how many.
    pub groups: Vec<[u32; 2]>,
}

/// References have room for so many groups; 100 million primitives are fewer.
pub(crate) const MAX_ITEMS: usize = 1 << 27;
/// Copies at most that spatial splits make, as a share of the primitives.
const COPIES: f32 = 0.3;
/// The same of cuts up front, which are tried where boxes are crowded.
const COPIES_OF_CROWDED: f32 = 1.0;
/// Where that is: a ray meets so many of the primitives' boxes.
const CROWDED: f32 = 50.0;
/// The share of the nodes for which better places are sought.
const REINSERTED: f32 = 0.3;

/// Builds a hierarchy over boxes, whose leaves hold groups of up to `lanes` primitives.
pub(crate) fn build(count: usize, things: &impl Things, lanes: usize, config: &Config) -> Built {
    let tree = match config.quality {
        Quality::Fast => top_down::build(Linear(things).keys(count), lanes, &Linear(things)),
        Quality::Medium => top_down::build(items(count, things), lanes, &Binned),
        Quality::High => return best(items(count, things), things, lanes),
    };
    collapse(tree, &Costs::new(lanes))
}

/// Of several trees the one at the least expected cost.
fn best(items: Big<Item>, things: &impl Things, lanes: usize) -> Built {
    let count = items.len();
    let done = |tree| collapse(reinsert::optimize(tree, REINSERTED, 1), &Costs::new(lanes));
    let whole = |items| top_down::build(items, lanes, &Binned);
    if count == 0 || things.corners(0).is_none() {
        return done(whole(items));
    }
    let room = (MAX_ITEMS - 1).saturating_sub(count);
    let budget = ((count as f32 * COPIES) as usize).min(room);
    let mut all = vec![done(spatial::build(&items, budget, lanes, things))];
    if crowding(&items) > CROWDED {
        let pieces = presplit(&items, ((count as f32 * COPIES_OF_CROWDED) as usize).min(room), things);
        all.push(done(BinaryTree { copies: true, ..whole(Big::from(pieces)) }));
    }
    let plain = done(whole(items));
    let cost = |built: &Built| built.bvh.stats.sah_cost;
    all.into_iter().fold(plain, |best, other| if cost(&other) < cost(&best) { other } else { best })
}

/// How many of the items' boxes a ray meets that meets the box around them all.
fn crowding(items: &[Item]) -> f32 {
    let all = items.iter().fold(Extent::EMPTY, |all, item| all.union(&item.bounds()));
    let sum: f64 = items.iter().map(|item| f64::from(item.bounds().half_area())).sum();
    sum as f32 / all.half_area().max(f32::MIN_POSITIVE)
}

/// Builds the plain binary tree over boxes, with up to `leaf_size` in a leaf.
pub(crate) fn build_binary(count: usize, things: &impl Things, leaf_size: usize) -> BinaryTree {
    top_down::build(items(count, things), leaf_size, &Binned)
}

fn items(count: usize, things: &impl Things) -> Big<Item> {
    let mut items = Big::<Item>::zeroed(count);
    items.par_iter_mut().zip(0..count as u32).for_each(|(item, i)| *item = Item::new(&things.bounds(i), i));
    items
}

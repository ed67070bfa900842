//! From boxes to a hierarchy: a binary tree by one of the builders, then the collapse.

use aureole_math::Bounds3;
use rayon::prelude::*;

use super::binned;
use super::collapse::{Costs, collapse};
use super::node::Bvh8;
use super::tree::Item;
use crate::Config;

/// A hierarchy and what its owner must put into its leaves.
pub(crate) struct Built {
    pub bvh: Bvh8,
    /// Primitives in the order of the leaves.
    pub order: Vec<u32>,
    /// For each leaf, in the order in which the references number packed things: the first in `order` and how many.
    pub leaves: Vec<[u32; 2]>,
}

/// Builds a hierarchy over boxes, whose leaves hold groups of up to `lanes` primitives.
pub(crate) fn build(boxes: &[Bounds3], lanes: usize, config: &Config) -> Built {
    let items: Vec<Item> = boxes.par_iter().enumerate().map(|(i, b)| Item::new(b, i as u32)).collect();
    let tree = binned::build(items, 1);
    let _ = config.quality;
    collapse(&tree, &Costs::new(lanes))
}

//! Cuts large, slanting triangles into pieces before a tree is built over them.
//!
//! The greedy search of [`spatial`](super::spatial) finds a plane only where a single cut pays at once. Triangles that are long in
//! every direction need several: here each gets a number of cuts by how much of its box it leaves empty.
//!
//! # References
//! [Karras and Aila 2013] "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies", section 4.

use rayon::prelude::*;

use super::spatial::piece;
use super::tree::{Extent, Item};
use crate::things::Things;

/// Bits of the grid on whose planes the cuts lie: all triangles near a plane are cut at the same place.
const BITS: u32 = 16;

/// The items and up to `budget` more, the pieces of some of them.
pub(super) fn presplit(items: &[Item], budget: usize, things: &impl Things) -> Vec<Item> {
    let root = items.par_iter().map(Item::bounds).reduce(|| Extent::EMPTY, |a, b| a.union(&b));
    let grid = Grid { root };
    let priorities: Vec<f32> = items.par_iter().map(|item| grid.priority(item, things)).collect();
    let cuts = |scale: f32| priorities.iter().map(|p| (p * scale) as usize).sum::<usize>();
    let sum: f64 = priorities.iter().map(|&p| f64::from(p)).sum();
    if budget == 0 || !(sum > 0.0 && sum.is_finite()) {
        return items.to_vec();
    }
    // The largest scale that the budget allows, to a hundredth or so.
    let (mut low, mut high) = ((budget as f64 / sum) as f32, (4.0 * budget as f64 / sum) as f32);
    for _ in 0..8 {
        let middle = 0.5 * (low + high);
        if cuts(middle) <= budget { low = middle } else { high = middle }
    }
    let chunk = 1 << 14;
    let pieces: Vec<Vec<Item>> = items
        .par_chunks(chunk)
        .zip(priorities.par_chunks(chunk))
        .map(|(items, priorities)| {
            let mut pieces = Vec::with_capacity(items.len() * 5 / 4);
            for (item, priority) in items.iter().zip(priorities) {
                grid.cut(item, (priority * low) as usize, things, &mut pieces);
            }
            pieces
        })
        .collect();
    pieces.concat()
}

/// Planes that halve the root's box again and again.
struct Grid {
    root: Extent,
}

/// The plane across a box that comes first in the halving.
struct Plane {
    axis: usize,
    at: f32,
    /// How often the root's box was halved before.
    level: u32,
}

impl Grid {
    fn plane(&self, bounds: &Extent) -> Option<Plane> {
        let size = self.root.max - self.root.min;
        let mut best: Option<(u32, f32, Plane)> = None;
        for axis in 0..3 {
            let scale = (1_u32 << BITS) as f32 / size[axis];
            if !(scale.is_finite() && size[axis].is_finite()) {
                continue;
            }
            let cell = |x: f32| (((x - self.root.min[axis]) * scale) as u32).min((1 << BITS) - 1);
            let (low, high) = (cell(bounds.min[axis]), cell(bounds.max[axis]));
            if low == high {
                continue;
            }
            let bit = 31 - (low ^ high).leading_zeros();
            let at = self.root.min[axis] + ((high >> bit) << bit) as f32 / scale;
            let length = bounds.max[axis] - bounds.min[axis];
            let comes_first = best.as_ref().is_none_or(|(b, l, _)| bit > *b || (bit == *b && length > *l));
            if comes_first && bounds.min[axis] < at && at < bounds.max[axis] {
                best = Some((bit, length, Plane { axis, at, level: BITS - 1 - bit }));
            }
        }
        best.map(|(.., plane)| plane)
    }

    /// How much a triangle is to be cut: by the area of its box that is not its own, and less the later its plane comes.
    fn priority(&self, item: &Item, things: &impl Things) -> f32 {
        let bounds = item.bounds();
        let Some((plane, [a, b, c])) = self.plane(&bounds).zip(things.corners(item.index())) else {
            return 0.0;
        };
        let [a, b, c] = [a, b, c].map(glam::Vec3::from);
        // The three shadows along the axes are the least that boxes around pieces of it can come down to.
        let ideal = 0.5 * (b - a).cross(c - a).abs().element_sum();
        let empty = (bounds.half_area() - ideal).max(0.0);
        (empty * (-(plane.level as f32)).exp2()).cbrt()
    }

    fn cut(&self, item: &Item, cuts: usize, things: &impl Things, into: &mut Vec<Item>) {
        let bounds = item.bounds();
        if cuts > 0
            && let Some(plane) = self.plane(&bounds)
            && let Some(corners) = things.corners(item.index())
        {
            let parts = [(f32::NEG_INFINITY, plane.at), (plane.at, f32::INFINITY)]
                .map(|(from, to)| piece(&corners, &bounds, plane.axis, from, to));
            if parts.iter().all(|part| !part.is_empty()) {
                let [left, right] = parts.map(|part| (part.max - part.min).truncate().max_element());
                let left_cuts = ((cuts - 1) as f32 * (left / (left + right)) + 0.5) as usize;
                let left_cuts = left_cuts.min(cuts - 1);
                for (part, cuts) in parts.iter().zip([left_cuts, cuts - 1 - left_cuts]) {
                    self.cut(&Item::new(&part.bounds(), item.index()), cuts, things, into);
                }
                return;
            }
        }
        into.push(*item);
    }
}

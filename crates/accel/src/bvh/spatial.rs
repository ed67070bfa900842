//! Spatial splits: a triangle that reaches far goes into both halves, each with the box of its part.
//!
//! # References
//! [Stich, Friedrich and Dietrich 2009] "Spatial Splits in Bounding Volume Hierarchies".

use aureole_math::Bounds3;
use glam::Vec4;
use rayon::prelude::*;

use super::binned::{self, Binned};
use super::top_down::{Builder, Cut, PARALLEL};
use super::tree::{BinaryNode, BinaryTree, Extent, FREE_LEVELS, Item};
use crate::big::Big;
use crate::things::Things;

/// Parts of a node's box between which planes may lie.
const BINS: usize = 16;
/// Planes are sought where the halves of the best ordinary cut overlap by more than this share of the root's area: the
/// paper's α.
const LEAST_OVERLAP: f32 = 1e-5;
/// Boxes of parts are larger by this share of the triangle's coordinates, since a hit may lie beside its triangle by rounding.
const SLACK: f32 = 1e-6;
/// Items whose bins are filled by one thread.
const CHUNK: usize = 1 << 14;

/// Builds a tree whose leaves have at most `leaf_size` items, with copies of some.
pub(super) fn build(items: &[Item], budget: usize, leaf_size: usize, things: &impl Things) -> BinaryTree {
    let count = items.len();
    if count == 0 {
        return BinaryTree::default();
    }
    let root = items.iter().fold(Extent::EMPTY, |extent, item| extent.union(&item.bounds()));
    let splitter = Splitter { leaf_size, things, least_overlap: LEAST_OVERLAP * root.half_area() };
    let mut part = Part::default();
    splitter.split(items.to_vec(), budget, 0, &mut part);
    BinaryTree {
        nodes: Big::from(part.nodes),
        order: Big::from(part.order),
        copies: true,
        ..BinaryTree::default()
    }
}

/// A part of the tree; its root is node 0, its leaves' items are numbered from 0.
#[derive(Default)]
struct Part {
    nodes: Vec<BinaryNode>,
    order: Vec<u32>,
}

impl Part {
    fn append(&mut self, other: Self) {
        let (nodes, items) = (self.nodes.len(), self.order.len());
        self.nodes.extend(other.nodes.into_iter().map(|node| node.moved_by(nodes, items)));
        self.order.extend(other.order);
    }
}

struct Splitter<'a, T> {
    leaf_size: usize,
    things: &'a T,
    /// The area from which on overlap is worth a look.
    least_overlap: f32,
}

/// A plane across a node, and what it would make.
struct Plane {
    cost: f32,
    axis: usize,
    at: f32,
    halves: [Half; 2],
}

/// One side of a cut.
#[derive(Clone, Copy)]
struct Half {
    extent: Extent,
    count: usize,
}

impl Half {
    const EMPTY: Self = Self { extent: Extent::EMPTY, count: 0 };

    fn cost(&self) -> f32 {
        self.extent.half_area() * self.count as f32
    }

    fn with(&self, item: &Item) -> Self {
        Self { extent: self.extent.union(&item.bounds()), ..*self }
    }

    fn without_one(&self) -> Self {
        Self { count: self.count.saturating_sub(1), ..*self }
    }
}

impl<T: Things> Splitter<'_, T> {
    /// Appends the tree over items, of which `budget` more may be made; the box around them.
    fn split(&self, mut items: Vec<Item>, budget: usize, depth: usize, part: &mut Part) -> Extent {
        let count = items.len();
        if budget == 0 || count <= self.leaf_size || depth >= FREE_LEVELS {
            let builder = Builder { leaf_size: self.leaf_size, cut: &Binned };
            let hint = Binned.hint(&items);
            let extent = builder.split(&mut items, part.order.len(), depth, &hint, &mut part.nodes);
            part.order.extend(items.iter().map(Item::index));
            return extent;
        }
        let [left, right] = self.halves(items, budget);
        let left_over = budget - (left.len() + right.len() - count);
        let left_budget = (left_over as u64 * left.len() as u64 / (left.len() + right.len()) as u64) as usize;
        let right_budget = left_over - left_budget;
        let node = part.nodes.len();
        part.nodes.push(BinaryNode::leaf(Bounds3::EMPTY, 0, 0));
        let (left_extent, right_extent, right_node);
        if count > PARALLEL {
            let build = |items: Vec<Item>, budget| {
                let mut part = Part::default();
                (self.split(items, budget, depth + 1, &mut part), part)
            };
            let (a, b) = rayon::join(|| build(left, left_budget), || build(right, right_budget));
            (left_extent, right_extent) = (a.0, b.0);
            part.append(a.1);
            right_node = part.nodes.len();
            part.append(b.1);
        } else {
            left_extent = self.split(left, left_budget, depth + 1, part);
            right_node = part.nodes.len();
            right_extent = self.split(right, right_budget, depth + 1, part);
        }
        let extent = left_extent.union(&right_extent);
        part.nodes[node] = BinaryNode::inner(extent.bounds(), node + 1, right_node);
        extent
    }

    fn corners(&self, item: &Item) -> [[f32; 3]; 3] {
        self.things.corners(item.index()).expect("only triangles are cut")
    }

    /// Shares items out to two sides, neither of them empty.
    fn halves(&self, mut items: Vec<Item>, budget: usize) -> [Vec<Item>; 2] {
        let ordinary = binned::best(&items);
        let (overlap, cost) = ordinary.as_ref().map_or((f32::INFINITY, f32::INFINITY), |(cut, _)| {
            let [left, right] = &cut.extents;
            (left.intersection(right).half_area(), cut.cost)
        });
        if overlap > self.least_overlap
            && let Some(plane) = self.best_plane(&items).filter(|plane| plane.cost < cost)
            && let Some(halves) = self.apart(&plane, &items, budget)
        {
            return halves;
        }
        let middle = ordinary.map_or(0, |(cut, slices)| cut.apply(&slices, &mut items));
        let middle = if middle == 0 || middle == items.len() { items.len() / 2 } else { middle };
        let right = items.split_off(middle);
        [items, right]
    }

    /// The plane at the least sum of area times number.
    fn best_plane(&self, items: &[Item]) -> Option<Plane> {
        let around = |items: &[Item]| items.iter().fold(Extent::EMPTY, |all, item| all.union(&item.bounds()));
        let extent = around(items);
        let slices = Slices::new(&extent);
        let bins = if items.len() <= CHUNK {
            self.fill(&slices, items)
        } else {
            items
                .par_chunks(CHUNK)
                .map(|items| self.fill(&slices, items))
                .reduce(Bins::new, |a, b| a.merged(&b))
        };
        let mut best: Option<Plane> = None;
        for axis in (0..3).filter(|&axis| slices.scale[axis] > 0.0) {
            let mut rights = [Half::EMPTY; BINS];
            let mut right = Half::EMPTY;
            for bin in (1..BINS).rev() {
                right.extent = right.extent.union(&bins.boxes[axis][bin]);
                right.count += bins.last[axis][bin] as usize;
                rights[bin] = right;
            }
            let mut left = Half::EMPTY;
            for (bin, right) in rights.iter().enumerate().skip(1) {
                left.extent = left.extent.union(&bins.boxes[axis][bin - 1]);
                left.count += bins.first[axis][bin - 1] as usize;
                let halves = [left, *right];
                let cost = halves[0].cost() + halves[1].cost();
                if halves.iter().all(|half| half.count > 0)
                    && best.as_ref().is_none_or(|best| cost < best.cost)
                {
                    best = Some(Plane { cost, axis, at: slices.plane(axis, bin), halves });
                }
            }
        }
        best
    }

    fn fill(&self, slices: &Slices, items: &[Item]) -> Bins {
        let mut bins = Bins::new();
        for item in items {
            let bounds = item.bounds();
            let mut corners = None;
            for axis in (0..3).filter(|&axis| slices.scale[axis] > 0.0) {
                let first = slices.bin(axis, bounds.min[axis]);
                let last = slices.bin(axis, bounds.max[axis]);
                bins.first[axis][first] += 1;
                bins.last[axis][last] += 1;
                if first == last {
                    bins.boxes[axis][first] = bins.boxes[axis][first].union(&bounds);
                    continue;
                }
                let corners = corners.get_or_insert_with(|| self.corners(item));
                for bin in first..=last {
                    let from = if bin == first { f32::NEG_INFINITY } else { slices.plane(axis, bin) };
                    let to = if bin == last { f32::INFINITY } else { slices.plane(axis, bin + 1) };
                    let piece = piece(corners, &bounds, axis, from, to);
                    bins.boxes[axis][bin] = bins.boxes[axis][bin].union(&piece);
                }
            }
        }
        bins
    }

    /// Shares items out to the sides of a plane. `None` when that takes too many copies or does not divide them.
    fn apart(&self, plane: &Plane, items: &[Item], budget: usize) -> Option<[Vec<Item>; 2]> {
        let (axis, at) = (plane.axis, plane.at);
        let [left, right] = &plane.halves;
        let mut sides = [Vec::with_capacity(left.count), Vec::with_capacity(right.count)];
        let mut copies = 0;
        for item in items {
            let bounds = item.bounds();
            if bounds.max[axis] <= at {
                sides[0].push(*item);
                continue;
            }
            if bounds.min[axis] >= at {
                sides[1].push(*item);
                continue;
            }
            // Whole on one side, if that is cheaper than a part on each.
            let costs = [
                plane.cost,
                left.with(item).cost() + right.without_one().cost(),
                left.without_one().cost() + right.with(item).cost(),
            ];
            let corners = self.corners(item);
            let parts = [(f32::NEG_INFINITY, at), (at, f32::INFINITY)]
                .map(|(from, to)| piece(&corners, &bounds, axis, from, to));
            if parts[1].is_empty() || (costs[1] < costs[0] && costs[1] <= costs[2]) {
                sides[0].push(*item);
            } else if parts[0].is_empty() || costs[2] < costs[0] {
                sides[1].push(*item);
            } else {
                copies += 1;
                for (side, part) in sides.iter_mut().zip(&parts) {
                    side.push(Item::new(&part.bounds(), item.index()));
                }
            }
        }
        let divides = sides.iter().all(|side| !side.is_empty() && side.len() < items.len());
        (copies <= budget && divides).then_some(sides)
    }
}

/// A node's box cut into equal slices along each axis.
struct Slices {
    low: Vec4,
    size: Vec4,
    /// Zero on axes that are not cut.
    scale: Vec4,
}

impl Slices {
    fn new(extent: &Extent) -> Self {
        let size = extent.max - extent.min;
        let scale = Vec4::splat(BINS as f32) / size;
        let axes = [0, 1, 2].map(|i| size[i] > 0.0 && size[i].is_finite() && scale[i].is_finite());
        let pick = |i: usize| if i < 3 && axes[i] { scale[i] } else { 0.0 };
        Self { low: extent.min, size, scale: Vec4::from_array([0, 1, 2, 3].map(pick)) }
    }

    fn bin(&self, axis: usize, x: f32) -> usize {
        (((x - self.low[axis]) * self.scale[axis]) as usize).min(BINS - 1)
    }

    /// Where a slice begins.
    fn plane(&self, axis: usize, bin: usize) -> f32 {
        self.low[axis] + self.size[axis] * (bin as f32 / BINS as f32)
    }
}

/// Boxes of what is in each slice, and how many items begin and end in it.
struct Bins {
    boxes: [[Extent; BINS]; 3],
    first: [[u32; BINS]; 3],
    last: [[u32; BINS]; 3],
}

impl Bins {
    fn new() -> Self {
        Self { boxes: [[Extent::EMPTY; BINS]; 3], first: [[0; BINS]; 3], last: [[0; BINS]; 3] }
    }

    fn merged(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.boxes[axis][bin] = self.boxes[axis][bin].union(&other.boxes[axis][bin]);
                self.first[axis][bin] += other.first[axis][bin];
                self.last[axis][bin] += other.last[axis][bin];
            }
        }
        self
    }
}

/// The box around the part of a triangle between two planes; within `bounds`, which may be a part already.
pub(super) fn piece(corners: &[[f32; 3]; 3], bounds: &Extent, axis: usize, from: f32, to: f32) -> Extent {
    let [a, b, c] = corners.map(|[x, y, z]| Vec4::new(x, y, z, 0.0));
    let mut piece = Extent::EMPTY;
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let (u, v) = (p[axis], q[axis]);
        if u >= from && u <= to {
            piece = piece.with(p);
        }
        for plane in [from, to] {
            if (u < plane && plane < v) || (v < plane && plane < u) {
                piece = piece.with(p + (q - p) * ((plane - u) / (v - u)));
            }
        }
    }
    let slack = SLACK * a.abs().max(b.abs()).max(c.abs());
    Extent { min: piece.min - slack, max: piece.max + slack }.intersection(bounds)
}

#[cfg(test)]
mod tests {
    use aureole_math::{Pcg32, Point3};

    use super::super::collapse::{Costs, collapse};
    use super::super::presplit::presplit;
    use super::super::{top_down, tree::Below};
    use super::*;

    struct Sticks(Vec<[[f32; 3]; 3]>);

    impl Things for Sticks {
        fn bounds(&self, id: u32) -> Bounds3 {
            Bounds3::around(self.0[id as usize].map(Point3::from))
        }

        fn corners(&self, id: u32) -> Option<[[f32; 3]; 3]> {
            Some(self.0[id as usize])
        }
    }

    /// Long, thin triangles that run across everything.
    fn sticks(count: usize) -> Sticks {
        let mut rng = Pcg32::new(12);
        let mut point = |size: f32| [0; 3].map(|_| (rng.next_f32() - 0.5) * size);
        Sticks(
            (0..count)
                .map(|_| {
                    let (start, way, width) = (point(1.0), point(1.5), point(0.02));
                    let end = [0, 1, 2].map(|i| start[i] + way[i]);
                    [start, end, [0, 1, 2].map(|i| end[i] + width[i])]
                })
                .collect(),
        )
    }

    fn cost(tree: BinaryTree) -> f32 {
        collapse(tree, &Costs::new(8)).bvh.stats.sah_cost
    }

    /// A few long planks, along the axes and across, among many small things.
    fn kitchen() -> Sticks {
        let mut rng = Pcg32::new(30);
        let mut triangles = sticks(3000).0;
        for t in &mut triangles[200..] {
            let small = |p: [f32; 3], a: [f32; 3]| [0, 1, 2].map(|i| a[i] + 0.02 * (p[i] - a[i]));
            *t = [t[0], small(t[1], t[0]), small(t[2], t[0])];
        }
        for t in &mut triangles[..100] {
            let axis = rng.next_u32() as usize % 3;
            let along = |i: usize| if i == axis { 1.0 } else { 0.02 };
            t[1] = [0, 1, 2].map(|i| t[0][i] + along(i) * (t[1][i] - t[0][i]).signum());
            t[2] = [0, 1, 2].map(|i| t[1][i] + 0.05 * rng.next_f32());
        }
        Sticks(triangles)
    }

    #[test]
    fn long_triangles_among_small_ones_cost_less_in_parts() {
        let kitchen = kitchen();
        let items: Vec<Item> = (0..3000).map(|i| Item::new(&kitchen.bounds(i), i)).collect();
        let parts = build(&items, 900, 8, &kitchen);
        assert!(parts.order.len() <= 3900 && parts.order.len() > 3000, "{}", parts.order.len());
        let (parts, whole) = (cost(parts), cost(top_down::build(Big::from(items), 8, &Binned)));
        assert!(parts < 0.9 * whole, "{parts} {whole}");
    }

    #[test]
    fn triangles_long_in_all_directions_cost_less_in_pieces() {
        let sticks = sticks(3000);
        let items: Vec<Item> = (0..3000).map(|i| Item::new(&sticks.bounds(i), i)).collect();
        let pieces = presplit(&items, 3000, &sticks);
        assert!(pieces.len() <= 6000 && pieces.len() > 5000, "{}", pieces.len());
        let tree = top_down::build(Big::from(pieces), 8, &Binned);
        let (parts, whole) =
            (cost(BinaryTree { copies: true, ..tree }), cost(top_down::build(Big::from(items), 8, &Binned)));
        assert!(parts < 0.9 * whole, "{parts} {whole}");
    }

    #[test]
    fn every_point_of_a_triangle_is_in_a_leaf_that_holds_it() {
        let sticks = sticks(500);
        let items: Vec<Item> = (0..500).map(|i| Item::new(&sticks.bounds(i), i)).collect();
        let pieces = top_down::build(Big::from(presplit(&items, 500, &sticks)), 2, &Binned);
        for tree in [build(&items, 150, 2, &sticks), pieces] {
            holds_every_point(&sticks, &tree);
        }
    }

    fn holds_every_point(sticks: &Sticks, tree: &BinaryTree) {
        let mut leaves = vec![Vec::new(); 500];
        for node in tree.nodes.iter() {
            if let Below::Items { first, count } = node.below() {
                for &id in &tree.order[first..first + count] {
                    leaves[id as usize].push(node.bounds);
                }
            }
        }
        let mut rng = Pcg32::new(4);
        for (triangle, leaves) in sticks.0.iter().zip(&leaves) {
            let [a, b, c] = triangle.map(Point3::from);
            for _ in 0..500 {
                let (u, v) = (rng.next_f32(), rng.next_f32());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let p = a + (b - a) * u + (c - a) * v;
                assert!(leaves.iter().any(|leaf| leaf.contains(p)), "{p:?} of {triangle:?}");
            }
        }
    }
}

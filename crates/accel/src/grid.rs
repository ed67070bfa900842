//! The uniform grid: space cut into equal cells, each with a list of what is in it.
//!
//! In the steps of the classic lecture: a box around everything; `n³ = d · |O|` cells, shared out by the box's proportions; each
//! object goes into the cells that its box overlaps, and stays where it overlaps the cell itself; a ray goes from cell to
//! cell along a 6-connected line by a 3D-DDA, and mailboxes keep it from testing an object again in the next cell.
//!
//! # References
//! [Amanatides and Woo 1987] "A Fast Voxel Traversal Algorithm for Ray Tracing"; mailboxes: [Arnaldi et al. 1987].

use aureole_math::{Bounds3, Point3, Ray};

use crate::bvh::{Leaf, TIE_SCALE, VisitLeaf};
use crate::simd::Simd;
use crate::things::Things;

/// How a grid is laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridConfig {
    /// `d`: cells for each object.
    pub density: f32,
    /// Whether objects stay only in the cells that they overlap themselves, rather than their boxes.
    pub exact: bool,
}

impl Default for GridConfig {
    fn default() -> Self {
        Self { density: 4.0, exact: true }
    }
}

/// Cells along an axis at most.
const MAX_SIDE: f64 = 1024.0;
/// Entries in the lists of all cells at most, for each object; never more than 32 bits can number.
const MAX_ENTRIES: usize = 256;
/// How far cells reach into their neighbours, as a share of the cell and of the grid: a ray's way through the cells and its
/// hits are rounded differently.
const OVERLAP: [f32; 2] = [1e-3, 1e-5];
/// Rays from farther away, in diagonals of the grid, would be rounded by more than that: they test everything.
const FAR: f64 = 32.0;
/// Objects that a ray remembers to have tested.
const MAILBOXES: usize = 64;

/// A grid over objects that its owner numbers.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    bounds: Bounds3,
    /// Cells along each axis.
    sides: [usize; 3],
    /// Where the list of each cell begins in `objects`; x runs fastest.
    starts: Vec<u32>,
    objects: Vec<u32>,
    count: usize,
}

impl Grid {
    /// Places `count` objects by their boxes, or more exactly.
    pub(crate) fn build(count: usize, things: &impl Things, config: &GridConfig) -> Self {
        let all = (0..count as u32).fold(Bounds3::EMPTY, |all, i| all.union(things.bounds(i)));
        let most = MAX_ENTRIES.saturating_mul(count).min(u32::MAX as usize);
        let mut density = f64::from(config.density.clamp(1e-3, 1e3));
        loop {
            let mut grid = Self::empty(all, count, density);
            let mut cells: Vec<u32> = vec![0; grid.sides.iter().product()];
            let mut entries = 0;
            let keep = |i: u32, cell: &Bounds3| !config.exact || things.overlaps(i, cell);
            for i in 0..count as u32 {
                grid.cells_of(&things.bounds(i), |cell, space| {
                    if keep(i, space) {
                        cells[cell] += 1;
                        entries += 1;
                    }
                });
                if entries > most {
                    break;
                }
            }
            if entries > most && grid.sides != [1; 3] {
                density /= 8.0; // large objects, each in a great many cells
                continue;
            }
            let mut sum = 0;
            grid.starts = cells
                .iter()
                .map(|n| {
                    sum += n;
                    sum - n
                })
                .chain([entries as u32])
                .collect();
            grid.objects = vec![0; entries];
            let mut next = grid.starts.clone();
            let mut objects = std::mem::take(&mut grid.objects);
            for i in 0..count as u32 {
                grid.cells_of(&things.bounds(i), |cell, space| {
                    if keep(i, space) {
                        objects[next[cell] as usize] = i;
                        next[cell] += 1;
                    }
                });
            }
            return Self { objects, ..grid };
        }
    }

    fn empty(bounds: Bounds3, count: usize, density: f64) -> Self {
        // In double precision no extent is infinite.
        let extent = |axis: usize| f64::from(bounds.max[axis]) - f64::from(bounds.min[axis]);
        let size = if bounds.is_empty() { [0.0; 3] } else { [0, 1, 2].map(extent) };
        let longest = size.into_iter().fold(f64::from(f32::MIN_POSITIVE), f64::max);
        // A flat scene has cells as if it were a little thick.
        let size = size.map(|s| s.max(longest * 1e-3));
        let edge = (size[0] * size[1] * size[2] / (density * count.max(1) as f64)).cbrt();
        let sides = size.map(|s| (s / edge).round().clamp(1.0, MAX_SIDE) as usize);
        Self { bounds, sides, starts: Vec::new(), objects: Vec::new(), count }
    }

    /// The space of a cell, and a little more.
    fn space(&self, cell: [usize; 3]) -> Bounds3 {
        let size = self.bounds.max - self.bounds.min;
        let corner = |up: usize| {
            let at = |axis: usize| {
                let share = (cell[axis] + up) as f32 / self.sides[axis] as f32;
                let slack = size[axis] / self.sides[axis] as f32 * OVERLAP[0] + size.length() * OVERLAP[1];
                self.bounds.min[axis] + size[axis] * share + if up == 1 { slack } else { -slack }
            };
            Point3::new(at(0), at(1), at(2))
        };
        Bounds3 { min: corner(0), max: corner(1) }
    }

    /// Calls `visit` with the number and the space of each cell that a box overlaps.
    fn cells_of(&self, object: &Bounds3, mut visit: impl FnMut(usize, &Bounds3)) {
        let size = self.bounds.max - self.bounds.min;
        let range = |axis: usize| {
            let slack = size[axis] / self.sides[axis] as f32 * OVERLAP[0] + size.length() * OVERLAP[1];
            let cell = |x: f32| {
                let at =
                    (x - self.bounds.min[axis]) / size[axis].max(f32::MIN_POSITIVE) * self.sides[axis] as f32;
                (at.max(0.0) as usize).min(self.sides[axis] - 1)
            };
            cell(object.min[axis] - slack)..=cell(object.max[axis] + slack)
        };
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    visit(self.number([x, y, z]), &self.space([x, y, z]));
                }
            }
        }
    }

    fn number(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.sides[1] + y) * self.sides[0] + x
    }

    /// Visits the objects in the cells along a ray.
    #[inline(always)]
    pub(crate) fn walk<S: Simd, V: VisitLeaf>(&self, ray: &Ray, mut t_max: f32, visitor: &mut V) {
        let Some(mut line) = Line::new(self, ray) else { return };
        if line.is_far {
            visitor.visit::<S>(0, self.count);
            return;
        }
        let mut mailboxes = [u32::MAX; MAILBOXES];
        loop {
            let cell = self.number(line.cell);
            for &object in &self.objects[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                let mailbox = &mut mailboxes[object as usize % MAILBOXES];
                if std::mem::replace(mailbox, object) == object {
                    continue;
                }
                match visitor.visit::<S>(object as usize, 1) {
                    Leaf::Continue(t) => t_max = t,
                    Leaf::Stop => return,
                }
            }
            if !line.advance(f64::from(t_max * TIE_SCALE)) {
                return;
            }
        }
    }

    /// What is in all lists.
    pub(crate) fn objects(&self) -> &[u32] {
        &self.objects
    }

    /// Bytes of the lists.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.starts[..]) + size_of_val(&self.objects[..])
    }

    /// Cells, and entries in all their lists.
    pub(crate) fn cells_and_entries(&self) -> (usize, usize) {
        (self.sides.iter().product(), self.objects.len())
    }

    /// The box around everything.
    pub(crate) fn bounds(&self) -> Bounds3 {
        self.bounds
    }
}

/// A ray's way from cell to cell, in double precision.
struct Line {
    cell: [usize; 3],
    /// How many steps remain on each axis before the ray leaves the grid.
    remaining: [usize; 3],
    forwards: [bool; 3],
    /// Where the ray crosses into the next cell on each axis, and how far apart the crossings are.
    crossing: [f64; 3],
    spacing: [f64; 3],
    is_far: bool,
}

impl Line {
    /// `None` when the ray misses the grid.
    #[inline(always)]
    fn new(grid: &Grid, ray: &Ray) -> Option<Self> {
        let wide = |v: [f32; 3]| v.map(f64::from);
        let (o, d) = (wide(ray.origin.to_array()), wide(ray.direction.to_array()));
        let (low, high) = (wide(grid.bounds.min.to_array()), wide(grid.bounds.max.to_array()));
        let size = (grid.bounds.max - grid.bounds.min).length();
        let slack = f64::from(size) * f64::from(OVERLAP[1]);
        let (mut enter, mut leave) = (f64::from(ray.t_min), f64::from(ray.t_max));
        for axis in 0..3 {
            if d[axis] == 0.0 {
                if o[axis] < low[axis] - slack || o[axis] > high[axis] + slack {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low[axis] - slack - o[axis]) / d[axis], (high[axis] + slack - o[axis]) / d[axis]);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        if grid.count == 0 || enter.is_nan() || enter > leave {
            return None;
        }
        let mut line = Self {
            cell: [0; 3],
            remaining: [0; 3],
            forwards: d.map(|d| d > 0.0),
            crossing: [f64::INFINITY; 3],
            spacing: [f64::INFINITY; 3],
            is_far: !size.is_finite()
                || (0..3).any(|axis| {
                    (o[axis] - low[axis]).abs().max((o[axis] - high[axis]).abs()) > FAR * f64::from(size)
                }),
        };
        for axis in 0..3 {
            let sides = grid.sides[axis] as f64;
            let edge = (high[axis] - low[axis]) / sides;
            let at = if edge > 0.0 { (o[axis] + d[axis] * enter - low[axis]) / edge } else { 0.0 };
            let cell = at.clamp(0.0, sides - 1.0) as usize;
            line.cell[axis] = cell;
            line.remaining[axis] = if line.forwards[axis] { grid.sides[axis] - 1 - cell } else { cell };
            if d[axis] != 0.0 && line.remaining[axis] > 0 {
                let plane = low[axis] + edge * (cell + usize::from(line.forwards[axis])) as f64;
                line.crossing[axis] = (plane - o[axis]) / d[axis];
                line.spacing[axis] = edge / d[axis].abs();
            }
        }
        Some(line)
    }

    /// Goes to the next cell; whether there is one before `t_max`.
    #[inline(always)]
    fn advance(&mut self, t_max: f64) -> bool {
        let [x, y, z] = self.crossing;
        let axis = if x <= y && x <= z {
            0
        } else if y <= z {
            1
        } else {
            2
        };
        if self.crossing[axis] > t_max || self.remaining[axis] == 0 {
            return false;
        }
        self.remaining[axis] -= 1;
        if self.forwards[axis] {
            self.cell[axis] += 1;
        } else {
            self.cell[axis] -= 1;
        }
        self.crossing[axis] =
            if self.remaining[axis] == 0 { f64::INFINITY } else { self.crossing[axis] + self.spacing[axis] };
        true
    }
}

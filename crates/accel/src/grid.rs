//! The uniform grid: space cut into equal cells, each with a list of what is in it.
//!
//! In the steps of the classic lecture: a box around everything; `n³ = d · |O|` cells, shared out by the box's proportions; each
//! object goes into the cells that its box overlaps, and stays where it overlaps the cell itself; a ray goes from cell to
//! cell along a 6-connected line by a 3D-DDA, and mailboxes keep it from testing an object again in the next cell. Cells with
//! many objects may hold a grid of their own: a teapot in a stadium fills one cell of the stadium's grid.
//!
//! # References
//! Mailboxes: [Arnaldi et al. 1987]; grids in grids: [Jevans and Wyvill 1989] "Adaptive Voxel Subdivision for Ray Tracing".

mod line;

use arrayvec::ArrayVec;
use aureole_math::{Bounds3, Point3, Ray};

use crate::bvh::{Leaf, TIE_SCALE, VisitLeaf};
use crate::simd::Simd;
use crate::things::Things;
use line::Line;

/// How a grid is laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridConfig {
    /// `d`: cells for each object.
    pub density: f32,
    /// Whether objects stay only in the cells that they overlap themselves, rather than their boxes.
    pub exact: bool,
    /// Cells with more objects than this hold a grid of their own.
    pub crowded: usize,
}

impl Default for GridConfig {
    fn default() -> Self {
        Self { density: 4.0, exact: true, crowded: 32 }
    }
}

impl GridConfig {
    /// The density, within reason.
    fn sound_density(&self) -> f64 {
        f64::from(self.density.clamp(1e-3, 1e3))
    }
}

/// Cells along an axis at most.
const MAX_SIDE: f64 = 1024.0;
/// Entries in the lists of all cells at most, for each object; never more than 32 bits can number.
const MAX_ENTRIES: usize = 256;
/// The same of a nested grid.
const MAX_NESTED_ENTRIES: usize = 64;
/// How far cells reach into their neighbours, as a share of the cell and of the grid: a ray's way through the cells and its
/// hits are rounded differently.
const OVERLAP: [f32; 2] = [1e-3, 1e-5];
/// Rays from farther away, in diagonals of the grid, would be rounded by more than that: they test everything.
const FAR: f64 = 32.0;
/// Exact tests for each entry: long, slanting objects are in few of the cells that their boxes overlap.
const TESTS: usize = 4;
/// Grids in grids.
const LEVELS: usize = 4;
/// Marks an entry of a list that is a nested grid.
const NESTED: u32 = 1 << 31;
/// Objects that a ray remembers to have tested.
const MAILBOXES: usize = 64;

/// A grid over objects that its owner numbers.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    bounds: Bounds3,
    /// Cells along each axis.
    sides: [usize; 3],
    /// How far cells reach out at least.
    slack: f32,
    /// Where the list of each cell begins in `objects`; x runs fastest.
    starts: Vec<u32>,
    /// Objects, or a grid with [`NESTED`], which is alone in its list.
    objects: Vec<u32>,
    nested: Vec<Grid>,
    count: usize,
}

/// What a grid is built over.
struct Builder<'a, T> {
    things: &'a T,
    config: &'a GridConfig,
    /// How far cells reach out at least.
    slack: f32,
    /// Entries that the lists may still have.
    left: usize,
}

impl<T: Things> Builder<'_, T> {
    /// The grid over some of the things in a box. `None` when the lists become too long.
    fn grid(
        &mut self,
        ids: &[u32],
        bounds: Bounds3,
        density: f64,
        limit: usize,
        levels: usize,
    ) -> Option<Grid> {
        let mut grid = Grid::empty(bounds, ids.len(), density, self.slack);
        let mut cells: Vec<u32> = vec![0; grid.sides.iter().product()];
        let (mut entries, mut tests) = (0, 0);
        for &id in ids {
            tests += self.cells(&grid, id, |cell| {
                cells[cell] += 1;
                entries += 1;
            });
            if (entries > limit || tests > TESTS * limit) && grid.sides != [1; 3] {
                return None;
            }
        }
        self.left = self.left.saturating_sub(entries);
        let ends = cells.iter().scan(0, |sum, n| {
            *sum += n;
            Some(*sum)
        });
        grid.starts = std::iter::once(0).chain(ends).collect();
        grid.objects = vec![0; entries];
        let mut next = grid.starts.clone();
        let mut objects = std::mem::take(&mut grid.objects);
        for &id in ids {
            self.cells(&grid, id, |cell| {
                objects[next[cell] as usize] = id;
                next[cell] += 1;
            });
        }
        grid.objects = objects;
        if levels > 1 {
            self.nest(&mut grid, levels - 1);
        }
        Some(grid)
    }

    /// Calls `visit` with the cells that hold a thing; how many its box overlaps.
    fn cells(&self, grid: &Grid, id: u32, mut visit: impl FnMut(usize)) -> usize {
        let mut overlapped = 0;
        grid.cells_of(&self.things.bounds(id), |cell, space| {
            overlapped += 1;
            if !self.config.exact || self.things.overlaps(id, space) {
                visit(cell);
            }
        });
        overlapped
    }

    /// Puts grids into crowded cells, where that shortens their lists.
    fn nest(&mut self, grid: &mut Grid, levels: usize) {
        let (starts, objects) = (std::mem::take(&mut grid.starts), std::mem::take(&mut grid.objects));
        grid.starts.push(0);
        for (cell, list) in starts.windows(2).enumerate() {
            let list = &objects[list[0] as usize..list[1] as usize];
            match self.nested(grid, cell, list, levels) {
                Some(inner) => {
                    grid.objects.push(NESTED | grid.nested.len() as u32);
                    grid.nested.push(inner);
                }
                None => grid.objects.extend_from_slice(list),
            }
            grid.starts.push(grid.objects.len() as u32);
        }
    }

    fn nested(&mut self, grid: &Grid, cell: usize, list: &[u32], levels: usize) -> Option<Grid> {
        // One that its objects fill is not worth a walk.
        let limit = (list.len() * (list.len() / 4).min(MAX_NESTED_ENTRIES)).min(self.left);
        if list.len() <= self.config.crowded || list.len() > limit {
            return None;
        }
        let space = grid.space(grid.cell(cell));
        let around = list.iter().fold(Bounds3::EMPTY, |all, &id| all.union(self.things.bounds(id)));
        let bounds = Bounds3 { min: space.min.max(around.min), max: space.max.min(around.max) };
        self.grid(list, bounds, self.config.sound_density(), limit, levels)
    }
}

impl Grid {
    /// Places `count` objects by their boxes, or more exactly.
    pub(crate) fn build(count: usize, things: &impl Things, config: &GridConfig) -> Self {
        let ids: Vec<u32> = (0..count as u32).collect();
        let all = ids.iter().fold(Bounds3::EMPTY, |all, &i| all.union(things.bounds(i)));
        let slack = (all.max - all.min).length() * OVERLAP[1];
        let most = MAX_ENTRIES.saturating_mul(count).min((NESTED - 1) as usize);
        let mut density = config.sound_density();
        loop {
            let mut builder = Builder { things, config, slack, left: most };
            match builder.grid(&ids, all, density, most, LEVELS) {
                Some(grid) => return grid,
                None => density /= 8.0, // large objects, each in a great many cells
            }
        }
    }

    fn empty(bounds: Bounds3, count: usize, density: f64, slack: f32) -> Self {
        // In double precision no extent is infinite.
        let extent = |axis: usize| f64::from(bounds.max[axis]) - f64::from(bounds.min[axis]);
        let size = if bounds.is_empty() { [0.0; 3] } else { [0, 1, 2].map(extent) };
        let longest = size.into_iter().fold(f64::from(f32::MIN_POSITIVE), f64::max);
        // A flat scene has cells as if it were a little thick.
        let size = size.map(|s| s.max(longest * 1e-3));
        let edge = (size[0] * size[1] * size[2] / (density * count.max(1) as f64)).cbrt();
        let sides = size.map(|s| (s / edge).round().clamp(1.0, MAX_SIDE) as usize);
        Self { bounds, sides, slack, starts: Vec::new(), objects: Vec::new(), nested: Vec::new(), count }
    }

    /// The space of a cell, and a little more.
    fn space(&self, cell: [usize; 3]) -> Bounds3 {
        let size = self.bounds.max - self.bounds.min;
        let corner = |up: usize| {
            let at = |axis: usize| {
                let share = (cell[axis] + up) as f32 / self.sides[axis] as f32;
                let slack = size[axis] / self.sides[axis] as f32 * OVERLAP[0] + self.slack;
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
            let slack = size[axis] / self.sides[axis] as f32 * OVERLAP[0] + self.slack;
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

    /// The cell of a number.
    fn cell(&self, number: usize) -> [usize; 3] {
        let [x, y, _] = self.sides;
        [number % x, number / x % y, number / (x * y)]
    }

    /// Whether a ray comes from so far away that it would be rounded by more than cells overlap.
    fn is_far(&self, ray: &Ray) -> bool {
        let size = (self.bounds.max - self.bounds.min).length();
        let farthest = (ray.origin - self.bounds.min).abs().max(ray.origin - self.bounds.max).abs();
        !size.is_finite() || f64::from(farthest.max_element()) > FAR * f64::from(size)
    }

    /// Visits the objects in the cells along a ray.
    #[inline(always)]
    pub(crate) fn walk<S: Simd, V: VisitLeaf>(&self, ray: &Ray, mut t_max: f32, visitor: &mut V) {
        let Some(line) = Line::new(self, ray) else { return };
        if self.is_far(ray) {
            visitor.visit::<S>(0, self.count);
            return;
        }
        let mut mailboxes = [u32::MAX; MAILBOXES];
        // The grids that the ray is in, from the outermost on.
        let mut lines = ArrayVec::<(&Self, Line), LEVELS>::new();
        lines.push((self, line));
        while let Some((grid, line)) = lines.last_mut() {
            let mut inner = None;
            for &object in grid.list(grid.number(line.cell)) {
                if object & NESTED != 0 {
                    let nested = &grid.nested[(object & !NESTED) as usize];
                    inner = Line::new(nested, ray).map(|line| (nested, line));
                    break;
                }
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
                lines.pop();
            }
            lines.extend(inner);
        }
    }

    fn list(&self, cell: usize) -> &[u32] {
        &self.objects[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// Calls `visit` with what is in all lists.
    pub(crate) fn for_each_object(&self, visit: &mut dyn FnMut(u32)) {
        self.objects.iter().filter(|object| **object & NESTED == 0).for_each(|object| visit(*object));
        self.nested.iter().for_each(|grid| grid.for_each_object(visit));
    }

    /// Bytes of the lists.
    pub(crate) fn bytes(&self) -> usize {
        let own =
            size_of_val(&self.starts[..]) + size_of_val(&self.objects[..]) + size_of_val(&self.nested[..]);
        own + self.nested.iter().map(Self::bytes).sum::<usize>()
    }

    /// Cells, and entries in all their lists.
    pub(crate) fn cells_and_entries(&self) -> (usize, usize) {
        let own = (self.sides.iter().product::<usize>(), self.objects.len());
        self.nested.iter().map(Self::cells_and_entries).fold(own, |a, b| (a.0 + b.0, a.1 + b.1))
    }

    /// The box around everything.
    pub(crate) fn bounds(&self) -> Bounds3 {
        self.bounds
    }
}

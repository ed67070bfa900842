//! A ray's way through the cells of a grid.
//!
//! # References
//! [Amanatides and Woo 1987] "A Fast Voxel Traversal Algorithm for Ray Tracing".

use aureole_math::Ray;

use super::Grid;

/// A ray's way from cell to cell, in double precision.
pub(super) struct Line {
    pub cell: [usize; 3],
    /// How many steps remain on each axis before the ray leaves the grid.
    remaining: [usize; 3],
    forwards: [bool; 3],
    /// Where the ray crosses into the next cell on each axis, and how far apart the crossings are.
    crossing: [f64; 3],
    spacing: [f64; 3],
}

impl Line {
    /// `None` when the ray misses the grid.
    #[inline(always)]
    pub(super) fn new(grid: &Grid, ray: &Ray) -> Option<Self> {
        let wide = |v: [f32; 3]| v.map(f64::from);
        let (o, d) = (wide(ray.origin.to_array()), wide(ray.direction.to_array()));
        let (low, high) = (wide(grid.bounds.min.to_array()), wide(grid.bounds.max.to_array()));
        let slack = f64::from(grid.slack);
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
    pub(super) fn advance(&mut self, t_max: f64) -> bool {
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

//! Tables over the unit square that depend on the incident direction, and warps of the square by them.

/// Which tables are interpolated, and how much of each: four for two parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slices {
    index: [usize; 4],
    weight: [f32; 4],
}

impl Slices {
    /// The only table of those that depend on nothing.
    pub(super) const SINGLE: Self = Self { index: [0; 4], weight: [1.0, 0.0, 0.0, 0.0] };

    /// The tables around two parameters, of which `b` varies fastest.
    pub(super) fn around(a_nodes: &[f32], a: f32, b_nodes: &[f32], b: f32) -> Self {
        let place = |nodes: &[f32], x: f32| {
            if nodes.len() < 2 {
                return (0, 0, 0.0);
            }
            let i = nodes.partition_point(|&node| node <= x).clamp(1, nodes.len() - 1) - 1;
            let width = nodes[i + 1] - nodes[i];
            let t = if width > 0.0 { ((x - nodes[i]) / width).clamp(0.0, 1.0) } else { 0.0 };
            (i, i + 1, t)
        };
        let ((a0, a1, s), (b0, b1, t)) = (place(a_nodes, a), place(b_nodes, b));
        let at = |a: usize, b: usize| a * b_nodes.len() + b;
        Self {
            index: [at(a0, b0), at(a0, b1), at(a1, b0), at(a1, b1)],
            weight: [(1.0 - s) * (1.0 - t), (1.0 - s) * t, s * (1.0 - t), s * t],
        }
    }

    /// An entry of tables of `size` entries each.
    #[inline]
    fn get(&self, values: &[f32], size: usize, entry: usize) -> f32 {
        let term = |i: usize| {
            let weight = self.weight[i];
            if weight == 0.0 { 0.0 } else { weight * values[self.index[i] * size + entry] }
        };
        term(0) + term(1) + term(2) + term(3)
    }
}

/// Tables of `height` rows of `width` values, bilinear in between.
#[derive(Clone, Debug)]
pub(super) struct Table {
    width: usize,
    height: usize,
    values: Box<[f32]>,
}

impl Table {
    /// Tables of values row by row; none if there are too few of them for whole tables of at least two by two.
    pub(super) fn new([height, width]: [usize; 2], slices: usize, values: &[f32]) -> Option<Self> {
        let count = width.checked_mul(height)?.checked_mul(slices)?;
        (width >= 2 && height >= 2 && values.len() == count && slices > 0).then(|| Self {
            width,
            height,
            values: values.into(),
        })
    }

    /// The cell of a point: its first entry, and the place in it.
    #[inline]
    fn cell(&self, [x, y]: [f32; 2]) -> ([usize; 2], [f32; 2]) {
        let along = |x: f32, n: usize| {
            let x = x.clamp(0.0, 1.0) * (n - 1) as f32;
            let i = (x as usize).min(n - 2);
            (i, x - i as f32)
        };
        let ((i, s), (j, t)) = (along(x, self.width), along(y, self.height));
        ([i, j], [s, t])
    }

    /// The four corners of a cell: at x and y, then both at x + 1.
    #[inline]
    fn corners(&self, slices: &Slices, [i, j]: [usize; 2]) -> [[f32; 2]; 2] {
        let size = self.width * self.height;
        let at = |i: usize, j: usize| slices.get(&self.values, size, j * self.width + i);
        [[at(i, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1)]]
    }

    /// The value at a point.
    pub(super) fn eval(&self, slices: &Slices, p: [f32; 2]) -> f32 {
        let (cell, [s, t]) = self.cell(p);
        let [[v00, v01], [v10, v11]] = self.corners(slices, cell);
        lerp(lerp(v00, v01, t), lerp(v10, v11, t), s)
    }
}

#[inline]
fn lerp(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// Where the integral of a line from `a` to `b` over [0, 1] reaches `target`.
#[inline]
fn invert_line(a: f32, b: f32, target: f32) -> f32 {
    let root = (a * a + 2.0 * target * (b - a)).max(0.0).sqrt();
    // The form that does not lose digits where the line is level.
    let sum = a + root;
    if sum > 0.0 { (2.0 * target / sum).clamp(0.0, 1.0) } else { 0.5 }
}

/// The integral of that line up to `t`.
#[inline]
fn integrate_line(a: f32, b: f32, t: f32) -> f32 {
    t * (a + 0.5 * t * (b - a))
}

/// The largest `i` below `n - 1` with `f(i) <= x`, where `f` ascends.
fn last_at_most(n: usize, x: f32, f: impl Fn(usize) -> f32) -> usize {
    let (mut low, mut high) = (0, n - 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if f(middle) <= x { low = middle } else { high = middle }
    }
    low
}

/// A warp of the square by tables: rows by their marginal distribution, then columns by their conditional one.
///
/// # References
/// [Dupuy and Jakob 2018] "An Adaptive Parameterization for Efficient Material Acquisition and Rendering": the layout;
/// bilinear densities are inverted exactly.
#[derive(Clone, Debug)]
pub(super) struct Warp {
    density: Table,
    /// Integrals over rows up to each row.
    marginal: Box<[f32]>,
    /// Integrals along each row up to each column.
    conditional: Box<[f32]>,
}

impl Warp {
    /// Normalises tables into densities.
    pub(super) fn new(size: [usize; 2], slices: usize, values: &[f32]) -> Option<Self> {
        let mut density = Table::new(size, slices, values)?;
        let (width, height) = (density.width, density.height);
        let mut marginal = Vec::with_capacity(slices * height);
        let mut conditional = Vec::with_capacity(values.len());
        for table in density.values.chunks_exact_mut(width * height) {
            let (first, first_row) = (conditional.len(), marginal.len());
            for row in table.chunks_exact(width) {
                conditional.push(0.0);
                let mut sum = 0.0_f64;
                for pair in row.windows(2) {
                    sum += 0.5 * (f64::from(pair[0]) + f64::from(pair[1]));
                    conditional.push(sum as f32);
                }
            }
            let total_of = |row: usize| f64::from(conditional[first + (row + 1) * width - 1]);
            let mut sum = 0.0;
            marginal.push(0.0);
            for row in 1..height {
                sum += 0.5 * (total_of(row - 1) + total_of(row));
                marginal.push(sum as f32);
            }
            if !(sum > 0.0 && sum.is_finite()) {
                return None;
            }
            let scale = (1.0 / sum) as f32;
            conditional[first..].iter_mut().for_each(|x| *x *= scale);
            marginal[first_row..].iter_mut().for_each(|x| *x *= scale);
            // Per unit of the square, which has (width - 1) (height - 1) cells.
            let per_area = scale * ((width - 1) * (height - 1)) as f32;
            table.iter_mut().for_each(|x| *x *= per_area);
        }
        Some(Self { density, marginal: marginal.into(), conditional: conditional.into() })
    }

    /// The density at a point.
    pub(super) fn pdf(&self, slices: &Slices, p: [f32; 2]) -> f32 {
        self.density.eval(slices, p)
    }

    #[inline]
    fn marginal(&self, slices: &Slices, row: usize) -> f32 {
        slices.get(&self.marginal, self.density.height, row)
    }

    #[inline]
    fn conditional(&self, slices: &Slices, row: usize, column: usize) -> f32 {
        let (width, height) = (self.density.width, self.density.height);
        slices.get(&self.conditional, width * height, row * width + column)
    }

    /// Warps a point of the square in proportion to the density.
    pub(super) fn sample(&self, slices: &Slices, u: [f32; 2]) -> [f32; 2] {
        let (width, height) = (self.density.width, self.density.height);
        let [x, y] = u.map(|u| u.clamp(1e-7, 1.0 - 1e-7));
        let row = last_at_most(height, y, |row| self.marginal(slices, row));
        let totals = [row, row + 1].map(|row| self.conditional(slices, row, width - 1));
        let t = invert_line(totals[0], totals[1], y - self.marginal(slices, row));
        let x = x * lerp(totals[0], totals[1], t);
        let along = |i| lerp(self.conditional(slices, row, i), self.conditional(slices, row + 1, i), t);
        let column = last_at_most(width, x, along);
        let [[v00, v01], [v10, v11]] = self.density.corners(slices, [column, row]);
        let per_cell = 1.0 / ((width - 1) * (height - 1)) as f32;
        let (c0, c1) = (lerp(v00, v01, t) * per_cell, lerp(v10, v11, t) * per_cell);
        let s = invert_line(c0, c1, x - along(column));
        [(column as f32 + s) / (width - 1) as f32, (row as f32 + t) / (height - 1) as f32]
    }

    /// The point that is warped to `p`.
    pub(super) fn invert(&self, slices: &Slices, p: [f32; 2]) -> [f32; 2] {
        let (width, height) = (self.density.width, self.density.height);
        let ([column, row], [s, t]) = self.density.cell(p);
        let [[v00, v01], [v10, v11]] = self.density.corners(slices, [column, row]);
        let per_cell = 1.0 / ((width - 1) * (height - 1)) as f32;
        let (c0, c1) = (lerp(v00, v01, t) * per_cell, lerp(v10, v11, t) * per_cell);
        let along = |i| lerp(self.conditional(slices, row, i), self.conditional(slices, row + 1, i), t);
        let x = (along(column) + integrate_line(c0, c1, s)) / along(width - 1).max(f32::MIN_POSITIVE);
        let totals = [row, row + 1].map(|row| self.conditional(slices, row, width - 1));
        let y = self.marginal(slices, row) + integrate_line(totals[0], totals[1], t);
        [x, y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Pcg32;

    fn example() -> (Warp, Slices) {
        let mut rng = Pcg32::new(3);
        let values: Vec<f32> = (0..2 * 3 * 4 * 5).map(|_| 0.05 + rng.next_f32()).collect();
        let warp = Warp::new([4, 5], 6, &values).unwrap();
        (warp, Slices::around(&[0.0, 1.0], 0.3, &[0.0, 0.5, 1.0], 0.7))
    }

    #[test]
    fn inversion_undoes_sampling() {
        let (warp, slices) = example();
        let mut rng = Pcg32::new(4);
        for _ in 0..1000 {
            let u = [rng.next_f32(), rng.next_f32()];
            let back = warp.invert(&slices, warp.sample(&slices, u));
            assert!((u[0] - back[0]).abs() < 1e-4 && (u[1] - back[1]).abs() < 1e-4, "{u:?} {back:?}");
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        let (warp, slices) = example();
        let n = 200;
        let middle = |i: usize| (i as f32 + 0.5) / n as f32;
        let sum: f32 = (0..n * n).map(|i| warp.pdf(&slices, [middle(i % n), middle(i / n)])).sum();
        assert!((sum / (n * n) as f32 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn broken_tables_are_refused() {
        assert!(Warp::new([2, 2], 1, &[0.0; 4]).is_none());
        assert!(Warp::new([2, 2], 1, &[1.0; 3]).is_none());
        assert!(Warp::new([1, 4], 1, &[1.0; 4]).is_none());
        assert!(Table::new([usize::MAX, 2], 3, &[1.0; 4]).is_none());
    }
}

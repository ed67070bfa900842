//! Piecewise-constant densities on the unit interval and the unit square.

use super::Discrete;
use crate::Point2;

/// A density on [0, 1] that is constant on each of n equal pieces.
#[derive(Clone, Debug)]
pub struct PiecewiseConstant1D {
    pieces: Discrete,
}

/// A draw from [`PiecewiseConstant1D`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecewiseSample1D {
    /// The value in [0, 1).
    pub x: f32,
    /// Its density.
    pub pdf: f32,
    /// The piece that it lies in.
    pub piece: usize,
}

impl PiecewiseConstant1D {
    /// A density in proportion to values; `None` as for [`Discrete::new`].
    pub fn new(values: impl IntoIterator<Item = f32>) -> Option<Self> {
        Some(Self { pieces: Discrete::new(values)? })
    }

    /// The density at `x`; zero outside [0, 1].
    pub fn pdf(&self, x: f32) -> f32 {
        if !(0.0..=1.0).contains(&x) {
            return 0.0;
        }
        let n = self.pieces.len();
        self.pieces.pmf(((x * n as f32) as usize).min(n - 1)) * n as f32
    }

    /// The point at `u` in [0, 1).
    pub fn sample(&self, u: f32) -> PiecewiseSample1D {
        let n = self.pieces.len() as f32;
        let s = self.pieces.sample(u);
        PiecewiseSample1D {
            x: ((s.index as f32 + s.u) / n).min(1.0 - f32::EPSILON / 2.0),
            pdf: s.pmf * n,
            piece: s.index,
        }
    }
}

/// A density on the unit square that is constant on each cell of a grid.
#[derive(Clone, Debug)]
pub struct PiecewiseConstant2D {
    rows: PiecewiseConstant1D,
    /// One conditional per row; a row without weight has none and is never drawn.
    columns: Vec<Option<PiecewiseConstant1D>>,
}

/// A draw from [`PiecewiseConstant2D`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecewiseSample2D {
    /// The point.
    pub p: Point2,
    /// Its density per unit area of the square.
    pub pdf: f32,
}

impl PiecewiseConstant2D {
    /// A density in proportion to row-major values; `None` when they are not usable.
    pub fn new(values: &[f32], width: usize) -> Option<Self> {
        if width == 0 || values.is_empty() || !values.len().is_multiple_of(width) {
            return None;
        }
        let columns: Vec<_> =
            values.chunks_exact(width).map(|row| PiecewiseConstant1D::new(row.iter().copied())).collect();
        let rows = PiecewiseConstant1D::new(values.chunks_exact(width).map(|row| row.iter().sum()))?;
        Some(Self { rows, columns })
    }

    /// The density at a point.
    pub fn pdf(&self, p: Point2) -> f32 {
        let n = self.columns.len();
        let row = ((p.y.max(0.0) * n as f32) as usize).min(n - 1);
        self.rows.pdf(p.y) * self.columns[row].as_ref().map_or(0.0, |c| c.pdf(p.x))
    }

    /// The point at `u`.
    pub fn sample(&self, u: Point2) -> Option<PiecewiseSample2D> {
        let y = self.rows.sample(u.y);
        let x = self.columns[y.piece].as_ref()?.sample(u.x);
        Some(PiecewiseSample2D { p: Point2::new(x.x, y.x), pdf: x.pdf * y.pdf })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pcg32;

    #[test]
    fn density_and_draws_agree() {
        let values = [1.0, 2.0, 0.0, 4.0, 5.0, 6.0, 0.0, 0.0, 0.0];
        let d = PiecewiseConstant2D::new(&values, 3).unwrap();
        let mut rng = Pcg32::new(2);
        let (mut counts, n) = ([0.0_f32; 9], 90_000);
        for _ in 0..n {
            let s = d.sample(rng.point2()).unwrap();
            assert!((s.pdf - d.pdf(s.p)).abs() < 1e-3 * s.pdf);
            counts[(s.p.y * 3.0) as usize * 3 + (s.p.x * 3.0) as usize] += 1.0;
        }
        let sum: f32 = values.iter().sum();
        for (count, value) in counts.iter().zip(values) {
            let expected = value / sum * n as f32;
            // Five standard deviations of a binomial.
            assert!((count - expected).abs() <= 5.0 * expected.sqrt(), "{counts:?}");
        }
    }
}

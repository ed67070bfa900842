//! Importance sampling of any filter by a table, as [PBRT4] section 8.8.

use aureole_math::{PiecewiseConstant2D, Point2, Vector2};

use super::FilterSample;

/// Cells of the table along each axis, per filter.
const CELLS: usize = 64;

/// A table of a filter's absolute values, for drawing offsets in proportion to them.
#[derive(Clone, Debug)]
pub(super) struct FilterTable {
    radius: Vector2,
    distribution: Option<PiecewiseConstant2D>,
    /// Integral of the absolute value over that of the value: what makes the mean weight one.
    scale: f32,
    /// Value over absolute value: +1 or -1 for each cell.
    signs: Vec<f32>,
}

impl FilterTable {
    pub(super) fn new(radius: Vector2, eval: impl Fn(Vector2) -> f32) -> Self {
        let at = |i: usize, r: f32| (2.0 * (i as f32 + 0.5) / CELLS as f32 - 1.0) * r;
        let values: Vec<f32> = (0..CELLS * CELLS)
            .map(|i| eval(Vector2::new(at(i % CELLS, radius.x), at(i / CELLS, radius.y))))
            .collect();
        let absolute: Vec<f32> = values.iter().map(|v| v.abs()).collect();
        let scale = absolute.iter().sum::<f32>() / values.iter().sum::<f32>();
        let signs = values.iter().map(|v| 1.0_f32.copysign(*v)).collect();
        Self { radius, distribution: PiecewiseConstant2D::new(&absolute, CELLS), scale, signs }
    }

    /// Draws an offset. Within a cell the filter is taken as constant.
    pub(super) fn sample(&self, u: Point2) -> FilterSample {
        let Some(drawn) = self.distribution.as_ref().and_then(|d| d.sample(u)) else {
            return FilterSample { offset: Vector2::ZERO, weight: 1.0 };
        };
        let cell = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
        let offset =
            Vector2::new((2.0 * drawn.p.x - 1.0) * self.radius.x, (2.0 * drawn.p.y - 1.0) * self.radius.y);
        FilterSample { offset, weight: self.scale * self.signs[cell(drawn.p.y) * CELLS + cell(drawn.p.x)] }
    }
}

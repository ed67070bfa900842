//! A piecewise-constant density on the unit square, drawn from within any rectangle.
//!
//! References: [Bitterli et al. 2015] "Portal-Masked Environment Map Sampling", section 4.

use aureole_math::Point2;

/// A rectangle of the unit square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    pub low: Point2,
    pub high: Point2,
}

impl Window {
    pub(super) fn contains(&self, p: Point2) -> bool {
        (self.low.x..=self.high.x).contains(&p.x) && (self.low.y..=self.high.y).contains(&p.y)
    }
}

/// Values on a grid, and their sums over all rectangles from the origin.
#[derive(Clone, Debug)]
pub(super) struct Windowed {
    values: Vec<f32>,
    /// (width + 1) × (height + 1) sums; the first row and column are zero.
    sums: Vec<f64>,
    size: [usize; 2],
}

impl Windowed {
    /// From row-major values; none of them negative.
    pub(super) fn new(values: Vec<f32>, width: usize) -> Self {
        let height = values.len() / width;
        let mut sums = vec![0.0; (width + 1) * (height + 1)];
        for y in 0..height {
            let mut row = 0.0;
            for x in 0..width {
                row += f64::from(values[y * width + x]);
                sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + row;
            }
        }
        Self { values, sums, size: [width, height] }
    }

    /// The integral over the rectangle from the origin to a point, in units of cells.
    fn sum_to(&self, x: f64, y: f64) -> f64 {
        let [w, h] = self.size;
        let clip = |v: f64, n: usize| (v * n as f64).clamp(0.0, n as f64);
        let (x, y) = (clip(x, w), clip(y, h));
        let (x0, y0) = ((x as usize).min(w - 1), (y as usize).min(h - 1));
        let (fx, fy) = (x - x0 as f64, y - y0 as f64);
        let at = |i: usize, j: usize| self.sums[(y0 + j) * (w + 1) + x0 + i];
        let row = |j: usize| at(0, j) + (at(1, j) - at(0, j)) * fx;
        row(0) + (row(1) - row(0)) * fy
    }

    fn integral(&self, x: [f64; 2], y: [f64; 2]) -> f64 {
        let corners = self.sum_to(x[1], y[1]) - self.sum_to(x[0], y[1]) - self.sum_to(x[1], y[0])
            + self.sum_to(x[0], y[0]);
        corners.max(0.0)
    }

    fn value(&self, p: Point2) -> f32 {
        let [w, h] = self.size;
        let index = |v: f32, n: usize| ((v * n as f32) as usize).min(n - 1);
        self.values[index(p.y, h) * w + index(p.x, w)]
    }

    /// Density per unit area at a point of the window.
    pub(super) fn pdf(&self, window: &Window, p: Point2) -> f32 {
        let [x, y] = sides(window);
        let cells = (self.size[0] * self.size[1]) as f64;
        let total = self.integral(x, y) / cells;
        if total > 0.0 { (f64::from(self.value(p)) / total) as f32 } else { 0.0 }
    }

    /// A point of the window; `None` where everything is zero.
    pub(super) fn sample(&self, window: &Window, u: Point2) -> Option<Point2> {
        let [x, y] = sides(window);
        let total = self.integral(x, y);
        if total <= 0.0 {
            return None;
        }
        let px = bisect(x, self.size[0], f64::from(u.x), |v| self.integral([x[0], v], y) / total);
        // Within one column of cells the density depends on y alone.
        let w = self.size[0] as f64;
        let left = (px * w).floor().min(w - 1.0) / w;
        let column = [left, left + 1.0 / w];
        let total = self.integral(column, y);
        if total <= 0.0 {
            return None;
        }
        let py = bisect(y, self.size[1], f64::from(u.y), |v| self.integral(column, [y[0], v]) / total);
        Some(Point2::new(px as f32, py as f32))
    }
}

fn sides(window: &Window) -> [[f64; 2]; 2] {
    [[window.low.x, window.high.x], [window.low.y, window.high.y]].map(|side| side.map(f64::from))
}

/// Where a function that grows from 0 to 1 over `range`, linear within each of `n` cells of the unit interval, is `u`.
fn bisect(range: [f64; 2], n: usize, u: f64, cdf: impl Fn(f64) -> f64) -> f64 {
    let n = n as f64;
    let [mut low, mut high] = range;
    // Until both ends are in one cell.
    while (high * n).ceil() - (low * n).floor() > 1.0 {
        let middle = (((low * n).floor() + (high * n).ceil()) * 0.5).floor() / n;
        let middle = if middle <= low { ((low * n).floor() + 1.0) / n } else { middle };
        if middle >= high {
            break;
        }
        if cdf(middle) <= u { low = middle } else { high = middle }
    }
    let (a, b) = (cdf(low), cdf(high));
    let t = if b > a { ((u - a) / (b - a)).clamp(0.0, 1.0) } else { 0.5 };
    low + (high - low) * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Pcg32;

    /// False alarm: five standard deviations in each of 16 cells, once in 100,000 seeds.
    #[test]
    fn draws_follow_the_density_within_the_window() {
        let values = vec![1.0, 2.0, 0.0, 4.0, 5.0, 6.0, 7.0, 0.5, 9.0];
        let windowed = Windowed::new(values, 3);
        let window = Window { low: Point2::new(0.2, 0.1), high: Point2::new(0.9, 0.8) };
        let mut rng = Pcg32::new(5);
        let (n, mut counts, mut expected) = (40_000, [0.0_f64; 16], [0.0_f64; 16]);
        let cell = |p: Point2| {
            let index = |v: f32, low: f32, high: f32| ((4.0 * (v - low) / (high - low)) as usize).min(3);
            index(p.y, 0.1, 0.8) * 4 + index(p.x, 0.2, 0.9)
        };
        for _ in 0..n {
            let p = windowed.sample(&window, rng.point2()).expect("there is something in the window");
            assert!(window.contains(p), "{p:?}");
            counts[cell(p)] += 1.0;
            let u = rng.point2();
            let p = Point2::new(0.2 + 0.7 * u.x, 0.1 + 0.7 * u.y);
            expected[cell(p)] += f64::from(windowed.pdf(&window, p)) * 0.49;
        }
        assert!((expected.iter().sum::<f64>() / f64::from(n) - 1.0).abs() < 0.02);
        for (count, expected) in counts.iter().zip(expected) {
            assert!((count - expected).abs() <= 5.0 * (2.5 * expected).sqrt() + 5.0, "{count} {expected}");
        }
    }
}

//! Adaptive integration over rectangles and the sphere.

use std::f64::consts::{PI, TAU};

use aureole_math::Vector3;

/// A rectangle `[x0, x1] × [y0, y1]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left.
    pub x0: f64,
    /// Right.
    pub x1: f64,
    /// Bottom.
    pub y0: f64,
    /// Top.
    pub y1: f64,
}

impl Rect {
    /// The unit square.
    pub const UNIT: Self = Self { x0: 0.0, x1: 1.0, y0: 0.0, y1: 1.0 };
    /// All of the sphere in azimuth (x) and polar angle (y).
    pub const SPHERE: Self = Self { x0: 0.0, x1: TAU, y0: 0.0, y1: PI };

    /// The cell at `(column, row)` of this rectangle divided into `columns × rows`.
    pub fn cell(&self, columns: usize, rows: usize, column: usize, row: usize) -> Self {
        let x = |i: usize| self.x0 + (self.x1 - self.x0) * i as f64 / columns as f64;
        let y = |i: usize| self.y0 + (self.y1 - self.y0) * i as f64 / rows as f64;
        Self { x0: x(column), x1: x(column + 1), y0: y(row), y1: y(row + 1) }
    }

    fn quadrants(&self) -> [Self; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.cell(2, 2, i, j))
    }
}

/// Halvings that always happen, so that a peak narrower than the rectangle is not overlooked.
const MIN_DEPTH: u32 = 2;
/// Halvings after which an integrand counts as discontinuous and its remaining error as small.
const MAX_DEPTH: u32 = 7;

/// The integral of `f(x, y)` over a rectangle, to about `tolerance` (absolute).
///
/// # Maths
/// Tensor products of the three-point Gauss-Legendre rule; a rectangle is quartered until it agrees with its quarters.
pub fn integrate(rect: Rect, tolerance: f64, f: &mut impl FnMut(f64, f64) -> f64) -> f64 {
    let depths = Depths { min: MIN_DEPTH, max: MAX_DEPTH };
    refine(rect, gauss3(&rect, f), tolerance, depths, f)
}

/// The same, looking everywhere for something small.
pub(crate) fn integrate_closely(rect: Rect, tolerance: f64, f: &mut impl FnMut(f64, f64) -> f64) -> f64 {
    let depths = Depths { min: MAX_DEPTH, max: MAX_DEPTH };
    refine(rect, gauss3(&rect, f), tolerance, depths, f)
}

/// How many more halvings there must be, and may be.
#[derive(Clone, Copy)]
struct Depths {
    min: u32,
    max: u32,
}

fn refine(
    rect: Rect,
    whole: f64,
    tolerance: f64,
    depths: Depths,
    f: &mut impl FnMut(f64, f64) -> f64,
) -> f64 {
    let quadrants = rect.quadrants();
    let parts = quadrants.map(|quadrant| gauss3(&quadrant, f));
    let sum: f64 = parts.iter().sum();
    let agreed = (sum - whole).abs() <= tolerance || !sum.is_finite();
    if depths.max == 0 || (depths.min == 0 && agreed) {
        return sum;
    }
    let deeper = Depths { min: depths.min.saturating_sub(1), max: depths.max - 1 };
    quadrants
        .iter()
        .zip(parts)
        .map(|(&quadrant, part)| refine(quadrant, part, 0.25 * tolerance, deeper, f))
        .sum()
}

/// The three-point Gauss-Legendre rule in both directions; exact for polynomials up to degree five.
fn gauss3(rect: &Rect, f: &mut impl FnMut(f64, f64) -> f64) -> f64 {
    // Nodes 0 and ±√(3/5), weights 8/9 and 5/9 on [-1, 1].
    const NODES: [(f64, f64); 3] =
        [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
    let (half_x, half_y) = (0.5 * (rect.x1 - rect.x0), 0.5 * (rect.y1 - rect.y0));
    let (mid_x, mid_y) = (0.5 * (rect.x1 + rect.x0), 0.5 * (rect.y1 + rect.y0));
    let mut sum = 0.0;
    for (x, weight_x) in NODES {
        for (y, weight_y) in NODES {
            sum += weight_x * weight_y * f(mid_x + half_x * x, mid_y + half_y * y);
        }
    }
    sum * half_x * half_y
}

/// The unit vector at an azimuth and a polar angle, computed in double precision.
pub(crate) fn direction(phi: f64, theta: f64) -> Vector3 {
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_phi, cos_phi) = phi.sin_cos();
    Vector3::new((sin_theta * cos_phi) as f32, (sin_theta * sin_phi) as f32, cos_theta as f32)
}

/// The integral of `f` over the sphere, per steradian, to about `tolerance` (absolute).
///
/// The equator is a border between cells, so a function that jumps there is integrated well.
pub fn integrate_sphere(tolerance: f64, mut f: impl FnMut(Vector3) -> f64) -> f64 {
    const COLUMNS: usize = 16;
    const ROWS: usize = 8;
    let mut sum = 0.0;
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let cell = Rect::SPHERE.cell(COLUMNS, ROWS, column, row);
            let share = tolerance / (COLUMNS * ROWS) as f64;
            sum += integrate(cell, share, &mut |phi, theta| f(direction(phi, theta)) * theta.sin());
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_peaked_and_broken_integrands() {
        let smooth = integrate(Rect::UNIT, 1e-10, &mut |x, y| (x * y).exp());
        assert!((smooth - 1.317_902_151_454_404).abs() < 1e-9);
        // A Gaussian of width 0.02 in the middle.
        let peaked = integrate(Rect::UNIT, 1e-10, &mut |x, y| {
            (-((x - 0.5).powi(2) + (y - 0.5).powi(2)) / (2.0 * 4e-4)).exp()
        });
        assert!((peaked - TAU * 4e-4).abs() < 1e-8);
        let broken = integrate(Rect::UNIT, 1e-7, &mut |x, y| if x + y < 0.7 { 1.0 } else { 0.0 });
        assert!((broken - 0.245).abs() < 1e-3, "{broken}");
    }

    #[test]
    fn the_sphere_has_its_area() {
        assert!((integrate_sphere(1e-8, |_| 1.0) - 4.0 * PI).abs() < 1e-7);
        assert!((integrate_sphere(1e-8, |w| f64::from(w.z.max(0.0))) - PI).abs() < 1e-6);
    }
}

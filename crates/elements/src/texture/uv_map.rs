//! The affine map that textures apply to surface parameters.

use aureole_math::{Point2, Transform, Vector2};

/// An affine map of the plane: the upper left part of a transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvMap {
    u: [f32; 3],
    v: [f32; 3],
}

impl UvMap {
    /// The part of a transform that acts on x and y.
    pub fn new(transform: &Transform) -> Self {
        let rows = transform.rows();
        let row = |i: usize| [rows[i][0] as f32, rows[i][1] as f32, rows[i][3] as f32];
        Self { u: row(0), v: row(1) }
    }

    /// The mapped point.
    #[inline]
    pub fn apply(&self, p: Point2) -> Point2 {
        Point2::new(
            self.u[0] * p.x + self.u[1] * p.y + self.u[2],
            self.v[0] * p.x + self.v[1] * p.y + self.v[2],
        )
    }

    /// The mapped difference of two points.
    pub fn linear(&self, d: Vector2) -> Vector2 {
        Vector2::new(self.u[0] * d.x + self.u[1] * d.y, self.v[0] * d.x + self.v[1] * d.y)
    }

    /// A gradient in mapped coordinates as one in the surface's.
    pub fn pull_back(&self, g: Vector2) -> Vector2 {
        Vector2::new(g.x * self.u[0] + g.y * self.v[0], g.x * self.u[1] + g.y * self.v[1])
    }
}

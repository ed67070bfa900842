//! The least arithmetic: a ray may slip through along an edge.
//!
//! # References
//! [Möller and Trumbore 1997] "Fast, Minimum Storage Ray/Triangle Intersection".

use aureole_math::Ray;

use super::{Block, BlockHits, LANES, TriangleTest};
use crate::simd::{Floats, Mask, Simd, load3, splat3};

/// A ray as it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fast {
    origin: [f32; 3],
    direction: [f32; 3],
    t_min: f32,
}

impl TriangleTest for Fast {
    /// The first vertex and the edges from it to the others.
    fn prepare([a, b, c]: [[f32; 3]; 3]) -> [[f32; 3]; 3] {
        let from_a = |p: [f32; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        [a, from_a(b), from_a(c)]
    }

    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self { origin: ray.origin.to_array(), direction: ray.direction.to_array(), t_min: ray.t_min }
    }

    #[inline(always)]
    fn intersect<S: Simd>(&self, block: &Block, t_max: f32) -> BlockHits {
        let [a, e1, e2]: [[S::F8; 3]; 3] =
            [load3(&block.corners[0]), load3(&block.corners[1]), load3(&block.corners[2])];
        let (o, d): ([S::F8; 3], [S::F8; 3]) = (splat3(self.origin), splat3(self.direction));
        let from_a = [o[0] - a[0], o[1] - a[1], o[2] - a[2]];
        let (p, q) = (cross(d, e2), cross(from_a, e1));
        // A vanishing determinant makes all of them infinite or NaN, which are in no range.
        let inv = S::F8::splat(1.0) / dot(p, e1);
        let (u, v, t) = (dot(p, from_a) * inv, dot(q, d) * inv, dot(q, e2) * inv);
        let inside = S::F8::splat(0.0).less_or_equal(u.min(v)) & (u + v).less_or_equal(S::F8::splat(1.0));
        let in_range = S::F8::splat(self.t_min).less(t) & t.less_or_equal(S::F8::splat(t_max));
        let mask = (inside & in_range).bits();
        if mask == 0 {
            return BlockHits::NONE;
        }
        BlockHits { mask, t: t.to_array(), u: u.to_array(), v: v.to_array() }
    }
}

#[inline(always)]
fn dot<F: Floats<LANES>>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<F: Floats<LANES>>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

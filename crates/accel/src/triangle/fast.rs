//! The least arithmetic: a ray may slip through along an edge.
//!
//! # References
//! [Möller and Trumbore 1997] "Fast, Minimum Storage Ray/Triangle Intersection".

use aureole_math::Ray;

use super::{Block, Hits, LANES, TriangleTest, corners, one_triangle};
use crate::bvh::{PACKET, SideBySide};
use crate::simd::{Floats, Mask, Simd, load3, splat3};

/// A ray as it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fast {
    origin: [f32; 3],
    direction: [f32; 3],
    t_min: f32,
}

/// Origins, directions and beginnings of rays.
pub(crate) struct FastRays {
    origin: [[f32; PACKET]; 3],
    direction: [[f32; PACKET]; 3],
    t_min: [f32; PACKET],
}

impl TriangleTest for Fast {
    type Rays = FastRays;

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
    fn together(_: &[Self; PACKET], rays: &SideBySide) -> Option<FastRays> {
        Some(FastRays { origin: rays.origin, direction: rays.direction, t_min: rays.t_min })
    }

    #[inline(always)]
    fn intersect<S: Simd>(&self, block: &Block, t_max: f32) -> Hits<LANES> {
        let t_min = S::F8::splat(self.t_min);
        intersect(
            corners(block, [0, 1, 2]),
            splat3(self.origin),
            splat3(self.direction),
            t_min,
            S::F8::splat(t_max),
        )
    }

    #[inline(always)]
    fn intersect_rays<S: Simd>(
        rays: &FastRays,
        block: &Block,
        lane: usize,
        ends: &[f32; PACKET],
    ) -> Hits<PACKET> {
        let (origin, direction) = (load3(&rays.origin), load3(&rays.direction));
        let t_min = S::F16::load(&rays.t_min);
        intersect(one_triangle(block, lane, [0, 1, 2]), origin, direction, t_min, S::F16::load(ends))
    }
}

#[inline(always)]
fn intersect<const N: usize, F: Floats<N>>(
    [a, e1, e2]: [[F; 3]; 3],
    o: [F; 3],
    d: [F; 3],
    t_min: F,
    t_max: F,
) -> Hits<N> {
    let from_a = [o[0] - a[0], o[1] - a[1], o[2] - a[2]];
    let (p, q) = (cross(d, e2), cross(from_a, e1));
    // A vanishing determinant makes all of them infinite or NaN, which are in no range.
    let inv = F::splat(1.0) / dot(p, e1);
    let (u, v, t) = (dot(p, from_a) * inv, dot(q, d) * inv, dot(q, e2) * inv);
    let inside = F::splat(0.0).less_or_equal(u.min(v)) & (u + v).less_or_equal(F::splat(1.0));
    let in_range = t_min.less(t) & t.less_or_equal(t_max);
    let mask = (inside & in_range).bits();
    if mask == 0 {
        return Hits::NONE;
    }
    Hits { mask, t: t.to_array(), u: u.to_array(), v: v.to_array() }
}

#[inline(always)]
fn dot<const N: usize, F: Floats<N>>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<const N: usize, F: Floats<N>>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

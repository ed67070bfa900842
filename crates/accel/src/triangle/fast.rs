//! The least arithmetic: a ray may slip through along an edge.
//!
//! # References
//! [Möller and Trumbore 1997] "Fast, Minimum Storage Ray/Triangle Intersection".

use aureole_math::{Ray, gamma};

use super::{Block, FoundHits, Hits, LANES, MovingBlock, TriangleTest, corners, moving, one_triangle};
use crate::bvh::Packet;
use crate::simd::{Floats, Mask, Simd, splat3};

/// A ray as it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fast {
    origin: [f32; 3],
    direction: [f32; 3],
    t_min: f32,
}

impl TriangleTest for Fast {
    type Rays = ();

    /// The first vertex and the edges from it to the others.
    fn prepare([a, b, c]: [[f32; 3]; 3]) -> [[f32; 3]; 3] {
        let from_a = |p: [f32; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        [a, from_a(b), from_a(c)]
    }

    #[inline(always)]
    fn prepare_lanes<F: Floats<LANES>>([a, b, c]: [[F; 3]; 3]) -> [[F; 3]; 3] {
        [a, [b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]]
    }

    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self { origin: ray.origin.to_array(), direction: ray.direction.to_array(), t_min: ray.t_min }
    }

    #[inline(always)]
    fn together<S: Simd>(_: &Packet<S>) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn one_of((): &(), _: usize, ray: &Ray) -> Self {
        Self::new(ray)
    }

    #[inline(always)]
    fn boxes<S: Simd>(block: &Block) -> [[[f32; LANES]; 2]; 3] {
        let [a, e1, e2]: [[S::F8; 3]; 3] = corners(block, [0, 1, 2]);
        let mut boxes = [[[0.0; LANES]; 2]; 3];
        for axis in 0..3 {
            let (a, b, c) = (a[axis], a[axis] + e1[axis], a[axis] + e2[axis]);
            // Both the edges and these corners are rounded.
            let slack = (a.abs() + e1[axis].abs() + e2[axis].abs()) * S::F8::splat(gamma(4));
            boxes[axis] = [(a.min(b).min(c) - slack).to_array(), (a.max(b).max(c) + slack).to_array()];
        }
        boxes
    }

    #[inline(always)]
    fn intersect<S: Simd>(&self, block: &Block, t_max: f32) -> Hits<S::F8> {
        let t_min = S::F8::splat(self.t_min);
        intersect(
            corners(block, [0, 1, 2]),
            splat3(self.origin),
            splat3(self.direction),
            t_min,
            S::F8::splat(t_max),
        )
    }

    #[inline(never)]
    fn intersect_moving(&self, block: &MovingBlock, share: f32, t_max: f32) -> FoundHits {
        moving::intersect(self, block, share, t_max)
    }

    #[inline(always)]
    fn intersect_rays<S: Simd>(
        (): &(),
        packet: &Packet<S>,
        block: &Block,
        lane: usize,
        ends: S::F16,
    ) -> Hits<S::F16> {
        let triangle = one_triangle(block, lane, [0, 1, 2]);
        intersect(triangle, packet.origin, packet.direction, packet.t_min, ends)
    }
}

#[inline(always)]
fn intersect<const N: usize, F: Floats<N>>(
    [a, e1, e2]: [[F; 3]; 3],
    o: [F; 3],
    d: [F; 3],
    t_min: F,
    t_max: F,
) -> Hits<F> {
    let from_a = [o[0] - a[0], o[1] - a[1], o[2] - a[2]];
    let (p, q) = (cross(d, e2), cross(from_a, e1));
    // A vanishing determinant makes all of them infinite or NaN, which are in no range.
    let inv = F::splat(1.0) / dot(p, e1);
    let (u, v, t) = (dot(p, from_a) * inv, dot(q, d) * inv, dot(q, e2) * inv);
    let inside = F::splat(0.0).less_or_equal(u.min(v)) & (u + v).less_or_equal(F::splat(1.0));
    let in_range = t_min.less(t) & t.less_or_equal(t_max);
    let mask = (inside & in_range).bits();
    Hits { mask, t, u, v }
}

#[inline(always)]
fn dot<const N: usize, F: Floats<N>>(a: [F; 3], b: [F; 3]) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<const N: usize, F: Floats<N>>(a: [F; 3], b: [F; 3]) -> [F; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

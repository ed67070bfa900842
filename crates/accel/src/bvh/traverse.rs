//! Walking the hierarchy, nearest children first.

use arrayvec::ArrayVec;
use aureole_math::{Ray, gamma};
use bytemuck::Pod;
use glam::{Vec3, Vec4};

use crate::simd::{Floats, Mask, Simd, splat3};

use super::node::{Bvh, COUNT_BITS, LEAF, MAX_LEVELS};
use super::wide::Wide;

/// Children left for later, at most fifteen a level: where the ray enters the child in the upper half (the bits of a number
/// that is not negative, which sort like the number) and its reference in the lower.
pub(super) type Stack = ArrayVec<u64, { 15 * MAX_LEVELS + 16 }>;

/// A ray made ready for the box test: a plane at `p` is met at `p · inv - offset`, the near planes a little too early and
/// the far ones a little too late, so that rounding loses nothing.
#[derive(Clone, Copy)]
pub(crate) struct TraversalRay<const W: usize, F: Floats<W>> {
    /// Which side of each axis's slabs is entered first.
    near: [usize; 3],
    near_inv: [F; 3],
    near_offset: [F; 3],
    far_inv: [F; 3],
    far_offset: [F; 3],
    t_min: F,
}

/// The rounding of `p · inv - offset` relative to its result, of both planes together.
pub(super) const RELATIVE: f32 = 1.0 + 4.0 * gamma(2);
/// The rounding of `o · inv` relative to it.
pub(super) const ABSOLUTE: f32 = 2.0 * gamma(2);

impl<const W: usize, F: Floats<W>> TraversalRay<W, F> {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let [o, d] =
            [Vec3::from(ray.origin.to_array()), Vec3::from(ray.direction.to_array())].map(|v| v.extend(1.0));
        // A zero component would make 0 · ∞ = NaN of planes through the origin; a huge reciprocal does not.
        let inv = d.abs().max(Vec4::splat(1e-18)).copysign(d).recip();
        let offset = o * inv;
        let slack = offset.abs() * ABSOLUTE;
        let splat = |v: Vec4| v.truncate().to_array();
        let negative = inv.is_negative_bitmask() as usize;
        Self {
            near: [negative & 1, (negative >> 1) & 1, (negative >> 2) & 1],
            near_inv: splat3(splat(inv)),
            near_offset: splat3(splat(offset + slack)),
            far_inv: splat3(splat(inv * RELATIVE)),
            far_offset: splat3(splat((offset - slack) * RELATIVE)),
            t_min: F::splat(ray.t_min),
        }
    }

    /// Where the ray enters each of a node's boxes, and a bit for each that it meets before `t_max`.
    #[inline(always)]
    fn intersect<S: Simd>(&self, node: &impl Wide<W, Floats<S> = F>, t_max: f32) -> (F, u32) {
        let (mut enter, mut leave) = (self.t_min, F::splat(t_max));
        for axis in 0..3 {
            let near = node.planes::<S>(axis, self.near[axis]);
            let far = node.planes::<S>(axis, self.near[axis] ^ 1);
            // In this order, a NaN decides nothing.
            enter = near.mul_sub(self.near_inv[axis], self.near_offset[axis]).max(enter);
            leave = far.mul_sub(self.far_inv[axis], self.far_offset[axis]).min(leave);
        }
        (enter, enter.less_or_equal(leave).bits())
    }
}

/// How far behind the best hit boxes are still opened: where a ray enters a box and where it meets a triangle in it are
/// rounded differently, and of equally near hits the one with the smallest number must be found.
pub(crate) const TIE_SCALE: f32 = 1.0 + 1e-5;

/// What a leaf says after it was tested.
pub(crate) enum Leaf {
    /// Go on; hits at or beyond this parameter no longer matter.
    Continue(f32),
    /// The query is answered.
    Stop,
}

/// Tests leaves. A trait rather than a closure, so that it can insist on being compiled into the walk.
pub(crate) trait VisitLeaf {
    /// Whether any hit will do: then the order does not matter.
    const ANY: bool;

    /// Tests the packed things from `first` on.
    fn visit<S: Simd>(&mut self, first: usize, count: usize) -> Leaf;
}

impl<N: Pod> Bvh<N> {
    /// Visits the leaves that a ray may meet, nearest first, with their first item and number of items.
    #[inline(always)]
    pub(crate) fn walk<const W: usize, S: Simd, V: VisitLeaf>(&self, ray: &Ray, t_max: f32, visitor: &mut V)
    where
        N: Wide<W>,
    {
        if self.nodes.is_empty() || t_max.is_nan() {
            return;
        }
        let ray = TraversalRay::<W, N::Floats<S>>::new(ray);
        let mut t_max = t_max * TIE_SCALE;
        let mut stack = Stack::new();
        let mut current = 0;
        loop {
            if current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let (enter, mask) = ray.intersect::<S>(node, t_max);
                if mask != 0 {
                    current = if V::ANY {
                        descend_any(node, enter.to_array(), mask, &mut stack)
                    } else {
                        descend(node, enter.to_array(), mask, &mut stack)
                    };
                    continue;
                }
            } else {
                let first = (current & !LEAF) >> COUNT_BITS;
                match visitor.visit::<S>(first as usize, (current & ((1 << COUNT_BITS) - 1)) as usize) {
                    Leaf::Continue(t) => t_max = t * TIE_SCALE,
                    Leaf::Stop => return,
                }
            }
            // What lies behind the hit found meanwhile is skipped; equally far things may still win by number.
            loop {
                let Some(entry) = stack.pop() else { return };
                if f32::from_bits((entry >> 32) as u32) <= t_max {
                    current = entry as u32;
                    break;
                }
            }
        }
    }
}

/// The nearest child that the ray meets; the others go onto the stack, farthest first.
#[inline(always)]
fn descend<const W: usize>(node: &impl Wide<W>, enter: [f32; W], mut mask: u32, stack: &mut Stack) -> u32 {
    let mut next = || {
        let i = mask.trailing_zeros() as usize % W;
        mask &= mask - 1;
        (u64::from(enter[i].to_bits()) << 32 | u64::from(node.child(i)), mask)
    };
    let (a, rest) = next();
    if rest == 0 {
        return a as u32;
    }
    let (b, mut rest) = next();
    let (mut nearest, far) = (a.min(b), a.max(b));
    if rest == 0 {
        stack.push(far);
        return nearest as u32;
    }
    let start = stack.len();
    stack.push(far);
    while rest != 0 {
        let (c, r) = next();
        rest = r;
        let (near, far) = (nearest.min(c), nearest.max(c));
        nearest = near;
        // Insert `far`.
        let mut at = stack.len();
        stack.push(far);
        while at > start && stack[at - 1] < far {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = far;
    }
    nearest as u32
}

/// The nearest child that the ray meets; the others go onto the stack as they come.
#[inline(always)]
fn descend_any<const W: usize>(
    node: &impl Wide<W>,
    enter: [f32; W],
    mut mask: u32,
    stack: &mut Stack,
) -> u32 {
    let mut next = || {
        let i = mask.trailing_zeros() as usize % W;
        mask &= mask - 1;
        (u64::from(enter[i].to_bits()) << 32 | u64::from(node.child(i)), mask)
    };
    let (mut nearest, mut rest) = next();
    while rest != 0 {
        let (other, r) = next();
        rest = r;
        stack.push(nearest.max(other));
        nearest = nearest.min(other);
    }
    nearest as u32
}

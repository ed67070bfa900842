//! Walking the hierarchy, nearest children first.

use aureole_math::{Ray, Vector3, gamma};

use crate::simd::{Avx2, Slabs};

use super::node::{Bvh8, COUNT_BITS, LEAF, MAX_LEVELS, Node, WIDTH};

/// Children left for later and where the ray enters them: at most seven a level.
///
/// Kept from ray to ray: clearing it would cost more than many a walk.
pub(crate) struct Stack([(u32, f32); STACK]);

const STACK: usize = (WIDTH - 1) * MAX_LEVELS + WIDTH;

impl Default for Stack {
    fn default() -> Self {
        Self([(0, 0.0); STACK])
    }
}

/// A ray made ready for the box test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TraversalRay {
    origin: [f32; 3],
    inv: [f32; 3],
    /// Which side of each axis's slabs is entered first.
    near: [usize; 3],
    t_min: f32,
    avx2: Option<Avx2>,
}

impl TraversalRay {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        // A zero component would make 0 · ∞ = NaN of planes through the origin; a huge reciprocal does not.
        let safe = |d: f32| if d.abs() < 1e-30 { 1e-30_f32.copysign(d) } else { d };
        let d = ray.direction;
        let inv = Vector3::new(1.0 / safe(d.x), 1.0 / safe(d.y), 1.0 / safe(d.z)).to_array();
        Self {
            origin: ray.origin.to_array(),
            inv,
            near: inv.map(|x| usize::from(x.is_sign_negative())),
            t_min: ray.t_min,
            avx2: Avx2::detect(),
        }
    }
}

/// How far behind the best hit boxes are still opened: where a ray enters a box and where it meets a triangle in it are
/// rounded differently, and of equally near hits the one with the smallest number must be found.
const TIE_SCALE: f32 = 1.0 + 1e-5;
/// Makes the far side reach as far as rounding could have taken it back [Ize 2013].
const FAR_SCALE: f32 = 1.0 + 2.0 * gamma(3);

/// Where the ray enters each of the eight boxes, and a bit for each that it meets before `t_max`.
#[inline(always)]
fn intersect_boxes(node: &Node, ray: &TraversalRay, t_max: f32) -> ([f32; WIDTH], u32) {
    let side = |axis: usize, far: usize| &node.planes[axis][ray.near[axis] ^ far];
    let slabs = Slabs {
        near: [side(0, 0), side(1, 0), side(2, 0)],
        far: [side(0, 1), side(1, 1), side(2, 1)],
        o: ray.origin,
        inv: ray.inv,
        far_scale: FAR_SCALE,
        t_min: ray.t_min,
        t_max: t_max * TIE_SCALE,
    };
    slabs.test(ray.avx2)
}

/// What a leaf says after it was tested.
pub(crate) enum Leaf {
    /// Go on; hits at or beyond this parameter no longer matter.
    Continue(f32),
    /// The query is answered.
    Stop,
}

/// Tests leaves. A trait rather than a closure, so that it can insist on being compiled into the walk.
pub(crate) trait VisitLeaf {
    /// Tests the packed things from `first` on.
    fn visit(&mut self, first: usize, count: usize) -> Leaf;
}

impl Bvh8 {
    /// Visits the leaves that a ray may meet, nearest first, with their first item and number of items.
    #[inline(always)]
    pub(crate) fn walk(
        &self,
        ray: &TraversalRay,
        mut t_max: f32,
        stack: &mut Stack,
        visitor: &mut impl VisitLeaf,
    ) {
        if self.nodes.is_empty() || t_max.is_nan() {
            return;
        }
        let stack = &mut stack.0;
        let mut top = 0;
        let mut current = 0_u32;
        loop {
            if current & LEAF != 0 {
                let first = (current & !LEAF) >> COUNT_BITS;
                match visitor.visit(first as usize, (current & ((1 << COUNT_BITS) - 1)) as usize) {
                    Leaf::Continue(t) => t_max = t,
                    Leaf::Stop => return,
                }
            } else {
                let node = &self.nodes[current as usize];
                let (enter, mut mask) = intersect_boxes(node, ray, t_max);
                if mask != 0 {
                    // The nearest child next, the others onto the stack, farthest first.
                    let start = top;
                    while mask != 0 {
                        let i = mask.trailing_zeros() as usize;
                        mask &= mask - 1;
                        let entry = (node.children[i], enter[i]);
                        let mut at = top;
                        while at > start && stack[at - 1].1 < entry.1 {
                            stack[at] = stack[at - 1];
                            at -= 1;
                        }
                        stack[at] = entry;
                        top += 1;
                    }
                    top -= 1;
                    current = stack[top].0;
                    continue;
                }
            }
            // What lies behind the hit found meanwhile is skipped; equally far things may still win by number.
            loop {
                if top == 0 {
                    return;
                }
                top -= 1;
                if stack[top].1 <= t_max * TIE_SCALE {
                    current = stack[top].0;
                    break;
                }
            }
        }
    }
}

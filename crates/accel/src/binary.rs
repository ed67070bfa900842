//! The plain hierarchy: two children a node, the nearer one first. Slower than the wide one, and easier to read.

use arrayvec::ArrayVec;
use aureole_math::{Bounds3, Ray};

use crate::bvh::{Below, BinaryTree, Leaf, MAX_LEVELS, TIE_SCALE, VisitLeaf};
use crate::simd::Simd;

/// Visits the leaves that a ray may meet, nearest first.
#[inline(always)]
pub(crate) fn walk<S: Simd, V: VisitLeaf>(tree: &BinaryTree, ray: &Ray, mut t_max: f32, visitor: &mut V) {
    let inv = ray.direction.to_array().map(|d| 1.0 / if d.abs() < 1e-18 { 1e-18_f32.copysign(d) } else { d });
    let enter = |node: usize, t_max: f32| enter(&tree.nodes[node].bounds, ray, inv, t_max * TIE_SCALE);
    let mut stack = ArrayVec::<(usize, f32), MAX_LEVELS>::new();
    let mut next = if tree.nodes.is_empty() { None } else { enter(0, t_max).map(|_| 0) };
    while let Some(current) = next {
        next = match tree.nodes[current].below() {
            Below::Items { first, .. } => {
                match visitor.visit::<S>(first, 1) {
                    Leaf::Continue(t) => t_max = t,
                    Leaf::Stop => return,
                }
                None
            }
            Below::Nodes(left, right) => match (enter(left, t_max), enter(right, t_max)) {
                (Some(a), Some(b)) => {
                    let (near, far) = if a <= b { (left, (right, b)) } else { (right, (left, a)) };
                    stack.push(far);
                    Some(near)
                }
                (Some(_), None) => Some(left),
                (None, Some(_)) => Some(right),
                (None, None) => None,
            },
        };
        while next.is_none() {
            match stack.pop() {
                Some((node, t)) if t <= t_max * TIE_SCALE => next = Some(node),
                Some(_) => {}
                None => return,
            }
        }
    }
}

/// Where a ray enters a box, if it does before `t_max`. A little too generous, so that rounding loses nothing.
#[inline(always)]
fn enter(bounds: &Bounds3, ray: &Ray, inv: [f32; 3], t_max: f32) -> Option<f32> {
    let (mut enter, mut leave) = (ray.t_min, t_max);
    for (axis, &inv) in inv.iter().enumerate() {
        let along = |plane: f32| (plane - ray.origin[axis]) * inv;
        let (a, b) = (along(bounds.min[axis]), along(bounds.max[axis]));
        let (near, far) = if inv < 0.0 { (b, a) } else { (a, b) };
        // In this order, a NaN decides nothing.
        enter = if near > enter { near } else { enter };
        leave = if far * FAR_SCALE < leave { far * FAR_SCALE } else { leave };
    }
    (enter <= leave).then_some(enter)
}

/// Makes the far side reach as far as rounding could have taken it back [Ize 2013].
const FAR_SCALE: f32 = 1.0 + 2.0 * aureole_math::gamma(3);

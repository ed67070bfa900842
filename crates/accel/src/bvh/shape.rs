//! Hierarchies of any layout, looked at from outside: for checks and figures.

use aureole_math::{Bounds3, Point3, Vector3};
use bytemuck::Pod;

use super::node::{Bvh, COUNT_BITS, LEAF, MAX_LEVELS};
use super::tree::{Below, BinaryTree};
use super::wide::Wide;
use crate::Defect;

/// A child of a node: its box and what is in it, counted in nodes or in groups of primitives.
pub(crate) struct Child {
    pub bounds: Bounds3,
    pub below: Below,
}

/// A hierarchy whose nodes have children.
pub(crate) trait Shape {
    /// Nodes with children.
    fn node_count(&self) -> usize;

    /// Calls `visit` with each child of a node.
    fn children(&self, node: usize, visit: &mut dyn FnMut(Child));

    /// The children of an imaginary node above everything.
    fn root(&self, visit: &mut dyn FnMut(Child));

    /// How far a child may reach out of its parent's box, as a share of that box: boxes are rounded outwards.
    fn slack(&self) -> f32 {
        0.0
    }
}

/// A hierarchy of nodes with `W` children.
pub(crate) struct Layers<'a, N: Pod, const W: usize> {
    bvh: &'a Bvh<N>,
    slack: f32,
}

impl<'a, N: Wide<W>, const W: usize> Layers<'a, N, W> {
    /// One whose boxes are the smallest there are.
    pub(crate) fn exact(bvh: &'a Bvh<N>) -> Self {
        Self { bvh, slack: 0.0 }
    }

    /// One whose planes are rounded to 8 bits: the parent's and the child's, each by less than a step.
    pub(crate) fn rounded(bvh: &'a Bvh<N>) -> Self {
        Self { bvh, slack: 2.0 / 255.0 }
    }
}

impl<N: Wide<W>, const W: usize> Shape for Layers<'_, N, W> {
    fn node_count(&self) -> usize {
        self.bvh.nodes.len()
    }

    fn children(&self, node: usize, visit: &mut dyn FnMut(Child)) {
        let node = &self.bvh.nodes[node];
        for slot in (0..W).filter(|&slot| node.child(slot) != LEAF) {
            let child = node.child(slot);
            let below = if child & LEAF == 0 {
                Below::Nodes(child as usize, child as usize)
            } else {
                let first = ((child & !LEAF) >> COUNT_BITS) as usize;
                Below::Items { first, count: (child & ((1 << COUNT_BITS) - 1)) as usize }
            };
            let [min, max] =
                [0, 1].map(|side| Point3::from([0, 1, 2].map(|axis| node.plane(axis, side, slot))));
            visit(Child { bounds: Bounds3 { min, max }, below });
        }
    }

    fn root(&self, visit: &mut dyn FnMut(Child)) {
        if !self.bvh.nodes.is_empty() {
            visit(Child { bounds: self.bvh.bounds::<W>(), below: Below::Nodes(0, 0) });
        }
    }

    fn slack(&self) -> f32 {
        self.slack
    }
}

/// Each leaf holds one group.
impl Shape for BinaryTree {
    fn node_count(&self) -> usize {
        self.nodes.iter().filter(|node| matches!(node.below(), Below::Nodes(..))).count()
    }

    fn children(&self, node: usize, visit: &mut dyn FnMut(Child)) {
        if let Below::Nodes(left, right) = self.nodes[node].below() {
            self.child(left, visit);
            self.child(right, visit);
        }
    }

    fn root(&self, visit: &mut dyn FnMut(Child)) {
        if !self.nodes.is_empty() {
            self.child(0, visit);
        }
    }
}

impl BinaryTree {
    fn child(&self, node: usize, visit: &mut dyn FnMut(Child)) {
        let below = match self.nodes[node].below() {
            Below::Nodes(..) => Below::Nodes(node, node),
            items => items,
        };
        visit(Child { bounds: self.nodes[node].bounds, below });
    }
}

/// What a hierarchy looks like, depth by depth.
#[derive(Clone, Debug, Default)]
pub(crate) struct Census {
    pub nodes: usize,
    pub leaves: usize,
    /// Children of all nodes.
    pub children: usize,
    pub depth: usize,
    /// Sum over nodes, and over the groups in leaves, of their areas, divided by that of the root.
    pub sah_cost: f32,
}

/// Walks through all of a hierarchy and calls `leaf` with the box of each leaf, its first group and their number.
///
/// # Errors
/// A box that does not hold a child, a node that is reached twice or not at all, or more levels than a walk has room for.
pub(crate) fn census(
    shape: &impl Shape,
    leaf: &mut dyn FnMut(Bounds3, usize, usize) -> Result<(), Defect>,
) -> Result<Census, Defect> {
    let mut census = Census::default();
    let mut stack = Vec::new();
    let mut total = 0.0;
    shape.root(&mut |child| stack.push((child, 1)));
    let root_area = stack.first().map_or(0.0, |(root, _)| half_area(&root.bounds)).max(f64::MIN_POSITIVE);
    let nodes = shape.node_count();
    while let Some((Child { bounds, below }, depth)) = stack.pop() {
        if depth > MAX_LEVELS {
            return Err(Defect::TooDeep { limit: MAX_LEVELS });
        }
        match below {
            Below::Nodes(node, _) => {
                census.nodes += 1;
                if census.nodes > nodes {
                    return Err(Defect::Nodes { reached: census.nodes, nodes });
                }
                census.depth = census.depth.max(depth);
                total += half_area(&bounds);
                let mut escapes = false;
                shape.children(node, &mut |child| {
                    escapes |= !holds(&bounds, &child.bounds, shape.slack());
                    census.children += 1;
                    let next = depth + usize::from(matches!(child.below, Below::Nodes(..)));
                    stack.push((child, next));
                });
                if escapes {
                    return Err(Defect::Escapes { node });
                }
            }
            Below::Items { first, count } => {
                census.leaves += 1;
                total += half_area(&bounds) * count as f64;
                leaf(bounds, first, count)?;
            }
        }
    }
    if census.nodes != nodes {
        return Err(Defect::Nodes { reached: census.nodes, nodes });
    }
    census.sah_cost = (total / root_area) as f32;
    Ok(census)
}

fn holds(outer: &Bounds3, inner: &Bounds3, slack: f32) -> bool {
    // Zero times an infinite extent is no number.
    let room = if slack > 0.0 { outer.diagonal() * slack } else { Vector3::ZERO };
    let Bounds3 { min, max } = Bounds3 { min: outer.min - room, max: outer.max + room };
    (0..3).all(|axis| min[axis] <= inner.min[axis] && inner.max[axis] <= max[axis])
}

fn half_area(b: &Bounds3) -> f64 {
    let d = (b.max - b.min).to_array().map(|x| f64::from(x.max(0.0)));
    d[0] * (d[1] + d[2]) + d[1] * d[2]
}

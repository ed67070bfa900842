//! Walking the hierarchy with sixteen rays of about one direction: a node is tested once for all of them.
//!
//! # References
//! Bounds of t over a packet by interval arithmetic: [Boulos et al. 2006] "Geometric and Arithmetic Culling Methods for Entire
//! Ray Packets".

use aureole_math::Ray;
use glam::{Vec3, Vec4};

use super::node::{Bvh8, COUNT_BITS, LEAF, Node, WIDTH};
use super::traverse::{ABSOLUTE, RELATIVE, Stack, TIE_SCALE};
use crate::simd::{Floats, Mask, Simd, lanes, splat3};

/// Rays in a packet.
pub(crate) const PACKET: usize = 16;

/// Tests leaves against the rays of a packet.
pub(crate) trait VisitPacket {
    /// Tests the packed things from `first` on against the rays whose bits are set in `active`. Lowers the ends of rays that
    /// hit something, to below zero where nothing nearer is wanted.
    fn visit<S: Simd>(&mut self, first: usize, count: usize, active: u32, ends: &mut [f32; PACKET]);

    /// The leaf whose things begin at `first` may be visited soon.
    fn expect<S: Simd>(&self, first: usize);
}

/// What all rays of a packet have in common, and what each box is tested with: see `TraversalRay`.
pub(crate) struct Packet<S: Simd> {
    /// Which side of each axis's slabs is entered first.
    near: [usize; 3],
    /// Those of the rays' origins from which the near and the far planes are soonest and latest met.
    near_origin: [S::F8; 3],
    far_origin: [S::F8; 3],
    /// The least and largest reciprocals of the directions.
    low_inv: [S::F8; 3],
    high_inv: [S::F8; 3],
    t_min: S::F8,
}

/// The rays of a packet side by side.
pub(crate) struct SideBySide {
    pub origin: [[f32; PACKET]; 3],
    pub direction: [[f32; PACKET]; 3],
    pub t_min: [f32; PACKET],
    /// For each axis the factors and offsets of the near and the far planes, as in `TraversalRay`.
    planes: [[[f32; PACKET]; 4]; 3],
}

/// How much directions may differ, relative to their length.
const SPREAD: f32 = 0.2;

impl<S: Simd> Packet<S> {
    /// `None` when the rays do not belong together.
    #[inline(always)]
    pub(crate) fn new(rays: &[Ray; PACKET]) -> Option<Self> {
        let vector = |v: [f32; 3]| Vec3::from(v).extend(1.0);
        let first = vector(rays[0].direction.to_array());
        let signs = first.is_negative_bitmask();
        let (mut low, mut high) = (first, first);
        let (mut low_o, mut high_o) = (Vec4::INFINITY, Vec4::NEG_INFINITY);
        let mut same_signs = true;
        for ray in rays {
            let (o, d) = (vector(ray.origin.to_array()), vector(ray.direction.to_array()));
            same_signs &= d.is_negative_bitmask() == signs;
            (low, high) = (low.min(d), high.max(d));
            (low_o, high_o) = (low_o.min(o), high_o.max(o));
        }
        let size = (high - low).max_element();
        if !(same_signs && size <= SPREAD * low.truncate().abs().max(high.truncate().abs()).max_element()) {
            return None;
        }
        let near = [signs as usize & 1, (signs as usize >> 1) & 1, (signs as usize >> 2) & 1];
        let (low_o, high_o) = (low_o.to_array(), high_o.to_array());
        let pick = |axis: usize, far: usize| if near[axis] ^ far == 0 { high_o[axis] } else { low_o[axis] };
        let mut t_min = f32::INFINITY;
        for ray in rays {
            t_min = t_min.min(ray.t_min);
        }
        Some(Self {
            near,
            near_origin: splat3([pick(0, 0), pick(1, 0), pick(2, 0)]),
            far_origin: splat3([pick(0, 1), pick(1, 1), pick(2, 1)]),
            low_inv: splat3(reciprocal(high).truncate().to_array()),
            high_inv: splat3(reciprocal(low).truncate().to_array()),
            t_min: S::F8::splat(t_min),
        })
    }

    /// The rays by themselves.
    #[inline(always)]
    pub(crate) fn side_by_side(&self, rays: &[Ray; PACKET]) -> SideBySide {
        let mut out = SideBySide {
            origin: [[0.0; PACKET]; 3],
            direction: [[0.0; PACKET]; 3],
            t_min: [0.0; PACKET],
            planes: [[[0.0; PACKET]; 4]; 3],
        };
        for (i, ray) in rays.iter().enumerate() {
            let (o, d) = (ray.origin, ray.direction);
            (out.origin[0][i], out.origin[1][i], out.origin[2][i]) = (o.x, o.y, o.z);
            (out.direction[0][i], out.direction[1][i], out.direction[2][i]) = (d.x, d.y, d.z);
            out.t_min[i] = ray.t_min;
        }
        for axis in 0..3 {
            // All directions have one sign on this axis.
            let sign = S::F16::splat(if self.near[axis] == 0 { 1.0 } else { -1.0 });
            let inv = sign / S::F16::load(&out.direction[axis]).abs().max(S::F16::splat(1e-18));
            let offset = S::F16::load(&out.origin[axis]) * inv;
            let slack = offset.abs() * S::F16::splat(ABSOLUTE);
            let relative = S::F16::splat(RELATIVE);
            out.planes[axis] = [
                inv.to_array(),
                (offset + slack).to_array(),
                (inv * relative).to_array(),
                ((offset - slack) * relative).to_array(),
            ];
        }
        out
    }

    /// Where the first ray may enter each of eight boxes, and a bit for each that some ray may meet before `t_max`.
    #[inline(always)]
    fn intersect_node(&self, node: &Node, t_max: f32) -> (S::F8, u32) {
        let (mut enter, mut leave) = (self.t_min, S::F8::splat(f32::INFINITY));
        for axis in 0..3 {
            let near = S::F8::load(&node.planes[axis][self.near[axis]]) - self.near_origin[axis];
            let far = S::F8::load(&node.planes[axis][self.near[axis] ^ 1]) - self.far_origin[axis];
            let soonest = (near * self.low_inv[axis]).min(near * self.high_inv[axis]);
            let latest = (far * self.low_inv[axis]).max(far * self.high_inv[axis]);
            (enter, leave) = (soonest.max(enter), latest.min(leave));
        }
        let leave = (leave * S::F8::splat(RELATIVE)).min(S::F8::splat(t_max));
        (enter, enter.less_or_equal(leave).bits())
    }

    /// A bit for each ray that meets one box before its end.
    #[inline(always)]
    fn intersect_box(&self, rays: &SideBySide, node: &Node, slot: usize, ends: &[f32; PACKET]) -> u32 {
        let mut enter = S::F16::load(&rays.t_min);
        let mut leave = S::F16::load(ends) * S::F16::splat(TIE_SCALE);
        for axis in 0..3 {
            let [near_inv, near_offset, far_inv, far_offset] = &rays.planes[axis];
            let near = S::F16::splat(node.planes[axis][self.near[axis]][slot]);
            let far = S::F16::splat(node.planes[axis][self.near[axis] ^ 1][slot]);
            enter = near.mul_sub(S::F16::load(near_inv), S::F16::load(near_offset)).max(enter);
            leave = far.mul_sub(S::F16::load(far_inv), S::F16::load(far_offset)).min(leave);
        }
        enter.less_or_equal(leave).bits()
    }
}

/// The reciprocal of a direction, as in `TraversalRay`.
#[inline(always)]
fn reciprocal(d: Vec4) -> Vec4 {
    d.abs().max(Vec4::splat(1e-18)).copysign(d).recip()
}

impl Bvh8 {
    /// Whether some ray of a packet may meet anything at all.
    #[inline(always)]
    pub(crate) fn is_met_by<S: Simd>(&self, packet: &Packet<S>) -> bool {
        self.nodes.first().is_some_and(|root| packet.intersect_node(root, f32::INFINITY).1 != 0)
    }

    /// Visits the leaves that rays of a packet may meet, nearest first.
    #[inline(always)]
    pub(crate) fn walk_packet<S: Simd>(
        &self,
        packet: &Packet<S>,
        rays: &SideBySide,
        ends: &mut [f32; PACKET],
        visitor: &mut impl VisitPacket,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let mut t_max = latest(ends);
        let mut stack = Stack::new();
        let mut current = 0;
        loop {
            let node = &self.nodes[current as usize];
            let (enter, mask) = packet.intersect_node(node, t_max);
            push_children(current, enter.to_array(), mask, &mut stack);
            for slot in lanes(mask) {
                let child = node.children[slot % WIDTH];
                if child & LEAF == 0 {
                    S::prefetch(&self.nodes[child as usize]);
                } else {
                    visitor.expect::<S>(((child & !LEAF) >> COUNT_BITS) as usize);
                }
            }
            current = loop {
                let Some(entry) = stack.pop() else { return };
                // Also stops when no ray wants more: then the latest end is below zero.
                if f32::from_bits((entry >> 32) as u32) > t_max {
                    continue;
                }
                let (parent, slot) = (&self.nodes[entry as u32 as usize / WIDTH], entry as usize % WIDTH);
                let active = packet.intersect_box(rays, parent, slot, ends);
                if active == 0 {
                    continue;
                }
                let child = parent.children[slot];
                if child & LEAF == 0 {
                    break child;
                }
                let first = (child & !LEAF) >> COUNT_BITS;
                visitor.visit::<S>(first as usize, (child & ((1 << COUNT_BITS) - 1)) as usize, active, ends);
                t_max = latest(ends);
            };
        }
    }
}

/// Beyond the last end, nothing matters to any ray.
#[inline(always)]
fn latest(ends: &[f32; PACKET]) -> f32 {
    ends.iter().fold(f32::NEG_INFINITY, |latest, &end| if end > latest { end } else { latest }) * TIE_SCALE
}

/// Puts the children that are met onto the stack, nearest last: by where they are entered, parent and slot.
#[inline(always)]
fn push_children(parent: u32, enter: [f32; WIDTH], mut mask: u32, stack: &mut Stack) {
    let start = stack.len();
    while mask != 0 {
        let slot = mask.trailing_zeros();
        mask &= mask - 1;
        let enter = u64::from(enter[slot as usize % WIDTH].to_bits());
        let entry = (enter << 32) | u64::from(parent * WIDTH as u32 + slot);
        let mut at = stack.len();
        stack.push(entry);
        while at > start && stack[at - 1] < entry {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = entry;
    }
}

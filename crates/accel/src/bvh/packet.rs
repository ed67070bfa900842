//! Walking the hierarchy with sixteen rays of about one direction: a node is tested once for all of them.
//!
//! # References
//! Bounds of t over a packet by interval arithmetic: [Boulos et al. 2006] "Geometric and Arithmetic Culling Methods for Entire
//! Ray Packets".

use aureole_math::Ray;
use glam::Vec4;

use super::node::{Bvh8, COUNT_BITS, LEAF, Node, WIDTH};
use super::traverse::{ABSOLUTE, RELATIVE, Stack, TIE_SCALE};
use crate::simd::{Floats, Mask, Simd, lanes, splat3};

/// Rays in a packet.
pub(crate) const PACKET: usize = 16;

/// Tests leaves against the rays of a packet.
pub(crate) trait VisitPacket<S: Simd> {
    /// Beyond these nothing matters to the rays; below zero where nothing more is wanted at all.
    fn ends(&self) -> S::F16;

    /// Tests the packed things from `first` on against the rays whose bits are set in `active`; beyond `t_max` nothing
    /// matters to any of them.
    fn visit(&mut self, packet: &Packet<S>, first: usize, count: usize, active: u32, t_max: f32);

    /// The leaf whose things begin at `first` may be visited soon.
    fn expect(&self, first: usize);
}

/// Rays of about one direction, side by side.
pub(crate) struct Packet<S: Simd> {
    pub origin: [S::F16; 3],
    pub direction: [S::F16; 3],
    pub t_min: S::F16,
    pub t_max: S::F16,
    pub outline: Outline<S>,
}

/// What rays of about one direction have in common.
#[derive(Clone, Copy)]
pub(crate) struct Outline<S: Simd> {
    /// Which side of each axis's slabs is entered first.
    pub near: [usize; 3],
    /// Those of the rays' origins from which the near and the far planes are soonest and latest met.
    near_origin: [S::F8; 3],
    far_origin: [S::F8; 3],
    /// The least and largest reciprocals of the directions.
    low_inv: [S::F8; 3],
    high_inv: [S::F8; 3],
    t_min: S::F8,
}

/// For each axis the factors and offsets of the near and the far planes, as in `TraversalRay`, of each ray.
struct Slabs<S: Simd>([[S::F16; 4]; 3]);

/// How much directions may differ, relative to their length.
const SPREAD: f32 = 0.2;
/// The least size of a component of a direction, as in `TraversalRay`.
const LEAST: f32 = 1e-18;

/// Sixteen rays as they come, four to a row: origins and beginnings, directions and ends.
struct Rows<S: Simd> {
    starts: [S::F16; 4],
    ways: [S::F16; 4],
}

/// The least and the largest numbers of rays.
#[derive(Clone, Copy)]
struct Extremes<S: Simd> {
    low_start: S::F4,
    high_start: S::F4,
    low_way: S::F4,
    high_way: S::F4,
    /// Whether none of the numbers is NaN.
    are_numbers: bool,
}

impl<S: Simd> Rows<S> {
    #[inline(always)]
    fn new(rays: &[Ray; PACKET]) -> Self {
        Self {
            starts: [starts::<S>(rays, 0), starts::<S>(rays, 1), starts::<S>(rays, 2), starts::<S>(rays, 3)],
            ways: [ways::<S>(rays, 0), ways::<S>(rays, 1), ways::<S>(rays, 2), ways::<S>(rays, 3)],
        }
    }

    #[inline(always)]
    fn extremes(&self) -> Extremes<S> {
        let [a, b, c, d] = self.starts;
        let [e, f, g, h] = self.ways;
        let ordered = ordered(a) & ordered(b) & ordered(c) & ordered(d);
        let ordered = ordered & self::ordered(e) & self::ordered(f) & self::ordered(g) & self::ordered(h);
        Extremes {
            low_start: least_quad::<S>(a.min(b).min(c.min(d))),
            high_start: largest_quad::<S>(a.max(b).max(c.max(d))),
            low_way: least_quad::<S>(e.min(f).min(g.min(h))),
            high_way: largest_quad::<S>(e.max(f).max(g.max(h))),
            are_numbers: ordered.bits() == 0xffff,
        }
    }
}

impl<S: Simd> Extremes<S> {
    /// Of both kinds of rays together.
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self {
            low_start: self.low_start.min(other.low_start),
            high_start: self.high_start.max(other.high_start),
            low_way: self.low_way.min(other.low_way),
            high_way: self.high_way.max(other.high_way),
            are_numbers: self.are_numbers & other.are_numbers,
        }
    }

    /// `None` when the rays do not belong together, or a number is none.
    #[inline(always)]
    fn outline(self) -> Option<Outline<S>> {
        let (low_o, high_o) = (self.low_start.to_array(), self.high_start.to_array());
        let (low_d, high_d) = (self.low_way.to_array(), self.high_way.to_array());
        let (mut near, mut spread, mut reach) = ([0; 3], 0.0_f32, 0.0_f32);
        let mut same_signs = self.are_numbers;
        for axis in 0..3 {
            let (low, high) = (low_d[axis], high_d[axis]);
            same_signs &= (low >= 0.0) | (high <= 0.0);
            near[axis] = usize::from(low < 0.0);
            spread = spread.max(high - low);
            reach = reach.max(high).max(-low);
        }
        if !(same_signs && spread <= SPREAD * reach) {
            return None;
        }
        let signs = Vec4::new(side(near[0]), side(near[1]), side(near[2]), 1.0);
        let reciprocal = |d: [f32; 4]| signs / Vec4::from_array(d).abs().max(Vec4::splat(LEAST));
        let pick = |axis: usize, far: usize| if near[axis] ^ far == 0 { high_o[axis] } else { low_o[axis] };
        Some(Outline {
            near,
            near_origin: splat3([pick(0, 0), pick(1, 0), pick(2, 0)]),
            far_origin: splat3([pick(0, 1), pick(1, 1), pick(2, 1)]),
            low_inv: splat3(reciprocal(high_d).truncate().to_array()),
            high_inv: splat3(reciprocal(low_d).truncate().to_array()),
            t_min: S::F8::splat(low_o[3]),
        })
    }
}

impl<S: Simd> Outline<S> {
    /// Of many rays; `None` when they do not belong together.
    #[inline(always)]
    pub(crate) fn around(rays: &[[Ray; PACKET]]) -> Option<Self> {
        let (first, others) = rays.split_first()?;
        let mut extremes = Rows::<S>::new(first).extremes();
        for rays in others {
            extremes = extremes.and(Rows::<S>::new(rays).extremes());
        }
        extremes.outline()
    }

    /// Where the first ray may enter each of eight boxes, and a bit for each that some ray may meet before `t_max`.
    /// `planes[axis][side]`: side 0 the lower, 1 the upper planes.
    #[inline(always)]
    pub(crate) fn intersect(&self, planes: &[[[f32; WIDTH]; 2]; 3], t_max: f32) -> (S::F8, u32) {
        let (mut enter, mut leave) = (self.t_min, S::F8::splat(f32::INFINITY));
        for axis in 0..3 {
            let near = S::F8::load(&planes[axis][self.near[axis]]) - self.near_origin[axis];
            let far = S::F8::load(&planes[axis][self.near[axis] ^ 1]) - self.far_origin[axis];
            let soonest = (near * self.low_inv[axis]).min(near * self.high_inv[axis]);
            let latest = (far * self.low_inv[axis]).max(far * self.high_inv[axis]);
            (enter, leave) = (soonest.max(enter), latest.min(leave));
        }
        let leave = (leave * S::F8::splat(RELATIVE)).min(S::F8::splat(t_max));
        (enter, enter.less_or_equal(leave).bits())
    }
}

impl<S: Simd> Packet<S> {
    /// `None` when the rays do not belong together.
    #[inline(always)]
    pub(crate) fn new(rays: &[Ray; PACKET]) -> Option<Self> {
        let rows = Rows::<S>::new(rays);
        let outline = rows.extremes().outline()?;
        let [ox, oy, oz, t_min] = S::transpose(rows.starts);
        let [dx, dy, dz, t_max] = S::transpose(rows.ways);
        Some(Self { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max, outline })
    }

    /// A bit for each of the rays that have about the direction of the first; the others, and numbers that are none, would
    /// make a packet of them impossible.
    #[inline(always)]
    pub(crate) fn similar_to_first(rays: &[Ray; PACKET]) -> u32 {
        let rows = Rows::<S>::new(rays);
        let [ox, oy, oz, t_min] = S::transpose(rows.starts);
        let [dx, dy, dz, t_max] = S::transpose(rows.ways);
        let d = rays[0].direction.to_array();
        let far = S::F16::splat(0.5 * SPREAD * d[0].abs().max(d[1].abs()).max(d[2].abs()));
        let numbers = ordered(ox) & ordered(oy) & ordered(oz) & ordered(t_min) & ordered(t_max);
        let similar = similar(dx, d[0], far) & similar(dy, d[1], far) & similar(dz, d[2], far);
        (numbers & similar).bits()
    }

    /// What each ray tests boxes with.
    #[inline(always)]
    fn slabs(&self) -> Slabs<S> {
        let mut slabs = Slabs([[S::F16::splat(0.0); 4]; 3]);
        for axis in 0..3 {
            // All directions have one sign on this axis.
            let least = self.direction[axis].abs().max(S::F16::splat(LEAST));
            let inv = S::F16::splat(side(self.outline.near[axis])) / least;
            let offset = self.origin[axis] * inv;
            let slack = offset.abs() * S::F16::splat(ABSOLUTE);
            let relative = S::F16::splat(RELATIVE);
            slabs.0[axis] = [inv, offset + slack, inv * relative, (offset - slack) * relative];
        }
        slabs
    }

    /// A bit for each ray that meets one box before its end.
    #[inline(always)]
    fn intersect_box(&self, slabs: &Slabs<S>, node: &Node, slot: usize, ends: S::F16) -> u32 {
        let mut enter = self.t_min;
        let mut leave = ends * S::F16::splat(TIE_SCALE);
        for axis in 0..3 {
            let [near_inv, near_offset, far_inv, far_offset] = slabs.0[axis];
            let near = S::F16::splat(node.planes[axis][self.outline.near[axis]][slot]);
            let far = S::F16::splat(node.planes[axis][self.outline.near[axis] ^ 1][slot]);
            enter = near.mul_sub(near_inv, near_offset).max(enter);
            leave = far.mul_sub(far_inv, far_offset).min(leave);
        }
        enter.less_or_equal(leave).bits()
    }
}

/// The sign of a direction, by the side of a slab that is entered first.
#[inline(always)]
fn side(near: usize) -> f32 {
    if near == 0 { 1.0 } else { -1.0 }
}

/// Every fourth ray's origin and beginning.
#[inline(always)]
fn starts<S: Simd>(rays: &[Ray; PACKET], first: usize) -> S::F16 {
    S::join([
        start::<S>(&rays[first]),
        start::<S>(&rays[first + 4]),
        start::<S>(&rays[first + 8]),
        start::<S>(&rays[first + 12]),
    ])
}

#[inline(always)]
fn start<S: Simd>(ray: &Ray) -> S::F4 {
    let o = ray.origin;
    S::F4::load(&[o.x, o.y, o.z, ray.t_min])
}

/// Every fourth ray's direction and end.
#[inline(always)]
fn ways<S: Simd>(rays: &[Ray; PACKET], first: usize) -> S::F16 {
    S::join([
        way::<S>(&rays[first]),
        way::<S>(&rays[first + 4]),
        way::<S>(&rays[first + 8]),
        way::<S>(&rays[first + 12]),
    ])
}

#[inline(always)]
fn way<S: Simd>(ray: &Ray) -> S::F4 {
    let d = ray.direction;
    S::F4::load(&[d.x, d.y, d.z, ray.t_max])
}

/// The least of four quads.
#[inline(always)]
fn least_quad<S: Simd>(row: S::F16) -> S::F4 {
    let [a, b, c, d] = S::quads(row);
    a.min(b).min(c.min(d))
}

/// The largest of four quads.
#[inline(always)]
fn largest_quad<S: Simd>(row: S::F16) -> S::F4 {
    let [a, b, c, d] = S::quads(row);
    a.max(b).max(c.max(d))
}

/// Where components of directions have the sign of one and are not far from it.
#[inline(always)]
fn similar<F: Floats<PACKET>>(d: F, one: f32, far: F) -> F::Mask {
    let same_sign = F::splat(0.0).less_or_equal(d * F::splat(if one < 0.0 { -1.0 } else { 1.0 }));
    same_sign & (d - F::splat(one)).abs().less_or_equal(far)
}

/// Where there is no NaN.
#[inline(always)]
fn ordered<F: Floats<PACKET>>(x: F) -> F::Mask {
    x.less_or_equal(x)
}

/// Nodes from which a walk waits for memory: those of a megabyte.
const MANY: usize = 4096;

impl Bvh8 {
    /// Whether some of the rays may meet anything at all.
    #[inline(always)]
    pub(crate) fn is_met_by<S: Simd>(&self, rays: &Outline<S>) -> bool {
        self.nodes.first().is_some_and(|root| rays.intersect(&root.planes, f32::INFINITY).1 != 0)
    }

    /// Visits the leaves that rays of a packet may meet, nearest first.
    #[inline(always)]
    pub(crate) fn walk_packet<S: Simd>(&self, packet: &Packet<S>, visitor: &mut impl VisitPacket<S>) {
        if self.nodes.is_empty() {
            return;
        }
        let slabs = packet.slabs();
        let waits = self.nodes.len() > MANY;
        let mut t_max = latest::<S>(visitor.ends());
        let mut stack = Stack::new();
        let mut current = 0;
        loop {
            let node = &self.nodes[current as usize];
            let (enter, mask) = packet.outline.intersect(&node.planes, t_max);
            push_children(current, enter.to_array(), mask, &mut stack);
            if waits {
                for slot in lanes(mask) {
                    let child = node.children[slot % WIDTH];
                    if child & LEAF == 0 {
                        S::prefetch(&self.nodes[child as usize]);
                    } else {
                        visitor.expect(((child & !LEAF) >> COUNT_BITS) as usize);
                    }
                }
            }
            current = loop {
                let Some(entry) = stack.pop() else { return };
                // Also stops when no ray wants more: then the latest end is below zero.
                if f32::from_bits((entry >> 32) as u32) > t_max {
                    continue;
                }
                let (parent, slot) = (&self.nodes[entry as u32 as usize / WIDTH], entry as usize % WIDTH);
                let active = packet.intersect_box(&slabs, parent, slot, visitor.ends());
                if active == 0 {
                    continue;
                }
                let child = parent.children[slot];
                if child & LEAF == 0 {
                    break child;
                }
                let first = ((child & !LEAF) >> COUNT_BITS) as usize;
                visitor.visit(packet, first, (child & ((1 << COUNT_BITS) - 1)) as usize, active, t_max);
                t_max = latest::<S>(visitor.ends());
            };
        }
    }
}

/// Beyond the last end, nothing matters to any ray.
#[inline(always)]
fn latest<S: Simd>(ends: S::F16) -> f32 {
    let [a, b, c, d] = largest_quad::<S>(ends).to_array();
    a.max(b).max(c.max(d)) * TIE_SCALE
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

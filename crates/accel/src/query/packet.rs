//! Sixteen rays of about one direction at once.

use std::marker::PhantomData;

use aureole_math::Ray;

use super::{Candidate, ClosestOne, OccludedOne, any_object, closest_after_objects, is_accepted};
use crate::bvh::{Bvh8, Outline, PACKET, Packet, VisitPacket};
use crate::index::Index;
use crate::simd::{self, Floats, Mask, Simd, lanes};
use crate::triangle::{Block, Hits, LANES, TriangleTest};
use crate::{Hit, UserShapes, World};

/// Packets that are first looked at together.
const PACKETS: usize = 4;
/// Rays that are first looked at together.
pub(super) const GROUP: usize = PACKETS * PACKET;
/// Of sixteen rays that do not belong together, how many of about one direction are worth a packet.
const WORTH_IT: u32 = 6;

/// The nearest hits of up to [`GROUP`] rays.
#[inline(always)]
pub(super) fn closest_of<S: Simd, T: TriangleTest, U: UserShapes>(
    world: &World,
    rays: &[Ray],
    hits: &mut [Hit],
    user: &U,
) {
    if all_miss::<S>(world, rays) {
        hits.fill(Hit::NONE);
        closest_objects_of::<T, U>(world, rays, hits, user);
        return;
    }
    for (rays, hits) in rays.chunks(PACKET).zip(hits.chunks_mut(PACKET)) {
        let mut alone = u32::MAX;
        let mut copies = None;
        if let Some(together) = Together::<S>::new(world, rays, &mut copies) {
            alone = together.alone;
            hits.fill(Hit::NONE);
            if together.bvh.is_met_by(&together.packet.outline) {
                let packet = &together.packet;
                let mut search = Search::<U, T, false>::new(world, user, together.rays, packet);
                together.bvh.walk_packet(packet, &mut search);
                let hit = S::F16::load(&search.t).less(packet.t_max).bits();
                for i in lanes(hit) {
                    let i = i % PACKET;
                    hits[i] = search.candidate(i).hit(world);
                }
            }
            if alone == 0 {
                closest_objects_of::<T, U>(world, rays, hits, user);
                continue;
            }
        }
        for (i, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            if alone >> i & 1 == 1 {
                *hit = simd::run(ClosestOne::<U, T>(world, ray, user, PhantomData));
            } else if world.has_others() {
                *hit = closest_after_objects::<T, U>(world, ray, *hit, user);
            }
        }
    }
}

/// The nearest of hits and those with everything else.
#[inline(always)]
fn closest_objects_of<T: TriangleTest, U: UserShapes>(
    world: &World,
    rays: &[Ray],
    hits: &mut [Hit],
    user: &U,
) {
    if world.has_others() {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = closest_after_objects::<T, U>(world, ray, *hit, user);
        }
    }
}

/// Whether each of up to [`GROUP`] rays hits anything.
#[inline(always)]
pub(super) fn any_of<S: Simd, T: TriangleTest, U: UserShapes>(
    world: &World,
    rays: &[Ray],
    blocked: &mut [bool],
    user: &U,
) {
    if all_miss::<S>(world, rays) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = any_object::<T, U>(world, ray, user);
        }
        return;
    }
    for (rays, blocked) in rays.chunks(PACKET).zip(blocked.chunks_mut(PACKET)) {
        let (mut alone, mut bits) = (u32::MAX, 0);
        let mut copies = None;
        if let Some(together) = Together::<S>::new(world, rays, &mut copies) {
            alone = together.alone;
            if together.bvh.is_met_by(&together.packet.outline) {
                let mut search = Search::<U, T, true>::new(world, user, together.rays, &together.packet);
                together.bvh.walk_packet(&together.packet, &mut search);
                bits = search.blocked;
            }
        }
        for (i, (ray, blocked)) in rays.iter().zip(blocked).enumerate() {
            *blocked = if alone >> i & 1 == 1 {
                simd::run(OccludedOne::<U, T>(world, ray, user, PhantomData))
            } else {
                bits >> i & 1 == 1 || any_object::<T, U>(world, ray, user)
            };
        }
    }
}

/// Whether it is plain at once that no ray of a group hits a triangle.
#[inline(always)]
fn all_miss<S: Simd>(world: &World, rays: &[Ray]) -> bool {
    let Index::Wide(bvh) = &world.triangles else { return false };
    let (packets, rest) = rays.as_chunks::<PACKET>();
    packets.len() > 1
        && rest.is_empty()
        && Outline::<S>::around(packets).is_some_and(|outline| !bvh.is_met_by(&outline))
}

/// Rays of about one direction, and a hierarchy that can be walked with all of them.
struct Together<'a, S: Simd> {
    bvh: &'a Bvh8,
    rays: &'a [Ray; PACKET],
    packet: Packet<S>,
    /// A bit for each ray that has another direction: the first one stands in its place.
    alone: u32,
}

impl<'a, S: Simd> Together<'a, S> {
    /// `copies` is where the rays are put together, if some do not fit in.
    #[inline(always)]
    fn new(world: &'a World, rays: &'a [Ray], copies: &'a mut Option<[Ray; PACKET]>) -> Option<Self> {
        let (Index::Wide(bvh), Ok(rays)) = (&world.triangles, <&[Ray; PACKET]>::try_from(rays)) else {
            return None;
        };
        if let Some(packet) = Packet::new(rays) {
            return Some(Self { bvh, rays, packet, alone: 0 });
        }
        let similar = Packet::<S>::similar_to_first(rays);
        if similar.count_ones() < WORTH_IT {
            return None;
        }
        let copies = copies.insert(*rays);
        let alone = 0xffff & !similar;
        for i in lanes(alone) {
            copies[i % PACKET] = copies[0];
        }
        Some(Self { bvh, rays: copies, packet: Packet::new(copies)?, alone })
    }
}

/// The search for the nearest triangles of the rays of a packet, or for any. What is found is kept side by side, as in
/// [`Candidate`].
#[repr(C, align(64))]
struct Search<'a, U, T: TriangleTest, const ANY: bool> {
    /// Also the rays' ends; infinitely negative where nothing more is wanted.
    t: [f32; PACKET],
    u: [f32; PACKET],
    v: [f32; PACKET],
    /// Numbers of triangles, as bits.
    id: [f32; PACKET],
    together: Option<T::Rays>,
    /// A bit for each ray that has hit something.
    blocked: u32,
    world: &'a World,
    user: &'a U,
    rays: &'a [Ray; PACKET],
}

impl<'a, U: UserShapes, T: TriangleTest, const ANY: bool> Search<'a, U, T, ANY> {
    #[inline(always)]
    fn new<S: Simd>(world: &'a World, user: &'a U, rays: &'a [Ray; PACKET], packet: &Packet<S>) -> Self {
        let (zeros, t) = ([0.0; PACKET], packet.t_max.to_array());
        let together = T::together(packet);
        Self { t, u: zeros, v: zeros, id: zeros, together, blocked: 0, world, user, rays }
    }

    #[inline(always)]
    fn candidate(&self, i: usize) -> Candidate {
        Candidate { t: self.t[i], u: self.u[i], v: self.v[i], id: self.id[i].to_bits() }
    }

    /// Takes a hit of a ray, if it is a better one.
    #[inline(always)]
    fn offer(&mut self, i: usize, found: Candidate) {
        let ray = &self.rays[i];
        let is_accepted = || is_accepted(self.world, self.user, &found, ray);
        if ANY {
            if found.t < ray.t_max && is_accepted() {
                self.t[i] = f32::NEG_INFINITY;
                self.blocked |= 1 << i;
            }
        } else if found.beats(&self.candidate(i)) && is_accepted() {
            (self.t[i], self.u[i], self.v[i]) = (found.t, found.u, found.v);
            self.id[i] = f32::from_bits(found.id);
        }
    }

    /// Takes the hits of some rays with one triangle.
    #[inline(always)]
    fn take<S: Simd>(&mut self, mask: u32, hits: Hits<S::F16>, id: u32) {
        let mut left = mask;
        if !U::HAS_FILTER {
            let ends = S::F16::load(&self.t);
            let nearer = hits.t.less(ends).bits() & mask;
            if ANY {
                self.t = S::select(nearer, S::F16::splat(f32::NEG_INFINITY), ends).to_array();
                self.blocked |= nearer;
                return;
            }
            self.t = S::select(nearer, hits.t, ends).to_array();
            self.u = S::select(nearer, hits.u, S::F16::load(&self.u)).to_array();
            self.v = S::select(nearer, hits.v, S::F16::load(&self.v)).to_array();
            let id = S::F16::splat(f32::from_bits(id));
            self.id = S::select(nearer, id, S::F16::load(&self.id)).to_array();
            // Equally near ones are compared by their numbers.
            left &= !nearer;
        }
        if left != 0 {
            let (t, u, v) = (hits.t.to_array(), hits.u.to_array(), hits.v.to_array());
            for i in lanes(left) {
                let i = i % PACKET;
                self.offer(i, Candidate { t: t[i], u: u[i], v: v[i], id });
            }
        }
    }

    #[inline(always)]
    fn test_block<S: Simd>(&mut self, packet: &Packet<S>, block: &Block, active: u32, t_max: f32) {
        let boxes = T::boxes::<S>(block);
        // Unused lanes hold NaN.
        let used = S::F8::load(&boxes[0][0]).less_or_equal(S::F8::load(&boxes[0][1])).bits();
        let met = packet.outline.intersect(&boxes, t_max).1 & used;
        match &self.together {
            // One triangle against all rays, or one ray against all triangles: whatever are fewer.
            Some(_) if met.count_ones() <= active.count_ones() => {
                for lane in lanes(met) {
                    let lane = lane % LANES;
                    let Some(rays) = &self.together else { return };
                    let hits = T::intersect_rays::<S>(rays, packet, block, lane, S::F16::load(&self.t));
                    if hits.mask & active != 0 {
                        self.take::<S>(hits.mask & active, hits, block.ids[lane]);
                    }
                }
            }
            _ if met == 0 => {}
            _ => {
                for i in lanes(active) {
                    let i = i % PACKET;
                    let test = match &self.together {
                        Some(rays) => T::one_of(rays, i, &self.rays[i]),
                        None => T::new(&self.rays[i]),
                    };
                    let hits = test.intersect::<S>(block, self.t[i]);
                    if hits.mask != 0 {
                        let (t, u, v) = (hits.t.to_array(), hits.u.to_array(), hits.v.to_array());
                        for lane in lanes(hits.mask) {
                            let lane = lane % LANES;
                            let id = block.ids[lane];
                            self.offer(i, Candidate { t: t[lane], u: u[lane], v: v[lane], id });
                        }
                    }
                }
            }
        }
    }
}

impl<S: Simd, U: UserShapes, T: TriangleTest, const ANY: bool> VisitPacket<S> for Search<'_, U, T, ANY> {
    #[inline(always)]
    fn ends(&self) -> S::F16 {
        S::F16::load(&self.t)
    }

    #[inline(always)]
    fn expect(&self, first: usize) {
        if let Some(block) = self.world.blocks.peek(first) {
            S::prefetch(block);
        }
    }

    #[inline(always)]
    fn visit(&mut self, packet: &Packet<S>, first: usize, count: usize, active: u32, t_max: f32) {
        for i in first..first + count {
            let mut made = None;
            let block = self.world.blocks.get(i, &mut made);
            self.test_block(packet, block, active, t_max);
        }
    }
}

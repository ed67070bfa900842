//! Answering rays: the walk over triangles, then the one over everything else.
//!
//! All of it insists on being inlined, so that it is compiled as a whole for each instruction set.

mod packet;

use std::marker::PhantomData;

use aureole_math::Ray;

use crate::bvh::{Leaf, VisitLeaf};
use crate::caller::Caller;
use crate::others;
use crate::simd::{self, Floats, Kernel, Simd, lanes};
use crate::triangle::{Block, Fast, LANES, TriangleTest, Watertight};
use crate::{Accuracy, Hit, NO_INSTANCE, UserShapes, World};

/// Defines a query: a kernel for each of the two kinds of callers and triangle tests, compiled here for all callers.
macro_rules! query {
    ($(#[$doc:meta])* $name:ident($($arg:ident: $Arg:ty),*) $(-> $Output:ty)?, $Kernel:ident) => {
        $(#[$doc])*
        #[inline]
        pub(crate) fn $name<U: UserShapes>(world: &World, $($arg: $Arg,)* user: &U) $(-> $Output)? {
            fn by_accuracy<const FILTERS: bool>(world: &World, $($arg: $Arg,)* user: Caller<'_, FILTERS>) $(-> $Output)? {
                match world.accuracy {
                    Accuracy::Watertight => simd::run($Kernel::<_, Watertight>(world, $($arg,)* &user, PhantomData)),
                    Accuracy::Fast => simd::run($Kernel::<_, Fast>(world, $($arg,)* &user, PhantomData)),
                }
            }
            fn plain(world: &World, $($arg: $Arg,)* user: Caller<'_, false>) $(-> $Output)? {
                by_accuracy(world, $($arg,)* user)
            }
            fn filtered(world: &World, $($arg: $Arg,)* user: Caller<'_, true>) $(-> $Output)? {
                by_accuracy(world, $($arg,)* user)
            }
            if U::HAS_FILTER || U::HAS_MASK {
                filtered(world, $($arg,)* Caller::new(user))
            } else {
                plain(world, $($arg,)* Caller::new(user))
            }
        }
    };
}

query!(
    /// The nearest hit of one ray.
    closest_hit(ray: &Ray) -> Hit, ClosestOne
);
query!(
    /// Whether one ray hits anything.
    is_occluded(ray: &Ray) -> bool, OccludedOne
);
query!(
    /// The nearest hits of rays.
    closest_hits(rays: &[Ray], hits: &mut [Hit]), Closest
);
query!(
    /// Whether rays hit anything.
    occluded(rays: &[Ray], blocked: &mut [bool]), Occluded
);

struct ClosestOne<'a, U, T>(&'a World, &'a Ray, &'a U, PhantomData<T>);

impl<U: UserShapes, T: TriangleTest> Kernel for ClosestOne<'_, U, T> {
    type Output = Hit;
    #[inline(always)]
    fn run<S: Simd>(self) -> Hit {
        closest::<S, T, U>(self.0, self.1, self.2)
    }
}

struct OccludedOne<'a, U, T>(&'a World, &'a Ray, &'a U, PhantomData<T>);

impl<U: UserShapes, T: TriangleTest> Kernel for OccludedOne<'_, U, T> {
    type Output = bool;
    #[inline(always)]
    fn run<S: Simd>(self) -> bool {
        any::<S, T, U>(self.0, self.1, self.2)
    }
}

struct Closest<'a, U, T>(&'a World, &'a [Ray], &'a mut [Hit], &'a U, PhantomData<T>);

impl<U: UserShapes, T: TriangleTest> Kernel for Closest<'_, U, T> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self) {
        let Self(world, rays, hits, user, _) = self;
        for (rays, hits) in rays.chunks(packet::GROUP).zip(hits.chunks_mut(packet::GROUP)) {
            packet::closest_of::<S, T, U>(world, rays, hits, user);
        }
    }
}

struct Occluded<'a, U, T>(&'a World, &'a [Ray], &'a mut [bool], &'a U, PhantomData<T>);

impl<U: UserShapes, T: TriangleTest> Kernel for Occluded<'_, U, T> {
    type Output = ();
    #[inline(always)]
    fn run<S: Simd>(self) {
        let Self(world, rays, blocked, user, _) = self;
        for (rays, blocked) in rays.chunks(packet::GROUP).zip(blocked.chunks_mut(packet::GROUP)) {
            packet::any_of::<S, T, U>(world, rays, blocked, user);
        }
    }
}

#[inline(always)]
fn closest<S: Simd, T: TriangleTest, U: UserShapes>(world: &World, ray: &Ray, user: &U) -> Hit {
    let mut best = Hit::NONE;
    if !world.blocks.is_empty() {
        let mut among = NearestTriangle::new(world, user, ray, T::new(ray));
        world.triangles.walk::<S, _>(ray, ray.t_max, &mut among);
        best = among.best();
    }
    if world.has_others() { closest_after_objects::<T, U>(world, ray, best, user) } else { best }
}

/// The nearest of a hit and those with everything else.
#[inline(always)]
fn closest_after_objects<T: TriangleTest, U: UserShapes>(
    world: &World,
    ray: &Ray,
    best: Hit,
    user: &U,
) -> Hit {
    let t = if best.is_some() { best.t } else { ray.t_max };
    let best = others::nearest::<T, U>(world, ray, Hit { t, ..best }, user);
    if best.is_some() { best } else { Hit::NONE }
}

#[inline(always)]
fn any<S: Simd, T: TriangleTest, U: UserShapes>(world: &World, ray: &Ray, user: &U) -> bool {
    let mut triangle = AnyTriangle { world, user, ray, test: T::new(ray), blocked: false };
    world.triangles.walk::<S, _>(ray, ray.t_max, &mut triangle);
    triangle.blocked || any_object::<T, U>(world, ray, user)
}

#[inline(always)]
fn any_object<T: TriangleTest, U: UserShapes>(world: &World, ray: &Ray, user: &U) -> bool {
    world.has_others() && others::any::<T, U>(world, ray, user)
}

/// Whether a hit counts: by the mask of its geometry and the caller's filter.
#[inline(always)]
pub(crate) fn accepts<U: UserShapes>(world: &World, user: &U, hit: &Hit, ray: &Ray) -> bool {
    (!U::HAS_MASK || world.mask_of(hit.geometry) & user.mask() != 0)
        && (!U::HAS_FILTER || user.accept(world.tag, hit, ray))
}

#[inline(always)]
fn is_accepted<U: UserShapes>(world: &World, user: &U, found: &Candidate, ray: &Ray) -> bool {
    !(U::HAS_MASK || U::HAS_FILTER) || accepts(world, user, &found.hit(world), ray)
}

/// A hit with a triangle, by its number in the level.
#[derive(Clone, Copy)]
struct Candidate {
    t: f32,
    u: f32,
    v: f32,
    id: u32,
}

impl Candidate {
    #[inline(always)]
    fn hit(&self, world: &World) -> Hit {
        let (geometry, primitive) = world.triangle_of(self.id);
        Hit { t: self.t, u: self.u, v: self.v, primitive, geometry, instance: NO_INSTANCE }
    }

    /// Which of two hits counts: the nearer one, and of equally near ones that with the smaller number.
    #[inline(always)]
    fn beats(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.id < other.id)
    }
}

/// The search for the nearest triangle. Before one is found, the ray's end stands for it, with a number that no other
/// beats: a hit at the very end does not count.
struct NearestTriangle<'a, U, T> {
    world: &'a World,
    user: &'a U,
    ray: &'a Ray,
    test: T,
    nearest: Candidate,
}

impl<'a, U: UserShapes, T: TriangleTest> NearestTriangle<'a, U, T> {
    #[inline(always)]
    fn new(world: &'a World, user: &'a U, ray: &'a Ray, test: T) -> Self {
        Self { world, user, ray, test, nearest: Candidate { t: ray.t_max, u: 0.0, v: 0.0, id: 0 } }
    }

    #[inline(always)]
    fn test_block<S: Simd>(&mut self, block: &Block) {
        let hits = self.test.intersect::<S>(block, self.nearest.t);
        if hits.mask == 0 {
            return;
        }
        let (t, u, v) = (hits.t.to_array(), hits.u.to_array(), hits.v.to_array());
        for i in lanes(hits.mask) {
            let i = i % LANES;
            self.offer(Candidate { t: t[i], u: u[i], v: v[i], id: block.ids[i] });
        }
    }

    #[inline(always)]
    fn offer(&mut self, found: Candidate) {
        if found.beats(&self.nearest) && is_accepted(self.world, self.user, &found, self.ray) {
            self.nearest = found;
        }
    }

    /// The hit, or none at the ray's end.
    #[inline(always)]
    fn best(&self) -> Hit {
        if self.nearest.t < self.ray.t_max { self.nearest.hit(self.world) } else { Hit::NONE }
    }
}

impl<U: UserShapes, T: TriangleTest> VisitLeaf for NearestTriangle<'_, U, T> {
    const ANY: bool = false;

    #[inline(always)]
    fn visit<S: Simd>(&mut self, first: usize, count: usize) -> Leaf {
        for i in first..first + count {
            let mut made = None;
            let block = self.world.blocks.get(i, &mut made);
            self.test_block::<S>(block);
        }
        Leaf::Continue(self.nearest.t)
    }
}

/// The search for any triangle.
struct AnyTriangle<'a, U, T> {
    world: &'a World,
    user: &'a U,
    ray: &'a Ray,
    test: T,
    blocked: bool,
}

impl<U: UserShapes, T: TriangleTest> VisitLeaf for AnyTriangle<'_, U, T> {
    const ANY: bool = true;

    #[inline(always)]
    fn visit<S: Simd>(&mut self, first: usize, count: usize) -> Leaf {
        for i in first..first + count {
            let mut made = None;
            let block = self.world.blocks.get(i, &mut made);
            let hits = self.test.intersect::<S>(block, self.ray.t_max);
            if hits.mask == 0 {
                continue;
            }
            let (t, u, v) = (hits.t.to_array(), hits.u.to_array(), hits.v.to_array());
            for i in lanes(hits.mask) {
                let i = i % LANES;
                let found = Candidate { t: t[i], u: u[i], v: v[i], id: block.ids[i] };
                if found.t < self.ray.t_max && is_accepted(self.world, self.user, &found, self.ray) {
                    self.blocked = true;
                    return Leaf::Stop;
                }
            }
        }
        Leaf::Continue(self.ray.t_max)
    }
}

#[cfg(test)]
mod tests;

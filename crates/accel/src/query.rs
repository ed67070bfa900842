//! Answering rays: the walk over triangles, then the one over everything else.
//!
//! All of it insists on being inlined, so that it is compiled as a whole for each instruction set.

mod packet;

use std::marker::PhantomData;

use aureole_math::Ray;

use crate::bvh::{Leaf, VisitLeaf};
use crate::caller::Caller;
use crate::simd::{self, Floats, Kernel, Simd, lanes};
use crate::triangle::{Block, Fast, LANES, TriangleTest, Watertight};
use crate::world::Object;
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
            if U::HAS_FILTER {
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
    if world.objects.is_empty() { best } else { closest_after_objects(world, ray, best, user) }
}

#[inline(always)]
fn any<S: Simd, T: TriangleTest, U: UserShapes>(world: &World, ray: &Ray, user: &U) -> bool {
    let mut among = AnyTriangle { world, user, ray, test: T::new(ray), blocked: false };
    world.triangles.walk::<S, _>(ray, ray.t_max, &mut among);
    among.blocked || any_object(world, ray, user)
}

/// The nearest of a hit and those with everything else. Like what else may be called more than once, compiled apart: the
/// code for all structures is long.
#[inline(never)]
fn closest_after_objects<U: UserShapes>(world: &World, ray: &Ray, best: Hit, user: &U) -> Hit {
    simd::run(ClosestAfter(world, ray, best, user))
}

struct ClosestAfter<'a, U>(&'a World, &'a Ray, Hit, &'a U);

impl<U: UserShapes> Kernel for ClosestAfter<'_, U> {
    type Output = Hit;
    #[inline(always)]
    fn run<S: Simd>(self) -> Hit {
        let Self(world, ray, best, user) = self;
        let t = if best.is_some() { best.t } else { ray.t_max };
        let mut among = NearestObject { world, user, ray, best: Hit { t, ..best } };
        world.object_index.walk::<S, _>(ray, t, &mut among);
        if among.best.is_some() { among.best } else { Hit::NONE }
    }
}

#[inline]
fn any_object<U: UserShapes>(world: &World, ray: &Ray, user: &U) -> bool {
    !world.objects.is_empty() && simd::run(AnyOther(world, ray, user))
}

struct AnyOther<'a, U>(&'a World, &'a Ray, &'a U);

impl<U: UserShapes> Kernel for AnyOther<'_, U> {
    type Output = bool;
    #[inline(always)]
    fn run<S: Simd>(self) -> bool {
        let Self(world, ray, user) = self;
        let mut object = AnyObject { world, user, ray, blocked: false };
        world.object_index.walk::<S, _>(ray, ray.t_max, &mut object);
        object.blocked
    }
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
        let is_accepted =
            || !U::HAS_FILTER || self.user.accept(self.world.tag, &found.hit(self.world), self.ray);
        if found.beats(&self.nearest) && is_accepted() {
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
                let is_accepted =
                    || !U::HAS_FILTER || self.user.accept(self.world.tag, &found.hit(self.world), self.ray);
                if found.t < self.ray.t_max && is_accepted() {
                    self.blocked = true;
                    return Leaf::Stop;
                }
            }
        }
        Leaf::Continue(self.ray.t_max)
    }
}

/// The search for the nearest of the other things, after that among triangles.
struct NearestObject<'a, U> {
    world: &'a World,
    user: &'a U,
    ray: &'a Ray,
    best: Hit,
}

impl<U: UserShapes> NearestObject<'_, U> {
    /// Takes a hit when it is nearer than the best one and accepted. The ray's own end does not count as a hit.
    fn offer(&mut self, hit: Hit) {
        let is_accepted = || !U::HAS_FILTER || self.user.accept(self.world.tag, &hit, self.ray);
        if hit.t < self.ray.t_max && hit.beats(&self.best) && is_accepted() {
            self.best = hit;
        }
    }

    fn object(&mut self, object: &Object) {
        // One step beyond the best hit, so that an equally near thing can win by its number.
        let until_best = self.best.t.next_up().min(self.ray.t_max);
        match object {
            Object::User { geometry, primitive } | Object::Ball { geometry, primitive } => {
                let (geometry, primitive) = (*geometry, *primitive);
                let ray = self.ray.until(until_best);
                if let Some(found) = self.user.intersect(self.world.tag, geometry, primitive, &ray) {
                    let (t, u, v) = (found.t, found.u, found.v);
                    self.offer(Hit { t, u, v, primitive, geometry, instance: NO_INSTANCE });
                }
            }
            Object::Instance { geometry, level, object_from_world } => {
                let local = object_from_world.ray(self.ray).until(until_best);
                if let Some(inner) = level.closest_hit(&local, self.user) {
                    let hit = Hit { instance: *geometry, ..inner };
                    if hit.beats(&self.best) {
                        self.best = hit;
                    }
                }
            }
        }
    }
}

impl<U: UserShapes> VisitLeaf for NearestObject<'_, U> {
    const ANY: bool = false;

    #[inline(always)]
    fn visit<S: Simd>(&mut self, first: usize, count: usize) -> Leaf {
        for object in &self.world.objects[first..first + count] {
            self.object(object);
        }
        Leaf::Continue(self.best.t)
    }
}

/// The search for any of the other things.
struct AnyObject<'a, U> {
    world: &'a World,
    user: &'a U,
    ray: &'a Ray,
    blocked: bool,
}

impl<U: UserShapes> AnyObject<'_, U> {
    fn object(&self, object: &Object) -> bool {
        let (ray, user, level_tag) = (self.ray, self.user, self.world.tag);
        match object {
            Object::User { geometry, primitive } | Object::Ball { geometry, primitive } => {
                let (geometry, primitive) = (*geometry, *primitive);
                user.intersect(level_tag, geometry, primitive, ray).is_some_and(|found| {
                    let (t, u, v) = (found.t, found.u, found.v);
                    let hit = Hit { t, u, v, primitive, geometry, instance: NO_INSTANCE };
                    t < ray.t_max && (!U::HAS_FILTER || user.accept(level_tag, &hit, ray))
                })
            }
            Object::Instance { level, object_from_world, .. } => {
                level.occluded(&object_from_world.ray(ray), user)
            }
        }
    }
}

impl<U: UserShapes> VisitLeaf for AnyObject<'_, U> {
    const ANY: bool = true;

    #[inline(always)]
    fn visit<S: Simd>(&mut self, first: usize, count: usize) -> Leaf {
        self.blocked = self.world.objects[first..first + count].iter().any(|object| self.object(object));
        if self.blocked { Leaf::Stop } else { Leaf::Continue(self.ray.t_max) }
    }
}

#[cfg(test)]
mod tests;

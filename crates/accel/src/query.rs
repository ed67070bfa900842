//! Answering rays: the walk over triangles, then the one over everything else.
//!
//! All of it insists on being inlined, so that it is compiled as a whole for each instruction set.

use aureole_math::Ray;

use crate::bvh::{Bvh8, Leaf, Stack, TraversalRay, VisitLeaf};
use crate::simd::Kernel;
use crate::triangle::{self, ShearedRay};
use crate::world::Object;
use crate::{Hit, NO_INSTANCE, Structure, UserShapes, World};

/// The nearest hits of rays.
pub(crate) struct Closest<'a, U> {
    pub world: &'a World,
    pub rays: &'a [Ray],
    pub hits: &'a mut [Hit],
    pub user: &'a U,
}

/// Whether rays hit anything.
pub(crate) struct Occluded<'a, U> {
    pub world: &'a World,
    pub rays: &'a [Ray],
    pub blocked: &'a mut [bool],
    pub user: &'a U,
}

impl<U: UserShapes> Kernel for Closest<'_, U> {
    #[inline(always)]
    fn run(self) {
        let mut stack = Stack::default();
        for (ray, hit) in self.rays.iter().zip(self.hits) {
            let best = Hit { t: ray.t_max, ..Hit::NONE };
            let mut nearest =
                Nearest { world: self.world, user: self.user, ray, sheared: ShearedRay::new(ray), best };
            nearest.search(&mut stack);
            *hit = if nearest.best.is_some() { nearest.best } else { Hit::NONE };
        }
    }
}

impl<U: UserShapes> Kernel for Occluded<'_, U> {
    #[inline(always)]
    fn run(self) {
        let mut stack = Stack::default();
        for (ray, blocked) in self.rays.iter().zip(self.blocked) {
            let sheared = ShearedRay::new(ray);
            let mut any = Any { world: self.world, user: self.user, ray, sheared, blocked: false };
            any.search(&mut stack);
            *blocked = any.blocked;
        }
    }
}

/// Visits the leaves of a hierarchy that a ray may meet, or all of them for the list.
#[inline(always)]
fn walk(
    world: &World,
    bvh: &Bvh8,
    count: usize,
    ray: &TraversalRay,
    t_max: f32,
    stack: &mut Stack,
    visitor: &mut impl VisitLeaf,
) {
    if world.structure == Structure::List {
        visitor.visit(0, count);
    } else {
        bvh.walk(ray, t_max, stack, visitor);
    }
}

/// The search for the nearest hit of one ray.
struct Nearest<'a, U> {
    world: &'a World,
    user: &'a U,
    ray: &'a Ray,
    sheared: ShearedRay,
    best: Hit,
}

/// The part of a search that is among triangles.
struct AmongTriangles<'s, S>(&'s mut S);
/// The part of a search that is among everything else.
struct AmongObjects<'s, S>(&'s mut S);

impl<U: UserShapes> Nearest<'_, U> {
    #[inline(always)]
    fn search(&mut self, stack: &mut Stack) {
        let world = self.world;
        let ray = TraversalRay::new(self.ray);
        let t_max = self.best.t;
        walk(world, &world.triangles, world.blocks.len(), &ray, t_max, stack, &mut AmongTriangles(self));
        if !world.objects.is_empty() {
            let t_max = self.best.t;
            walk(world, &world.objects_bvh, world.objects.len(), &ray, t_max, stack, &mut AmongObjects(self));
        }
    }

    /// Takes a hit when it is nearer than the best one and accepted. The ray's own end does not count as a hit.
    #[inline(always)]
    fn offer(&mut self, hit: Hit) {
        let inside = hit.t < self.ray.t_max;
        let is_accepted = || !U::HAS_FILTER || self.user.accept(self.world.tag, &hit, self.ray);
        if inside && hit.beats(&self.best) && is_accepted() {
            self.best = hit;
        }
    }

    fn object(&mut self, object: &Object) {
        match object {
            Object::User { geometry, primitive } => {
                let (geometry, primitive) = (*geometry, *primitive);
                // One step beyond the best hit, so that an equally near shape can win by its number.
                let ray_to_best = self.ray.until(self.best.t.next_up().min(self.ray.t_max));
                if let Some(found) = self.user.intersect(self.world.tag, geometry, primitive, &ray_to_best) {
                    let (t, u, v) = (found.t, found.u, found.v);
                    self.offer(Hit { t, u, v, primitive, geometry, instance: NO_INSTANCE });
                }
            }
            Object::Instance { geometry, level, object_from_world } => {
                let local = object_from_world.ray(self.ray).until(self.best.t.next_up().min(self.ray.t_max));
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

impl<U: UserShapes> VisitLeaf for AmongTriangles<'_, Nearest<'_, U>> {
    #[inline(always)]
    fn visit(&mut self, first: usize, count: usize) -> Leaf {
        for block in &self.0.world.blocks[first..first + count] {
            let (sheared, t_max) = (self.0.sheared, self.0.best.t);
            triangle::intersect(block, &sheared, t_max, |hit| self.0.offer(block.hit(&hit)));
        }
        Leaf::Continue(self.0.best.t)
    }
}

impl<U: UserShapes> VisitLeaf for AmongObjects<'_, Nearest<'_, U>> {
    #[inline(always)]
    fn visit(&mut self, first: usize, count: usize) -> Leaf {
        for object in &self.0.world.objects[first..first + count] {
            self.0.object(object);
        }
        Leaf::Continue(self.0.best.t)
    }
}

/// The search for any hit of one ray.
struct Any<'a, U> {
    world: &'a World,
    user: &'a U,
    ray: &'a Ray,
    sheared: ShearedRay,
    blocked: bool,
}

impl<U: UserShapes> Any<'_, U> {
    #[inline(always)]
    fn search(&mut self, stack: &mut Stack) {
        let world = self.world;
        let ray = TraversalRay::new(self.ray);
        let t_max = self.ray.t_max;
        walk(world, &world.triangles, world.blocks.len(), &ray, t_max, stack, &mut AmongTriangles(self));
        if !self.blocked && !world.objects.is_empty() {
            walk(world, &world.objects_bvh, world.objects.len(), &ray, t_max, stack, &mut AmongObjects(self));
        }
    }

    #[inline(always)]
    fn found(&mut self, hit: Hit) {
        let is_accepted = || !U::HAS_FILTER || self.user.accept(self.world.tag, &hit, self.ray);
        self.blocked |= hit.t < self.ray.t_max && is_accepted();
    }

    #[inline(always)]
    fn verdict(&self) -> Leaf {
        if self.blocked { Leaf::Stop } else { Leaf::Continue(self.ray.t_max) }
    }

    fn object(&mut self, object: &Object) {
        match object {
            Object::User { geometry, primitive } => {
                let (geometry, primitive) = (*geometry, *primitive);
                if let Some(found) = self.user.intersect(self.world.tag, geometry, primitive, self.ray) {
                    let (t, u, v) = (found.t, found.u, found.v);
                    self.found(Hit { t, u, v, primitive, geometry, instance: NO_INSTANCE });
                }
            }
            Object::Instance { level, object_from_world, .. } => {
                self.blocked |= level.occluded(&object_from_world.ray(self.ray), self.user);
            }
        }
    }
}

impl<U: UserShapes> VisitLeaf for AmongTriangles<'_, Any<'_, U>> {
    #[inline(always)]
    fn visit(&mut self, first: usize, count: usize) -> Leaf {
        for block in &self.0.world.blocks[first..first + count] {
            let (sheared, t_max) = (self.0.sheared, self.0.ray.t_max);
            triangle::intersect(block, &sheared, t_max, |hit| self.0.found(block.hit(&hit)));
        }
        self.0.verdict()
    }
}

impl<U: UserShapes> VisitLeaf for AmongObjects<'_, Any<'_, U>> {
    #[inline(always)]
    fn visit(&mut self, first: usize, count: usize) -> Leaf {
        for object in &self.0.world.objects[first..first + count] {
            self.0.object(object);
        }
        self.0.verdict()
    }
}

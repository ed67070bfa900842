//! Answering rays among everything but triangles at rest: moving ones, user shapes and instances.
//!
//! What is called here for each leaf is so much that the walk to it may be compiled once, for all kinds of user shapes.

use aureole_math::Ray;

use crate::bvh::Leaf;
use crate::query::accepts;
use crate::triangle::TriangleTest;
use crate::world::Object;
use crate::{Hit, NO_INSTANCE, UserShapes, World};

/// The nearest hit of a ray, after that among triangles at rest.
#[inline(never)]
pub(crate) fn nearest<T: TriangleTest, U: UserShapes>(world: &World, ray: &Ray, best: Hit, user: &U) -> Hit {
    let mut search = Search { world, user, ray, best };
    if !world.moving.is_empty() {
        search.moving(&T::new(ray), false);
    }
    if !world.objects.is_empty() {
        let t_max = search.best.t;
        world.object_index.walk_aside(ray, t_max, false, &mut |first, count| {
            for object in &world.objects[first..first + count] {
                search.object(object);
            }
            Leaf::Continue(search.best.t)
        });
    }
    search.best
}

/// Whether a ray hits anything.
#[inline(never)]
pub(crate) fn any<T: TriangleTest, U: UserShapes>(world: &World, ray: &Ray, user: &U) -> bool {
    let mut search = Search { world, user, ray, best: Hit { t: ray.t_max, ..Hit::NONE } };
    if !world.moving.is_empty() {
        search.moving(&T::new(ray), true);
    }
    let mut is_blocked = search.best.is_some();
    if !is_blocked && !world.objects.is_empty() {
        world.object_index.walk_aside(ray, ray.t_max, true, &mut |first, count| {
            is_blocked =
                world.objects[first..first + count].iter().any(|object| search.is_blocked_by(object));
            if is_blocked { Leaf::Stop } else { Leaf::Continue(ray.t_max) }
        });
    }
    is_blocked
}

struct Search<'a, U> {
    world: &'a World,
    user: &'a U,
    ray: &'a Ray,
    best: Hit,
}

impl<U: UserShapes> Search<'_, U> {
    /// Takes a hit when it is nearer than the best one and accepted. The ray's own end does not count as a hit.
    fn offer(&mut self, hit: Hit) -> bool {
        let counts =
            hit.t < self.ray.t_max && hit.beats(&self.best) && accepts(self.world, self.user, &hit, self.ray);
        if counts {
            self.best = hit;
        }
        counts
    }

    /// Moving triangles; `any` of them will do.
    fn moving<T: TriangleTest>(&mut self, test: &T, any: bool) {
        let (world, ray) = (self.world, self.ray);
        for moving in &world.moving {
            let Some((interval, share)) = moving.at(ray.time) else { continue };
            interval.index.walk_aside(ray, self.best.t, any, &mut |first, count| {
                for block in &interval.blocks[first..first + count] {
                    let hits = test.intersect_moving(block, share, self.best.t);
                    for i in crate::simd::lanes(hits.mask) {
                        let hit = moving.hit(hits.t[i], hits.u[i], hits.v[i], block.ids[i]);
                        if self.offer(hit) && any {
                            return Leaf::Stop;
                        }
                    }
                }
                Leaf::Continue(self.best.t)
            });
            if any && self.best.is_some() {
                return;
            }
        }
    }

    fn is_hidden(&self, object: &Object) -> bool {
        U::HAS_MASK && self.world.mask_of(object.geometry()) & self.user.mask() == 0
    }

    fn object(&mut self, object: &Object) {
        if self.is_hidden(object) {
            return;
        }
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
                self.instance(*geometry, level, &object_from_world.ray(self.ray).until(until_best));
            }
            Object::MovingInstance { geometry, level, world_from_object } => {
                let object_from_world = world_from_object.at(self.ray.time).inverse();
                self.instance(*geometry, level, &object_from_world.ray(self.ray).until(until_best));
            }
        }
    }

    fn instance(&mut self, geometry: u32, level: &World, local: &Ray) {
        if let Some(inner) = level.closest_hit(local, self.user) {
            let hit = Hit { instance: geometry, ..inner };
            if hit.beats(&self.best) {
                self.best = hit;
            }
        }
    }

    fn is_blocked_by(&self, object: &Object) -> bool {
        let (ray, user, level_tag) = (self.ray, self.user, self.world.tag);
        if self.is_hidden(object) {
            return false;
        }
        match object {
            Object::User { geometry, primitive } | Object::Ball { geometry, primitive } => {
                let (geometry, primitive) = (*geometry, *primitive);
                user.intersect(level_tag, geometry, primitive, ray).is_some_and(|found| {
                    let (t, u, v) = (found.t, found.u, found.v);
                    let hit = Hit { t, u, v, primitive, geometry, instance: NO_INSTANCE };
                    t < ray.t_max && accepts(self.world, user, &hit, ray)
                })
            }
            Object::Instance { level, object_from_world, .. } => {
                level.occluded(&object_from_world.ray(ray), user)
            }
            Object::MovingInstance { level, world_from_object, .. } => {
                level.occluded(&world_from_object.at(ray.time).inverse().ray(ray), user)
            }
        }
    }
}

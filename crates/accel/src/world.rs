//! Worlds: geometries in one hierarchy for triangles and one for everything else.

use std::sync::Arc;

use aureole_math::{Bounds3, Point3, Ray, Transform};

use crate::bvh::{Bvh8, Leaf, Stack, Stats, TraversalRay, build};
use crate::triangle::{self, Block, LANES, ShearedRay};
use crate::{AccelError, Config, Geometry, Hit, NO_INSTANCE, Structure, UserShapes};

/// Something that is not a triangle.
#[derive(Clone, Debug)]
enum Object {
    User { geometry: u32, primitive: u32 },
    Instance { geometry: u32, level: Arc<World>, object_from_world: Transform },
}

/// Geometries ready for rays.
#[derive(Clone, Debug)]
pub struct World {
    tag: u32,
    bounds: Bounds3,
    triangles: Bvh8,
    blocks: Vec<Block>,
    objects_bvh: Bvh8,
    objects: Vec<Object>,
    structure: Structure,
}

impl World {
    /// Builds a world; `tag` tells levels apart in [`UserShapes`]' methods.
    ///
    /// # Errors
    /// Vertices or boxes that are not finite, indices out of range, or more than 2²⁷ leaves.
    pub fn build(geometries: Vec<Geometry>, tag: u32, config: &Config) -> Result<Self, AccelError> {
        let mut world = Self {
            tag,
            bounds: Bounds3::EMPTY,
            triangles: Bvh8::default(),
            blocks: Vec::new(),
            objects_bvh: Bvh8::default(),
            objects: Vec::new(),
            structure: config.structure,
        };
        world.build_triangles(&geometries, config)?;
        world.build_objects(geometries, config)?;
        Ok(world)
    }

    fn build_triangles(&mut self, geometries: &[Geometry], config: &Config) -> Result<(), AccelError> {
        let mut ids: Vec<[u32; 2]> = Vec::new();
        let mut boxes = Vec::new();
        for (g, geometry) in geometries.iter().enumerate() {
            let Geometry::Triangles { positions, indices } = geometry else { continue };
            check_mesh(g, positions, indices)?;
            boxes.extend(
                indices.iter().map(|t| Bounds3::around(t.map(|i| Point3::from(positions[i as usize])))),
            );
            ids.extend((0..indices.len() as u32).map(|p| [g as u32, p]));
        }
        if boxes.len() >= 1 << 28 {
            return Err(AccelError::TooMany(boxes.len() as u64));
        }
        self.bounds = boxes.iter().fold(self.bounds, |b, other| b.union(*other));
        let mut blocks = Vec::new();
        let vertices = |[g, p]: [u32; 2]| match &geometries[g as usize] {
            Geometry::Triangles { positions, indices } => indices[p as usize].map(|i| positions[i as usize]),
            _ => [[f32::NAN; 3]; 3],
        };
        let mut pack = |items: &[u32]| {
            let first = blocks.len() as u32;
            for group in items.chunks(LANES) {
                let mut block = Block::EMPTY;
                for (lane, &item) in group.iter().enumerate() {
                    let id = ids[item as usize];
                    block.set(lane, vertices(id), id[0], id[1]);
                }
                blocks.push(block);
            }
            (first, blocks.len() as u32 - first)
        };
        self.triangles = build(&boxes, config, &mut pack, size_of::<Block>() / LANES);
        self.blocks = blocks;
        Ok(())
    }

    fn build_objects(&mut self, geometries: Vec<Geometry>, config: &Config) -> Result<(), AccelError> {
        let mut boxes = Vec::new();
        let mut all = Vec::new();
        for (g, geometry) in geometries.into_iter().enumerate() {
            let geometry_id = g as u32;
            match geometry {
                Geometry::Triangles { .. } => {}
                Geometry::User(list) => {
                    let broken = list.iter().filter(|b| !b.min.is_finite() || !b.max.is_finite()).count();
                    if broken > 0 {
                        return Err(AccelError::NonFinite { geometry: g, count: broken });
                    }
                    all.extend(
                        (0..list.len() as u32)
                            .map(|primitive| Object::User { geometry: geometry_id, primitive }),
                    );
                    boxes.extend(list);
                }
                Geometry::Instance { level, world_from_object } => {
                    let bounds = world_from_object.bounds(&level.bounds);
                    if bounds.is_empty() {
                        continue;
                    }
                    if !(bounds.min.is_finite() && bounds.max.is_finite()) {
                        return Err(AccelError::NonFinite { geometry: g, count: 1 });
                    }
                    boxes.push(bounds);
                    let object_from_world = world_from_object.inverse();
                    all.push(Object::Instance { geometry: geometry_id, level, object_from_world });
                }
            }
        }
        self.bounds = boxes.iter().fold(self.bounds, |b, other| b.union(*other));
        let mut order = Vec::new();
        let mut pack = |items: &[u32]| {
            let first = order.len() as u32;
            order.extend_from_slice(items);
            (first, items.len() as u32)
        };
        let config = Config { max_leaf_size: 2, ..*config };
        self.objects_bvh = build(&boxes, &config, &mut pack, size_of::<Object>());
        self.objects = order.into_iter().map(|i| all[i as usize].clone()).collect();
        Ok(())
    }

    /// The box around everything.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Figures about the hierarchies of this level.
    pub fn stats(&self) -> Stats {
        self.triangles.stats.merged(self.objects_bvh.stats)
    }

    /// The nearest hit of a ray in `(t_min, t_max)`.
    #[inline]
    pub fn closest_hit<U: UserShapes>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        let hit = self.nearest(ray, user, &mut Stack::default());
        hit.is_some().then_some(hit)
    }

    /// The nearest hit, or [`Hit::NONE`].
    #[inline]
    fn nearest<U: UserShapes>(&self, ray: &Ray, user: &U, stack: &mut Stack) -> Hit {
        let mut best = Hit { t: ray.t_max, ..Hit::NONE };
        self.closest(ray, user, stack, &mut best);
        if best.is_some() { best } else { Hit::NONE }
    }

    /// Whether anything lies on the ray in `(t_min, t_max)`.
    #[inline]
    pub fn occluded<U: UserShapes>(&self, ray: &Ray, user: &U) -> bool {
        self.blocked(ray, user, &mut Stack::default())
    }

    fn blocked<U: UserShapes>(&self, ray: &Ray, user: &U, stack: &mut Stack) -> bool {
        let mut blocked = false;
        let sheared = ShearedRay::new(ray);
        let walk = TraversalRay::new(ray);
        self.each_block(&walk, ray.t_max, stack, |blocks| {
            for block in blocks {
                triangle::intersect(block, &sheared, ray.t_max, |hit| {
                    blocked |=
                        hit.t < ray.t_max && (!U::HAS_FILTER || user.accept(self.tag, &block.hit(&hit), ray));
                });
            }
            if blocked { Leaf::Stop } else { Leaf::Continue(ray.t_max) }
        });
        if blocked || self.objects.is_empty() {
            return blocked;
        }
        self.each_object(&walk, ray.t_max, stack, |objects| {
            blocked |= objects.iter().any(|object| self.object_blocks(object, ray, user));
            if blocked { Leaf::Stop } else { Leaf::Continue(ray.t_max) }
        });
        blocked
    }

    /// [`closest_hit`](Self::closest_hit) for many rays; [`Hit::NONE`] where there is none.
    pub fn closest_hits<U: UserShapes>(&self, rays: &[Ray], hits: &mut [Hit], user: &U) {
        let mut stack = Stack::default();
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.nearest(ray, user, &mut stack);
        }
    }

    /// [`occluded`](Self::occluded) for many rays.
    pub fn occluded_many<U: UserShapes>(&self, rays: &[Ray], blocked: &mut [bool], user: &U) {
        let mut stack = Stack::default();
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.blocked(ray, user, &mut stack);
        }
    }

    fn closest<U: UserShapes>(&self, ray: &Ray, user: &U, stack: &mut Stack, best: &mut Hit) {
        let sheared = ShearedRay::new(ray);
        let walk = TraversalRay::new(ray);
        let t_max = best.t;
        self.each_block(&walk, t_max, stack, |blocks| {
            for block in blocks {
                let limit = best.t;
                triangle::intersect(block, &sheared, limit, |hit| {
                    let hit = block.hit(&hit);
                    self.offer(hit, ray, user, best);
                });
            }
            Leaf::Continue(best.t)
        });
        if !self.objects.is_empty() {
            let t_max = best.t;
            self.each_object(&walk, t_max, stack, |objects| {
                for object in objects {
                    self.object_closest(object, ray, user, best);
                }
                Leaf::Continue(best.t)
            });
        }
    }

    /// Takes a hit when it is nearer than the best one and accepted. The ray's own end does not count as a hit.
    #[inline]
    fn offer<U: UserShapes>(&self, hit: Hit, ray: &Ray, user: &U, best: &mut Hit) {
        let inside = hit.t < ray.t_max;
        if inside && hit.beats(best) && (!U::HAS_FILTER || user.accept(self.tag, &hit, ray)) {
            *best = hit;
        }
    }

    fn object_closest<U: UserShapes>(&self, object: &Object, ray: &Ray, user: &U, best: &mut Hit) {
        match object {
            Object::User { geometry, primitive } => {
                // One step beyond the best hit, so that an equally near shape can win by its number.
                let ray_to_best = ray.until(best.t.next_up().min(ray.t_max));
                if let Some(found) = user.intersect(self.tag, *geometry, *primitive, &ray_to_best) {
                    let hit = Hit {
                        t: found.t,
                        u: found.u,
                        v: found.v,
                        primitive: *primitive,
                        geometry: *geometry,
                        instance: NO_INSTANCE,
                    };
                    self.offer(hit, ray, user, best);
                }
            }
            Object::Instance { geometry, level, object_from_world } => {
                let local = object_from_world.ray(ray);
                let mut inner = Hit { t: best.t, ..Hit::NONE };
                // The outer walk's stack is in use: instances get their own.
                level.closest(&local, user, &mut Stack::default(), &mut inner);
                let hit = Hit { instance: *geometry, ..inner };
                if inner.is_some() && hit.beats(best) {
                    *best = hit;
                }
            }
        }
    }

    fn object_blocks<U: UserShapes>(&self, object: &Object, ray: &Ray, user: &U) -> bool {
        match object {
            Object::User { geometry, primitive } => {
                let Some(found) = user.intersect(self.tag, *geometry, *primitive, ray) else { return false };
                let (primitive, geometry) = (*primitive, *geometry);
                let hit =
                    Hit { t: found.t, u: found.u, v: found.v, primitive, geometry, instance: NO_INSTANCE };
                found.t < ray.t_max && (!U::HAS_FILTER || user.accept(self.tag, &hit, ray))
            }
            Object::Instance { level, object_from_world, .. } => {
                level.occluded(&object_from_world.ray(ray), user)
            }
        }
    }

    #[inline]
    fn each_block(
        &self,
        walk: &TraversalRay,
        t_max: f32,
        stack: &mut Stack,
        mut visit: impl FnMut(&[Block]) -> Leaf,
    ) {
        if self.structure == Structure::List {
            visit(&self.blocks);
            return;
        }
        self.triangles.walk(walk, t_max, stack, |first, count| visit(&self.blocks[first..first + count]));
    }

    #[inline]
    fn each_object(
        &self,
        walk: &TraversalRay,
        t_max: f32,
        stack: &mut Stack,
        mut visit: impl FnMut(&[Object]) -> Leaf,
    ) {
        if self.structure == Structure::List {
            visit(&self.objects);
            return;
        }
        self.objects_bvh.walk(walk, t_max, stack, |first, count| visit(&self.objects[first..first + count]));
    }
}

fn check_mesh(geometry: usize, positions: &[[f32; 3]], indices: &[[u32; 3]]) -> Result<(), AccelError> {
    let broken = positions.iter().filter(|p| !Point3::from(**p).is_finite()).count();
    if broken > 0 {
        return Err(AccelError::NonFinite { geometry, count: broken });
    }
    let vertices = positions.len();
    for (triangle, t) in indices.iter().enumerate() {
        if let Some(&index) = t.iter().find(|&&i| i as usize >= vertices) {
            return Err(AccelError::BadIndex { geometry, triangle, index, vertices });
        }
    }
    Ok(())
}

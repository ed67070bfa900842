//! Worlds: geometries in one hierarchy for triangles and one for everything else.

use std::sync::Arc;

use aureole_math::{Bounds3, Point3, Ray, Transform};

use crate::bvh::{Bvh8, Stats, build};
use crate::triangle::{Block, LANES};
use crate::{AccelError, Config, Geometry, Hit, Structure, UserShapes, query, simd};

/// Something that is not a triangle.
#[derive(Clone, Debug)]
pub(crate) enum Object {
    User { geometry: u32, primitive: u32 },
    Instance { geometry: u32, level: Arc<World>, object_from_world: Transform },
}

/// Geometries ready for rays.
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) tag: u32,
    bounds: Bounds3,
    pub(crate) triangles: Bvh8,
    pub(crate) blocks: Vec<Block>,
    pub(crate) objects_bvh: Bvh8,
    pub(crate) objects: Vec<Object>,
    pub(crate) structure: Structure,
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
        check_count(boxes.len())?;
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
        check_count(boxes.len())?;
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
    pub fn closest_hit<U: UserShapes>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        let mut hit = [Hit::NONE];
        self.closest_hits(std::slice::from_ref(ray), &mut hit, user);
        hit[0].is_some().then_some(hit[0])
    }

    /// Whether anything lies on the ray in `(t_min, t_max)`.
    pub fn occluded<U: UserShapes>(&self, ray: &Ray, user: &U) -> bool {
        let mut blocked = [false];
        self.occluded_many(std::slice::from_ref(ray), &mut blocked, user);
        blocked[0]
    }

    /// [`closest_hit`](Self::closest_hit) for many rays; [`Hit::NONE`] where there is none.
    pub fn closest_hits<U: UserShapes>(&self, rays: &[Ray], hits: &mut [Hit], user: &U) {
        simd::run(query::Closest { world: self, rays, hits, user });
    }

    /// [`occluded`](Self::occluded) for many rays.
    pub fn occluded_many<U: UserShapes>(&self, rays: &[Ray], blocked: &mut [bool], user: &U) {
        simd::run(query::Occluded { world: self, rays, blocked, user });
    }
}

/// Leaves name their first item in 27 bits.
fn check_count(items: usize) -> Result<(), AccelError> {
    if items < 1 << 27 { Ok(()) } else { Err(AccelError::TooMany(items as u64)) }
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

//! Worlds: geometries in one hierarchy for triangles and one for everything else.

use std::sync::Arc;

use aureole_math::{Bounds3, Motion, Point3, Ray, RayMap};

use crate::blocks::{Blocks, Meshes};
use crate::bvh::MAX_ITEMS;
use crate::index::{Index, Indexed};
use crate::moving::Moving;
use crate::overlap::ball_overlaps_box;
use crate::things::Things;
use crate::triangle::LANES;
use crate::{AccelError, Accuracy, Config, Geometry, Hit, Layout, Structure, UserShapes, query};

/// Something that is not a triangle.
#[derive(Clone, Debug)]
pub(crate) enum Object {
    User { geometry: u32, primitive: u32 },
    Ball { geometry: u32, primitive: u32 },
    Instance { geometry: u32, level: Arc<World>, object_from_world: RayMap },
    MovingInstance { geometry: u32, level: Arc<World>, world_from_object: Box<Motion> },
}

impl Object {
    pub(crate) fn geometry(&self) -> u32 {
        match self {
            Self::User { geometry, .. }
            | Self::Ball { geometry, .. }
            | Self::Instance { geometry, .. }
            | Self::MovingInstance { geometry, .. } => *geometry,
        }
    }
}

/// Geometries ready for rays.
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) tag: u32,
    pub(crate) bounds: Bounds3,
    pub(crate) triangles: Index,
    pub(crate) blocks: Blocks,
    /// For each mesh, the number of its first triangle and its geometry.
    pub(crate) meshes: Vec<[u32; 2]>,
    pub(crate) moving: Vec<Moving>,
    pub(crate) object_index: Index,
    pub(crate) objects: Vec<Object>,
    triangle_count: usize,
    pub(crate) accuracy: Accuracy,
    pub(crate) config: Config,
    /// The kind of each geometry and how many primitives it has.
    pub(crate) numbers: Vec<[usize; 2]>,
    /// A mask for each geometry; all ones beyond the end.
    pub(crate) masks: Vec<u32>,
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
            triangles: Index::List { bounds: Bounds3::EMPTY, groups: 0 },
            blocks: Blocks::default(),
            meshes: Vec::new(),
            moving: Moving::build_all(&geometries, config)?,
            object_index: Index::List { bounds: Bounds3::EMPTY, groups: 0 },
            objects: Vec::new(),
            triangle_count: 0,
            accuracy: config.accuracy,
            config: *config,
            numbers: geometries.iter().map(Self::kind_and_number).collect(),
            masks: Vec::new(),
        };
        world.bounds = world.moving.iter().fold(Bounds3::EMPTY, |all, moving| all.union(moving.bounds()));
        world.build_triangles(&geometries, config)?;
        world.build_objects(geometries, config)?;
        Ok(world)
    }

    /// The same world, in which [`Masked`](crate::Masked) queries meet the geometries whose mask has a bit in common with
    /// theirs. Geometries beyond the end of the list have all bits; a mask can be changed at any time.
    #[must_use]
    pub fn with_masks(self, masks: Vec<u32>) -> Self {
        Self { masks, ..self }
    }

    /// Whether there is anything but triangles at rest.
    #[inline(always)]
    pub(crate) fn has_others(&self) -> bool {
        !(self.moving.is_empty() && self.objects.is_empty())
    }

    #[inline]
    pub(crate) fn mask_of(&self, geometry: u32) -> u32 {
        self.masks.get(geometry as usize).copied().unwrap_or(u32::MAX)
    }

    fn build_triangles(&mut self, geometries: &[Geometry], config: &Config) -> Result<(), AccelError> {
        let mut meshes = Meshes::new(config.accuracy);
        let mut count = 0;
        for (g, geometry) in geometries.iter().enumerate() {
            let Geometry::Triangles { positions, indices } = geometry else { continue };
            check_mesh(g, positions, indices)?;
            self.meshes.push([count as u32, g as u32]);
            meshes.push(count as u32, positions, indices);
            count += indices.len();
            check_count(count)?;
        }
        self.triangle_count = count;
        let Indexed { index, order, groups } = Index::build(count, &meshes, LANES, config);
        self.blocks = match (config.structure, config.layout) {
            (Structure::Hierarchy, Layout::Compact) => Blocks::numbers(meshes, &order, &groups),
            _ => Blocks::ready(&meshes, &order, &groups),
        };
        self.bounds = self.bounds.union(index.bounds());
        self.triangles = index;
        Ok(())
    }

    /// The geometry and the number in it of a triangle of this level.
    #[inline(always)]
    pub(crate) fn triangle_of(&self, id: u32) -> (u32, u32) {
        let [first, geometry] = match self.meshes[..] {
            [only] => only,
            _ => self.meshes[self.meshes.partition_point(|[first, _]| *first <= id) - 1],
        };
        (geometry, id - first)
    }

    fn build_objects(&mut self, geometries: Vec<Geometry>, config: &Config) -> Result<(), AccelError> {
        let mut boxes = Vec::new();
        let mut all = Vec::new();
        for (g, geometry) in geometries.into_iter().enumerate() {
            let geometry_id = g as u32;
            match geometry {
                Geometry::Triangles { .. } | Geometry::MovingTriangles { .. } => {}
                Geometry::User(list) => {
                    let user = |primitive| Object::User { geometry: geometry_id, primitive };
                    all.extend((0..list.len() as u32).map(user));
                    boxes.extend(checked(list, g)?);
                }
                Geometry::Balls(list) => {
                    let ball = |primitive| Object::Ball { geometry: geometry_id, primitive };
                    all.extend((0..list.len() as u32).map(ball));
                    boxes.extend(checked(list, g)?);
                }
                Geometry::Instance { level, world_from_object } => {
                    let bounds = world_from_object.bounds(&level.bounds);
                    if bounds.is_empty() {
                        continue;
                    }
                    boxes.extend(checked(vec![bounds], g)?);
                    let object_from_world = world_from_object.inverse().ray_map();
                    all.push(Object::Instance { geometry: geometry_id, level, object_from_world });
                }
                Geometry::MovingInstance { level, world_from_object } => {
                    let bounds = world_from_object.bounds(&level.bounds);
                    if bounds.is_empty() {
                        continue;
                    }
                    boxes.extend(checked(vec![bounds], g)?);
                    all.push(Object::MovingInstance { geometry: geometry_id, level, world_from_object });
                }
            }
        }
        check_count(boxes.len())?;
        self.bounds = boxes.iter().fold(self.bounds, |b, other| b.union(*other));
        let others = Others { objects: &all, boxes: &boxes };
        let Indexed { index, order, .. } = Index::build(boxes.len(), &others, 1, config);
        self.objects = order.iter().map(|&i| all[i as usize].clone()).collect();
        self.object_index = index;
        Ok(())
    }

    /// The box around everything.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangle_count
    }

    /// The nearest hit of a ray in `(t_min, t_max)`.
    #[inline]
    pub fn closest_hit<U: UserShapes>(&self, ray: &Ray, user: &U) -> Option<Hit> {
        let hit = query::closest_hit(self, ray, user);
        hit.is_some().then_some(hit)
    }

    /// Whether anything lies on the ray in `(t_min, t_max)`.
    #[inline]
    pub fn occluded<U: UserShapes>(&self, ray: &Ray, user: &U) -> bool {
        query::is_occluded(self, ray, user)
    }

    /// [`closest_hit`](Self::closest_hit) for many rays; [`Hit::NONE`] where there is none.
    pub fn closest_hits<U: UserShapes>(&self, rays: &[Ray], hits: &mut [Hit], user: &U) {
        query::closest_hits(self, rays, hits, user);
    }

    /// [`occluded`](Self::occluded) for many rays.
    pub fn occluded_many<U: UserShapes>(&self, rays: &[Ray], blocked: &mut [bool], user: &U) {
        query::occluded(self, rays, blocked, user);
    }
}

/// Everything else.
struct Others<'a> {
    objects: &'a [Object],
    boxes: &'a [Bounds3],
}

impl Things for Others<'_> {
    fn bounds(&self, id: u32) -> Bounds3 {
        self.boxes[id as usize]
    }

    fn overlaps(&self, id: u32, cell: &Bounds3) -> bool {
        let Bounds3 { min, max } = self.boxes[id as usize];
        let is_ball = matches!(self.objects[id as usize], Object::Ball { .. });
        !is_ball || ball_overlaps_box(min + (max - min) * 0.5, 0.5 * (max - min).max_element(), cell)
    }
}

/// Leaves name their first item in 27 bits.
pub(crate) fn check_count(items: usize) -> Result<(), AccelError> {
    if items < MAX_ITEMS { Ok(()) } else { Err(AccelError::TooMany(items as u64)) }
}

pub(crate) fn checked(boxes: Vec<Bounds3>, geometry: usize) -> Result<Vec<Bounds3>, AccelError> {
    let count = boxes.iter().filter(|b| !b.min.is_finite() || !b.max.is_finite()).count();
    if count == 0 { Ok(boxes) } else { Err(AccelError::NonFinite { geometry, count }) }
}

pub(crate) fn check_mesh(
    geometry: usize,
    positions: &[[f32; 3]],
    indices: &[[u32; 3]],
) -> Result<(), AccelError> {
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

//! Worlds: geometries in one hierarchy for triangles and one for everything else.

use std::sync::Arc;

use aureole_math::{Bounds3, Point3, Ray, Transform};

use crate::blocks::{Blocks, Meshes};
use crate::bvh::Stats;
use crate::index::{Index, Indexed};
use crate::overlap::{ball_overlaps_box, triangle_overlaps_box};
use crate::triangle::LANES;
use crate::{AccelError, Accuracy, Config, Geometry, Hit, Layout, Structure, UserShapes, query};

/// Something that is not a triangle.
#[derive(Clone, Debug)]
pub(crate) enum Object {
    User { geometry: u32, primitive: u32 },
    Ball { geometry: u32, primitive: u32 },
    Instance { geometry: u32, level: Arc<World>, object_from_world: Transform },
}

/// Geometries ready for rays.
#[derive(Clone, Debug)]
pub struct World {
    pub(crate) tag: u32,
    bounds: Bounds3,
    pub(crate) triangles: Index,
    pub(crate) blocks: Blocks,
    /// For each mesh, the number of its first triangle and its geometry.
    meshes: Vec<[u32; 2]>,
    pub(crate) object_index: Index,
    pub(crate) objects: Vec<Object>,
    pub(crate) accuracy: Accuracy,
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
            object_index: Index::List { bounds: Bounds3::EMPTY, groups: 0 },
            objects: Vec::new(),
            accuracy: config.accuracy,
        };
        world.build_triangles(&geometries, config)?;
        world.build_objects(geometries, config)?;
        Ok(world)
    }

    fn build_triangles(&mut self, geometries: &[Geometry], config: &Config) -> Result<(), AccelError> {
        let mut meshes = Vec::new();
        let mut kept = Meshes::new(config.accuracy);
        let mut count = 0;
        for (g, geometry) in geometries.iter().enumerate() {
            let Geometry::Triangles { positions, indices } = geometry else { continue };
            check_mesh(g, positions, indices)?;
            self.meshes.push([count as u32, g as u32]);
            kept.push(count as u32, positions, indices);
            meshes.push((positions, indices));
            count += indices.len();
            check_count(count)?;
        }
        let starts = &self.meshes;
        let triangle = |id: u32| {
            let mesh = starts.partition_point(|[first, _]| *first <= id) - 1;
            let (positions, indices) = meshes[mesh];
            indices[(id - starts[mesh][0]) as usize].map(|i| positions[i as usize])
        };
        let bounds = |id: u32| Bounds3::around(triangle(id).map(Point3::from));
        let overlaps = |id: u32, cell: &Bounds3| triangle_overlaps_box(triangle(id).map(Point3::from), cell);
        let Indexed { index, order, groups } = Index::build(count, bounds, overlaps, LANES, config);
        self.blocks = match (config.structure, config.layout) {
            (Structure::Hierarchy, Layout::Compact) => Blocks::numbers(kept, &order, &groups),
            _ => Blocks::ready(&kept, &order, &groups),
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
                Geometry::Triangles { .. } => {}
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
        let overlaps = |i: u32, cell: &Bounds3| match all[i as usize] {
            Object::Ball { .. } => {
                let [low, high] = [boxes[i as usize].min, boxes[i as usize].max];
                ball_overlaps_box(low + (high - low) * 0.5, 0.5 * (high - low).max_element(), cell)
            }
            _ => true,
        };
        let Indexed { index, order, .. } =
            Index::build(boxes.len(), |i| boxes[i as usize], overlaps, 1, config);
        self.objects = order.iter().map(|&i| all[i as usize].clone()).collect();
        self.object_index = index;
        Ok(())
    }

    /// The box around everything.
    pub fn bounds(&self) -> Bounds3 {
        self.bounds
    }

    /// Figures about the hierarchies of this level.
    pub fn stats(&self) -> Stats {
        let bytes = self.blocks.bytes() + size_of_val(&self.objects[..]);
        let stats = self.triangles.stats().merged(self.object_index.stats());
        Stats { bytes: stats.bytes + bytes, ..stats }
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

/// Leaves name their first item in 27 bits.
fn check_count(items: usize) -> Result<(), AccelError> {
    if items < 1 << 27 { Ok(()) } else { Err(AccelError::TooMany(items as u64)) }
}

fn checked(boxes: Vec<Bounds3>, geometry: usize) -> Result<Vec<Bounds3>, AccelError> {
    let count = boxes.iter().filter(|b| !b.min.is_finite() || !b.max.is_finite()).count();
    if count == 0 { Ok(boxes) } else { Err(AccelError::NonFinite { geometry, count }) }
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

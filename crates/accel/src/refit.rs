//! Worlds whose things have moved a little: the same hierarchy over new boxes.

use aureole_math::Bounds3;

use crate::blocks::Meshes;
use crate::index::Index;
use crate::world::{Object, check_mesh, checked};
use crate::{AccelError, Geometry, World};

impl World {
    /// Fits the world to the same geometries in other places, many times faster than a build.
    ///
    /// The shape of the hierarchies stays: what was together stays together, however far apart it is now. Hits are those of a
    /// new world. Rays become slower the more things have moved past each other; [`Stats::degradation`](crate::Stats) says by
    /// how much, as the ratio of the expected costs now and when it was built: build again at about 1.5. Parts of triangles
    /// that spatial splits made are whole again after the first refit. Grids, sixteen-wide and compact hierarchies are built anew.
    ///
    /// # Errors
    /// As for [`build`](Self::build), or [`AccelError::Changed`] where there are more or fewer primitives than before or of another
    /// kind; the world is unchanged then.
    pub fn refit(&mut self, geometries: &[Geometry]) -> Result<(), AccelError> {
        self.same_numbers(geometries)?;
        let moves = geometries.iter().any(|g| matches!(g, Geometry::MovingTriangles { .. }));
        let fits = |index: &Index| matches!(index, Index::List { .. } | Index::Binary(_) | Index::Wide(_));
        if !(fits(&self.triangles) && fits(&self.object_index)) || moves || !self.moving.is_empty() {
            // Cells have no boxes to fit, rounded ones no room, and what moves has its keys in them.
            let masks = self.masks.clone();
            *self = Self::build(geometries.to_vec(), self.tag, &self.config)?.with_masks(masks);
            return Ok(());
        }
        let meshes = self.checked_meshes(geometries)?;
        let objects = self.moved_objects(geometries)?;
        self.triangles.refit(&self.blocks.refit(&meshes));
        self.refit_objects(objects);
        self.bounds = self.triangles.bounds().union(self.object_index.bounds());
        Ok(())
    }

    fn same_numbers(&self, geometries: &[Geometry]) -> Result<(), AccelError> {
        let differs = |(geometry, (now, then)): (usize, (&Geometry, &[usize; 2]))| {
            (Self::kind_and_number(now) != *then).then_some(geometry)
        };
        let changed = if geometries.len() != self.numbers.len() {
            Some(geometries.len().min(self.numbers.len()))
        } else {
            geometries.iter().zip(&self.numbers).enumerate().find_map(differs)
        };
        changed.map_or(Ok(()), |geometry| Err(AccelError::Changed { geometry }))
    }

    fn checked_meshes(&self, geometries: &[Geometry]) -> Result<Meshes, AccelError> {
        let mut meshes = Meshes::new(self.config.accuracy);
        let mut count = 0;
        for (g, geometry) in geometries.iter().enumerate() {
            if let Geometry::Triangles { positions, indices } = geometry {
                check_mesh(g, positions, indices)?;
                meshes.push(count, positions, indices);
                count += indices.len() as u32;
            }
        }
        Ok(meshes)
    }

    /// The objects in their places and their boxes, in the order of the leaves.
    fn moved_objects(&self, geometries: &[Geometry]) -> Result<Vec<(Object, Bounds3)>, AccelError> {
        let moved = |object: &Object| {
            let geometry = object.geometry() as usize;
            let (object, bounds) = match (object, &geometries[geometry]) {
                (
                    Object::User { primitive, .. } | Object::Ball { primitive, .. },
                    Geometry::User(boxes) | Geometry::Balls(boxes),
                ) => (object.clone(), boxes[*primitive as usize]),
                (Object::Instance { geometry, .. }, Geometry::Instance { level, world_from_object }) => {
                    let object_from_world = world_from_object.inverse().ray_map();
                    let bounds = world_from_object.bounds(&level.bounds);
                    (
                        Object::Instance { geometry: *geometry, level: level.clone(), object_from_world },
                        bounds,
                    )
                }
                (
                    Object::MovingInstance { geometry, .. },
                    Geometry::MovingInstance { level, world_from_object },
                ) => {
                    let bounds = world_from_object.bounds(&level.bounds);
                    let motion = world_from_object.clone();
                    let (geometry, level) = (*geometry, level.clone());
                    (Object::MovingInstance { geometry, level, world_from_object: motion }, bounds)
                }
                _ => return Err(AccelError::Changed { geometry }),
            };
            checked(vec![bounds], geometry).map(|_| (object, bounds))
        };
        self.objects.iter().map(moved).collect()
    }

    fn refit_objects(&mut self, objects: Vec<(Object, Bounds3)>) {
        let (objects, boxes): (Vec<_>, Vec<_>) = objects.into_iter().unzip();
        self.objects = objects;
        self.object_index.refit(&boxes);
    }

    /// What must not change between a build and a refit.
    pub(crate) fn kind_and_number(geometry: &Geometry) -> [usize; 2] {
        match geometry {
            Geometry::Triangles { indices, .. } => [0, indices.len()],
            Geometry::MovingTriangles { indices, .. } => [1, indices.len()],
            Geometry::User(boxes) => [2, boxes.len()],
            Geometry::Balls(boxes) => [3, boxes.len()],
            // An instance of nothing is nowhere.
            Geometry::Instance { level, .. } => [4, usize::from(!level.bounds.is_empty())],
            Geometry::MovingInstance { level, .. } => [5, usize::from(!level.bounds.is_empty())],
        }
    }
}

impl Index {
    /// Fits boxes to those of the groups.
    fn refit(&mut self, groups: &[Bounds3]) {
        match self {
            Self::List { bounds, .. } => *bounds = groups.iter().fold(Bounds3::EMPTY, |all, b| all.union(*b)),
            Self::Grid(_) | Self::Sixteen(_) | Self::Compact(_) => {} // built anew
            Self::Binary(tree) => tree.refit(groups),
            Self::Wide(bvh) => bvh.refit(groups),
        }
    }
}

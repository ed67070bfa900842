//! Meshes whose vertices move: a structure for each interval between keys, over boxes that hold a triangle all the way.

use std::sync::Arc;

use aureole_math::{Bounds3, Point3};
use rayon::prelude::*;

use crate::big::Big;
use crate::index::{Index, Indexed};
use crate::things::Boxes;
use crate::triangle::{LANES, MovingBlock};
use crate::validate::{self, Member};
use crate::{AccelError, Config, Defect, Geometry, Hit, NO_INSTANCE, Stats};

/// Meshes with the same number of keys.
#[derive(Clone, Debug, Default)]
pub(crate) struct Moving {
    intervals: Vec<Interval>,
    /// For each mesh, the number of its first triangle and its geometry.
    meshes: Vec<[u32; 2]>,
    count: usize,
}

/// Between two keys.
#[derive(Clone, Debug)]
pub(crate) struct Interval {
    pub index: Index,
    pub blocks: Big<MovingBlock>,
}

/// A mesh as it came: vertices at equally spaced times, and triangles.
struct Mesh<'a> {
    geometry: u32,
    keys: &'a [Arc<[[f32; 3]]>],
    indices: &'a [[u32; 3]],
}

impl Moving {
    /// All moving meshes among geometries, by their numbers of keys.
    pub(crate) fn build_all(geometries: &[Geometry], config: &Config) -> Result<Vec<Self>, AccelError> {
        let mut meshes: Vec<Mesh<'_>> = Vec::new();
        for (g, geometry) in geometries.iter().enumerate() {
            if let Geometry::MovingTriangles { keys, indices } = geometry {
                check(g, keys, indices)?;
                meshes.push(Mesh { geometry: g as u32, keys, indices });
            }
        }
        meshes.sort_by_key(|mesh| (mesh.keys.len(), mesh.geometry));
        meshes.chunk_by(|a, b| a.keys.len() == b.keys.len()).map(|alike| Self::build(alike, config)).collect()
    }

    fn build(meshes: &[Mesh<'_>], config: &Config) -> Result<Self, AccelError> {
        let mut starts = Vec::new();
        let mut count = 0;
        for mesh in meshes {
            starts.push([count as u32, mesh.geometry]);
            count += mesh.indices.len();
            crate::world::check_count(count)?;
        }
        let intervals = meshes.first().map_or(0, |mesh| mesh.keys.len() - 1);
        let interval = |i: usize| {
            let ends = |id: u32| {
                let number = starts.partition_point(|[first, _]| *first <= id) - 1;
                let mesh = &meshes[number];
                let vertices = mesh.indices[(id - starts[number][0]) as usize];
                [i, i + 1].map(|key| vertices.map(|vertex| mesh.keys[key][vertex as usize]))
            };
            let bounds = |id: u32| Bounds3::around(ends(id).into_iter().flatten().map(Point3::from));
            let Indexed { index, order, groups } = Index::build(count, &Boxes(bounds), LANES, config);
            let mut blocks = Big::zeroed(groups.len());
            blocks.par_iter_mut().zip(&groups).for_each(|(block, &[first, count])| {
                *block = MovingBlock::new(&order[first as usize..(first + count) as usize], ends);
            });
            Interval { index, blocks }
        };
        Ok(Self { intervals: (0..intervals).map(interval).collect(), meshes: starts, count })
    }

    /// The box around everything at all times.
    pub(crate) fn bounds(&self) -> Bounds3 {
        self.intervals.iter().fold(Bounds3::EMPTY, |all, interval| all.union(interval.index.bounds()))
    }

    /// Checks the structures of all intervals.
    pub(crate) fn validate(&self) -> Result<Stats, Defect> {
        let mut all = Stats::default();
        for Interval { index, blocks } in &self.intervals {
            let members = |group: usize, visit: &mut dyn FnMut(Member)| {
                let block: &MovingBlock = &blocks[group];
                for (lane, &id) in block.ids.iter().enumerate().take_while(|(_, id)| **id != u32::MAX) {
                    visit((id, Some(block.bounds(lane))));
                }
            };
            let stats = validate::check(index, blocks.len(), self.count, &members)?;
            all = all.merged(Stats { bytes: stats.bytes + size_of_val(&blocks[..]), ..stats });
        }
        Ok(Stats { primitives: self.count, ..all })
    }

    /// The interval that a time falls into, and the share of it that has gone by.
    pub(crate) fn at(&self, time: f32) -> Option<(&Interval, f32)> {
        let last = self.intervals.len().checked_sub(1)?;
        let time = if time.is_nan() { 0.0 } else { time.clamp(0.0, 1.0) };
        let at = time * self.intervals.len() as f32;
        let number = (at as usize).min(last);
        Some((&self.intervals[number], at - number as f32))
    }

    pub(crate) fn hit(&self, t: f32, u: f32, v: f32, id: u32) -> Hit {
        let [first, geometry] = self.meshes[self.meshes.partition_point(|[first, _]| *first <= id) - 1];
        Hit { t, u, v, primitive: id - first, geometry, instance: NO_INSTANCE }
    }
}

fn check(geometry: usize, keys: &[Arc<[[f32; 3]]>], indices: &[[u32; 3]]) -> Result<(), AccelError> {
    let vertices = keys.first().map_or(0, |key| key.len());
    if keys.len() < 2 || keys.iter().any(|key| key.len() != vertices) {
        return Err(AccelError::BadKeys { geometry, keys: keys.len() });
    }
    keys.iter().try_for_each(|key| crate::world::check_mesh(geometry, key, indices))
}

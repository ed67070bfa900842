//! Triangles in the order of a structure's leaves: ready for the test, or only their numbers.

use std::sync::Arc;

use aureole_math::{Bounds3, Point3};
use rayon::prelude::*;

use crate::Accuracy;
use crate::big::Big;
use crate::overlap::triangle_overlaps_box;
use crate::things::Things;
use crate::triangle::{Block, LANES};

/// What leaves refer to.
#[derive(Clone, Debug)]
pub(crate) enum Blocks {
    /// Triangles ready for the test.
    Ready(Big<Block>),
    /// Numbers; blocks are made when a ray comes.
    Numbers(Big<[u32; LANES]>, Meshes),
}

/// The meshes of a level.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meshes {
    accuracy: Accuracy,
    all: Vec<Mesh>,
}

#[derive(Clone, Debug)]
struct Mesh {
    /// The number of its first triangle.
    first: u32,
    positions: Arc<[[f32; 3]]>,
    indices: Arc<[[u32; 3]]>,
}

impl Meshes {
    pub(crate) fn new(accuracy: Accuracy) -> Self {
        Self { accuracy, all: Vec::new() }
    }

    pub(crate) fn push(&mut self, first: u32, positions: &Arc<[[f32; 3]]>, indices: &Arc<[[u32; 3]]>) {
        self.all.push(Mesh { first, positions: positions.clone(), indices: indices.clone() });
    }

    /// The corners of a triangle.
    #[inline]
    pub(crate) fn triangle(&self, id: u32) -> [[f32; 3]; 3] {
        let mesh = match self.all.len() {
            1 => 0,
            _ => self.all.partition_point(|mesh| mesh.first <= id) - 1,
        };
        let Mesh { first, positions, indices } = &self.all[mesh];
        indices[(id - first) as usize].map(|i| positions[i as usize])
    }

    #[inline(never)]
    fn block(&self, ids: &[u32; LANES]) -> Block {
        let used = ids.iter().position(|&id| id == u32::MAX).unwrap_or(LANES);
        Block::new(self.accuracy, &ids[..used], |id| self.triangle(id))
    }
}

impl Things for Meshes {
    fn bounds(&self, id: u32) -> Bounds3 {
        Bounds3::around(self.triangle(id).map(Point3::from))
    }

    fn overlaps(&self, id: u32, cell: &Bounds3) -> bool {
        triangle_overlaps_box(self.triangle(id).map(Point3::from), cell)
    }

    fn corners(&self, id: u32) -> Option<[[f32; 3]; 3]> {
        Some(self.triangle(id))
    }
}

impl Default for Blocks {
    fn default() -> Self {
        Self::Ready(Big::default())
    }
}

impl Blocks {
    /// Triangles ready for the test, a block for each group of numbers.
    pub(crate) fn ready(meshes: &Meshes, order: &[u32], groups: &[[u32; 2]]) -> Self {
        let mut blocks = Big::zeroed(groups.len());
        blocks.par_iter_mut().zip(groups).for_each(|(block, &[first, count])| {
            let ids = &order[first as usize..(first + count) as usize];
            *block = Block::new(meshes.accuracy, ids, |id| meshes.triangle(id));
        });
        Self::Ready(blocks)
    }

    /// The numbers alone.
    pub(crate) fn numbers(meshes: Meshes, order: &[u32], groups: &[[u32; 2]]) -> Self {
        let mut blocks = Big::<[u32; LANES]>::zeroed(groups.len());
        for (block, &[first, count]) in blocks.iter_mut().zip(groups) {
            *block = [u32::MAX; LANES];
            block[..count as usize].copy_from_slice(&order[first as usize..(first + count) as usize]);
        }
        Self::Numbers(blocks, meshes)
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        match self {
            Self::Ready(blocks) => blocks.is_empty(),
            Self::Numbers(blocks, _) => blocks.is_empty(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Ready(blocks) => blocks.len(),
            Self::Numbers(blocks, _) => blocks.len(),
        }
    }

    /// Moves the triangles to where `meshes` has them now; the box around each block. Blocks that are only numbers have none.
    pub(crate) fn refit(&mut self, meshes: &Meshes) -> Vec<Bounds3> {
        let Self::Ready(blocks) = self else { return Vec::new() };
        let fit = |block: &mut Block| {
            let count = block.ids.iter().take_while(|id| **id != u32::MAX).count();
            let ids = block.ids;
            *block = Block::new(meshes.accuracy, &ids[..count], |id| meshes.triangle(id));
            Bounds3::around(ids[..count].iter().flat_map(|&id| meshes.triangle(id)).map(Point3::from))
        };
        blocks.par_iter_mut().with_min_len(256).map(fit).collect()
    }

    /// A block; `made` is where it is made, if it must be.
    #[inline(always)]
    pub(crate) fn get<'a>(&'a self, i: usize, made: &'a mut Option<Block>) -> &'a Block {
        match self {
            Self::Ready(blocks) => &blocks[i],
            Self::Numbers(blocks, meshes) => made.insert(meshes.block(&blocks[i])),
        }
    }

    /// One that may be asked for soon, if it is there.
    #[inline(always)]
    pub(crate) fn peek(&self, i: usize) -> Option<&Block> {
        match self {
            Self::Ready(blocks) => Some(&blocks[i]),
            Self::Numbers(..) => None,
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        match self {
            Self::Ready(blocks) => size_of_val(&blocks[..]),
            Self::Numbers(blocks, _) => size_of_val(&blocks[..]),
        }
    }
}

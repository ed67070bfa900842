//! Ray-triangle tests, several triangles at a time.

mod fast;
mod watertight;

pub(crate) use fast::Fast;
pub(crate) use watertight::Watertight;

use aureole_math::Ray;
use bytemuck::{Pod, Zeroable};

use crate::Accuracy;
use crate::simd::Simd;

/// Triangles in a block.
pub(crate) const LANES: usize = 8;

/// Triangles side by side. Unused lanes hold NaN, which nothing hits.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct Block {
    /// `corners[vector][axis][lane]`; the kind of test says which three vectors it wants.
    corners: [[[f32; LANES]; 3]; 3],
    /// Numbers of the triangles, counted through all meshes of the level.
    pub ids: [u32; LANES],
}

impl Block {
    const EMPTY: Self = Self { corners: [[[f32::NAN; LANES]; 3]; 3], ids: [u32::MAX; LANES] };

    /// The triangles with these numbers, of which there are at most [`LANES`].
    pub(crate) fn new(accuracy: Accuracy, ids: &[u32], triangle: impl Fn(u32) -> [[f32; 3]; 3]) -> Self {
        let mut block = Self::EMPTY;
        for (lane, &id) in ids.iter().enumerate() {
            let vertices = triangle(id);
            let corners = match accuracy {
                Accuracy::Watertight => Watertight::prepare(vertices),
                Accuracy::Fast => Fast::prepare(vertices),
            };
            for (corner, p) in corners.iter().enumerate() {
                for (axis, &x) in p.iter().enumerate() {
                    block.corners[corner][axis][lane] = x;
                }
            }
            block.ids[lane] = id;
        }
        block
    }
}

/// A bit for each triangle of a block that was hit, and where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockHits {
    pub mask: u32,
    pub t: [f32; LANES],
    pub u: [f32; LANES],
    pub v: [f32; LANES],
}

impl BlockHits {
    pub(crate) const NONE: Self = Self { mask: 0, t: [0.0; LANES], u: [0.0; LANES], v: [0.0; LANES] };
}

/// A way to intersect rays with triangles.
pub(crate) trait TriangleTest: Copy {
    /// What a block keeps of a triangle.
    fn prepare(vertices: [[f32; 3]; 3]) -> [[f32; 3]; 3];

    /// A ray made ready for the test.
    fn new(ray: &Ray) -> Self;

    /// The hits with the triangles of a block in `(t_min, t_max]`.
    fn intersect<S: Simd>(&self, block: &Block, t_max: f32) -> BlockHits;
}

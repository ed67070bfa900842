//! Ray-triangle tests, several triangles at a time.

mod fast;
mod watertight;

pub(crate) use fast::Fast;
pub(crate) use watertight::Watertight;

use aureole_math::Ray;
use bytemuck::{Pod, Zeroable};

use crate::Accuracy;
use crate::bvh::{PACKET, SideBySide};
use crate::simd::{Floats, Simd, splat3};

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

/// A bit for each of some tests that found a hit, and where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hits<const N: usize> {
    pub mask: u32,
    pub t: [f32; N],
    pub u: [f32; N],
    pub v: [f32; N],
}

impl<const N: usize> Hits<N> {
    pub(crate) const NONE: Self = Self { mask: 0, t: [0.0; N], u: [0.0; N], v: [0.0; N] };
}

/// A way to intersect rays with triangles: a ray made ready for it. One ray against the triangles of a block and one triangle
/// against the rays of a packet are the same arithmetic, so they find the same hits.
pub(crate) trait TriangleTest: Copy {
    /// The rays of a packet.
    type Rays;

    /// What a block keeps of a triangle.
    fn prepare(vertices: [[f32; 3]; 3]) -> [[f32; 3]; 3];

    fn new(ray: &Ray) -> Self;

    /// The rays of a packet, if they can be tested together.
    fn together(rays: &[Self; PACKET], side_by_side: &SideBySide) -> Option<Self::Rays>;

    /// The hits of the ray with the triangles of a block in `(t_min, t_max]`.
    fn intersect<S: Simd>(&self, block: &Block, t_max: f32) -> Hits<LANES>;

    /// The hits of rays, up to their ends, with one triangle of a block.
    fn intersect_rays<S: Simd>(
        rays: &Self::Rays,
        block: &Block,
        lane: usize,
        ends: &[f32; PACKET],
    ) -> Hits<PACKET>;
}

/// What a block keeps of all its triangles, the axes in this order.
#[inline(always)]
fn corners<F: Floats<LANES>>(block: &Block, [x, y, z]: [usize; 3]) -> [[F; 3]; 3] {
    let [a, b, c] = &block.corners;
    [
        [F::load(&a[x]), F::load(&a[y]), F::load(&a[z])],
        [F::load(&b[x]), F::load(&b[y]), F::load(&b[z])],
        [F::load(&c[x]), F::load(&c[y]), F::load(&c[z])],
    ]
}

/// The same of one triangle, for each ray of a packet.
#[inline(always)]
fn one_triangle<F: Floats<PACKET>>(block: &Block, lane: usize, [x, y, z]: [usize; 3]) -> [[F; 3]; 3] {
    let [a, b, c] = &block.corners;
    [
        splat3([a[x][lane], a[y][lane], a[z][lane]]),
        splat3([b[x][lane], b[y][lane], b[z][lane]]),
        splat3([c[x][lane], c[y][lane], c[z][lane]]),
    ]
}

//! Ray-triangle tests, several triangles at a time.

mod fast;
mod moving;
mod watertight;

pub(crate) use fast::Fast;
pub(crate) use moving::{FoundHits, MovingBlock};
pub(crate) use watertight::Watertight;

use aureole_math::Ray;
use bytemuck::{Pod, Zeroable};

use crate::Accuracy;
use crate::bvh::{PACKET, Packet};
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

impl Block {
    /// The corners of one of the triangles, to within rounding.
    pub(crate) fn vertices(&self, accuracy: Accuracy, lane: usize) -> [[f32; 3]; 3] {
        let [a, b, c] = self.corners.map(|corner| corner.map(|axis| axis[lane]));
        let from_a = |edge: [f32; 3]| [a[0] + edge[0], a[1] + edge[1], a[2] + edge[2]];
        match accuracy {
            Accuracy::Watertight => [a, b, c],
            Accuracy::Fast => [a, from_a(b), from_a(c)],
        }
    }
}

/// A bit for each of some tests that found a hit, and where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hits<F> {
    pub mask: u32,
    pub t: F,
    pub u: F,
    pub v: F,
}

impl<F: Copy> Hits<F> {
    /// No hit.
    #[inline(always)]
    fn none(zero: F) -> Self {
        Self { mask: 0, t: zero, u: zero, v: zero }
    }
}

/// A way to intersect rays with triangles: a ray made ready for it. One ray against the triangles of a block and one triangle
/// against the rays of a packet are the same arithmetic, so they find the same hits.
pub(crate) trait TriangleTest: Copy {
    /// What the rays of a packet are tested with, beside the packet.
    type Rays;

    /// What a block keeps of a triangle.
    fn prepare(vertices: [[f32; 3]; 3]) -> [[f32; 3]; 3];

    /// The same of eight triangles at once.
    fn prepare_lanes<F: Floats<LANES>>(vertices: [[F; 3]; 3]) -> [[F; 3]; 3];

    fn new(ray: &Ray) -> Self;

    /// The rays of a packet, if they can be tested together.
    fn together<S: Simd>(packet: &Packet<S>) -> Option<Self::Rays>;

    /// One of the rays by itself.
    fn one_of(rays: &Self::Rays, i: usize, ray: &Ray) -> Self;

    /// The boxes of the triangles of a block, `[axis][side]`.
    fn boxes<S: Simd>(block: &Block) -> [[[f32; LANES]; 2]; 3];

    /// The hits of the ray with the triangles of a block in `(t_min, t_max]`.
    fn intersect<S: Simd>(&self, block: &Block, t_max: f32) -> Hits<S::F8>;

    /// The same with triangles that move, when a share of the interval has gone by.
    fn intersect_moving(&self, block: &MovingBlock, share: f32, t_max: f32) -> FoundHits;

    /// The hits of rays, up to their ends, with one triangle of a block.
    fn intersect_rays<S: Simd>(
        rays: &Self::Rays,
        packet: &Packet<S>,
        block: &Block,
        lane: usize,
        ends: S::F16,
    ) -> Hits<S::F16>;
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

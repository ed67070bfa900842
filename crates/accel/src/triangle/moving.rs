//! Triangles that move along straight lines.

use aureole_math::{Bounds3, Point3};
use bytemuck::{Pod, Zeroable};

use super::{Block, LANES, TriangleTest};
use crate::simd::{self, Floats, Kernel, Simd};

/// Triangles side by side, at the beginning and at the end of an interval of time.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub(crate) struct MovingBlock {
    /// `ends[end][corner][axis][lane]`; unused lanes hold NaN.
    ends: [[[[f32; LANES]; 3]; 3]; 2],
    /// Numbers of the triangles, counted through all meshes that move like them.
    pub ids: [u32; LANES],
}

impl MovingBlock {
    /// The triangles with these numbers, of which there are at most [`LANES`].
    pub(crate) fn new(ids: &[u32], mut ends: impl FnMut(u32) -> [[[f32; 3]; 3]; 2]) -> Self {
        let mut block = Self { ends: [[[[f32::NAN; LANES]; 3]; 3]; 2], ids: [u32::MAX; LANES] };
        for (lane, &id) in ids.iter().enumerate() {
            block.ids[lane] = id;
            for (end, corners) in ends(id).iter().enumerate() {
                for (corner, p) in corners.iter().enumerate() {
                    for (axis, &x) in p.iter().enumerate() {
                        block.ends[end][corner][axis][lane] = x;
                    }
                }
            }
        }
        block
    }

    /// The box around one of them all the way.
    pub(crate) fn bounds(&self, lane: usize) -> Bounds3 {
        let corners = self.ends.iter().flatten();
        Bounds3::around(corners.map(|corner| Point3::from(corner.map(|axis| axis[lane]))))
    }

    /// Where they are when this share of the interval has gone by.
    ///
    /// # Maths
    /// p = a + (b - a) s, held between a and b, so that rounding takes no vertex out of its box.
    #[inline(always)]
    fn at<S: Simd, T: TriangleTest>(&self, share: f32) -> Block {
        let share = S::F8::splat(share);
        let [start, end] = &self.ends;
        let mut vertices = [[S::F8::splat(0.0); 3]; 3];
        for (corner, vertex) in vertices.iter_mut().enumerate() {
            for (axis, x) in vertex.iter_mut().enumerate() {
                let (a, b) = (S::F8::load(&start[corner][axis]), S::F8::load(&end[corner][axis]));
                *x = (a + (b - a) * share).max(a.min(b)).min(a.max(b));
            }
        }
        let mut block = Block { ids: self.ids, ..Block::EMPTY };
        for (corner, vector) in T::prepare_lanes(vertices).into_iter().enumerate() {
            for (axis, x) in vector.into_iter().enumerate() {
                block.corners[corner][axis] = x.to_array();
            }
        }
        block
    }
}

/// The hits of a ray with the triangles of a block when a share of the interval has gone by.
pub(super) fn intersect<T: TriangleTest>(test: &T, block: &MovingBlock, share: f32, t_max: f32) -> FoundHits {
    simd::run(Intersect { test, block, share, t_max })
}

/// Hits in memory, a bit for each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FoundHits {
    pub mask: u32,
    pub t: [f32; LANES],
    pub u: [f32; LANES],
    pub v: [f32; LANES],
}

struct Intersect<'a, T> {
    test: &'a T,
    block: &'a MovingBlock,
    share: f32,
    t_max: f32,
}

impl<T: TriangleTest> Kernel for Intersect<'_, T> {
    type Output = FoundHits;
    #[inline(always)]
    fn run<S: Simd>(self) -> FoundHits {
        let hits = self.test.intersect::<S>(&self.block.at::<S, T>(self.share), self.t_max);
        FoundHits { mask: hits.mask, t: hits.t.to_array(), u: hits.u.to_array(), v: hits.v.to_array() }
    }
}

#[cfg(test)]
mod tests {
    use aureole_math::{Pcg32, Ray};

    use super::*;
    use crate::simd::Portable;
    use crate::triangle::{Fast, Watertight};

    fn same<T: TriangleTest>() {
        let mut rng = Pcg32::new(17);
        let mut hits = 0;
        for _ in 0..2000 {
            let mut point = |size: f32| [0; 3].map(|_| (rng.next_f32() - 0.5) * size);
            let block =
                MovingBlock::new(&[0, 1, 2, 3, 4, 5, 6, 7], |_| [0; 2].map(|_| [0; 3].map(|_| point(1.0))));
            let (origin, target) = (Point3::from(point(4.0)), Point3::from(point(0.5)));
            let (test, share) = (T::new(&Ray::new(origin, target - origin)), point(1.0)[0] + 0.5);
            let wide = intersect(&test, &block, share, 3.0);
            let portable = Intersect { test: &test, block: &block, share, t_max: 3.0 }.run::<Portable>();
            assert_eq!(wide.mask, portable.mask);
            for i in crate::simd::lanes(wide.mask) {
                assert_eq!([wide.t[i], wide.u[i], wide.v[i]], [portable.t[i], portable.u[i], portable.v[i]]);
            }
            hits += wide.mask.count_ones();
        }
        assert!(hits > 200, "{hits}");
    }

    #[test]
    fn instruction_sets_find_the_same_hits() {
        same::<Watertight>();
        same::<Fast>();
    }
}

//! No ray slips through between triangles that share an edge or a corner.
//!
//! # References
//! [Woop, Benthin and Wald 2013] "Watertight Ray/Triangle Intersection", JCGT 2(1).

use aureole_math::{Ray, gamma};
use glam::{DVec3, Vec4};

use super::{Block, FoundHits, Hits, LANES, MovingBlock, TriangleTest, corners, moving, one_triangle};
use crate::bvh::{PACKET, Packet};
use crate::simd::{Floats, Mask, Simd, load3, splat3};

/// What becomes x, y and z, by the largest axis and whether the ray runs down it: the winding of triangles is kept.
const AXES: [[[usize; 3]; 2]; 3] = [[[1, 2, 0], [2, 1, 0]], [[2, 0, 1], [0, 2, 1]], [[0, 1, 2], [1, 0, 2]]];

/// A ray whose largest axis becomes z, sheared so that it points along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Watertight {
    axes: [usize; 3],
    shear: [f32; 3],
    origin: [f32; 3],
    t_min: f32,
}

/// Rays with the same axes.
#[repr(C, align(64))]
pub(crate) struct WatertightRays {
    shear: [[f32; PACKET]; 3],
    axes: [usize; 3],
}

impl TriangleTest for Watertight {
    type Rays = WatertightRays;

    fn prepare(vertices: [[f32; 3]; 3]) -> [[f32; 3]; 3] {
        vertices
    }

    #[inline(always)]
    fn prepare_lanes<F: Floats<LANES>>(vertices: [[F; 3]; 3]) -> [[F; 3]; 3] {
        vertices
    }

    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        // Without branches: the axis of a random ray cannot be predicted.
        let d = ray.direction.to_array();
        let [x, y, z] = d.map(f32::abs);
        let z_is_largest = usize::from(z > x.max(y));
        let largest = 2 * z_is_largest + (1 - z_is_largest) * usize::from(y > x);
        let axes = AXES[largest % 3][usize::from(d[largest % 3] < 0.0)];
        let shear = Vec4::new(d[axes[0]], d[axes[1]], 1.0, 1.0) / d[axes[2]];
        let origin = ray.origin.to_array();
        Self {
            axes,
            shear: shear.truncate().to_array(),
            origin: axes.map(|axis| origin[axis]),
            t_min: ray.t_min,
        }
    }

    #[inline(always)]
    fn together<S: Simd>(packet: &Packet<S>) -> Option<WatertightRays> {
        let d = packet.direction;
        let (x, y, z) = (d[0].abs(), d[1].abs(), d[2].abs());
        let largest = match (x.max(y).less(z).bits(), x.less(y).bits()) {
            (0xffff, _) => 2,
            (0, 0xffff) => 1,
            (0, 0) => 0,
            _ => return None,
        };
        let axes = AXES[largest][packet.outline.near[largest]];
        let [dx, dy, dz] = [d[axes[0]], d[axes[1]], d[axes[2]]];
        let shear = [(dx / dz).to_array(), (dy / dz).to_array(), (S::F16::splat(1.0) / dz).to_array()];
        Some(WatertightRays { axes, shear })
    }

    #[inline(always)]
    fn one_of(rays: &WatertightRays, i: usize, ray: &Ray) -> Self {
        let origin = ray.origin.to_array();
        let [x, y, z] = rays.axes;
        Self {
            axes: rays.axes,
            shear: [rays.shear[0][i], rays.shear[1][i], rays.shear[2][i]],
            origin: [origin[x], origin[y], origin[z]],
            t_min: ray.t_min,
        }
    }

    #[inline(always)]
    fn boxes<S: Simd>(block: &Block) -> [[[f32; LANES]; 2]; 3] {
        let [a, b, c]: [[S::F8; 3]; 3] = corners(block, [0, 1, 2]);
        let mut boxes = [[[0.0; LANES]; 2]; 3];
        for axis in 0..3 {
            let (a, b, c) = (a[axis], b[axis], c[axis]);
            boxes[axis] = [a.min(b).min(c).to_array(), a.max(b).max(c).to_array()];
        }
        boxes
    }

    #[inline(always)]
    fn intersect<S: Simd>(&self, block: &Block, t_max: f32) -> Hits<S::F8> {
        let corners = corners(block, self.axes);
        let t_min = S::F8::splat(self.t_min);
        intersect(corners, splat3(self.origin), splat3(self.shear), t_min, S::F8::splat(t_max))
    }

    #[inline(never)]
    fn intersect_moving(&self, block: &MovingBlock, share: f32, t_max: f32) -> FoundHits {
        moving::intersect(self, block, share, t_max)
    }

    #[inline(always)]
    fn intersect_rays<S: Simd>(
        rays: &WatertightRays,
        packet: &Packet<S>,
        block: &Block,
        lane: usize,
        ends: S::F16,
    ) -> Hits<S::F16> {
        let [x, y, z] = rays.axes;
        let origin = [packet.origin[x], packet.origin[y], packet.origin[z]];
        intersect(one_triangle(block, lane, rays.axes), origin, load3(&rays.shear), packet.t_min, ends)
    }
}

#[inline(always)]
fn intersect<const N: usize, F: Floats<N>>(
    [a, b, c]: [[F; 3]; 3],
    origin: [F; 3],
    shear: [F; 3],
    t_min: F,
    t_max: F,
) -> Hits<F> {
    let ([x0, y0, z0], [x1, y1, z1], [x2, y2, z2]) =
        (relative(a, origin, shear), relative(b, origin, shear), relative(c, origin, shear));
    // Twice the signed areas between the ray and each edge; outside where their signs differ.
    let (u, v, w) = (x2 * y1 - y2 * x1, x0 * y2 - y0 * x2, x1 * y0 - y1 * x0);
    let mut inside = same_signs(u, v, w);
    if inside == 0 {
        return Hits::none(shear[0]);
    }
    let mut edges = [u, v, w];
    if u.abs().min(v.abs()).min(w.abs()).less_or_equal(F::splat(0.0)).bits() & inside != 0 {
        let exact = exact_edges(
            [x0.to_array(), x1.to_array(), x2.to_array()],
            [y0.to_array(), y1.to_array(), y2.to_array()],
            [u.to_array(), v.to_array(), w.to_array()],
        );
        edges = load3(&exact);
        inside &= same_signs(edges[0], edges[1], edges[2]);
    }
    let [u, v, w] = edges;
    let inv = F::splat(1.0) / (u + v + w);
    let z = [shear[2] * z0, shear[2] * z1, shear[2] * z2];
    let t = (u * z[0] + v * z[1] + w * z[2]) * inv;
    // A vanishing determinant makes t infinite or NaN, which is in no range.
    inside &= (t_min.less(t) & t.less_or_equal(t_max)).bits();
    if inside == 0 {
        return Hits::none(shear[0]);
    }
    let bound = error_bound(edges, [x0, x1, x2], [y0, y1, y2], z, inv);
    let near = inside & !bound.less(t).bits();
    if near != 0 {
        let arrays = |v: [F; 3]| [v[0].to_array(), v[1].to_array(), v[2].to_array()];
        let corners = [arrays(a), arrays(b), arrays(c)];
        inside &= !near | exactly_ahead(&corners, &arrays(origin), &arrays(shear), near);
    }
    Hits { mask: inside, t, u: v * inv, v: w * inv }
}

/// A corner relative to the ray's origin, sheared (z not yet scaled).
#[inline(always)]
fn relative<const N: usize, F: Floats<N>>(corner: [F; 3], origin: [F; 3], shear: [F; 3]) -> [F; 3] {
    let z = corner[2] - origin[2];
    [(corner[0] - origin[0]) - shear[0] * z, (corner[1] - origin[1]) - shear[1] * z, z]
}

/// A bit for each lane in which three numbers have one sign, zero counting as either.
#[inline(always)]
fn same_signs<const N: usize, F: Floats<N>>(u: F, v: F, w: F) -> u32 {
    let zero = F::splat(0.0);
    let (least, largest) = (u.min(v).min(w), u.max(v).max(w));
    zero.less_or_equal(least).bits() | largest.less_or_equal(zero).bits()
}

/// Where a ray is on an edge to within rounding, the edge functions in double precision, in which they are exact in sign.
#[cold]
#[inline(never)]
fn exact_edges<const N: usize>(
    x: [[f32; N]; 3],
    y: [[f32; N]; 3],
    mut edges: [[f32; N]; 3],
) -> [[f32; N]; 3] {
    for i in 0..N {
        if edges.iter().all(|e| e[i] != 0.0) {
            continue;
        }
        let edge = |a: usize, b: usize| {
            (f64::from(x[a][i]) * f64::from(y[b][i]) - f64::from(y[a][i]) * f64::from(x[b][i])) as f32
        };
        let exact = [edge(2, 1), edge(0, 2), edge(1, 0)];
        for (e, exact) in edges.iter_mut().zip(exact) {
            e[i] = exact;
        }
    }
    edges
}

/// Which of some triangles that are as near as rounding goes lie ahead of the ray, in double precision. A ray that starts on a
/// triangle is kept off it, by as much as that one's points are rounded, and must not hit it again; the one beside it at an edge
/// it must not miss, or light leaks into closed bodies.
#[cold]
#[inline(never)]
fn exactly_ahead<const N: usize>(
    corners: &[[[f32; N]; 3]; 3],
    origin: &[[f32; N]; 3],
    shear: &[[f32; N]; 3],
    which: u32,
) -> u32 {
    let mut ahead = 0;
    for i in (0..N).filter(|i| which >> i & 1 != 0) {
        let at = |v: &[[f32; N]; 3]| DVec3::new(v[0][i].into(), v[1][i].into(), v[2][i].into());
        let [a, b, c] = [0, 1, 2].map(|k| at(&corners[k]) - at(origin));
        let n = (b - a).cross(c - a);
        let shear = at(shear);
        let along = n.dot(DVec3::new(shear.x, shear.y, 1.0)) * shear.z;
        ahead |= u32::from(n.dot(a) * along > 0.0) << i;
    }
    ahead
}

/// How large the ray parameter of a point on the triangle's plane may come out by rounding alone.
///
/// # References
/// [PBRT4] section 6.8.7, for sheared vertices and edge functions.
#[inline(always)]
fn error_bound<const N: usize, F: Floats<N>>(
    edges: [F; 3],
    x: [F; 3],
    y: [F; 3],
    z: [F; 3],
    inv_det: F,
) -> F {
    let (x, y, z, e) = (largest(x), largest(y), largest(z), largest(edges));
    let [g2, g3, g5] = [F::splat(gamma(2)), F::splat(gamma(3)), F::splat(gamma(5))];
    let (dz, dx, dy) = (g3 * z, g5 * (x + z), g5 * (y + z));
    let de = F::splat(2.0) * (g2 * x * y + dy * x + dx * y);
    F::splat(3.0) * (g3 * e * z + de * z + dz * e) * inv_det.abs()
}

#[inline(always)]
fn largest<const N: usize, F: Floats<N>>(values: [F; 3]) -> F {
    values[0].abs().max(values[1].abs()).max(values[2].abs())
}

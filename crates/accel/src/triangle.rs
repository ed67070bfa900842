//! Watertight ray-triangle tests, four triangles at a time.
//!
//! # References
//! [Woop, Benthin and Wald 2013] "Watertight Ray/Triangle Intersection", JCGT 2(1).

use aureole_math::{Ray, gamma};

use crate::Hit;
use crate::simd::same_signs;

/// Triangles in a block.
pub(crate) const LANES: usize = 4;

/// Four triangles side by side. Unused lanes hold NaN, which nothing hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub(crate) struct Block {
    /// `vertices[vertex][axis][lane]`.
    vertices: [[[f32; LANES]; 3]; 3],
    pub geometry: [u32; LANES],
    pub primitive: [u32; LANES],
}

impl Block {
    pub(crate) const EMPTY: Self = Self {
        vertices: [[[f32::NAN; LANES]; 3]; 3],
        geometry: [u32::MAX; LANES],
        primitive: [u32::MAX; LANES],
    };

    pub(crate) fn set(&mut self, lane: usize, triangle: [[f32; 3]; 3], geometry: u32, primitive: u32) {
        for (vertex, p) in triangle.iter().enumerate() {
            for (axis, &x) in p.iter().enumerate() {
                self.vertices[vertex][axis][lane] = x;
            }
        }
        self.geometry[lane] = geometry;
        self.primitive[lane] = primitive;
    }
}

/// A ray made ready for the triangle test: its largest axis becomes z, and a shear makes it point along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    axes: [usize; 3],
    shear: [f32; 3],
    origin: [f32; 3],
    t_min: f32,
}

impl ShearedRay {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let z = d.abs().max_axis();
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        // Keep the winding of triangles.
        if d[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let shear = [d[x] / d[z], d[y] / d[z], 1.0 / d[z]];
        let o = ray.origin;
        Self { axes: [x, y, z], shear, origin: [o[x], o[y], o[z]], t_min: ray.t_min }
    }
}

/// A hit within a block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockHit {
    pub lane: usize,
    pub t: f32,
    pub u: f32,
    pub v: f32,
}

/// The hits of a ray with the triangles of a block that lie at or before `t_max`, handed to `found`.
#[inline(always)]
pub(crate) fn intersect(block: &Block, ray: &ShearedRay, t_max: f32, mut found: impl FnMut(BlockHit)) {
    let [kx, ky, kz] = ray.axes;
    let [sx, sy, sz] = ray.shear;
    let [ox, oy, oz] = ray.origin;
    // Vertices relative to the origin, sheared.
    let mut x = [[0.0_f32; LANES]; 3];
    let mut y = [[0.0_f32; LANES]; 3];
    let mut z = [[0.0_f32; LANES]; 3];
    for vertex in 0..3 {
        let p = &block.vertices[vertex];
        for i in 0..LANES {
            let dz = p[kz][i] - oz;
            x[vertex][i] = (p[kx][i] - ox) - sx * dz;
            y[vertex][i] = (p[ky][i] - oy) - sy * dz;
            z[vertex][i] = sz * dz;
        }
    }
    // Twice the signed areas between the ray and each edge.
    let mut u = [0.0_f32; LANES];
    let mut v = [0.0_f32; LANES];
    let mut w = [0.0_f32; LANES];
    for i in 0..LANES {
        u[i] = x[2][i] * y[1][i] - y[2][i] * x[1][i];
        v[i] = x[0][i] * y[2][i] - y[0][i] * x[2][i];
        w[i] = x[1][i] * y[0][i] - y[1][i] * x[0][i];
    }
    let mut candidates = same_signs(&u, &v, &w);
    while candidates != 0 {
        let i = candidates.trailing_zeros() as usize;
        candidates &= candidates - 1;
        let edge = |a: usize, b: usize| {
            (f64::from(x[a][i]) * f64::from(y[b][i]) - f64::from(y[a][i]) * f64::from(x[b][i])) as f32
        };
        let (mut u, mut v, mut w) = (u[i], v[i], w[i]);
        if u == 0.0 || v == 0.0 || w == 0.0 {
            // On an edge to within rounding: decide exactly.
            (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
            if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
                continue;
            }
        }
        let det = u + v + w;
        if det == 0.0 {
            continue;
        }
        let inv = 1.0 / det;
        let t = (u * z[0][i] + v * z[1][i] + w * z[2][i]) * inv;
        if t > ray.t_min
            && t <= t_max
            && t > error_bound([u, v, w], [0, 1, 2].map(|k| [x[k][i], y[k][i], z[k][i]]), inv)
        {
            found(BlockHit { lane: i, t, u: v * inv, v: w * inv });
        }
    }
}

/// How large the ray parameter of a point on the triangle's plane may come out by rounding alone: a ray that starts on
/// the triangle must not hit it again.
///
/// # References
/// [PBRT4] section 6.8.7, for sheared vertices and edge functions.
#[inline(always)]
fn error_bound(edges: [f32; 3], vertices: [[f32; 3]; 3], inv_det: f32) -> f32 {
    let largest = |values: [f32; 3]| values[0].abs().max(values[1].abs()).max(values[2].abs());
    let [x, y, z] = [0, 1, 2].map(|axis| largest(vertices.map(|v| v[axis])));
    let (dz, dx, dy) = (gamma(3) * z, gamma(5) * (x + z), gamma(5) * (y + z));
    let de = 2.0 * (gamma(2) * x * y + dy * x + dx * y);
    let e = largest(edges);
    3.0 * (gamma(3) * e * z + de * z + dz * e) * inv_det.abs()
}

impl Block {
    /// The hit with the triangle's numbers.
    #[inline(always)]
    pub(crate) fn hit(&self, hit: &BlockHit) -> Hit {
        Hit {
            t: hit.t,
            u: hit.u,
            v: hit.v,
            primitive: self.primitive[hit.lane],
            geometry: self.geometry[hit.lane],
            instance: crate::NO_INSTANCE,
        }
    }
}

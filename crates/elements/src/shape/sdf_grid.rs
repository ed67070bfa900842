//! `sdf_grid`: the zero level of signed distances on a grid over the unit cube, interpolated trilinearly.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `values` | floats | | signed distances, x fastest; negative inside |
//! | `resolution` | ints | | grid points in x, y, z; at least 2 each |
//! | `normals` | string | smooth | `smooth` (continuous over voxel borders) or `analytic` (the gradient within a voxel) |
//!
//! References: [Hansson-Söderlund et al. 2022] "Ray Tracing of Signed Distance Function Grids", JCGT 11(3).

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Point2, Point3, Ray, Vector3};

use super::quadric::{ObjectRay, ObjectSpace};
use super::{Geometry, Placement, ShapeHit, ShapeOps, SurfacePoint};
use crate::{Element, Resolver};

/// How normals are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Normals {
    Smooth,
    Analytic,
}

/// A signed distance grid. Only voxels that the surface crosses are primitives.
#[derive(Clone, Debug)]
pub struct SdfGrid {
    space: ObjectSpace,
    values: Box<[f32]>,
    resolution: [usize; 3],
    normals: Normals,
    voxels: Vec<[u32; 3]>,
}

impl SdfGrid {
    fn value(&self, [x, y, z]: [usize; 3]) -> f32 {
        let [nx, ny, _] = self.resolution;
        self.values[(z * ny + y) * nx + x]
    }

    /// The eight values around a voxel; bit 0 of the index is x, bit 1 y, bit 2 z.
    fn corners(&self, voxel: [usize; 3]) -> [f64; 8] {
        std::array::from_fn(|i| {
            f64::from(self.value([voxel[0] + (i & 1), voxel[1] + (i >> 1 & 1), voxel[2] + (i >> 2)]))
        })
    }

    /// Voxels along each axis.
    fn cells(&self) -> [f64; 3] {
        self.resolution.map(|n| (n - 1) as f64)
    }

    /// Gradient, in the unit cube's space, of the trilinear function of one voxel, continued to any point.
    fn gradient(&self, voxel: [usize; 3], p: [f64; 3]) -> [f64; 3] {
        let c = self.corners(voxel);
        let cells = self.cells();
        let f: [f64; 3] = std::array::from_fn(|i| p[i] * cells[i] - voxel[i] as f64);
        let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let face = |a: [f64; 4], u: f64, v: f64| lerp(lerp(a[0], a[1], u), lerp(a[2], a[3], u), v);
        [
            cells[0] * face([c[1] - c[0], c[3] - c[2], c[5] - c[4], c[7] - c[6]], f[1], f[2]),
            cells[1] * face([c[2] - c[0], c[3] - c[1], c[6] - c[4], c[7] - c[5]], f[0], f[2]),
            cells[2] * face([c[4] - c[0], c[5] - c[1], c[6] - c[2], c[7] - c[3]], f[0], f[1]),
        ]
    }

    /// The gradients of the eight voxels around a point, blended by its place among their centres: continuous.
    fn smooth_gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let cells = self.cells();
        let place: [f64; 3] = std::array::from_fn(|i| p[i] * cells[i] - 0.5);
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let mut weight = 1.0;
            let voxel = std::array::from_fn(|i| {
                let base = place[i].floor();
                let up = corner >> i & 1;
                let t = place[i] - base;
                weight *= if up == 1 { t } else { 1.0 - t };
                (base + up as f64).clamp(0.0, cells[i] - 1.0) as usize
            });
            let g = self.gradient(voxel, p);
            let length = g.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-30);
            for i in 0..3 {
                sum[i] += weight * g[i] / length;
            }
        }
        sum
    }

    /// Where a ray, given over [0, length] of its parameter within one voxel, first meets the zero level.
    fn voxel_hit(&self, voxel: [usize; 3], ray: &ObjectRay, t0: f64, t1: f64) -> Option<f64> {
        let c = self.corners(voxel);
        let cells = self.cells();
        let value = |t: f64| {
            let p = ray.at(t);
            let f: [f64; 3] = std::array::from_fn(|i| (p[i] * cells[i] - voxel[i] as f64).clamp(0.0, 1.0));
            let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
            let low = lerp(lerp(c[0], c[1], f[0]), lerp(c[2], c[3], f[0]), f[1]);
            let high = lerp(lerp(c[4], c[5], f[0]), lerp(c[6], c[7], f[0]), f[1]);
            lerp(low, high, f[2])
        };
        // The trilinear function is a cubic along the ray: its extrema split the interval into monotonic pieces.
        let h = t1 - t0;
        let samples = [value(t0), value(t0 + h / 3.0), value(t0 + 2.0 * h / 3.0), value(t1)];
        let mut bounds = [t0, t1, t1, t1];
        for (slot, s) in bounds[1..3].iter_mut().zip(cubic_extrema(samples)) {
            *slot = t0 + s.clamp(0.0, 1.0) * h;
        }
        bounds.windows(2).find_map(|pair| crossing(&value, pair[0], pair[1]))
    }
}

/// The places in [0, 1], ascending, where the cubic through values at 0, 1/3, 2/3, 1 turns; 1 where it does not.
fn cubic_extrema([y0, y1, y2, y3]: [f64; 4]) -> [f64; 2] {
    let a = 4.5 * (y3 - y0) + 13.5 * (y1 - y2);
    let b = 9.0 * y0 - 22.5 * y1 + 18.0 * y2 - 4.5 * y3;
    let c = -5.5 * y0 + 9.0 * y1 - 4.5 * y2 + y3;
    let (qa, qb) = (3.0 * a, 2.0 * b);
    let discriminant = qb * qb - 4.0 * qa * c;
    if discriminant <= 0.0 {
        return [1.0, 1.0];
    }
    let q = -0.5 * (qb + discriminant.sqrt().copysign(qb));
    let inside = |s: f64| if (0.0..=1.0).contains(&s) { s } else { 1.0 };
    let (s, t) = (inside(q / qa), inside(c / q));
    [s.min(t), s.max(t)]
}

/// The zero of a function that is monotonic between two parameters, by bisection and secants (regula falsi, Illinois).
fn crossing(f: &impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> Option<f64> {
    let (mut fa, mut fb) = (f(a), f(b));
    if fa == 0.0 {
        return Some(a);
    }
    if fa * fb > 0.0 || b <= a {
        return None;
    }
    for _ in 0..40 {
        let t = (a * fb - b * fa) / (fb - fa);
        let ft = f(t);
        if ft.abs() < 1e-14 || (b - a).abs() < 1e-12 {
            return Some(t);
        }
        if ft * fb < 0.0 {
            (a, fa) = (b, fb);
        } else {
            fa *= 0.5;
        }
        (b, fb) = (t, ft);
    }
    Some(b)
}

impl Element for SdfGrid {
    const SUMMARY: &'static str = "The zero level of signed distances on a grid over the unit cube.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "values",
            ty: "floats",
            default: "",
            doc: "signed distances, x fastest; negative inside",
        },
        ParamDoc { name: "resolution", ty: "ints", default: "", doc: "grid points in x, y, z" },
        ParamDoc { name: "normals", ty: "string", default: "smooth", doc: "`smooth` or `analytic`" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let invalid = |message: &str| SceneError::invalid(message, Span::NONE);
        let values = params.try_floats("values")?.ok_or_else(|| invalid("sdf_grid needs `values`"))?;
        let resolution =
            params.try_ints("resolution")?.ok_or_else(|| invalid("sdf_grid needs `resolution`"))?;
        let resolution = match *resolution {
            [x, y, z] if x >= 2 && y >= 2 && z >= 2 => [x as usize, y as usize, z as usize],
            _ => return Err(invalid("`resolution` must be three whole numbers of at least 2")),
        };
        if values.len() != resolution.iter().product::<usize>() || values.iter().any(|v| !v.is_finite()) {
            return Err(invalid("`values` must hold one finite number for each grid point"));
        }
        let normals =
            params.one_of("normals", &[("smooth", Normals::Smooth), ("analytic", Normals::Analytic)])?;
        let space = ObjectSpace::new(placement.world_from_object, placement.flip_normals);
        let mut grid =
            Self { space, values: values.to_vec().into(), resolution, normals, voxels: Vec::new() };
        let [nx, ny, nz] = resolution.map(|n| n as u32 - 1);
        let all = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
        let is_crossed = |v: &[u32; 3]| {
            let c = grid.corners(v.map(|i| i as usize));
            c.iter().any(|&x| x <= 0.0) && c.iter().any(|&x| x >= 0.0)
        };
        grid.voxels = all.filter(is_crossed).collect();
        Ok(grid)
    }
}

impl ShapeOps for SdfGrid {
    fn geometry(&self) -> Geometry {
        let cells = self.cells();
        let around = |v: &[u32; 3]| {
            let corner = |add: f64| {
                Point3::from(std::array::from_fn::<_, 3, _>(|i| ((f64::from(v[i]) + add) / cells[i]) as f32))
            };
            self.space.world_from_object.bounds(&Bounds3::new(corner(0.0), corner(1.0)))
        };
        Geometry::Boxes(self.voxels.iter().map(around).collect())
    }

    fn bounds(&self) -> Bounds3 {
        self.space.world_from_object.bounds(&Bounds3::new(Point3::ORIGIN, Point3::splat(1.0)))
    }

    fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
        let local = self.space.ray(ray);
        let voxel = self.voxels[primitive as usize].map(|i| i as usize);
        let cells = self.cells();
        let (mut t0, mut t1) = (local.t_min, local.t_max);
        for axis in 0..3 {
            let inv = 1.0 / local.d[axis];
            let a = (voxel[axis] as f64 / cells[axis] - local.o[axis]) * inv;
            let b = ((voxel[axis] + 1) as f64 / cells[axis] - local.o[axis]) * inv;
            t0 = t0.max(a.min(b));
            t1 = t1.min(a.max(b));
        }
        if t0 > t1 || t1.is_infinite() {
            return None;
        }
        let t = self.voxel_hit(voxel, &local, t0, t1)?;
        local.covers(t).then_some(ShapeHit { t: t as f32, primitive, uv: [0.0; 2] })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let p = self.space.ray(ray).at(f64::from(hit.t));
        let voxel = self.voxels[hit.primitive as usize].map(|i| i as usize);
        let direction =
            |g: [f64; 3]| Vector3::from(g.map(|x| x as f32)).try_normalized().unwrap_or(Vector3::Z);
        let ng = self.space.normal(direction(self.gradient(voxel, p)));
        let ns = match self.normals {
            Normals::Smooth => self.space.normal(direction(self.smooth_gradient(p))),
            Normals::Analytic => ng,
        };
        let (world, error) = self.space.place(Point3::from(p.map(|x| x as f32)));
        let frame = aureole_math::Frame::from_normal(ng);
        // The hit lies on the surface to within the ray parameter's precision, not the position's.
        let error = error + Vector3::splat(hit.t * ray.direction.length() * 4.0 * f32::EPSILON);
        let surface = SurfacePoint::new(world, error, ng, Point2::new(0.0, 0.0), frame.s, frame.t);
        SurfacePoint { primitive: hit.primitive, ..surface.with_shading_normal(ns) }
    }

    fn primitive_count(&self) -> usize {
        self.voxels.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrema_of_a_cubic() {
        // (s - 0.2)(s - 0.5)(s - 0.9): turns at (1.6 ± sqrt(0.37)) / 3.
        let f = |s: f64| (s - 0.2) * (s - 0.5) * (s - 0.9);
        let [a, b] = cubic_extrema([f(0.0), f(1.0 / 3.0), f(2.0 / 3.0), f(1.0)]);
        assert!(
            (a - (1.6 - 0.37_f64.sqrt()) / 3.0).abs() < 1e-9
                && (b - (1.6 + 0.37_f64.sqrt()) / 3.0).abs() < 1e-9
        );
        assert!((crossing(&f, 0.0, a).unwrap() - 0.2).abs() < 1e-9);
    }
}

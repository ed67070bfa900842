//! `bilinear_mesh`: quadrilateral patches, each the bilinear interpolation of its four corners.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `positions` | floats | | three numbers a vertex |
//! | `indices` | ints | 0 1 2 3 | four vertices a patch: (u, v) = (0,0), (1,0), (0,1), (1,1) |
//! | `normals` | floats | | three numbers a vertex |
//! | `uvs` | floats | | two numbers a vertex |
//!
//! References: [Reshetov 2019] "Cool Patches: A Geometric Approach to Ray/Bilinear Patch Intersections", Ray Tracing Gems.

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Discrete, Normal3, Point2, Point3, Ray, Vector3, gamma};

use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint};
use crate::{Element, Resolver};

/// Bilinear patches in level space.
#[derive(Clone, Debug)]
pub struct BilinearMesh {
    positions: Vec<Point3>,
    normals: Vec<Vector3>,
    uvs: Vec<Point2>,
    patches: Vec<[u32; 4]>,
    by_area: Discrete,
    orientation: f32,
}

/// Position and derivatives at a point of a patch.
struct PatchPoint {
    p: Point3,
    du: Vector3,
    dv: Vector3,
}

fn mix(c: [Vector3; 4], u: f32, v: f32) -> Vector3 {
    c[0] * ((1.0 - u) * (1.0 - v)) + c[1] * (u * (1.0 - v)) + c[2] * ((1.0 - u) * v) + c[3] * (u * v)
}

impl BilinearMesh {
    fn corners(&self, patch: usize) -> [Vector3; 4] {
        self.patches[patch].map(|i| self.positions[i as usize].to_vector())
    }

    fn at(&self, patch: usize, u: f32, v: f32) -> PatchPoint {
        let c = self.corners(patch);
        PatchPoint {
            p: mix(c, u, v).to_point(),
            du: (c[1] - c[0]) * (1.0 - v) + (c[3] - c[2]) * v,
            dv: (c[2] - c[0]) * (1.0 - u) + (c[3] - c[1]) * u,
        }
    }

    fn normal(&self, point: &PatchPoint) -> Vector3 {
        point.du.cross(point.dv).try_normalized().unwrap_or(Vector3::Z) * self.orientation
    }

    fn uv(&self, patch: usize, u: f32, v: f32) -> Point2 {
        if self.uvs.is_empty() {
            return Point2::new(u, v);
        }
        let [a, b, c, d] = self.patches[patch].map(|i| self.uvs[i as usize]);
        let blend = |a: f32, b: f32, c: f32, d: f32| {
            (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v
        };
        Point2::new(blend(a.x, b.x, c.x, d.x), blend(a.y, b.y, c.y, d.y))
    }

    fn patch_area(&self, patch: usize) -> f32 {
        const STEPS: usize = 8;
        let middle = |i: usize| (i as f32 + 0.5) / STEPS as f32;
        let areas = (0..STEPS * STEPS).map(|i| {
            let point = self.at(patch, middle(i % STEPS), middle(i / STEPS));
            point.du.cross(point.dv).length()
        });
        areas.sum::<f32>() / (STEPS * STEPS) as f32
    }

    fn pdf_area(&self, patch: usize, point: &PatchPoint) -> f32 {
        self.by_area.pmf(patch) / point.du.cross(point.dv).length()
    }
}

impl Element for BilinearMesh {
    const SUMMARY: &'static str = "Bilinear patches.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "positions", ty: "floats", default: "", doc: "three numbers a vertex" },
        ParamDoc { name: "indices", ty: "ints", default: "0 1 2 3", doc: "four vertices a patch" },
        ParamDoc { name: "normals", ty: "floats", default: "", doc: "three numbers a vertex" },
        ParamDoc { name: "uvs", ty: "floats", default: "", doc: "two numbers a vertex" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let place = &placement.world_from_object;
        let sign = if placement.flip_normals { -1.0 } else { 1.0 };
        let invalid = |message: &str| SceneError::invalid(message, Span::NONE);
        let triples = |list: Option<std::sync::Arc<[f32]>>| -> Vec<[f32; 3]> {
            list.map_or_else(Vec::new, |l| l.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
        };
        let positions: Vec<_> =
            triples(params.try_floats("positions")?).iter().map(|p| place.point(Point3::from(*p))).collect();
        let turn = |n: &[f32; 3]| Vector3::from(place.normal(Normal3::from(*n))) * sign;
        let normals: Vec<_> = triples(params.try_floats("normals")?).iter().map(turn).collect();
        let uvs: Vec<_> = params
            .try_floats("uvs")?
            .map_or_else(Vec::new, |l| l.chunks_exact(2).map(|c| Point2::new(c[0], c[1])).collect());
        let indices = params.try_ints("indices")?.unwrap_or_else(|| [0, 1, 2, 3].into());
        let n = positions.len();
        if indices.len() % 4 != 0 || indices.iter().any(|&i| i < 0 || i as usize >= n) {
            return Err(invalid("`indices` must name four existing vertices for each patch"));
        }
        if positions.iter().any(|p| !p.is_finite()) {
            return Err(invalid("`positions` must be finite"));
        }
        if (!normals.is_empty() && normals.len() != n) || (!uvs.is_empty() && uvs.len() != n) {
            return Err(invalid("`normals` and `uvs` must have one entry for each vertex"));
        }
        let patches: Vec<[u32; 4]> =
            indices.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]].map(|i| i as u32)).collect();
        let flip = placement.flip_normals != place.swaps_handedness();
        let placeholder = Discrete::new([1.0]).ok_or_else(|| invalid("no patches"))?;
        let orientation = if flip { -1.0 } else { 1.0 };
        let mut mesh = Self { positions, normals, uvs, patches, by_area: placeholder, orientation };
        mesh.by_area = Discrete::new((0..mesh.patches.len()).map(|i| mesh.patch_area(i)))
            .ok_or_else(|| invalid("the patches have no area"))?;
        Ok(mesh)
    }
}

impl ShapeOps for BilinearMesh {
    fn geometry(&self) -> Geometry {
        let around = |patch: usize| Bounds3::around(self.corners(patch).map(Vector3::to_point));
        Geometry::Boxes((0..self.patches.len()).map(around).collect())
    }

    fn bounds(&self) -> Bounds3 {
        Bounds3::around(self.positions.iter().copied())
    }

    fn intersect(&self, ray: &Ray, primitive: u32) -> Option<ShapeHit> {
        let [q00, q10, q01, q11] = self.corners(primitive as usize);
        let o = ray.origin.to_vector();
        let d = ray.direction;
        let (e10, e11, e00) = (q10 - q00, q11 - q10, q01 - q00);
        let qn = e10.cross(q01 - q11);
        let (q00, q10) = (q00 - o, q10 - o);
        let a = q00.cross(d).dot(e00);
        let c = qn.dot(d);
        let b = q10.cross(d).dot(e11) - (a + c);
        // A quadratic in u: the lines of constant u that the ray meets.
        let (a, b, c) = (f64::from(a), f64::from(b), f64::from(c));
        let roots: [f64; 2] = if c == 0.0 {
            [-a / b, f64::NAN]
        } else {
            let discriminant = b * b - 4.0 * a * c;
            if discriminant < 0.0 {
                return None;
            }
            let s = -(b + discriminant.sqrt().copysign(b)) * 0.5;
            [s / c, a / s]
        };
        let mut best: Option<ShapeHit> = None;
        for u in roots.map(|u| u as f32).into_iter().filter(|u| (0.0..=1.0).contains(u)) {
            let (pa, pb) = (q00.lerp(q10, u), e00.lerp(e11, u));
            let n = d.cross(pb);
            let det = n.dot(n);
            let n = n.cross(pa);
            let (t, v) = (n.dot(pb) / det, n.dot(d) / det);
            let limit = best.map_or(ray.t_max, |hit| hit.t);
            if (0.0..=1.0).contains(&v) && t > ray.t_min && t < limit {
                best = Some(ShapeHit { t, primitive, uv: [u, v] });
            }
        }
        best
    }

    fn surface(&self, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let patch = hit.primitive as usize;
        let [u, v] = hit.uv;
        let point = self.at(patch, u, v);
        let largest = self.corners(patch).iter().fold(Vector3::ZERO, |m, c| m.max(c.abs()));
        // The patch's own equation is solved in single precision: its error is that of a few more operations.
        let error = largest * gamma(16);
        let mut ng = self.normal(&point);
        let mut surface = SurfacePoint::new(point.p, error, ng, self.uv(patch, u, v), point.du, point.dv);
        if !self.normals.is_empty() {
            let n = mix(self.patches[patch].map(|i| self.normals[i as usize]), u, v);
            if let Some(n) = n.try_normalized() {
                ng = ng.face_forward(n);
                surface = SurfacePoint { ng, ..surface.with_shading_normal(n) };
            }
        }
        SurfacePoint { primitive: hit.primitive, ..surface }
    }

    fn area(&self) -> f32 {
        self.by_area.sum()
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        let choice = self.by_area.sample(u.x);
        let point = self.at(choice.index, choice.u, u.y);
        let pdf = self.pdf_area(choice.index, &point);
        let error = point.p.to_vector().abs() * gamma(16);
        let ng = self.normal(&point);
        pdf.is_finite().then(|| ShapeSample {
            p: point.p,
            error,
            ng,
            uv: self.uv(choice.index, choice.u, u.y),
            pdf,
        })
    }

    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        let cos = wi.abs_dot(surface.ng);
        let stretch = surface.dp_du.cross(surface.dp_dv).length();
        let pdf_area = self.by_area.pmf(surface.primitive as usize) / stretch;
        if cos > 0.0 { pdf_area * (surface.p - reference).length_squared() / cos } else { 0.0 }
    }

    fn primitive_count(&self) -> usize {
        self.patches.len()
    }
}

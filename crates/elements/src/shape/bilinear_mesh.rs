//! `bilinear_mesh`: quadrilateral patches, each the bilinear interpolation of its four corners.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `positions` | floats | | three numbers a vertex |
//! | `indices` | ints | 0 1 2 3 | four vertices a patch: (u, v) = (0,0), (1,0), (0,1), (1,1) |
//! | `normals` | floats | | three numbers a vertex |
//! | `uvs` | floats | | two numbers a vertex |
//! | `drawn` | string | by_area | where it shines, points are drawn `by_area`, or of `each_alike` of its patches |
//!
//! References: [Reshetov 2019] "Cool Patches: A Geometric Approach to Ray/Bilinear Patch Intersections", Ray Tracing Gems.

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Discrete, Normal3, Point2, Point3, Ray, Vector3, gamma};
use glam::DVec3;

use super::{Geometry, Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint};
use crate::{Element, Resolver};

/// Bilinear patches in level space.
#[derive(Clone, Debug)]
pub struct BilinearMesh {
    positions: Vec<Point3>,
    normals: Vec<Vector3>,
    uvs: Vec<Point2>,
    patches: Vec<[u32; 4]>,
    /// Which patches points are drawn from: in proportion to their area, or all alike.
    drawn: Discrete,
    area: f32,
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

    /// Derivatives of position by the texture coordinates, which need not be the patch's own parameters.
    fn derivatives(&self, patch: usize, [u, v]: [f32; 2], point: &PatchPoint) -> [Vector3; 2] {
        let own = [point.du, point.dv];
        if self.uvs.is_empty() {
            return own;
        }
        let [a, b, c, d] = self.patches[patch].map(|i| self.uvs[i as usize]);
        let by_u = (b - a) * (1.0 - v) + (d - c) * v;
        let by_v = (c - a) * (1.0 - u) + (d - b) * u;
        let inv = 1.0 / (by_u.x * by_v.y - by_u.y * by_v.x);
        let by_uv =
            [(point.du * by_v.y - point.dv * by_u.y) * inv, (point.dv * by_u.x - point.du * by_v.x) * inv];
        if by_uv.iter().all(|d| d.is_finite()) { by_uv } else { own }
    }

    /// The geometric normal on the side of vertex normals.
    fn outward(&self, patch: usize, u: f32, v: f32, point: &PatchPoint) -> Vector3 {
        let ng = self.normal(point);
        if self.normals.is_empty() {
            return ng;
        }
        ng.face_forward(mix(self.patches[patch].map(|i| self.normals[i as usize]), u, v))
    }

    /// The error of points of a patch. It is the same along all axes: where all corners lie in a plane of zero coordinates, none
    /// of them is rounded, but rays that meet the patch are.
    fn error(&self, patch: usize) -> Vector3 {
        let corners = self.corners(patch);
        let largest = corners.iter().map(|c| c.abs().max_element()).fold(0.0, f32::max);
        Vector3::splat(largest * gamma(8))
    }

    /// Where the line of a ray meets a patch, in double precision, so that rounding leaves no gaps between patches that share an
    /// edge and no hits of the patch that a ray leaves [Reshetov 2019].
    fn crossings(&self, ray: &Ray, patch: usize) -> [Option<ShapeHit>; 2] {
        /// How far beyond its edges a patch is still met, by its parameters.
        const SLACK: f64 = 1e-7;
        let wide = |v: Vector3| DVec3::new(v.x.into(), v.y.into(), v.z.into());
        let (o, d) = (wide(ray.origin.to_vector()), wide(ray.direction));
        let [q00, q10, q01, q11] = self.corners(patch).map(|corner| wide(corner) - o);
        let (across, opposite, start) = (q10 - q00, q11 - q10, q01 - q00);
        // A quadratic in u: the lines of constant u that the ray meets.
        let a = q00.cross(d).dot(start);
        let c = across.cross(q01 - q11).dot(d);
        let b = q10.cross(d).dot(opposite) - (a + c);
        let discriminant = b * b - 4.0 * a * c;
        let s = -0.5 * (b + discriminant.max(0.0).sqrt().copysign(b));
        let roots = if discriminant < 0.0 { [f64::NAN; 2] } else { [s / c, a / s] };
        let inside = -SLACK..=1.0 + SLACK;
        roots.map(|u| {
            if !inside.contains(&u) {
                return None;
            }
            let u = u.clamp(0.0, 1.0);
            let (from, along) = (q00.lerp(q10, u), start.lerp(opposite, u));
            let n = d.cross(along);
            let m = n.cross(from) / n.length_squared();
            let v = m.dot(d);
            let uv = [u as f32, v.clamp(0.0, 1.0) as f32];
            inside.contains(&v).then(|| ShapeHit { t: m.dot(along) as f32, primitive: patch as u32, uv })
        })
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
        self.drawn.pmf(patch) / point.du.cross(point.dv).length()
    }
}

impl Element for BilinearMesh {
    const SUMMARY: &'static str = "Bilinear patches.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "positions", ty: "floats", default: "", doc: "three numbers a vertex" },
        ParamDoc { name: "indices", ty: "ints", default: "0 1 2 3", doc: "four vertices a patch" },
        ParamDoc { name: "normals", ty: "floats", default: "", doc: "three numbers a vertex" },
        ParamDoc { name: "uvs", ty: "floats", default: "", doc: "two numbers a vertex" },
        super::DRAWN,
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
        let drawn = Discrete::new([1.0]).ok_or_else(|| invalid("no patches"))?;
        let orientation = if flip { -1.0 } else { 1.0 };
        let mut mesh = Self { positions, normals, uvs, patches, drawn, area: 0.0, orientation };
        let areas: Vec<f32> = (0..mesh.patches.len()).map(|i| mesh.patch_area(i)).collect();
        mesh.area = areas.iter().map(|&area| f64::from(area)).sum::<f64>() as f32;
        let all_alike = super::draws_all_alike(params)?;
        let weight = |area: &f32| if all_alike && *area > 0.0 { 1.0 } else { *area };
        mesh.drawn =
            Discrete::new(areas.iter().map(weight)).ok_or_else(|| invalid("the patches have no area"))?;
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
        let hits = self.crossings(ray, primitive as usize);
        let is_there = |hit: &ShapeHit| hit.t > ray.t_min && hit.t < ray.t_max;
        hits.into_iter().flatten().filter(is_there).min_by(|a, b| a.t.total_cmp(&b.t))
    }

    fn surface(&self, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let patch = hit.primitive as usize;
        let [u, v] = hit.uv;
        let point = self.at(patch, u, v);
        let mut ng = self.normal(&point);
        let [dp_du, dp_dv] = self.derivatives(patch, hit.uv, &point);
        let uv = self.uv(patch, u, v);
        let mut surface = SurfacePoint::new(point.p, self.error(patch), ng, uv, dp_du, dp_dv);
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
        self.area
    }

    fn primitive_area(&self, primitive: u32) -> f32 {
        self.patch_area(primitive as usize)
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        let choice = self.drawn.sample(u.x);
        let point = self.at(choice.index, choice.u, u.y);
        let pdf = self.pdf_area(choice.index, &point);
        pdf.is_finite().then(|| ShapeSample {
            p: point.p,
            error: self.error(choice.index),
            ng: self.outward(choice.index, choice.u, u.y, &point),
            uv: self.uv(choice.index, choice.u, u.y),
            primitive: choice.index as u32,
            pdf,
        })
    }

    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        let cos = wi.abs_dot(surface.ng);
        let patch = surface.primitive as usize;
        // The patch's own parameters, found again where the ray meets it.
        let far = |hit: &ShapeHit| {
            let [u, v] = hit.uv;
            (self.at(patch, u, v).p - surface.p).length_squared()
        };
        let hits = self.crossings(&Ray::new(reference, wi), patch);
        let Some(hit) = hits.into_iter().flatten().min_by(|a, b| far(a).total_cmp(&far(b))) else {
            return 0.0;
        };
        let pdf_area = self.pdf_area(patch, &self.at(patch, hit.uv[0], hit.uv[1]));
        if cos > 0.0 { pdf_area * (surface.p - reference).length_squared() / cos } else { 0.0 }
    }

    fn primitive_count(&self) -> usize {
        self.patches.len()
    }
}

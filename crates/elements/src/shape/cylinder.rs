//! `cylinder`: the open lateral surface of a cylinder between two points, normals outwards.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `p0`, `p1` | point | (0,0,0), (0,0,1) | the axis |
//! | `radius` | float | 1 | radius |
//! | `phi_max` | float | 360 | the part around the axis, in degrees |

use std::f32::consts::TAU;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Frame, Point2, Point3, Ray, Transform, Vector3, warp};

use super::quadric::ObjectSpace;
use super::{Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint};
use crate::{Element, Resolver};

/// The unit cylinder around Z from z = 0 to 1 in an object space.
#[derive(Clone, Debug)]
pub struct Cylinder {
    space: ObjectSpace,
    phi_max: f32,
    area: f32,
}

impl Cylinder {
    fn new(p0: Point3, p1: Point3, radius: f32, phi_max: f32, placement: &Placement) -> Option<Self> {
        let length = (p1 - p0).length();
        let frame = Frame::from_normal((p1 - p0).try_normalized()?);
        let columns = [frame.s * radius, frame.t * radius, frame.n * length, p0.to_vector()];
        let row = |i: usize, w: f64| {
            [f64::from(columns[0][i]), f64::from(columns[1][i]), f64::from(columns[2][i]), w]
        };
        let along = Transform::from_rows([
            row(0, p0.x.into()),
            row(1, p0.y.into()),
            row(2, p0.z.into()),
            [0.0, 0.0, 0.0, 1.0],
        ])?;
        let space = ObjectSpace::new(placement.world_from_object * along, placement.flip_normals);
        let mut cylinder = Self { space, phi_max, area: 0.0 };
        const STEPS: u32 = 1024;
        let scales = (0..STEPS)
            .map(|i| f64::from(space.area_scale(cylinder.normal_at((i as f32 + 0.5) / STEPS as f32))));
        cylinder.area = phi_max * (scales.sum::<f64>() / f64::from(STEPS)) as f32;
        Some(cylinder)
    }

    /// Object normal at a fraction of the way round.
    fn normal_at(&self, u: f32) -> Vector3 {
        let (sin, cos) = (u * self.phi_max).sin_cos();
        Vector3::new(cos, sin, 0.0)
    }

    fn pdf_area(&self, n: Vector3) -> f32 {
        1.0 / (self.phi_max * self.space.area_scale(n))
    }
}

impl Element for Cylinder {
    const SUMMARY: &'static str = "The open lateral surface of a cylinder between two points.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "p0", ty: "point", default: "0, 0, 0", doc: "start of the axis" },
        ParamDoc { name: "p1", ty: "point", default: "0, 0, 1", doc: "end of the axis" },
        ParamDoc { name: "radius", ty: "float", default: "1", doc: "radius" },
        ParamDoc {
            name: "phi_max",
            ty: "float",
            default: "360",
            doc: "the part around the axis, in degrees",
        },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let p0 = Point3::from(params.vec3("p0", [0.0; 3])?);
        let p1 = Point3::from(params.vec3("p1", [0.0, 0.0, 1.0])?);
        let radius = params.float_in("radius", 1.0, f32::MIN_POSITIVE, f32::INFINITY)?;
        let phi_max = params.float_in("phi_max", 360.0, 1e-3, 360.0)?.to_radians();
        Self::new(p0, p1, radius, phi_max, &placement)
            .ok_or_else(|| SceneError::invalid("the cylinder's `p0` and `p1` must differ", Span::NONE))
    }
}

impl ShapeOps for Cylinder {
    fn bounds(&self) -> Bounds3 {
        let unit = Bounds3::new(Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 1.0));
        self.space.world_from_object.bounds(&unit)
    }

    #[inline]
    fn intersect(&self, ray: &Ray, _: u32) -> Option<ShapeHit> {
        let local = self.space.ray(ray);
        let is_there = |t: &f64| {
            local.covers(*t) && {
                let [x, y, z] = local.at(*t).map(|x| x as f32);
                (0.0..=1.0).contains(&z) && (self.phi_max >= TAU || warp::azimuth(y, x) <= self.phi_max)
            }
        };
        let t = local.unit_quadric(2)?.into_iter().find(is_there)?;
        Some(ShapeHit { t: t as f32, primitive: 0, uv: [0.0; 2] })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let [x, y, z] = self.space.ray(ray).at(f64::from(hit.t)).map(|x| x as f32);
        let n = Vector3::new(x, y, 0.0).normalized();
        let (p, error) = self.space.place(Point3::new(n.x, n.y, z));
        let uv = Point2::new(warp::azimuth(y, x) / self.phi_max, z);
        let vector = |v| self.space.world_from_object.vector(v);
        let du = vector(Vector3::new(-n.y, n.x, 0.0) * self.phi_max);
        SurfacePoint::new(p, error, self.space.normal(n), uv, du, vector(Vector3::Z))
    }

    fn normal_change(&self, at: &SurfacePoint, _: &ShapeHit) -> [Vector3; 2] {
        let across = |v: Vector3| Vector3::new(v.x, v.y, 0.0);
        let n = across(self.space.local(at.p).to_vector()).normalized();
        [at.dp_du, at.dp_dv].map(|dp| self.space.normal_change(n, dp, across))
    }

    fn area(&self) -> f32 {
        self.area
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        let n = self.normal_at(u.x);
        let (p, error) = self.space.place(Point3::new(n.x, n.y, u.y));
        Some(ShapeSample { p, error, ng: self.space.normal(n), uv: u, primitive: 0, pdf: self.pdf_area(n) })
    }

    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        let local = self.space.local(surface.p);
        let n = Vector3::new(local.x, local.y, 0.0).normalized();
        let cos = wi.abs_dot(surface.ng);
        if cos > 0.0 { self.pdf_area(n) * (surface.p - reference).length_squared() / cos } else { 0.0 }
    }
}

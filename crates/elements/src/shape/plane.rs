//! `plane`: the infinite plane n·P + d = 0 of the lecture's slide.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `normal` | vector | 0, 0, 1 | n, of any length |
//! | `offset` | float | 0 | d, for a unit n |

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Frame, Normal3, Point2, Point3, Ray, Transform, Vector3, gamma};

use super::{Geometry, Placement, ShapeHit, ShapeOps, SurfacePoint};
use crate::{Element, Resolver};

/// An infinite plane. It cannot shine: its area is infinite.
#[derive(Clone, Debug)]
pub struct Plane {
    origin: Point3,
    frame: Frame,
}

impl Plane {
    /// The plane `normal · P + offset = 0` (for a unit normal), placed by a transform; `None` for a zero normal.
    pub fn new(normal: Vector3, offset: f32, world_from_object: &Transform) -> Option<Self> {
        let n = normal.try_normalized()?;
        let origin = world_from_object.point((n * -offset).to_point());
        let n = Vector3::from(world_from_object.normal(Normal3::from(n))).try_normalized()?;
        Some(Self { origin, frame: Frame::from_normal(n) })
    }
}

impl Element for Plane {
    const SUMMARY: &'static str = "The infinite plane n.P + d = 0.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "normal", ty: "vector", default: "0, 0, 1", doc: "n, of any length" },
        ParamDoc { name: "offset", ty: "float", default: "0", doc: "d, for a unit n" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let normal = Vector3::from(params.vec3("normal", [0.0, 0.0, 1.0])?);
        let sign = if placement.flip_normals { -1.0 } else { 1.0 };
        let offset = params.float("offset", 0.0)?;
        Self::new(normal * sign, offset * sign, &placement.world_from_object)
            .ok_or_else(|| SceneError::invalid("the plane's `normal` must not be zero", Span::NONE))
    }
}

impl ShapeOps for Plane {
    fn geometry(&self) -> Geometry {
        Geometry::Unbounded
    }

    fn bounds(&self) -> Bounds3 {
        Bounds3::EMPTY
    }

    #[inline]
    fn intersect(&self, ray: &Ray, _: u32) -> Option<ShapeHit> {
        // |denominator| < epsilon means parallel.
        let denominator = self.frame.n.dot(ray.direction);
        if denominator.abs() < f32::MIN_POSITIVE {
            return None;
        }
        let t = self.frame.n.dot(self.origin - ray.origin) / denominator;
        (t > ray.t_min && t < ray.t_max).then_some(ShapeHit { t, primitive: 0, uv: [0.0; 2] })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let rough = ray.at(hit.t) - self.origin;
        let (u, v) = (rough.dot(self.frame.s), rough.dot(self.frame.t));
        // Back onto the plane, so that the error no longer grows with the ray's length.
        let p = self.origin + self.frame.s * u + self.frame.t * v;
        let terms = self.origin.to_vector().abs() + (self.frame.s * u).abs() + (self.frame.t * v).abs();
        SurfacePoint::new(p, terms * gamma(6), self.frame.n, Point2::new(u, v), self.frame.s, self.frame.t)
    }
}

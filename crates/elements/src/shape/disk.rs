//! `disk`: a disk or ring in a plane of constant z, its normal along +Z.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radius` | float | 1 | outer radius |
//! | `inner_radius` | float | 0 | radius of the hole |
//! | `height` | float | 0 | z |
//! | `phi_max` | float | 360 | the part around Z, in degrees |
//! | `uv` | string | radius_angle | which of radius and angle is u; `angle_radius` counts v inwards |

use std::f32::consts::TAU;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Point2, Point3, Ray, Vector3, warp};

use super::quadric::ObjectSpace;
use super::{Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint};
use crate::{Element, Resolver};

/// How texture coordinates run over a disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Parametrisation {
    /// u along the radius, v around (Mitsuba).
    RadiusAngle,
    /// u around, v from the rim inwards (pbrt).
    AngleRadius,
}

/// A disk, a ring, or a sector of one.
#[derive(Clone, Debug)]
pub struct Disk {
    space: ObjectSpace,
    radius: f32,
    inner: f32,
    height: f32,
    phi_max: f32,
    uv: Parametrisation,
}

impl Element for Disk {
    const SUMMARY: &'static str = "A disk or ring, its normal along +Z.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "radius", ty: "float", default: "1", doc: "outer radius" },
        ParamDoc { name: "inner_radius", ty: "float", default: "0", doc: "radius of the hole" },
        ParamDoc { name: "height", ty: "float", default: "0", doc: "z" },
        ParamDoc { name: "phi_max", ty: "float", default: "360", doc: "the part around Z, in degrees" },
        ParamDoc {
            name: "uv",
            ty: "string",
            default: "radius_angle",
            doc: "`radius_angle` or `angle_radius`",
        },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let radius = params.float_in("radius", 1.0, f32::MIN_POSITIVE, f32::INFINITY)?;
        Ok(Self {
            space: ObjectSpace::new(placement.world_from_object, placement.flip_normals),
            radius,
            inner: params.float_in("inner_radius", 0.0, 0.0, radius)?,
            height: params.float("height", 0.0)?,
            phi_max: params.float_in("phi_max", 360.0, 1e-3, 360.0)?.to_radians(),
            uv: params.one_of(
                "uv",
                &[
                    ("radius_angle", Parametrisation::RadiusAngle),
                    ("angle_radius", Parametrisation::AngleRadius),
                ],
            )?,
        })
    }
}

impl Disk {
    fn coordinates(&self, r: f32, phi: f32) -> Point2 {
        let width = (self.radius - self.inner).max(f32::MIN_POSITIVE);
        match self.uv {
            Parametrisation::RadiusAngle => Point2::new((r - self.inner) / width, phi / self.phi_max),
            Parametrisation::AngleRadius => Point2::new(phi / self.phi_max, (self.radius - r) / width),
        }
    }

    fn object_area(&self) -> f32 {
        0.5 * self.phi_max * (self.radius * self.radius - self.inner * self.inner)
    }
}

impl ShapeOps for Disk {
    fn bounds(&self) -> Bounds3 {
        let corner = Vector3::new(self.radius, self.radius, 0.0);
        let middle = Point3::new(0.0, 0.0, self.height);
        self.space.world_from_object.bounds(&Bounds3::new(middle - corner, middle + corner))
    }

    #[inline]
    fn intersect(&self, ray: &Ray, _: u32) -> Option<ShapeHit> {
        let local = self.space.ray(ray);
        if local.d[2] == 0.0 {
            return None;
        }
        let t = (f64::from(self.height) - local.o[2]) / local.d[2];
        if !local.covers(t) {
            return None;
        }
        let [x, y, _] = local.at(t).map(|x| x as f32);
        let r2 = x * x + y * y;
        let is_there = r2 <= self.radius * self.radius
            && r2 >= self.inner * self.inner
            && (self.phi_max >= TAU || warp::azimuth(y, x) <= self.phi_max);
        is_there.then_some(ShapeHit { t: t as f32, primitive: 0, uv: [x, y] })
    }

    fn surface(&self, _: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let [x, y] = hit.uv;
        let (p, error) = self.space.place(Point3::new(x, y, self.height));
        let r = (x * x + y * y).sqrt();
        let (cos, sin) = if r > 0.0 { (x / r, y / r) } else { (1.0, 0.0) };
        let outwards = Vector3::new(cos, sin, 0.0) * (self.radius - self.inner);
        let around = Vector3::new(-sin, cos, 0.0) * (r.max(1e-6 * self.radius) * self.phi_max);
        let vector = |v| self.space.world_from_object.vector(v);
        let (du, dv) = match self.uv {
            Parametrisation::RadiusAngle => (vector(outwards), vector(around)),
            Parametrisation::AngleRadius => (vector(around), vector(-outwards)),
        };
        let uv = self.coordinates(r, warp::azimuth(y, x));
        SurfacePoint::new(p, error, self.space.normal(Vector3::Z), uv, du, dv)
    }

    fn area(&self) -> f32 {
        self.object_area() * self.space.area_scale(Vector3::Z)
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        let (phi, r) = if self.inner == 0.0 && self.phi_max >= TAU {
            let d = warp::square_to_disk_concentric(u);
            (warp::azimuth(d.y, d.x), d.x.hypot(d.y) * self.radius)
        } else {
            let [r2, i2] = [self.radius, self.inner].map(|r| r * r);
            (u.x * self.phi_max, (i2 + (r2 - i2) * u.y).sqrt())
        };
        let (sin, cos) = phi.sin_cos();
        let (p, error) = self.space.place(Point3::new(r * cos, r * sin, self.height));
        let ng = self.space.normal(Vector3::Z);
        Some(ShapeSample { p, error, ng, uv: self.coordinates(r, phi), primitive: 0, pdf: 1.0 / self.area() })
    }
}

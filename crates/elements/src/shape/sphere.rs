//! `sphere`: a sphere, whole or in part; an ellipsoid when its transform scales unevenly.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `center` | point | 0, 0, 0 | centre |
//! | `radius` | float | 1 | radius, > 0 |
//! | `z_min`, `z_max` | float | whole | cuts the sphere at these heights |
//! | `phi_max` | float | 360 | the part around Z, in degrees |
//! | `flip_v` | bool | false | v grows towards +Z instead of away from it |

use std::f32::consts::{PI, TAU};

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Frame, Point2, Point3, Ray, Transform, Vector3, warp};

use super::quadric::ObjectSpace;
use super::{Placement, ShapeHit, ShapeOps, ShapeSample, SurfacePoint};
use crate::{Element, Resolver};

/// The unit sphere in an object space.
#[derive(Clone, Debug)]
pub struct Sphere {
    space: ObjectSpace,
    /// Heights between which the sphere is there, on the unit sphere.
    z: [f32; 2],
    phi_max: f32,
    flip_v: bool,
    area: f32,
    /// World centre and radius of a whole, evenly scaled sphere: it can be sampled by its cone.
    ball: Option<(Point3, f32)>,
}

impl Sphere {
    /// A whole sphere placed by a transform.
    pub fn new(center: Point3, radius: f32, world_from_object: &Transform) -> Self {
        Self::part(center, radius, world_from_object, false, [-1.0, 1.0], TAU, false)
    }

    fn part(
        center: Point3,
        radius: f32,
        world_from_object: &Transform,
        flip_normals: bool,
        z: [f32; 2],
        phi_max: f32,
        flip_v: bool,
    ) -> Self {
        let place = *world_from_object
            * Transform::translate(center.to_vector())
            * Transform::scale(Vector3::splat(radius));
        let space = ObjectSpace::new(place, flip_normals);
        let axes = [Vector3::X, Vector3::Y, Vector3::Z].map(|a| place.vector(a));
        let size = axes[0].length();
        let even = axes.iter().all(|a| (a.length() - size).abs() < 1e-4 * size)
            && (0..3).all(|i| axes[i].dot(axes[(i + 1) % 3]).abs() < 1e-4 * size * size);
        let whole = z == [-1.0, 1.0] && phi_max >= TAU;
        let ball = (even && whole).then(|| (place.point(Point3::ORIGIN), size));
        let mut sphere = Self { space, z, phi_max, flip_v, area: 0.0, ball };
        sphere.area = sphere.measure();
        sphere
    }

    /// The area: exact when evenly scaled, else by a midpoint rule over the sphere.
    fn measure(&self) -> f32 {
        if let Some((_, radius)) = self.ball {
            return 4.0 * PI * radius * radius;
        }
        const STEPS: usize = 256;
        let object_area = (self.z[1] - self.z[0]) * self.phi_max;
        let mut sum = 0.0;
        for i in 0..STEPS {
            for j in 0..STEPS {
                let u = Point2::new((i as f32 + 0.5) / STEPS as f32, (j as f32 + 0.5) / STEPS as f32);
                sum += f64::from(self.space.area_scale(self.direction(u)));
            }
        }
        object_area * (sum / (STEPS * STEPS) as f64) as f32
    }

    /// A uniformly distributed unit vector of the part that is there.
    fn direction(&self, u: Point2) -> Vector3 {
        let z = self.z[1] + (self.z[0] - self.z[1]) * u.y;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (u.x * self.phi_max).sin_cos();
        Vector3::new(r * cos, r * sin, z)
    }

    fn uv(&self, n: Vector3) -> Point2 {
        let [bottom, top] = self.z.map(|z| z.clamp(-1.0, 1.0).acos());
        let v = (warp::polar_angle(n) - top) / (bottom - top);
        Point2::new(warp::azimuth(n.y, n.x) / self.phi_max, if self.flip_v { 1.0 - v } else { v })
    }

    fn sample_at(&self, n: Vector3, pdf: f32) -> ShapeSample {
        let (p, error) = self.space.place(n.to_point());
        ShapeSample { p, error, ng: self.space.normal(n), uv: self.uv(n), primitive: 0, pdf }
    }

    /// Density per unit world area at object normal `n`.
    fn pdf_area(&self, n: Vector3) -> f32 {
        1.0 / ((self.z[1] - self.z[0]) * self.phi_max * self.space.area_scale(n))
    }

    /// `1 - cos` of the half angle under which an outside point sees the ball; `None` from inside.
    fn cone(center: Point3, radius: f32, reference: Point3) -> Option<f32> {
        let sin2 = radius * radius / (center - reference).length_squared();
        (sin2 < 0.9999).then(|| sin2 / (1.0 + (1.0 - sin2).sqrt()))
    }
}

impl Element for Sphere {
    const SUMMARY: &'static str = "A sphere, whole or in part.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "center", ty: "point", default: "0, 0, 0", doc: "centre" },
        ParamDoc { name: "radius", ty: "float", default: "1", doc: "radius, > 0" },
        ParamDoc { name: "z_min", ty: "float", default: "-radius", doc: "the sphere ends below this height" },
        ParamDoc { name: "z_max", ty: "float", default: "radius", doc: "the sphere ends above this height" },
        ParamDoc { name: "phi_max", ty: "float", default: "360", doc: "the part around Z, in degrees" },
        ParamDoc { name: "flip_v", ty: "bool", default: "false", doc: "v grows towards +Z" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let placement = Placement::from_params(params)?;
        let center = Point3::from(params.vec3("center", [0.0; 3])?);
        let radius = params.float_in("radius", 1.0, f32::MIN_POSITIVE, f32::INFINITY)?;
        let (a, b) = (params.float("z_min", -radius)?, params.float("z_max", radius)?);
        let z = [a.min(b), a.max(b)].map(|z| (z / radius).clamp(-1.0, 1.0));
        let phi_max = params.float_in("phi_max", 360.0, 1e-3, 360.0)?.to_radians();
        let flip_v = params.bool("flip_v", false)?;
        Ok(Self::part(
            center,
            radius,
            &placement.world_from_object,
            placement.flip_normals,
            z,
            phi_max,
            flip_v,
        ))
    }
}

impl ShapeOps for Sphere {
    fn bounds(&self) -> Bounds3 {
        // The box of an ellipsoid: each axis reaches as far as the length of its row [exact for linear maps].
        let rows = self.space.world_from_object.rows();
        let reach =
            |i: usize| ((0..3).map(|j| rows[i][j] * rows[i][j]).sum::<f64>().sqrt() * 1.000_001) as f32;
        let (center, half) =
            (self.space.world_from_object.point(Point3::ORIGIN), Vector3::new(reach(0), reach(1), reach(2)));
        Bounds3::new(center - half, center + half)
    }

    #[inline]
    fn intersect(&self, ray: &Ray, _: u32) -> Option<ShapeHit> {
        let local = self.space.ray(ray);
        let crossings = local.unit_quadric(3)?;
        let is_there = |t: &f64| {
            local.covers(*t) && {
                let p = local.at(*t).map(|x| x as f32);
                (p[2] >= self.z[0] || self.z[0] <= -1.0)
                    && (p[2] <= self.z[1] || self.z[1] >= 1.0)
                    && (self.phi_max >= TAU || warp::azimuth(p[1], p[0]) <= self.phi_max)
            }
        };
        let t = crossings.into_iter().find(is_there)?;
        Some(ShapeHit { t: t as f32, primitive: 0, uv: [0.0; 2] })
    }

    fn surface(&self, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let local = self.space.ray(ray);
        let n = Vector3::from(local.at(f64::from(hit.t)).map(|x| x as f32)).normalized();
        let (p, error) = self.space.place(n.to_point());
        let scale = [self.phi_max, self.z[0].acos() - self.z[1].acos()];
        let r = (n.x * n.x + n.y * n.y).sqrt();
        // Along the parallel and along the meridian; at a pole any pair of tangents will do.
        let (du, dv) = if r > 1e-7 {
            (Vector3::new(-n.y, n.x, 0.0), Vector3::new(n.z * n.x / r, n.z * n.y / r, -r))
        } else {
            (Vector3::X, Vector3::Y * n.z.signum())
        };
        let dv = if self.flip_v { -dv } else { dv };
        let vector = |v| self.space.world_from_object.vector(v);
        SurfacePoint::new(
            p,
            error,
            self.space.normal(n),
            self.uv(n),
            vector(du * scale[0]),
            vector(dv * scale[1]),
        )
    }

    fn normal_change(&self, at: &SurfacePoint, _: &ShapeHit) -> [Vector3; 2] {
        let n = self.space.local(at.p).to_vector().normalized();
        [at.dp_du, at.dp_dv].map(|dp| self.space.normal_change(n, dp, |v| v))
    }

    fn area(&self) -> f32 {
        self.area
    }

    fn sample_area(&self, u: Point2) -> Option<ShapeSample> {
        let n = self.direction(u);
        Some(self.sample_at(n, self.pdf_area(n)))
    }

    fn sample_towards(&self, reference: Point3, u: Point2) -> Option<ShapeSample> {
        let Some((center, radius)) = self.ball else {
            return self.sample_area(u)?.into_solid_angle(reference);
        };
        let Some(one_minus_cos) = Self::cone(center, radius, reference) else {
            return self.sample_area(u)?.into_solid_angle(reference);
        };
        // A direction in the cone, and from it the point of the sphere that it sees first [PBRT4, section 6.2.4].
        let axis = center - reference;
        let distance = axis.length();
        let w = warp::square_to_uniform_cone(u, one_minus_cos);
        let sin2 = (1.0 - w.z * w.z).max(0.0);
        let t = distance * w.z - (radius * radius - distance * distance * sin2).max(0.0).sqrt();
        let direction = Frame::from_normal(axis / distance).to_world(w);
        let n = self.space.local(reference + direction * t).to_vector().try_normalized()?;
        Some(self.sample_at(n, warp::uniform_cone_pdf(one_minus_cos)))
    }

    fn pdf_towards(&self, reference: Point3, wi: Vector3, surface: &SurfacePoint) -> f32 {
        if let Some((center, radius)) = self.ball
            && let Some(one_minus_cos) = Self::cone(center, radius, reference)
        {
            return warp::uniform_cone_pdf(one_minus_cos);
        }
        let n = self.space.local(surface.p).to_vector().normalized();
        let cos = wi.abs_dot(surface.ng);
        if cos > 0.0 { self.pdf_area(n) * (surface.p - reference).length_squared() / cos } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_sphere_is_hit_where_it_should_be() {
        // The naive quadratic loses all digits here.
        let sphere = Sphere::new(Point3::new(0.0, 0.0, 1e5), 1.0, &Transform::IDENTITY);
        let hit = sphere.intersect(&Ray::new(Point3::ORIGIN, Vector3::Z), 0).unwrap();
        assert!((hit.t - 99_999.0).abs() < 0.02);
    }

    #[test]
    fn an_ellipsoid_has_knuds_area() {
        let scale = Transform::scale(Vector3::new(1.0, 2.0, 3.0));
        let sphere = Sphere::new(Point3::ORIGIN, 1.0, &scale);
        // Closed form by elliptic integrals: 48.8822 for semi-axes 1, 2, 3.
        assert!((sphere.area() - 48.8822).abs() < 0.01, "{}", sphere.area());
    }

    #[test]
    fn partial_spheres_have_holes() {
        let sphere = Sphere::part(Point3::ORIGIN, 1.0, &Transform::IDENTITY, false, [-1.0, 0.5], TAU, false);
        let hit = sphere.intersect(&Ray::new(Point3::new(0.0, 0.0, 3.0), -Vector3::Z), 0).unwrap();
        assert!((hit.t - 4.0).abs() < 1e-5, "through the missing cap onto the inside");
        assert!((sphere.area() - TAU * 1.5).abs() < 1e-3);
    }
}

//! What spheres, disks and cylinders share: an object space, and quadratic equations.

use aureole_math::{Normal3, Point3, Ray, Transform, Vector3, gamma};

use super::surface::normal_change;

/// A shape's own space and the way to its level's.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectSpace {
    pub world_from_object: Transform,
    object_from_world: Transform,
    /// |det| of the linear part.
    volume_scale: f32,
    /// -1 when normals are turned round.
    pub orientation: f32,
}

impl ObjectSpace {
    pub(super) fn new(world_from_object: Transform, flip_normals: bool) -> Self {
        let [x, y, z] = [Vector3::X, Vector3::Y, Vector3::Z].map(|axis| world_from_object.vector(axis));
        Self {
            world_from_object,
            object_from_world: world_from_object.inverse(),
            volume_scale: x.cross(y).dot(z).abs(),
            orientation: if flip_normals { -1.0 } else { 1.0 },
        }
    }

    /// A ray in object space, in double precision: what a single one would round away is more than what keeps rays off the
    /// surface that they leave.
    #[inline]
    pub(super) fn ray(&self, ray: &Ray) -> ObjectRay {
        let o = self.object_from_world.point_f64(ray.origin.to_array().map(f64::from));
        let d = self.object_from_world.vector_f64(ray.direction.to_array().map(f64::from));
        ObjectRay { o, d, t_min: f64::from(ray.t_min), t_max: f64::from(ray.t_max) }
    }

    /// A world point in object space.
    #[inline]
    pub(super) fn local(&self, p: Point3) -> Point3 {
        self.object_from_world.point(p)
    }

    /// By how much areas around a point with unit object normal `n` are stretched.
    pub(super) fn area_scale(&self, n: Vector3) -> f32 {
        self.volume_scale * Vector3::from(self.world_from_object.normal(Normal3::from(n))).length()
    }

    /// The outward unit normal in the world of an object normal.
    pub(super) fn normal(&self, n: Vector3) -> Vector3 {
        Vector3::from(self.world_from_object.normal(n.into())).normalized() * self.orientation
    }

    /// How the unit normal changes along the world's `dp`, where the unit object normal `n` changes as `dn` of that way in
    /// object space.
    pub(super) fn normal_change(&self, n: Vector3, dp: Vector3, dn: impl Fn(Vector3) -> Vector3) -> Vector3 {
        let dn = dn(self.object_from_world.vector(dp));
        normal_change(&self.world_from_object, n, dn) * self.orientation
    }

    /// World position of an object point and the bound on its error.
    pub(super) fn place(&self, p: Point3) -> (Point3, Vector3) {
        let rows = self.world_from_object.rows();
        let magnitude = |i: usize| {
            (0..3).map(|j| (rows[i][j] as f32 * p[j]).abs()).sum::<f32>() + (rows[i][3] as f32).abs()
        };
        // The point itself (γ5) and its way into the world (γ4), each row's sum of absolute terms as the bound.
        let error = Vector3::new(magnitude(0), magnitude(1), magnitude(2)) * gamma(9);
        (self.world_from_object.point(p), error)
    }
}

/// A ray in object space.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectRay {
    pub o: [f64; 3],
    pub d: [f64; 3],
    pub t_min: f64,
    pub t_max: f64,
}

impl ObjectRay {
    /// The point at `t`.
    #[inline]
    pub(super) fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|i| self.o[i] + t * self.d[i])
    }

    /// Whether `t` lies on the ray.
    #[inline]
    pub(super) fn covers(&self, t: f64) -> bool {
        t > self.t_min && t < self.t_max
    }

    /// Both crossings with the unit sphere (`dimensions` = 3) or the unit cylinder around Z (2), nearest first.
    ///
    /// The equation is solved around the point nearest to the axis, which keeps precision far from the origin
    /// [Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems].
    #[inline]
    pub(super) fn unit_quadric(&self, dimensions: usize) -> Option<[f64; 2]> {
        let (o, d) = (&self.o[..dimensions], &self.d[..dimensions]);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let a = dot(d, d);
        if a == 0.0 {
            return None;
        }
        let t_nearest = -dot(o, d) / a;
        let distance2: f64 = o.iter().zip(d).map(|(o, d)| (o + t_nearest * d).powi(2)).sum();
        if distance2 > 1.0 || distance2.is_nan() {
            return None;
        }
        let half = ((1.0 - distance2) / a).sqrt();
        Some([t_nearest - half, t_nearest + half])
    }
}

//! What is known about a point of a surface.

use aureole_math::{Frame, Point2, Point3, Ray, Transform, Vector3, gamma, offset_ray_origin};

/// A point of a surface, in the space of whoever asks (world space for integrators).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position.
    pub p: Point3,
    /// Bound on the absolute rounding error of each coordinate of `p`.
    pub error: Vector3,
    /// Unit geometric normal; it points outwards.
    pub ng: Vector3,
    /// Shading frame: `n` is the (interpolated) shading normal, `s` follows `dp_du`.
    pub frame: Frame,
    /// Surface parameters for textures.
    pub uv: Point2,
    /// Derivative of position by u.
    pub dp_du: Vector3,
    /// Derivative of position by v.
    pub dp_dv: Vector3,
    /// Derivatives of the shading normal by u and v; zero unless a material asks, and where they are not known.
    pub dn_duv: [Vector3; 2],
    /// Whether the shading normal is interpolated between those of vertices.
    pub has_vertex_normals: bool,
    /// The triangle, patch or part of the shape.
    pub primitive: u32,
}

/// How the unit normal changes in another space where the unit normal `n` changes by `dn`.
pub(super) fn normal_change(transform: &Transform, n: Vector3, dn: Vector3) -> Vector3 {
    let [turned, change] = [n, dn].map(|v| Vector3::from(transform.normal(v.into())));
    let unit = turned.normalized();
    (change - unit * unit.dot(change)) / turned.length()
}

impl SurfacePoint {
    /// A point whose shading frame follows its geometric normal.
    pub fn new(p: Point3, error: Vector3, ng: Vector3, uv: Point2, dp_du: Vector3, dp_dv: Vector3) -> Self {
        Self {
            p,
            error,
            ng,
            frame: Frame::from_normal_and_tangent(ng, dp_du),
            uv,
            dp_du,
            dp_dv,
            dn_duv: [Vector3::ZERO; 2],
            has_vertex_normals: false,
            primitive: 0,
        }
    }

    /// The same point with another shading normal.
    pub fn with_shading_normal(self, ns: Vector3) -> Self {
        Self { frame: Frame::from_normal_and_tangent(ns, self.dp_du), ..self }
    }

    /// A ray that leaves the point towards `w` and cannot hit the same surface again by rounding.
    #[inline]
    pub fn spawn_ray(&self, w: Vector3, time: f32) -> Ray {
        Ray { time, ..Ray::new(offset_ray_origin(self.p, self.error, self.ng, w), w) }
    }

    /// The point in another space.
    pub fn transformed(&self, transform: &Transform) -> Self {
        let normal = |n: Vector3| Vector3::from(transform.normal(n.into())).normalized();
        let (p, error) = place(transform, self.p, self.error + way_back_error(transform, self.p));
        let (dp_du, dp_dv) = (transform.vector(self.dp_du), transform.vector(self.dp_dv));
        let frame = Frame::from_normal_and_tangent(normal(self.frame.n), dp_du);
        let dn_duv = if self.dn_duv == [Vector3::ZERO; 2] {
            self.dn_duv
        } else {
            self.dn_duv.map(|dn| normal_change(transform, self.frame.n, dn))
        };
        Self { p, error, ng: normal(self.ng), frame, dp_du, dp_dv, dn_duv, ..*self }
    }
}

/// A point in another space, and its error: that grows with the map's stretch, and the map itself rounds.
fn place(transform: &Transform, p: Point3, error: Vector3) -> (Point3, Vector3) {
    let rows = transform.rows();
    let stretch = |i: usize| (0..3).map(|j| rows[i][j].abs() as f32 * error[j]).sum::<f32>();
    let magnitude =
        |i: usize| (0..3).map(|j| (rows[i][j] as f32 * p[j]).abs()).sum::<f32>() + (rows[i][3] as f32).abs();
    let row = |i: usize| stretch(i) * (1.0 + gamma(4)) + magnitude(i) * gamma(4);
    (transform.point(p), Vector3::new(row(0), row(1), row(2)))
}

/// By how much a ray that leaves the point in the other space may miss its start when it is brought back, by rounding.
fn way_back_error(transform: &Transform, p: Point3) -> Vector3 {
    let (rows, back) = (transform.rows(), transform.inverse().rows());
    let magnitude = |row: &[f64; 4], p: [f32; 3]| {
        (0..3).map(|j| (row[j] as f32 * p[j]).abs()).sum::<f32>() + row[3].abs() as f32
    };
    let there = [0, 1, 2].map(|i| magnitude(&rows[i], p.to_array()));
    let error = [0, 1, 2].map(|i| magnitude(&back[i], there) * gamma(4));
    Vector3::from(error)
}

/// A point drawn from a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeSample {
    /// Position.
    pub p: Point3,
    /// Bound on the rounding error of `p`.
    pub error: Vector3,
    /// Unit geometric normal.
    pub ng: Vector3,
    /// Surface parameters.
    pub uv: Point2,
    /// The triangle, patch or part of the shape.
    pub primitive: u32,
    /// Density: per unit area from `sample_area`, per steradian from `sample_towards`.
    pub pdf: f32,
}

impl ShapeSample {
    /// The point in another space, its density left as it was.
    pub fn transformed(&self, transform: &Transform) -> Self {
        let (p, error) = place(transform, self.p, self.error);
        let ng = Vector3::from(transform.normal(self.ng.into())).normalized();
        Self { p, error, ng, ..*self }
    }

    /// Converts a density per area into one per steradian at `reference`; `None` at grazing angles.
    #[inline]
    pub fn into_solid_angle(self, reference: Point3) -> Option<Self> {
        let d = self.p - reference;
        let d2 = d.length_squared();
        let cos = d.abs_dot(self.ng) / d2.sqrt();
        let pdf = self.pdf * d2 / cos;
        (cos > 0.0 && d2 > 0.0 && pdf.is_finite()).then_some(Self { pdf, ..self })
    }
}

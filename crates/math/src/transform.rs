//! Affine and projective maps.

use std::ops::Mul;

use glam::{DMat4, DVec3, DVec4, Mat4, Vec3};

use crate::{Bounds3, Normal3, Point3, Ray, Vector3};

/// A 4×4 matrix with its inverse; points are columns: p' = M p.
///
/// Composed in double precision, applied in single.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    exact: DMat4,
    exact_inverse: DMat4,
    matrix: Mat4,
    inverse: Mat4,
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// The map that changes nothing.
    pub const IDENTITY: Self = Self {
        exact: DMat4::IDENTITY,
        exact_inverse: DMat4::IDENTITY,
        matrix: Mat4::IDENTITY,
        inverse: Mat4::IDENTITY,
    };

    pub(crate) fn of(exact: DMat4, exact_inverse: DMat4) -> Self {
        Self { exact, exact_inverse, matrix: exact.as_mat4(), inverse: exact_inverse.as_mat4() }
    }

    /// From rows; `None` when the matrix is singular or not finite.
    pub fn from_rows(rows: [[f64; 4]; 4]) -> Option<Self> {
        let matrix = DMat4::from_cols_array_2d(&rows).transpose();
        let inverse = matrix.inverse();
        (matrix.is_finite() && inverse.is_finite() && matrix.determinant() != 0.0)
            .then(|| Self::of(matrix, inverse))
    }

    /// The matrix by rows.
    pub fn rows(&self) -> [[f64; 4]; 4] {
        self.exact.transpose().to_cols_array_2d()
    }

    /// Moves by a vector.
    pub fn translate(by: Vector3) -> Self {
        let v = DVec3::new(by.x.into(), by.y.into(), by.z.into());
        Self::of(DMat4::from_translation(v), DMat4::from_translation(-v))
    }

    /// Scales along the axes. A zero factor gives a map without inverse: check with [`is_invertible`](Self::is_invertible).
    pub fn scale(by: Vector3) -> Self {
        let v = DVec3::new(by.x.into(), by.y.into(), by.z.into());
        Self::of(DMat4::from_scale(v), DMat4::from_scale(v.recip()))
    }

    /// Turns counter-clockwise around an axis, in degrees; the identity for a zero axis.
    pub fn rotate(axis: Vector3, degrees: f64) -> Self {
        let axis = DVec3::new(axis.x.into(), axis.y.into(), axis.z.into());
        match axis.try_normalize() {
            Some(axis) => {
                let matrix = DMat4::from_axis_angle(axis, degrees.to_radians());
                Self::of(matrix, matrix.transpose())
            }
            None => Self::IDENTITY,
        }
    }

    /// World from camera: +Z towards the target, +Y up, +X to the left of the image (right-handed).
    ///
    /// `None` when the directions are degenerate.
    pub fn look_at(origin: Point3, target: Point3, up: Vector3) -> Option<Self> {
        let d = |v: Vector3| DVec3::new(v.x.into(), v.y.into(), v.z.into());
        let forward = (d(target.to_vector()) - d(origin.to_vector())).try_normalize()?;
        let left = d(up).cross(forward).try_normalize()?;
        let up = forward.cross(left);
        let o = d(origin.to_vector());
        let matrix = DMat4::from_cols(left.extend(0.0), up.extend(0.0), forward.extend(0.0), o.extend(1.0));
        Some(Self::of(matrix, matrix.inverse()))
    }

    /// The map back.
    pub fn inverse(&self) -> Self {
        Self {
            exact: self.exact_inverse,
            exact_inverse: self.exact,
            matrix: self.inverse,
            inverse: self.matrix,
        }
    }

    /// Whether the map has a finite inverse.
    pub fn is_invertible(&self) -> bool {
        self.matrix.is_finite() && self.inverse.is_finite()
    }

    /// Whether the map changes nothing.
    pub fn is_identity(&self) -> bool {
        self.exact == DMat4::IDENTITY
    }

    /// Whether the map turns a right-handed frame into a left-handed one.
    pub fn swaps_handedness(&self) -> bool {
        glam::DMat3::from_mat4(self.exact).determinant() < 0.0
    }

    /// A point, by the affine part.
    #[inline]
    pub fn point(&self, p: Point3) -> Point3 {
        self.matrix.transform_point3(Vec3::from_array(p.to_array())).to_array().into()
    }

    /// A point, with division by w.
    #[inline]
    pub fn point_projective(&self, p: Point3) -> Point3 {
        self.matrix.project_point3(Vec3::from_array(p.to_array())).to_array().into()
    }

    /// A point in double precision, by the affine part.
    pub fn point_f64(&self, p: [f64; 3]) -> [f64; 3] {
        let v: DVec4 = self.exact * DVec3::from_array(p).extend(1.0);
        v.truncate().to_array()
    }

    /// A vector in double precision.
    pub fn vector_f64(&self, v: [f64; 3]) -> [f64; 3] {
        self.exact.transform_vector3(DVec3::from_array(v)).to_array()
    }

    /// A vector.
    #[inline]
    pub fn vector(&self, v: Vector3) -> Vector3 {
        self.matrix.transform_vector3(Vec3::from_array(v.to_array())).to_array().into()
    }

    /// A normal: by the inverse transpose. Not normalised.
    #[inline]
    pub fn normal(&self, n: Normal3) -> Normal3 {
        let m = &self.inverse;
        Normal3::new(
            m.x_axis.x * n.x + m.x_axis.y * n.y + m.x_axis.z * n.z,
            m.y_axis.x * n.x + m.y_axis.y * n.y + m.y_axis.z * n.z,
            m.z_axis.x * n.x + m.z_axis.y * n.y + m.z_axis.z * n.z,
        )
    }

    /// A ray; `t` keeps its meaning, since the direction is not normalised.
    #[inline]
    pub fn ray(&self, ray: &Ray) -> Ray {
        self.ray_map().ray(ray)
    }

    /// What of the map rays need.
    #[inline]
    pub fn ray_map(&self) -> RayMap {
        RayMap(self.matrix)
    }

    /// The box around a transformed box.
    pub fn bounds(&self, b: &Bounds3) -> Bounds3 {
        if b.is_empty() { *b } else { Bounds3::around(b.corners().map(|p| self.point(p))) }
    }
}

/// A map of rays alone: a sixth of the bytes of a [`Transform`], for where there are millions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayMap(Mat4);

impl RayMap {
    /// A ray; `t` keeps its meaning, since the direction is not normalised.
    #[inline]
    pub fn ray(&self, ray: &Ray) -> Ray {
        let origin = self.0.transform_point3(Vec3::from_array(ray.origin.to_array())).to_array().into();
        let direction =
            self.0.transform_vector3(Vec3::from_array(ray.direction.to_array())).to_array().into();
        Ray { origin, direction, ..*ray }
    }
}

impl Mul for Transform {
    type Output = Self;
    /// `(a * b)` applies `b` first.
    fn mul(self, b: Self) -> Self {
        Self::of(self.exact * b.exact, b.exact_inverse * self.exact_inverse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Point3, b: Point3) -> bool {
        a.distance(b) < 1e-5
    }

    #[test]
    fn composition_and_inverse() {
        let a = Transform::translate(Vector3::new(1.0, 2.0, 3.0))
            * Transform::rotate(Vector3::new(1.0, 1.0, 0.0), 33.0)
            * Transform::scale(Vector3::new(1.0, 2.0, -3.0));
        let p = Point3::new(0.3, -0.7, 2.0);
        assert!(close(a.inverse().point(a.point(p)), p));
        assert!(a.swaps_handedness());
        assert!(
            Transform::rotate(Vector3::Z, 90.0)
                .point(Point3::new(1.0, 0.0, 0.0))
                .distance(Point3::new(0.0, 1.0, 0.0))
                < 1e-6
        );
    }

    #[test]
    fn normals_stay_perpendicular() {
        let a = Transform::scale(Vector3::new(1.0, 4.0, 1.0)) * Transform::rotate(Vector3::X, 20.0);
        let (n, v) = (Normal3::new(0.0, 1.0, 1.0), Vector3::new(1.0, 1.0, -1.0));
        assert!(a.normal(n).dot(a.vector(v)).abs() < 1e-5);
    }

    #[test]
    fn look_at_looks_at() {
        let t = Transform::look_at(Point3::new(0.0, 0.0, 5.0), Point3::ORIGIN, Vector3::Y).unwrap();
        assert!(close(t.point(Point3::new(0.0, 0.0, 5.0)), Point3::ORIGIN));
        assert!((t.vector(Vector3::X) - Vector3::new(-1.0, 0.0, 0.0)).length() < 1e-6);
        assert!(Transform::look_at(Point3::ORIGIN, Point3::ORIGIN, Vector3::Y).is_none());
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert!(Transform::from_rows([[0.0; 4]; 4]).is_none());
        assert!(!Transform::scale(Vector3::new(0.0, 1.0, 1.0)).is_invertible());
    }
}

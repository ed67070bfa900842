//! Rays.

use crate::{Point3, Vector3};

/// A half-line segment `origin + t · direction`, `t` in `(t_min, t_max)`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Start.
    pub origin: Point3,
    /// Hits at or below this parameter do not count.
    pub t_min: f32,
    /// Direction; need not be of unit length.
    pub direction: Vector3,
    /// Hits at or beyond this parameter do not count.
    pub t_max: f32,
    /// Time, for moving things.
    pub time: f32,
}

impl Ray {
    /// A ray without end at time zero.
    #[inline]
    pub const fn new(origin: Point3, direction: Vector3) -> Self {
        Self { origin, t_min: 0.0, direction, t_max: f32::INFINITY, time: 0.0 }
    }

    /// The same ray, ending before `t_max`.
    #[inline]
    pub const fn until(self, t_max: f32) -> Self {
        Self { t_max, ..self }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Point3 {
        self.origin + self.direction * t
    }
}

//! Axis-aligned boxes.

use crate::{Point3, Ray, Vector3, gamma};

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Bounds3 {
    /// Lower corner.
    pub min: Point3,
    /// Upper corner.
    pub max: Point3,
}

/// The part of a ray inside a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabHit {
    /// Where the ray enters.
    pub t_enter: f32,
    /// Where it leaves.
    pub t_leave: f32,
}

impl Default for Bounds3 {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds3 {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: Point3::splat(f32::INFINITY), max: Point3::splat(f32::NEG_INFINITY) };

    /// The smallest box around two points.
    pub fn new(a: Point3, b: Point3) -> Self {
        Self { min: a.min(b), max: a.max(b) }
    }

    /// The smallest box around points.
    pub fn around(points: impl IntoIterator<Item = Point3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::extend)
    }

    /// Whether nothing is inside.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y || self.min.z > self.max.z
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The smallest box around this one and a point.
    #[inline]
    pub fn extend(self, p: Point3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// Whether the point is inside or on the border.
    pub fn contains(&self, p: Point3) -> bool {
        (0..3).all(|i| p[i] >= self.min[i] && p[i] <= self.max[i])
    }

    /// From corner to corner; zero for the empty box.
    #[inline]
    pub fn diagonal(&self) -> Vector3 {
        if self.is_empty() { Vector3::ZERO } else { self.max - self.min }
    }

    /// The middle.
    #[inline]
    pub fn centroid(&self) -> Point3 {
        self.min.lerp(self.max, 0.5)
    }

    /// The area of the six sides.
    #[inline]
    pub fn surface_area(&self) -> f32 {
        let d = self.diagonal();
        2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }

    /// The eight corners.
    pub fn corners(&self) -> [Point3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            Point3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }

    /// Half the diagonal's length: the radius of the sphere around the box.
    pub fn radius(&self) -> f32 {
        self.diagonal().length() * 0.5
    }

    /// The part of a ray inside the box; never misses a box that the exact ray touches.
    ///
    /// # References
    /// [Ize 2013] "Robust BVH Ray Traversal", JCGT 2(2).
    #[inline]
    pub fn intersect(&self, ray: &Ray, inv_direction: Vector3) -> Option<SlabHit> {
        let (mut t_enter, mut t_leave) = (ray.t_min, ray.t_max);
        for axis in 0..3 {
            let a = (self.min[axis] - ray.origin[axis]) * inv_direction[axis];
            let b = (self.max[axis] - ray.origin[axis]) * inv_direction[axis];
            // NaN (a ray inside a slab's border) leaves the interval as it is: comparisons with it are false.
            let (near, far) = if a > b { (b, a) } else { (a, b) };
            let far = far * (1.0 + 2.0 * gamma(3));
            t_enter = if near > t_enter { near } else { t_enter };
            t_leave = if far < t_leave { far } else { t_leave };
        }
        (t_enter <= t_leave).then_some(SlabHit { t_enter, t_leave })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs() {
        let unit = Bounds3::new(Point3::ORIGIN, Point3::splat(1.0));
        let hit = |o: [f32; 3], d: [f32; 3]| {
            let d = Vector3::from(d);
            let inv = Vector3::new(1.0 / d.x, 1.0 / d.y, 1.0 / d.z);
            unit.intersect(&Ray::new(Point3::from(o), d), inv)
        };
        assert!(hit([-1.0, 0.5, 0.5], [1.0, 0.0, 0.0]).is_some());
        assert!(hit([-1.0, 1.5, 0.5], [1.0, 0.0, 0.0]).is_none());
        assert!(hit([2.0, 0.5, 0.5], [1.0, 0.0, 0.0]).is_none());
        assert!(hit([0.5, 0.5, 0.5], [0.0, 0.0, -1.0]).is_some());
        assert!(hit([0.0, 0.5, -1.0], [0.0, 0.0, 1.0]).is_some());
        assert!(Bounds3::EMPTY.is_empty() && Bounds3::EMPTY.surface_area() == 0.0);
    }
}

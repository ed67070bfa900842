//! Rays that meet some geometries only.

use aureole_math::Ray;

use crate::{Hit, UserHit, UserShapes};

/// Queries with it meet the geometries whose mask has a bit in common with theirs.
///
/// The mask is an argument of the query rather than a part of the ray: rays without one are as fast as if there were none. Rays
/// of one slice share a mask. An instance is met where both its own mask and that of a geometry in it agree.
///
/// ```
/// use std::sync::Arc;
/// use aureole_accel::{Config, Geometry, Masked, NoUserShapes, World};
/// use aureole_math::{Point3, Ray, Vector3};
///
/// const CAMERA: u32 = 1;
/// const SHADOW: u32 = 2;
/// let square = |z: f32| Geometry::Triangles {
///     positions: Arc::from([[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]]),
///     indices: Arc::from([[0, 1, 2]]),
/// };
/// let world = World::build(vec![square(0.0), square(0.5)], 0, &Config::default())?.with_masks(vec![CAMERA | SHADOW, SHADOW]);
/// let ray = Ray::new(Point3::new(0.2, 0.3, 1.0), -Vector3::Z);
/// let geometry = |mask| world.closest_hit(&ray, &Masked::new(mask, &NoUserShapes)).map(|hit| hit.geometry);
/// assert_eq!((geometry(CAMERA), geometry(SHADOW), geometry(4)), (Some(0), Some(1), None));
/// # Ok::<(), aureole_accel::AccelError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Masked<'a, U> {
    mask: u32,
    shapes: &'a U,
}

impl<'a, U> Masked<'a, U> {
    /// Rays with a mask, among these shapes.
    pub const fn new(mask: u32, shapes: &'a U) -> Self {
        Self { mask, shapes }
    }
}

impl<U: UserShapes> UserShapes for Masked<'_, U> {
    const HAS_FILTER: bool = U::HAS_FILTER;
    const HAS_MASK: bool = true;

    #[inline]
    fn intersect(&self, level: u32, geometry: u32, primitive: u32, ray: &Ray) -> Option<UserHit> {
        self.shapes.intersect(level, geometry, primitive, ray)
    }

    #[inline]
    fn accept(&self, level: u32, hit: &Hit, ray: &Ray) -> bool {
        self.shapes.accept(level, hit, ray)
    }

    #[inline(always)]
    fn mask(&self) -> u32 {
        self.mask & self.shapes.mask()
    }
}

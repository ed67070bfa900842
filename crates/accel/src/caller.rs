//! The caller's shapes behind one face, so that the kernels are compiled once, in this crate, and not for every caller.

use aureole_math::Ray;

use crate::{Hit, UserHit, UserShapes};

/// What is asked of a caller, whoever it is.
trait Ask {
    fn intersect(&self, level: u32, geometry: u32, primitive: u32, ray: &Ray) -> Option<UserHit>;
    fn accept(&self, level: u32, hit: &Hit, ray: &Ray) -> bool;
}

impl<U: UserShapes> Ask for U {
    #[inline]
    fn intersect(&self, level: u32, geometry: u32, primitive: u32, ray: &Ray) -> Option<UserHit> {
        UserShapes::intersect(self, level, geometry, primitive, ray)
    }

    #[inline]
    fn accept(&self, level: u32, hit: &Hit, ray: &Ray) -> bool {
        UserShapes::accept(self, level, hit, ray)
    }
}

/// Some caller; `FILTERS` says whether it is asked about every hit, by mask or by filter.
#[derive(Clone, Copy)]
pub(crate) struct Caller<'a, const FILTERS: bool> {
    shapes: &'a dyn Ask,
    mask: u32,
}

impl<'a, const FILTERS: bool> Caller<'a, FILTERS> {
    #[inline(always)]
    pub(crate) fn new<U: UserShapes>(shapes: &'a U) -> Self {
        Self { shapes, mask: shapes.mask() }
    }
}

impl<const FILTERS: bool> UserShapes for Caller<'_, FILTERS> {
    const HAS_FILTER: bool = FILTERS;
    const HAS_MASK: bool = FILTERS;

    #[inline(always)]
    fn intersect(&self, level: u32, geometry: u32, primitive: u32, ray: &Ray) -> Option<UserHit> {
        self.shapes.intersect(level, geometry, primitive, ray)
    }

    #[inline(always)]
    fn accept(&self, level: u32, hit: &Hit, ray: &Ray) -> bool {
        self.shapes.accept(level, hit, ray)
    }

    #[inline(always)]
    fn mask(&self) -> u32 {
        self.mask
    }
}

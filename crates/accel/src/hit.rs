//! What goes in and what comes out.

use std::sync::Arc;

use aureole_math::{Bounds3, Motion, Ray, Transform};

use crate::World;

/// Stands in [`Hit::instance`] for "not in an instance".
pub const NO_INSTANCE: u32 = u32::MAX;

/// Things that rays can hit. Their order gives them their numbers.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// A triangle mesh.
    Triangles {
        /// Vertices.
        positions: Arc<[[f32; 3]]>,
        /// Vertex indices, three a triangle.
        indices: Arc<[[u32; 3]]>,
    },
    /// A triangle mesh whose vertices move in straight lines from key to key while the time of rays goes from 0 to 1.
    MovingTriangles {
        /// Vertices at equally spaced times, the first at 0 and the last at 1.
        keys: Vec<Arc<[[f32; 3]]>>,
        /// Vertex indices, three a triangle.
        indices: Arc<[[u32; 3]]>,
    },
    /// Boxes around shapes that the caller intersects.
    User(Vec<Bounds3>),
    /// The same where the shapes are balls that fill their boxes: structures that look closer put them into fewer places.
    Balls(Vec<Bounds3>),
    /// Another world, placed by a transform.
    Instance {
        /// What is repeated.
        level: Arc<World>,
        /// Where.
        world_from_object: Arc<Transform>,
    },
    /// Another world that moves.
    MovingInstance {
        /// What is repeated.
        level: Arc<World>,
        /// Where, at which time.
        world_from_object: Box<Motion>,
    },
}

/// The nearest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f32,
    /// Barycentric weight of vertex 1, or whatever a user shape reports.
    pub u: f32,
    /// Barycentric weight of vertex 2, or whatever a user shape reports.
    pub v: f32,
    /// The primitive within its geometry.
    pub primitive: u32,
    /// The geometry within its level.
    pub geometry: u32,
    /// The geometry of the top level that is the instance, or [`NO_INSTANCE`].
    pub instance: u32,
}

impl Hit {
    /// No hit: infinitely far.
    pub const NONE: Self = Self {
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
        primitive: u32::MAX,
        geometry: u32::MAX,
        instance: NO_INSTANCE,
    };

    /// Whether something was hit.
    #[inline]
    pub fn is_some(&self) -> bool {
        self.primitive != u32::MAX
    }

    /// Which of two hits counts: the nearer one, and of equally near ones that with the smaller numbers.
    #[inline(always)]
    pub(crate) fn beats(&self, other: &Self) -> bool {
        let id = |hit: &Self| (hit.instance, hit.geometry, hit.primitive);
        self.t < other.t || (self.t == other.t && id(self) < id(other))
    }
}

/// A hit with a user shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UserHit {
    /// Ray parameter.
    pub t: f32,
    /// Passed on to the hit.
    pub u: f32,
    /// Passed on to the hit.
    pub v: f32,
}

/// The caller's shapes, and its say about hits.
pub trait UserShapes {
    /// Whether [`accept`](Self::accept) is asked about every hit.
    const HAS_FILTER: bool = false;

    /// Whether rays meet some geometries only: see [`Masked`](crate::Masked).
    const HAS_MASK: bool = false;

    /// Intersects a primitive of a [`Geometry::User`] of the world with tag `level`; the ray is in that level's space.
    fn intersect(&self, level: u32, geometry: u32, primitive: u32, ray: &Ray) -> Option<UserHit>;

    /// Whether a hit counts: cut-outs say no.
    fn accept(&self, _level: u32, _hit: &Hit, _ray: &Ray) -> bool {
        true
    }

    /// The rays' mask.
    #[inline(always)]
    fn mask(&self) -> u32 {
        u32::MAX
    }
}

/// For worlds of triangles alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoUserShapes;

impl UserShapes for NoUserShapes {
    fn intersect(&self, _: u32, _: u32, _: u32, _: &Ray) -> Option<UserHit> {
        None
    }
}

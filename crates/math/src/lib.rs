//! Points, vectors, frames, transforms, rays, bounds, warps, distributions, hashing, ids and arenas.
//!
//! Geometry is `f32`; points, vectors and normals are distinct types. World space is right-handed.
//!
//! ```
//! use aureole_math::{Point3, Transform, Vector3};
//!
//! let world_from_object = Transform::translate(Vector3::new(1.0, 0.0, 0.0)) * Transform::scale(Vector3::splat(2.0));
//! assert_eq!(world_from_object.point(Point3::new(1.0, 1.0, 1.0)), Point3::new(3.0, 2.0, 2.0));
//! ```

mod arena;
mod bounds;
mod frame;
mod hash;
mod motion;
mod ray;
mod robust;
mod transform;
mod tuple;

pub mod distribution;
pub mod warp;

pub use arena::{Arena, Id};
pub use bounds::{Bounds3, SlabHit};
pub use distribution::{Discrete, PiecewiseConstant1D, PiecewiseConstant2D};
pub use frame::{Frame, Refraction, reflect, refract, spherical_direction};
pub use hash::{Pcg32, hash_u32, hash_u64};
pub use motion::Motion;
pub use ray::Ray;
pub use robust::{difference_of_products, gamma, next_down, next_up, offset_ray_origin};
pub use transform::{RayMap, Transform};
pub use tuple::{Normal3, Point2, Point3, Vector2, Vector3};

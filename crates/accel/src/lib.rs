//! Ray-intersection structures: a hierarchy over boxes with leaf closures, triangle-mesh kernels, two-level scenes.
//!
//! ```
//! use std::sync::Arc;
//! use aureole_accel::{Config, Geometry, NoUserShapes, World};
//! use aureole_math::{Point3, Ray, Vector3};
//!
//! let triangle = Geometry::Triangles {
//!     positions: Arc::from([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
//!     indices: Arc::from([[0, 1, 2]]),
//! };
//! let world = World::build(vec![triangle], 0, &Config::default())?;
//! let ray = Ray::new(Point3::new(0.2, 0.3, 1.0), -Vector3::Z);
//! let hit = world.closest_hit(&ray, &NoUserShapes).expect("the ray points at the triangle");
//! assert_eq!((hit.t, hit.u, hit.v), (1.0, 0.2, 0.3));
//! # Ok::<(), aureole_accel::AccelError>(())
//! ```

mod big;
mod binary;
mod blocks;
mod bvh;
mod caller;
mod config;
mod error;
mod grid;
mod hit;
mod index;
mod mask;
mod moving;
mod others;
mod overlap;
mod query;
mod refit;
mod simd;
mod stats;
mod things;
mod triangle;
mod validate;
mod world;

pub use config::{Accuracy, Config, GridConfig, Layout, Quality, Structure, Width};
pub use error::AccelError;
pub use hit::{Geometry, Hit, NO_INSTANCE, NoUserShapes, UserHit, UserShapes};
pub use mask::Masked;
pub use overlap::{ball_overlaps_box, triangle_overlaps_box};
pub use stats::Stats;
pub use validate::Defect;
pub use world::World;

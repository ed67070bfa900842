//! Bounding-volume hierarchies over boxes.

mod build;
mod node;
mod traverse;

pub(crate) use build::build;
pub(crate) use node::Bvh8;
pub use node::Stats;
pub(crate) use traverse::{Leaf, Stack, TraversalRay, VisitLeaf};

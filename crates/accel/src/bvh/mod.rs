//! Bounding-volume hierarchies over boxes.

mod binned;
mod build;
mod collapse;
mod node;
mod packet;
mod reinsert;
mod traverse;
mod tree;

pub(crate) use build::build;
pub(crate) use node::Bvh8;
pub use node::Stats;
pub(crate) use packet::{PACKET, Packet, VisitPacket};
pub(crate) use traverse::{Leaf, VisitLeaf};

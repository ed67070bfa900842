//! Bounding-volume hierarchies over boxes.

mod binned;
mod bins;
mod build;
mod collapse;
mod compact;
mod linear;
mod node;
mod packet;
mod presplit;
mod refit;
mod reinsert;
mod shape;
mod spatial;
mod top_down;
mod traverse;
mod tree;
mod wide;

pub(crate) use build::{MAX_ITEMS, build, build_binary};
pub(crate) use compact::CompactNode;
pub(crate) use node::{Bvh, Bvh8, MAX_LEVELS};
pub(crate) use packet::{Outline, PACKET, Packet, VisitPacket};
pub(crate) use shape::{Census, Layers, census};
pub(crate) use traverse::{Leaf, TIE_SCALE, VisitLeaf};
pub(crate) use tree::{Below, BinaryNode, BinaryTree};
pub(crate) use wide::Node16;

//! OpenEXR, through the `exr` crate.

mod attributes;
mod chroma;
mod decode;
mod encode;
mod planes;
mod steps;

pub(super) use decode::decode;
pub(super) use encode::encode;
pub use planes::{Plane, Planes};

#[cfg(test)]
mod tests;

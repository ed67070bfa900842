//! OpenEXR, through the `exr` crate.

mod attributes;
mod decode;
mod encode;
mod planes;

pub(super) use decode::decode;
pub(super) use encode::encode;
pub use planes::{Plane, Planes};

#[cfg(test)]
mod tests;

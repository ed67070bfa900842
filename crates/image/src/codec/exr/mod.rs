//! OpenEXR, through the `exr` crate.

mod attributes;
mod decode;
mod encode;

pub(super) use decode::decode;
pub(super) use encode::encode;

#[cfg(test)]
mod tests;

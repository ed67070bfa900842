//! Every built-in element against the laws of its family.
//!
//! Each family's module lists examples of every kind; a kind without an example fails, so that a new element is
//! enrolled by being registered. Seeds are fixed; each statistical test states its false-alarm rate.

mod camera;
mod filter;
mod light;
mod material;
mod realistic;
mod sampler;
mod shape;
mod texture;
mod world;

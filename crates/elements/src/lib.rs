//! Filters, samplers, textures, shapes, BSDFs, lights, cameras: a folder a family, a file a thing.
//!
//! Every family lists its kinds once, in its `mod.rs`, by the `registry!` macro; that list makes the enum, the builder,
//! the names for messages and `aureole list`, and enrols each element in its family's tests.
//! Elements receive values, never the scene: ids into arenas of their own or lower families.

#[macro_use]
mod registry;

pub mod bsdf;
pub mod camera;
mod element;
pub mod filter;
pub mod light;
pub mod sampler;
pub mod shape;
pub mod texture;

pub use bsdf::{Bsdf, Lobe, Material};
pub use camera::Camera;
pub use element::{Element, FilmSpec, Manual, Resolver, float_texture, spectrum_texture};
pub use filter::Filter;
pub use light::Light;
pub use sampler::Sampler;
pub use shape::{Shape, SurfacePoint};
pub use texture::{Texture, TextureContext};

//! Pixel buffers, codecs, tone curves, image metrics.
//!
//! An [`Image`] is what a render produces: linear floats in named channels. A [`Bitmap`] is what a texture reads: texels as
//! compact as their file. Both are read from EXR, PNG, JPEG, HDR, PFM, PPM, TGA, BMP, TIFF and WebP; images are written to
//! the first six, whole or not at all.
//!
//! ```no_run
//! use aureole_image::{Image, ToneMapping, WriteOptions, read_image, write_image};
//!
//! let image: Image = read_image("render.exr".as_ref(), &Default::default())?;
//! let tone = ToneMapping { exposure: 1.0, ..Default::default() };
//! write_image(&image, "render.png".as_ref(), &WriteOptions { tone, ..Default::default() })?;
//! # Ok::<(), aureole_image::ImageError>(())
//! ```

#![forbid(unsafe_code)]

mod atomic;
mod bitmap;
mod codec;
mod encoding;
mod error;
mod image;
mod limits;
mod metadata;
pub mod metric;
mod raster;
mod stray;
mod tone;

pub use crate::image::{Image, Window};
pub use atomic::write_atomically;
pub use bitmap::Bitmap;
pub use codec::{
    BitDepth, Format, Plane, Planes, Precision, Probe, WriteOptions, decode_bitmap, decode_image, encode,
    probe_image, read_bitmap, read_image, write_image,
};
pub use encoding::Encoding;
pub use error::ImageError;
pub use limits::ImageLimits;
pub use metadata::{Attribute, Metadata};
pub use stray::stray;
pub use tone::{Dither, ToneCurve, ToneMapping};

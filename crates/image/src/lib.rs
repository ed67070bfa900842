//! Pixel buffers, codecs, tone curves, image metrics.
//!
//! ```no_run
//! use aureole_image::{Image, ToneMapping, WriteOptions, read_image, write_image};
//!
//! let image: Image = read_image("render.exr".as_ref(), &Default::default())?;
//! write_image(&image, "render.png".as_ref(), &WriteOptions::default())?;
//! # Ok::<(), aureole_image::ImageError>(())
//! ```

mod bitmap;
mod buffer;
mod codec;
mod error;
mod tone;

pub use bitmap::{Bitmap, Encoding};
pub use buffer::Image;
pub use codec::{
    Format, Precision, WriteOptions, encode, read_bitmap, read_image, write_atomically, write_image,
};
pub use error::{ImageError, ImageLimits};
pub use tone::{ToneCurve, ToneMapping};

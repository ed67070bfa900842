//! How far one image is from another.
//!
//! [`compare`] gives the usual sums over linear values; [`flip`] what an eye would notice when the pictures alternate;
//! [`z_test`] whether differences can be explained by Monte Carlo noise. Values that are not finite never enter a
//! sum; they are counted.
//!
//! ```
//! use aureole_image::{Image, metric};
//!
//! let reference = Image::from_rgb(2, 1, &[[1.0; 3], [0.5; 3]]).unwrap();
//! let test = Image::from_rgb(2, 1, &[[1.0; 3], [0.6; 3]]).unwrap();
//! let errors = metric::compare(&reference, &test)?;
//! assert!((errors.mse - 0.005).abs() < 1e-6);
//! # Ok::<(), aureole_image::ImageError>(())
//! ```

mod colormap;
mod difference;
mod error_map;
mod flip;
mod z_test;

pub use colormap::Colormap;
pub use difference::{Errors, REL_MSE_EPSILON, compare, psnr, squared_error_map};
pub use error_map::ErrorMap;
pub use flip::{PIXELS_PER_DEGREE, flip};
pub use z_test::{ZTest, z_test};

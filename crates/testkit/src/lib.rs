//! Statistical tests over closures: chi-square, z-test, moments, furnace, reciprocity, finite differences.
//!
//! Nothing here knows what it tests: a sampler is a closure from a random generator to a draw, a density is a
//! closure from a point to a number. So every crate above the maths may use it in its tests without a loop.
//!
//! # False alarms
//! Each test rejects a correct implementation with a stated probability, its *significance*. Seeds are fixed, so a
//! test that passes once passes always; the rate matters on the day the code under test changes. A family of `n` tests
//! keeps the rate for the whole family with [`sidak`].
//!
//! ```
//! use aureole_math::warp;
//! use aureole_testkit::{Chi2Config, chi2_sphere};
//!
//! let config = Chi2Config::default();
//! let outcome = chi2_sphere(
//!     &config,
//!     |rng| Some(warp::square_to_cosine_hemisphere(rng.point2())),
//!     |w| warp::cosine_hemisphere_pdf(w.z),
//! );
//! assert!(outcome.is_ok(), "{outcome:?}");
//! ```

mod chi2;
mod difference;
mod furnace;
mod mean;
mod quadrature;
mod reciprocity;
mod special;

pub use chi2::{Chi2Config, Chi2Error, Chi2Outcome, chi2_counts, chi2_disk, chi2_sphere, chi2_square};
pub use difference::{derivative, gradient3, jacobian2};
pub use furnace::{directional_albedo, furnace};
pub use mean::{Mean, mean_with_error, sidak, z_test, z_test_between};
pub use quadrature::{Rect, integrate, integrate_sphere};
pub use reciprocity::{Asymmetry, worst_asymmetry};
pub use special::{chi2_survival, normal_two_sided};

//! Floats, words and masks in SIMD lanes: code is written once, over `R: Real`, and runs on one lane, on 4 (NEON), 8 (AVX2) or 16
//! (AVX-512), chosen when the program runs. All give the same bits.
//!
//! ```
//! use aureole_lanes::{Kernel, Lanes, Level, Real, math, run};
//!
//! struct Decay<'a>(&'a mut [f32]);
//!
//! impl Kernel for Decay<'_> {
//!     type Output = ();
//!     #[inline(always)]
//!     fn run<R: Real>(self) {
//!         for group in self.0.chunks_mut(R::N) {
//!             let x = R::load_part(group);
//!             let y = x.lt(R::zero()).select(R::one(), math::exp(-x));
//!             y.store_part(group);
//!         }
//!     }
//! }
//! # use aureole_lanes::Mask;
//!
//! let mut wide = [-1.0, 0.0, 1.0, 2.0, 3.0];
//! let mut narrow = wide;
//! run(Level::best(), Decay(&mut wide));
//! run(Level::One, Decay(&mut narrow));
//! assert_eq!(wide, narrow);
//! ```
//!
//! # What the bits depend on
//! On the operations alone. Each is defined wholly: rounded by IEEE 754, never fused with another, comparisons and conversions with a
//! stated answer to every input. Only which NaN comes out of an operation is left open.
//!
//! # How to keep it fast
//! An operation is an instruction only inside code that was compiled for its instruction set: [`run`] and [`Real::vectorize`] enter such
//! code, and everything below must be inlined into it. So mark functions *and closures* of kernels `#[inline(always)]`; library
//! functions that take closures (`array::map`, `Option::map_or`) are safe only where they are certain to be inlined. Dispatch once a
//! stage, not once a ray. Conditions are masks: compute both sides and [`select`](Mask::select), leave early where [`Mask::none`].

mod dispatch;
mod geometry;
mod lanes;
mod one;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod registers;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;

pub mod math;
pub mod soa;

pub use dispatch::{Kernel, Level, run};
pub use geometry::{Frame, Spectrum4, Vec3};
pub use lanes::{Arithmetic, BitArithmetic, Lanes, MAX_LANES, Mask, Real, Select, SetBits, Word};
pub use one::Word1;

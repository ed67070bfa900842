//! Broken and hostile input: good files ([`samples`]), ways of damaging them ([`corrupt`]), and what must hold however
//! damaged a file is ([`targets`]).
//!
//! The same targets are driven by the tests of this crate (tens of thousands of damaged files, on every change), by
//! libFuzzer (`fuzz/`, millions), and, through the whole program, by the tool `aureole-hostile` over a folder of real files.
//!
//! ```
//! use aureole_hostile::{corrupt::Corruptor, samples, targets};
//!
//! let sample = &samples::of("ply")[0];
//! let damaged = Corruptor::new(1).corrupt(&sample.bytes);
//! targets::find("ply").expect("a target for each reader").check(&damaged.bytes);
//! ```

#![forbid(unsafe_code)]

pub mod corrupt;
mod film;
pub mod samples;
pub mod targets;
mod wild;

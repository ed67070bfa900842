//! Aureole's readers under libFuzzer: each target of `aureole-hostile` is a program here.
//!
//! `cargo +nightly fuzz run ply fuzz/corpus/ply` (see docs/robustness.md). The seeds come from `cargo run --bin seeds`.

#[doc(hidden)]
pub use libfuzzer_sys;

pub use aureole_hostile::{samples, targets};

/// The entry point of one target.
#[macro_export]
macro_rules! reader {
    ($name:literal) => {
        static TARGET: std::sync::LazyLock<$crate::targets::Target> =
            std::sync::LazyLock::new(|| *$crate::targets::find($name).expect("a target of that name"));

        $crate::libfuzzer_sys::fuzz_target!(|data: &[u8]| TARGET.check(data));
    };
}

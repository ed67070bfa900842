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
        static TARGET: std::sync::LazyLock<$crate::targets::Target> = std::sync::LazyLock::new(|| {
            $crate::forgive_dependencies();
            *$crate::targets::find($name).expect("a target of that name")
        });

        $crate::libfuzzer_sys::fuzz_target!(|data: &[u8]| TARGET.check(data));
    };
}

/// Lets decoders of other authors panic where the project catches it.
///
/// libFuzzer's hook ends the process at any panic, even one that is caught: `exr` has sums that overflow on damaged files,
/// which only builds with checks notice. What nobody catches still ends the process, in the fuzz target's own guard.
#[doc(hidden)]
pub fn forgive_dependencies() {
    let end = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let is_foreign = info.location().is_some_and(|place| place.file().contains("/registry/src/"));
        if !is_foreign {
            end(info);
        }
    }));
}

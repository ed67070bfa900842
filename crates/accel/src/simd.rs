//! The same code, compiled for several instruction sets; the best one that the machine has is chosen at run time.
//!
//! No operation is fused or reordered, so all of them give the same bits.
#![expect(unsafe_code, reason = "calling code that was compiled for more than the baseline")]

/// Work on many rays. Its `run` and all that it calls should insist on being inlined.
pub(crate) trait Kernel {
    /// Does the work.
    fn run(self);
}

/// Runs a kernel with the widest instructions that this machine has.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: `has_avx2` says that the processor has what `run_avx2` was compiled for.
        return unsafe { run_avx2(kernel) };
    }
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<K: Kernel>(kernel: K) {
    kernel.run();
}

/// Whether AVX2 and its companions are available; asked once, then remembered by the standard library.
#[cfg(target_arch = "x86_64")]
#[inline]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("bmi1")
        && std::arch::is_x86_feature_detected!("bmi2")
        && std::arch::is_x86_feature_detected!("lzcnt")
        && std::arch::is_x86_feature_detected!("popcnt")
}

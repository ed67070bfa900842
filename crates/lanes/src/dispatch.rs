//! The choice of instructions at run time.

use std::sync::atomic::{AtomicU8, Ordering};

use crate::Real;

/// Instruction sets, the narrower first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Level {
    /// One lane, on any processor.
    One = 1,
    /// Four lanes, on all 64-bit Arm processors.
    Neon,
    /// Eight lanes: AVX2 with what comes with it (Haswell, Zen and later).
    Avx2,
    /// Sixteen lanes: AVX-512 with what comes with it (Ice Lake, Zen 4 and later).
    Avx512,
}

impl Level {
    /// All that there are, on this processor or not.
    pub const ALL: [Self; 4] = [Self::One, Self::Neon, Self::Avx2, Self::Avx512];

    /// The widest that this processor has.
    #[inline(always)]
    pub fn best() -> Self {
        // One look for all features. Zero means that nobody has asked yet.
        static BEST: AtomicU8 = AtomicU8::new(0);
        match BEST.load(Ordering::Relaxed) {
            level if level == Self::Avx512 as u8 => Self::Avx512,
            level if level == Self::Avx2 as u8 => Self::Avx2,
            level if level == Self::Neon as u8 => Self::Neon,
            level if level == Self::One as u8 => Self::One,
            _ => {
                let level = Self::detect();
                BEST.store(level as u8, Ordering::Relaxed);
                level
            }
        }
    }

    /// Does this processor have it?
    #[inline(always)]
    pub fn is_available(self) -> bool {
        let of_this_machine = match self {
            Self::One => true,
            Self::Neon => cfg!(target_arch = "aarch64"),
            Self::Avx2 | Self::Avx512 => cfg!(target_arch = "x86_64"),
        };
        of_this_machine && self <= Self::best()
    }

    #[cold]
    fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            macro_rules! has {
                ($($feature:tt)*) => { $(is_x86_feature_detected!($feature))&&* };
            }
            if !has!("avx2" "fma" "bmi1" "bmi2" "lzcnt" "popcnt") {
                Self::One
            } else if has!("avx512f" "avx512vl" "avx512dq" "avx512bw" "avx512cd" "gfni") {
                Self::Avx512
            } else {
                Self::Avx2
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        if cfg!(target_arch = "aarch64") { Self::Neon } else { Self::One }
    }
}

/// Work that is written once for any number of lanes.
pub trait Kernel {
    /// What comes out.
    type Output;

    /// Does the work. Mark it `#[inline(always)]`, and all that it calls in its loops: what stays a call is compiled for the baseline,
    /// and each operation in it becomes a call of its own.
    fn run<R: Real>(self) -> Self::Output;
}

/// Runs a kernel with the lanes of an instruction set.
///
/// # Panics
/// If this processor does not have it.
#[inline]
pub fn run<K: Kernel>(level: Level, kernel: K) -> K::Output {
    match level {
        Level::One => kernel.run::<f32>(),
        #[cfg(target_arch = "aarch64")]
        Level::Neon => crate::neon::run(kernel),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => crate::avx2::run(kernel),
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => crate::avx512::run(kernel),
        missing => panic!("this processor has no {missing:?}"),
    }
}

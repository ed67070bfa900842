//! AVX2 and AVX-512.
#![expect(unsafe_code, reason = "calling code that was compiled for more than the baseline, and intrinsics")]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, Div, Mul, Sub};
use std::sync::atomic::{AtomicU8, Ordering};

use super::{Floats, Kernel, Mask, Portable, Simd};

/// Sixteen registers of eight numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2;

/// Thirty-two registers of sixteen numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512;

/// What the processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub(super) enum Level {
    Baseline = 1,
    Avx2,
    Avx512,
}

impl Level {
    #[inline(always)]
    pub(super) fn get() -> Self {
        // One look for all features: a single ray pays for it. Zero means that nobody has asked yet.
        static LEVEL: AtomicU8 = AtomicU8::new(0);
        match LEVEL.load(Ordering::Relaxed) {
            level if level == Self::Avx512 as u8 => Self::Avx512,
            level if level == Self::Avx2 as u8 => Self::Avx2,
            level if level == Self::Baseline as u8 => Self::Baseline,
            _ => {
                let level = Self::detect();
                LEVEL.store(level as u8, Ordering::Relaxed);
                level
            }
        }
    }

    #[cold]
    fn detect() -> Self {
        macro_rules! has {
            ($($feature:tt)*) => { $(is_x86_feature_detected!($feature))&&* };
        }
        if !has!("avx2" "fma" "bmi1" "bmi2" "lzcnt" "popcnt") {
            Self::Baseline
        } else if has!("avx512f" "avx512vl" "avx512dq" "avx512bw") {
            Self::Avx512
        } else {
            Self::Avx2
        }
    }
}

/// Runs a kernel with the widest instructions there are.
#[inline(always)]
pub(super) fn run<K: Kernel>(kernel: K) -> K::Output {
    match Level::get() {
        // SAFETY: the processor has what the function was compiled for.
        Level::Avx512 => unsafe { run_avx512(kernel) },
        // SAFETY: as above.
        Level::Avx2 => unsafe { run_avx2(kernel) },
        Level::Baseline => kernel.run::<Portable>(),
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512vl,avx512dq,avx512bw")]
pub(super) fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx512>()
}

impl Simd for Avx2 {
    type F4 = F4;
    type F8 = F8;
    type F16 = Pair;

    #[inline(always)]
    fn numbers(bytes: &[u8; 8]) -> F8 {
        numbers(bytes)
    }

    #[inline(always)]
    fn join([a, b, c, d]: [F4; 4]) -> Pair {
        // SAFETY: see `register`.
        unsafe { Pair(F8(_mm256_set_m128(b.0, a.0)), F8(_mm256_set_m128(d.0, c.0))) }
    }

    #[inline(always)]
    fn quads(Pair(low, high): Pair) -> [F4; 4] {
        // SAFETY: see `register`.
        unsafe {
            [
                F4(_mm256_castps256_ps128(low.0)),
                F4(_mm256_extractf128_ps::<1>(low.0)),
                F4(_mm256_castps256_ps128(high.0)),
                F4(_mm256_extractf128_ps::<1>(high.0)),
            ]
        }
    }

    #[inline(always)]
    fn transpose([a, b, c, d]: [Pair; 4]) -> [Pair; 4] {
        let [low_0, low_1, low_2, low_3] = transpose8([a.0, b.0, c.0, d.0]);
        let [high_0, high_1, high_2, high_3] = transpose8([a.1, b.1, c.1, d.1]);
        [Pair(low_0, high_0), Pair(low_1, high_1), Pair(low_2, high_2), Pair(low_3, high_3)]
    }

    #[inline(always)]
    fn select(bits: u32, yes: Pair, no: Pair) -> Pair {
        Pair(select8(bits, yes.0, no.0), select8(bits >> 8, yes.1, no.1))
    }

    #[inline(always)]
    fn prefetch<T>(soon: &T) {
        prefetch(soon);
    }
}

impl Simd for Avx512 {
    type F4 = F4;
    type F8 = F8;
    type F16 = F16;

    #[inline(always)]
    fn numbers(bytes: &[u8; 8]) -> F8 {
        numbers(bytes)
    }

    #[inline(always)]
    fn join([a, b, c, d]: [F4; 4]) -> F16 {
        // SAFETY: see `register`.
        unsafe {
            let low = _mm512_castps256_ps512(_mm256_set_m128(b.0, a.0));
            F16(_mm512_insertf32x8::<1>(low, _mm256_set_m128(d.0, c.0)))
        }
    }

    #[inline(always)]
    fn quads(F16(joined): F16) -> [F4; 4] {
        // SAFETY: see `register`.
        unsafe {
            [
                F4(_mm512_castps512_ps128(joined)),
                F4(_mm512_extractf32x4_ps::<1>(joined)),
                F4(_mm512_extractf32x4_ps::<2>(joined)),
                F4(_mm512_extractf32x4_ps::<3>(joined)),
            ]
        }
    }

    #[inline(always)]
    fn transpose([a, b, c, d]: [F16; 4]) -> [F16; 4] {
        // SAFETY: see `register`.
        unsafe {
            let (ab, cd) = (_mm512_unpacklo_ps(a.0, b.0), _mm512_unpacklo_ps(c.0, d.0));
            let (ab_high, cd_high) = (_mm512_unpackhi_ps(a.0, b.0), _mm512_unpackhi_ps(c.0, d.0));
            [
                F16(_mm512_shuffle_ps::<0x44>(ab, cd)),
                F16(_mm512_shuffle_ps::<0xee>(ab, cd)),
                F16(_mm512_shuffle_ps::<0x44>(ab_high, cd_high)),
                F16(_mm512_shuffle_ps::<0xee>(ab_high, cd_high)),
            ]
        }
    }

    #[inline(always)]
    fn select(bits: u32, yes: F16, no: F16) -> F16 {
        // SAFETY: see `register`.
        F16(unsafe { _mm512_mask_blend_ps(bits as u16, no.0, yes.0) })
    }

    #[inline(always)]
    fn prefetch<T>(soon: &T) {
        prefetch(soon);
    }
}

#[inline(always)]
fn numbers(bytes: &[u8; 8]) -> F8 {
    // SAFETY: see `register`; eight bytes are read.
    unsafe { F8(_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(bytes.as_ptr().cast())))) }
}

#[inline(always)]
fn transpose8([a, b, c, d]: [F8; 4]) -> [F8; 4] {
    // SAFETY: see `register`.
    unsafe {
        let (ab, cd) = (_mm256_unpacklo_ps(a.0, b.0), _mm256_unpacklo_ps(c.0, d.0));
        let (ab_high, cd_high) = (_mm256_unpackhi_ps(a.0, b.0), _mm256_unpackhi_ps(c.0, d.0));
        [
            F8(_mm256_shuffle_ps::<0x44>(ab, cd)),
            F8(_mm256_shuffle_ps::<0xee>(ab, cd)),
            F8(_mm256_shuffle_ps::<0x44>(ab_high, cd_high)),
            F8(_mm256_shuffle_ps::<0xee>(ab_high, cd_high)),
        ]
    }
}

#[inline(always)]
fn select8(bits: u32, yes: F8, no: F8) -> F8 {
    // SAFETY: see `register`.
    unsafe {
        let bit_of_lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        let set = _mm256_and_si256(_mm256_set1_epi32(bits as i32), bit_of_lane);
        let mask = _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bit_of_lane));
        F8(_mm256_blendv_ps(no.0, yes.0, mask))
    }
}

#[inline(always)]
fn prefetch<T>(soon: &T) {
    let start = std::ptr::from_ref(soon).cast::<i8>();
    for line in (0..size_of::<T>()).step_by(64) {
        // SAFETY: a prefetch reads nothing; the address is within the thing anyway.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(start.add(line)) };
    }
}

/// Registers are only made and used by code that runs inside `run_avx2` or `run_avx512`: that is what makes each of the
/// intrinsics below sound.
macro_rules! register {
    ($name:ident, $raw:ty, $n:literal, $($op:ident = $intrinsic:ident),*; $mask:ident, $compare:ident) => {
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name($raw);

        register!(@operators $name, $($op = $intrinsic),*);

        impl Floats<$n> for $name {
            type Mask = $mask;

            register!(@methods $n, $($op = $intrinsic),*);

            #[inline(always)]
            fn less(self, other: Self) -> $mask {
                // SAFETY: see the macro.
                $mask(unsafe { $compare::<_CMP_LT_OQ>(self.0, other.0) })
            }

            #[inline(always)]
            fn less_or_equal(self, other: Self) -> $mask {
                // SAFETY: see the macro.
                $mask(unsafe { $compare::<_CMP_LE_OQ>(self.0, other.0) })
            }
        }
    };
    (@operators $name:ident, add = $add:ident, sub = $sub:ident, mul = $mul:ident, div = $div:ident, $($rest:tt)*) => {
        register!(@operator $name, Add add $add);
        register!(@operator $name, Sub sub $sub);
        register!(@operator $name, Mul mul $mul);
        register!(@operator $name, Div div $div);
    };
    (@operator $name:ident, $trait:ident $method:ident $intrinsic:ident) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the macro.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
    (@methods $n:literal, add = $add:ident, sub = $sub:ident, mul = $mul:ident, div = $div:ident, min = $min:ident,
     max = $max:ident, andnot = $andnot:ident, fmsub = $fmsub:ident, set1 = $set1:ident, loadu = $loadu:ident,
     storeu = $storeu:ident) => {
        #[inline(always)]
        fn splat(x: f32) -> Self {
            // SAFETY: see the macro.
            Self(unsafe { $set1(x) })
        }

        #[inline(always)]
        fn load(from: &[f32; $n]) -> Self {
            // SAFETY: see the macro; as many numbers are read as the array has, and no alignment is asked for.
            Self(unsafe { $loadu(from.as_ptr()) })
        }

        #[inline(always)]
        fn to_array(self) -> [f32; $n] {
            let mut array = [0.0; $n];
            // SAFETY: see the macro; as many numbers are written as the array has.
            unsafe { $storeu(array.as_mut_ptr(), self.0) };
            array
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: see the macro.
            Self(unsafe { $min(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: see the macro.
            Self(unsafe { $max(self.0, other.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: see the macro.
            Self(unsafe { $andnot($set1(-0.0), self.0) })
        }

        #[inline(always)]
        fn mul_sub(self, b: Self, c: Self) -> Self {
            // SAFETY: see the macro.
            Self(unsafe { $fmsub(self.0, b.0, c.0) })
        }
    };
}

register!(F4, __m128, 4, add = _mm_add_ps, sub = _mm_sub_ps, mul = _mm_mul_ps, div = _mm_div_ps, min = _mm_min_ps,
    max = _mm_max_ps, andnot = _mm_andnot_ps, fmsub = _mm_fmsub_ps, set1 = _mm_set1_ps, loadu = _mm_loadu_ps,
    storeu = _mm_storeu_ps; F4, _mm_cmp_ps);
register!(F8, __m256, 8, add = _mm256_add_ps, sub = _mm256_sub_ps, mul = _mm256_mul_ps, div = _mm256_div_ps,
    min = _mm256_min_ps, max = _mm256_max_ps, andnot = _mm256_andnot_ps, fmsub = _mm256_fmsub_ps, set1 = _mm256_set1_ps,
    loadu = _mm256_loadu_ps, storeu = _mm256_storeu_ps; F8, _mm256_cmp_ps);
register!(F16, __m512, 16, add = _mm512_add_ps, sub = _mm512_sub_ps, mul = _mm512_mul_ps, div = _mm512_div_ps,
    min = _mm512_min_ps, max = _mm512_max_ps, andnot = _mm512_andnot_ps, fmsub = _mm512_fmsub_ps, set1 = _mm512_set1_ps,
    loadu = _mm512_loadu_ps, storeu = _mm512_storeu_ps; Bits16, _mm512_cmp_ps_mask);

macro_rules! wide_mask {
    ($name:ident, $and:ident, $movemask:ident) => {
        impl BitAnd for $name {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                // SAFETY: see `register`.
                Self(unsafe { $and(self.0, other.0) })
            }
        }

        impl Mask for $name {
            #[inline(always)]
            fn bits(self) -> u32 {
                // SAFETY: see `register`.
                unsafe { $movemask(self.0) as u32 }
            }
        }
    };
}
wide_mask!(F4, _mm_and_ps, _mm_movemask_ps);
wide_mask!(F8, _mm256_and_ps, _mm256_movemask_ps);

#[derive(Clone, Copy, Debug)]
pub(crate) struct Bits16(u16);

impl BitAnd for Bits16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl Mask for Bits16 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.into()
    }
}

/// Sixteen numbers in two registers of eight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair(F8, F8);

macro_rules! pairwise {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for Pair {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    )*};
}
pairwise!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand);

impl Mask for Pair {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.bits() | self.1.bits() << 8
    }
}

impl Floats<16> for Pair {
    type Mask = Self;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self(F8::splat(x), F8::splat(x))
    }

    #[inline(always)]
    fn load(from: &[f32; 16]) -> Self {
        let [low, high] = bytemuck::cast_ref::<_, [[f32; 8]; 2]>(from);
        Self(F8::load(low), F8::load(high))
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 16] {
        bytemuck::cast([self.0.to_array(), self.1.to_array()])
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        Self(self.0.mul_sub(b.0, c.0), self.1.mul_sub(b.1, c.1))
    }

    #[inline(always)]
    fn less(self, other: Self) -> Self {
        Self(self.0.less(other.0), self.1.less(other.1))
    }

    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Self {
        Self(self.0.less_or_equal(other.0), self.1.less_or_equal(other.1))
    }
}

/// The narrower of the two, for tests.
#[cfg(test)]
pub(super) fn avx2<K: Kernel>(kernel: K) -> K::Output {
    assert!(Level::get() >= Level::Avx2);
    // SAFETY: just asserted.
    unsafe { run_avx2(kernel) }
}

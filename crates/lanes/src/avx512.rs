//! Sixteen lanes: AVX-512, as processors from Ice Lake and Zen 4 on have it.
#![expect(unsafe_code, reason = "intrinsics, and calling code that was compiled for more than the baseline")]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

use crate::registers::{lanes, methods, operators, rows, simd};
use crate::{Kernel, Lanes, Level, Mask, Real, Select, Word};

/// Runs a kernel.
///
/// # Panics
/// If the processor has no AVX-512.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) -> K::Output {
    assert!(Level::Avx512.is_available(), "this processor has no AVX-512");
    Real16::vectorize(
        #[inline(always)]
        || kernel.run::<Real16>(),
    )
}

#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx512cd,gfni,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn enter<T>(f: impl FnOnce() -> T) -> T {
    f()
}

#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Real16(__m512);

#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Word16(__m512i);

#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Mask16(__mmask16);

impl Mask for Mask16 {
    const N: usize = 16;

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as u16)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.into()
    }
}

impl Not for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

macro_rules! mask_operators {
    ($($trait:ident $method:ident),*) => {$(
        impl $trait for Mask16 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )*};
}
mask_operators!(BitAnd bitand, BitOr bitor, BitXor bitxor);

impl Select<Mask16> for Mask16 {
    #[inline(always)]
    fn select(mask: Mask16, yes: Self, no: Self) -> Self {
        (mask & yes) | (!mask & no)
    }
}

#[inline(always)]
fn select(mask: u16, yes: __m512, no: __m512) -> __m512 {
    simd!(_mm512_mask_blend_ps(mask, no, yes))
}

#[inline(always)]
fn select_words(mask: u16, yes: __m512i, no: __m512i) -> __m512i {
    simd!(_mm512_mask_blend_epi32(mask, no, yes))
}

// In a register, and stored plainly: compressing stores to memory are microcode on Zen 4.
#[inline(always)]
fn pack(x: __m512, mask: Mask16) -> __m512 {
    simd!(_mm512_maskz_compress_ps(mask.0, x))
}

#[inline(always)]
fn pack_words(x: __m512i, mask: Mask16) -> __m512i {
    simd!(_mm512_maskz_compress_epi32(mask.0, x))
}

/// # Safety
/// The indices are within the table, and below 2³¹.
#[inline(always)]
unsafe fn gather(table: *const f32, at: Word16) -> __m512 {
    // SAFETY: as the caller promised.
    unsafe { _mm512_i32gather_ps::<4>(at.0, table.cast()) }
}

/// # Safety
/// The indices are within the table, and below 2³¹.
#[inline(always)]
unsafe fn gather_words(table: *const u32, at: Word16) -> __m512i {
    // SAFETY: as the caller promised.
    unsafe { _mm512_i32gather_epi32::<4>(at.0, table.cast()) }
}

lanes!(Word16 of 16 u32, Mask16, Word16:
    select_words _mm512_set1_epi32 _mm512_loadu_epi32 _mm512_storeu_epi32 pack_words gather_words);
operators!(Word16, u32: Add add _mm512_add_epi32, Sub sub _mm512_sub_epi32, Mul mul _mm512_mullo_epi32,
    BitAnd bitand _mm512_and_si512, BitOr bitor _mm512_or_si512, BitXor bitxor _mm512_xor_si512,
    Shl shl _mm512_sllv_epi32, Shr shr _mm512_srlv_epi32);

impl Not for Word16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self ^ u32::MAX
    }
}

impl Word for Word16 {
    methods! {
        min -> Self |a, other| _mm512_min_epu32(a, other);
        max -> Self |a, other| _mm512_max_epu32(a, other);
        eq -> Mask16 |a, other| _mm512_cmpeq_epi32_mask(a, other);
        lt -> Mask16 |a, other| _mm512_cmplt_epu32_mask(a, other);
        leading_zeros -> Self |a| _mm512_lzcnt_epi32(a);
    }

    #[inline(always)]
    fn iota() -> Self {
        Self(simd!(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)))
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        // In each byte by the matrix with ones across; then the order of bytes.
        simd!({
            let across = _mm512_set1_epi64(0x8040_2010_0804_0201_u64 as i64);
            let swapped = _mm512_set4_epi32(0x0c0d_0e0f, 0x0809_0a0b, 0x0405_0607, 0x0001_0203);
            Self(_mm512_shuffle_epi8(_mm512_gf2p8affine_epi64_epi8::<0>(self.0, across), swapped))
        })
    }
}

lanes!(Real16 of 16 f32, Mask16, Word16: select _mm512_set1_ps _mm512_loadu_ps _mm512_storeu_ps pack gather);
operators!(Real16, f32: Add add _mm512_add_ps, Sub sub _mm512_sub_ps, Mul mul _mm512_mul_ps, Div div _mm512_div_ps);

impl Neg for Real16 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::from_bits(self.to_bits() ^ (1 << 31))
    }
}

impl Real for Real16 {
    methods! {
        sqrt -> Self |a| _mm512_sqrt_ps(a);
        min -> Self |a, other| _mm512_min_ps(a, other);
        max -> Self |a, other| _mm512_max_ps(a, other);
        floor -> Self |a| _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a);
        round -> Self |a| _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a);
        lt -> Mask16 |a, other| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, other);
        le -> Mask16 |a, other| _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, other);
        eq -> Mask16 |a, other| _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, other);
        to_bits -> Word16 |a| _mm512_castps_si512(a);
        to_word -> Word16 |a| _mm512_cvttps_epi32(a);
    }

    #[inline(always)]
    fn from_bits(bits: Word16) -> Self {
        Self(simd!(_mm512_castsi512_ps(bits.0)))
    }

    #[inline(always)]
    fn from_word(word: Word16) -> Self {
        Self(simd!(_mm512_cvtepi32_ps(word.0)))
    }

    rows!(Word16, rows);

    #[inline(always)]
    fn least(self, mask: Mask16) -> f32 {
        let x = mask.select(self, Self::splat(f32::INFINITY));
        simd!(_mm512_reduce_min_ps(x.0))
    }

    #[inline(always)]
    fn vectorize<T>(f: impl FnOnce() -> T) -> T {
        // SAFETY: the processor has the instructions, see `registers`.
        unsafe { enter(f) }
    }
}

/// Rows of `K` numbers, read by four and transposed: four columns cost one load a lane, where gathers cost four and are microcode.
///
/// # Safety
/// Where the indices say, in units of eight bytes, there are `K` numbers.
#[inline(always)]
unsafe fn rows<const K: usize>(table: *const f32, at: Word16) -> [Real16; K] {
    let mut lanes = [0; 16];
    at.store(&mut lanes);
    let mut columns = [Real16::zero(); K];
    for (quad, columns) in columns.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        // Volatile, or LLVM takes the register of indices apart instead: two instructions a lane.
        // SAFETY: reads of four numbers, as the caller promised; the processor has the instructions, see `registers`.
        unsafe {
            macro_rules! row {
                ($lane:expr) => {{
                    let at = std::ptr::read_volatile(&lanes[$lane]) as usize;
                    _mm_loadu_ps(table.byte_add(8 * at).add(4 * quad))
                }};
            }
            macro_rules! two {
                ($lane:expr) => {
                    _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(row!($lane)), row!($lane + 4))
                };
            }
            macro_rules! four {
                ($lane:expr) => {
                    _mm512_insertf32x8::<1>(_mm512_castps256_ps512(two!($lane)), two!($lane + 8))
                };
            }
            *columns = transpose([four!(0), four!(1), four!(2), four!(3)]);
        }
    }
    columns
}

/// In each quarter: number `i` of row `j` becomes number `j` of row `i`.
#[inline(always)]
fn transpose([a, b, c, d]: [__m512; 4]) -> [Real16; 4] {
    simd!({
        let (ab, cd) = (_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d));
        let (ab_high, cd_high) = (_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d));
        [
            Real16(_mm512_shuffle_ps::<0x44>(ab, cd)),
            Real16(_mm512_shuffle_ps::<0xee>(ab, cd)),
            Real16(_mm512_shuffle_ps::<0x44>(ab_high, cd_high)),
            Real16(_mm512_shuffle_ps::<0xee>(ab_high, cd_high)),
        ]
    })
}

//! Eight lanes: AVX2.
#![expect(unsafe_code, reason = "intrinsics, and calling code that was compiled for more than the baseline")]

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

use crate::registers::{lanes, methods, operators, rows, simd};
use crate::{Kernel, Lanes, Level, Mask, Real, Select, Word};

/// Runs a kernel.
///
/// # Panics
/// If the processor has no AVX2.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) -> K::Output {
    assert!(Level::Avx2.is_available(), "this processor has no AVX2");
    Real8::vectorize(
        #[inline(always)]
        || kernel.run::<Real8>(),
    )
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
fn enter<T>(f: impl FnOnce() -> T) -> T {
    f()
}

#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Real8(__m256);

#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Word8(__m256i);

/// All bits of a lane are the same.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Mask8(__m256);

impl Mask for Mask8 {
    const N: usize = 8;

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        let bit_of_lane = Word8(simd!(_mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128)));
        (bit_of_lane & bits).eq(bit_of_lane)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        simd!(_mm256_movemask_ps(self.0) as u32)
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(simd!(_mm256_xor_ps(self.0, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))))
    }
}

macro_rules! mask_operators {
    ($($trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl $trait for Mask8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(simd!($intrinsic(self.0, other.0)))
            }
        }
    )*};
}
mask_operators!(BitAnd bitand _mm256_and_ps, BitOr bitor _mm256_or_ps, BitXor bitxor _mm256_xor_ps);

impl Select<Mask8> for Mask8 {
    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(select(mask.0, yes.0, no.0))
    }
}

#[inline(always)]
fn select(mask: __m256, yes: __m256, no: __m256) -> __m256 {
    simd!(_mm256_blendv_ps(no, yes, mask))
}

#[inline(always)]
fn select_words(mask: __m256, yes: __m256i, no: __m256i) -> __m256i {
    simd!(_mm256_blendv_epi8(no, yes, _mm256_castps_si256(mask)))
}

/// For each mask, the lanes that are set, lowest first, a byte each.
static SET_LANES: [u64; 256] = {
    let mut table = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let (mut rest, mut place) = (bits as u64, 0);
        while rest != 0 {
            table[bits] |= (rest.trailing_zeros() as u64) << (8 * place);
            rest &= rest - 1;
            place += 1;
        }
        bits += 1;
    }
    table
};

#[inline(always)]
fn pack(x: __m256, mask: Mask8) -> __m256 {
    let order = SET_LANES[(mask.bits() & 255) as usize] as i64;
    simd!(_mm256_permutevar8x32_ps(x, _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order))))
}

#[inline(always)]
fn pack_words(x: __m256i, mask: Mask8) -> __m256i {
    simd!(_mm256_castps_si256(pack(_mm256_castsi256_ps(x), mask)))
}

/// # Safety
/// The indices are within the table, and below 2³¹.
#[inline(always)]
unsafe fn gather(table: *const f32, at: Word8) -> __m256 {
    // SAFETY: as the caller promised.
    unsafe { _mm256_i32gather_ps::<4>(table, at.0) }
}

/// # Safety
/// The indices are within the table, and below 2³¹.
#[inline(always)]
unsafe fn gather_words(table: *const u32, at: Word8) -> __m256i {
    // SAFETY: as the caller promised.
    unsafe { _mm256_i32gather_epi32::<4>(table.cast(), at.0) }
}

lanes!(Word8 of 8 u32, Mask8, Word8:
    select_words _mm256_set1_epi32 _mm256_loadu_si256 _mm256_storeu_si256 pack_words gather_words);
operators!(Word8, u32: Add add _mm256_add_epi32, Sub sub _mm256_sub_epi32, Mul mul _mm256_mullo_epi32,
    BitAnd bitand _mm256_and_si256, BitOr bitor _mm256_or_si256, BitXor bitxor _mm256_xor_si256,
    Shl shl _mm256_sllv_epi32, Shr shr _mm256_srlv_epi32);

impl Not for Word8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self ^ u32::MAX
    }
}

/// The same sixteen bytes in both halves.
#[inline(always)]
fn both(bytes: [u8; 16]) -> __m256i {
    // SAFETY: sixteen bytes are read; the processor has the instructions, see `registers`.
    unsafe { _mm256_broadcastsi128_si256(_mm_loadu_si128(bytes.as_ptr().cast())) }
}

impl Word for Word8 {
    methods! {
        min -> Self |a, other| _mm256_min_epu32(a, other);
        max -> Self |a, other| _mm256_max_epu32(a, other);
        eq -> Mask8 |a, other| _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, other));
    }

    #[inline(always)]
    fn iota() -> Self {
        Self(simd!(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        // Comparisons are of numbers with sign.
        let (a, b) = (self ^ (1 << 31), other ^ (1 << 31));
        Mask8(simd!(_mm256_castsi256_ps(_mm256_cmpgt_epi32(b.0, a.0))))
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        // Half bytes by table, then the order of bytes.
        const REVERSED: [u8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];
        const REVERSED_HIGH: [u8; 16] =
            [0, 128, 64, 192, 32, 160, 96, 224, 16, 144, 80, 208, 48, 176, 112, 240];
        let high = both(REVERSED_HIGH);
        let low = both(REVERSED);
        let swapped = both([3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12]);
        let (a, b) = (self & 0x0f0f_0f0f, (self >> 4) & 0x0f0f_0f0f);
        Self(simd!(_mm256_shuffle_epi8(
            _mm256_or_si256(_mm256_shuffle_epi8(high, a.0), _mm256_shuffle_epi8(low, b.0)),
            swapped
        )))
    }

    #[inline(always)]
    fn leading_zeros(self) -> Self {
        // The exponent of the number, with lower bits cleared lest it be rounded up to the next power of two. Words that would have
        // a sign, and so an exponent of more than 158, saturate to no zeros.
        let exponent = Self(Real8::from_word(self & !(self >> 8)).to_bits().0) >> 23;
        let zeros = Self(simd!(_mm256_subs_epu16(_mm256_set1_epi32(158), exponent.0)));
        zeros.min(Self::splat(32))
    }
}

lanes!(Real8 of 8 f32, Mask8, Word8: select _mm256_set1_ps _mm256_loadu_ps _mm256_storeu_ps pack gather);
operators!(Real8, f32: Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);

impl Neg for Real8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::from_bits(self.to_bits() ^ (1 << 31))
    }
}

impl Real for Real8 {
    methods! {
        sqrt -> Self |a| _mm256_sqrt_ps(a);
        min -> Self |a, other| _mm256_min_ps(a, other);
        max -> Self |a, other| _mm256_max_ps(a, other);
        floor -> Self |a| _mm256_floor_ps(a);
        round -> Self |a| _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a);
        lt -> Mask8 |a, other| _mm256_cmp_ps::<_CMP_LT_OQ>(a, other);
        le -> Mask8 |a, other| _mm256_cmp_ps::<_CMP_LE_OQ>(a, other);
        eq -> Mask8 |a, other| _mm256_cmp_ps::<_CMP_EQ_OQ>(a, other);
        to_bits -> Word8 |a| _mm256_castps_si256(a);
        to_word -> Word8 |a| _mm256_cvttps_epi32(a);
    }

    #[inline(always)]
    fn from_bits(bits: Word8) -> Self {
        Self(simd!(_mm256_castsi256_ps(bits.0)))
    }

    #[inline(always)]
    fn from_word(word: Word8) -> Self {
        Self(simd!(_mm256_cvtepi32_ps(word.0)))
    }

    rows!(Word8, rows);

    #[inline(always)]
    fn least(self, mask: Mask8) -> f32 {
        let x = mask.select(self, Self::splat(f32::INFINITY)).0;
        simd!({
            let x = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x));
            let x = _mm_min_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_min_ss(x, _mm_shuffle_ps::<1>(x, x)))
        })
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
unsafe fn rows<const K: usize>(table: *const f32, at: Word8) -> [Real8; K] {
    let mut lanes = [0; 8];
    at.store(&mut lanes);
    let mut columns = [Real8::zero(); K];
    for (quad, columns) in columns.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        // Volatile, or LLVM takes the register of indices apart instead: two instructions a lane.
        // SAFETY: reads of four numbers, as the caller promised; the processor has the instructions, see `registers`.
        unsafe {
            macro_rules! row {
                ($lane:literal) => {{
                    let at = std::ptr::read_volatile(&lanes[$lane]) as usize;
                    _mm_loadu_ps(table.byte_add(8 * at).add(4 * quad))
                }};
            }
            macro_rules! two {
                ($lane:literal, $other:literal) => {
                    _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(row!($lane)), row!($other))
                };
            }
            *columns = transpose([two!(0, 4), two!(1, 5), two!(2, 6), two!(3, 7)]);
        }
    }
    columns
}

/// In each half: number `i` of row `j` becomes number `j` of row `i`.
#[inline(always)]
fn transpose([a, b, c, d]: [__m256; 4]) -> [Real8; 4] {
    simd!({
        let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
        let (ab_high, cd_high) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
        [
            Real8(_mm256_shuffle_ps::<0x44>(ab, cd)),
            Real8(_mm256_shuffle_ps::<0xee>(ab, cd)),
            Real8(_mm256_shuffle_ps::<0x44>(ab_high, cd_high)),
            Real8(_mm256_shuffle_ps::<0xee>(ab_high, cd_high)),
        ]
    })
}

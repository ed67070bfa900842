//! Four lanes: NEON, which every 64-bit Arm processor has.
#![expect(unsafe_code, reason = "intrinsics that read and write memory")]
#![allow(unused_unsafe, reason = "intrinsics on registers alone are safe where all processors have them")]

use std::arch::aarch64::*;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

use crate::registers::{lanes, methods, operators, rows, simd};
use crate::{Kernel, Lanes, Mask, Real, Select, Word};

/// Runs a kernel.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Real4>()
}

#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Real4(float32x4_t);

#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Word4(uint32x4_t);

/// All bits of a lane are the same.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
struct Mask4(uint32x4_t);

const BIT_OF_LANE: [u32; 4] = [1, 2, 4, 8];

impl Mask for Mask4 {
    const N: usize = 4;

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(simd!(vtstq_u32(vdupq_n_u32(bits), Word4::load(&BIT_OF_LANE).0)))
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        simd!(vaddvq_u32(vandq_u32(self.0, Word4::load(&BIT_OF_LANE).0)))
    }
}

impl Not for Mask4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(simd!(vmvnq_u32(self.0)))
    }
}

macro_rules! mask_operators {
    ($($trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl $trait for Mask4 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(simd!($intrinsic(self.0, other.0)))
            }
        }
    )*};
}
mask_operators!(BitAnd bitand vandq_u32, BitOr bitor vorrq_u32, BitXor bitxor veorq_u32);

impl Select<Mask4> for Mask4 {
    #[inline(always)]
    fn select(mask: Mask4, yes: Self, no: Self) -> Self {
        Self(select_words(mask.0, yes.0, no.0))
    }
}

#[inline(always)]
fn select(mask: uint32x4_t, yes: float32x4_t, no: float32x4_t) -> float32x4_t {
    simd!(vbslq_f32(mask, yes, no))
}

#[inline(always)]
fn select_words(mask: uint32x4_t, yes: uint32x4_t, no: uint32x4_t) -> uint32x4_t {
    simd!(vbslq_u32(mask, yes, no))
}

/// For each mask, the bytes of the lanes that are set, lowest first.
static SET_LANES: [[u8; 16]; 16] = {
    let mut table = [[0; 16]; 16];
    let mut bits = 0;
    while bits < 16 {
        let (mut lane, mut place) = (0, 0);
        while lane < 16 {
            if bits >> (lane / 4) & 1 == 1 {
                table[bits][place] = lane as u8;
                place += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

#[inline(always)]
fn pack_words(x: uint32x4_t, mask: Mask4) -> uint32x4_t {
    let order = &SET_LANES[(mask.bits() & 15) as usize];
    // SAFETY: sixteen bytes are read.
    unsafe { vreinterpretq_u32_u8(vqtbl1q_u8(vreinterpretq_u8_u32(x), vld1q_u8(order.as_ptr()))) }
}

#[inline(always)]
fn pack(x: float32x4_t, mask: Mask4) -> float32x4_t {
    simd!(vreinterpretq_f32_u32(pack_words(vreinterpretq_u32_f32(x), mask)))
}

/// # Safety
/// The indices are within the table.
#[inline(always)]
unsafe fn gather_words(table: *const u32, at: Word4) -> uint32x4_t {
    let mut lanes = [0; 4];
    at.store(&mut lanes);
    // SAFETY: as the caller promised.
    Word4::load(&unsafe { lanes.map(|at| *table.add(at as usize)) }).0
}

/// # Safety
/// The indices are within the table.
#[inline(always)]
unsafe fn gather(table: *const f32, at: Word4) -> float32x4_t {
    // SAFETY: as the caller promised.
    unsafe { vreinterpretq_f32_u32(gather_words(table.cast(), at)) }
}

/// Shifts to the left by `count`, to the right if it is negative.
#[inline(always)]
fn shift(x: uint32x4_t, count: int32x4_t) -> uint32x4_t {
    simd!(vshlq_u32(x, count))
}

/// Counts of shifts; the instruction looks at their lowest byte alone.
#[inline(always)]
fn counts(count: uint32x4_t) -> int32x4_t {
    simd!(vreinterpretq_s32_u32(vminq_u32(count, vdupq_n_u32(32))))
}

#[inline(always)]
fn shift_left(x: uint32x4_t, count: uint32x4_t) -> uint32x4_t {
    shift(x, counts(count))
}

#[inline(always)]
fn shift_right(x: uint32x4_t, count: uint32x4_t) -> uint32x4_t {
    shift(x, simd!(vnegq_s32(counts(count))))
}

lanes!(Word4 of 4 u32, Mask4, Word4: select_words vdupq_n_u32 vld1q_u32 vst1q_u32 pack_words gather_words);
operators!(Word4, u32: Add add vaddq_u32, Sub sub vsubq_u32, Mul mul vmulq_u32,
    BitAnd bitand vandq_u32, BitOr bitor vorrq_u32, BitXor bitxor veorq_u32, Shl shl shift_left, Shr shr shift_right);

impl Not for Word4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(simd!(vmvnq_u32(self.0)))
    }
}

impl Word for Word4 {
    methods! {
        min -> Self |a, other| vminq_u32(a, other);
        max -> Self |a, other| vmaxq_u32(a, other);
        eq -> Mask4 |a, other| vceqq_u32(a, other);
        lt -> Mask4 |a, other| vcltq_u32(a, other);
        leading_zeros -> Self |a| vclzq_u32(a);
        reverse_bits -> Self |a| vreinterpretq_u32_u8(vrev32q_u8(vrbitq_u8(vreinterpretq_u8_u32(a))));
    }

    #[inline(always)]
    fn iota() -> Self {
        Self::load(&[0, 1, 2, 3])
    }
}

lanes!(Real4 of 4 f32, Mask4, Word4: select vdupq_n_f32 vld1q_f32 vst1q_f32 pack gather);
operators!(Real4, f32: Add add vaddq_f32, Sub sub vsubq_f32, Mul mul vmulq_f32, Div div vdivq_f32);

impl Neg for Real4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(simd!(vnegq_f32(self.0)))
    }
}

impl Real for Real4 {
    methods! {
        sqrt -> Self |a| vsqrtq_f32(a);
        // The instructions for smaller and larger ones have other rules for NaN and zeros.
        min -> Self |a, other| vbslq_f32(vcltq_f32(a, other), a, other);
        max -> Self |a, other| vbslq_f32(vcgtq_f32(a, other), a, other);
        floor -> Self |a| vrndmq_f32(a);
        round -> Self |a| vrndnq_f32(a);
        lt -> Mask4 |a, other| vcltq_f32(a, other);
        le -> Mask4 |a, other| vcleq_f32(a, other);
        eq -> Mask4 |a, other| vceqq_f32(a, other);
        to_bits -> Word4 |a| vreinterpretq_u32_f32(a);
    }

    #[inline(always)]
    fn from_bits(bits: Word4) -> Self {
        Self(simd!(vreinterpretq_f32_u32(bits.0)))
    }

    #[inline(always)]
    fn from_word(word: Word4) -> Self {
        Self(simd!(vcvtq_f32_s32(vreinterpretq_s32_u32(word.0))))
    }

    #[inline(always)]
    fn to_word(self) -> Word4 {
        // The instruction brings numbers into the range instead.
        let inside = self.abs().lt(Self::splat(-(i32::MIN as f32)));
        let word = Word4(simd!(vreinterpretq_u32_s32(vcvtq_s32_f32(self.0))));
        inside.select(word, Word4::splat(1 << 31))
    }

    rows!(Word4, rows);

    #[inline(always)]
    fn least(self, mask: Mask4) -> f32 {
        let x = mask.select(self, Self::splat(f32::INFINITY));
        simd!(vminvq_f32(x.0))
    }

    #[inline(always)]
    fn vectorize<T>(f: impl FnOnce() -> T) -> T {
        f()
    }
}

/// Rows of `K` numbers, read by four and transposed.
///
/// # Safety
/// Where the indices say, in units of eight bytes, there are `K` numbers.
#[inline(always)]
unsafe fn rows<const K: usize>(table: *const f32, at: Word4) -> [Real4; K] {
    let mut lanes = [0; 4];
    at.store(&mut lanes);
    let mut columns = [Real4::zero(); K];
    for (quad, columns) in columns.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        // SAFETY: reads of four numbers, as the caller promised.
        *columns =
            transpose(unsafe { lanes.map(|at| vld1q_f32(table.byte_add(8 * at as usize).add(4 * quad))) });
    }
    columns
}

/// Number `i` of row `j` becomes number `j` of row `i`.
#[inline(always)]
fn transpose([a, b, c, d]: [float32x4_t; 4]) -> [Real4; 4] {
    simd!({
        let (ac, ac_high) = (vzip1q_f32(a, c), vzip2q_f32(a, c));
        let (bd, bd_high) = (vzip1q_f32(b, d), vzip2q_f32(b, d));
        [
            Real4(vzip1q_f32(ac, bd)),
            Real4(vzip2q_f32(ac, bd)),
            Real4(vzip1q_f32(ac_high, bd_high)),
            Real4(vzip2q_f32(ac_high, bd_high)),
        ]
    })
}

//! One lane: `f32`, [`Word1`] and `bool`. It runs on any machine, and is what the others are held against.

use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Not, Shl, Shr, Sub};

use crate::{Lanes, Mask, Real, Select, Word};

impl Mask for bool {
    const N: usize = 1;

    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        bits & 1 == 1
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.into()
    }
}

macro_rules! select {
    ($($type:ty),*) => {$(
        impl Select<bool> for $type {
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }
    )*};
}
select!(bool, f32, Word1);

/// A word whose sums and products wrap: the one-lane [`Word`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Word1(pub u32);

macro_rules! word_operators {
    ($($trait:ident $method:ident |$a:ident, $b:ident| $result:expr;)*) => {$(
        impl $trait<u32> for Word1 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, $b: u32) -> Self {
                let $a = self.0;
                Self($result)
            }
        }
        impl $trait for Word1 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.$method(other.0)
            }
        }
    )*};
}
word_operators! {
    Add add |a, b| a.wrapping_add(b);
    Sub sub |a, b| a.wrapping_sub(b);
    Mul mul |a, b| a.wrapping_mul(b);
    BitAnd bitand |a, b| a & b;
    BitOr bitor |a, b| a | b;
    BitXor bitxor |a, b| a ^ b;
    Shl shl |a, b| if b < 32 { a << b } else { 0 };
    Shr shr |a, b| if b < 32 { a >> b } else { 0 };
}

impl Not for Word1 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

/// The place of a row or number in a table, brought within it.
#[inline(always)]
fn within<T>(table: &[T], at: Word1) -> &T {
    &table[(at.0 as usize).min(table.len() - 1)]
}

impl Lanes for Word1 {
    const N: usize = 1;
    type Item = u32;
    type Mask = bool;
    type Word = Self;

    #[inline(always)]
    fn splat(x: u32) -> Self {
        Self(x)
    }

    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        Self(from[0])
    }

    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[0] = self.0;
    }

    #[inline(always)]
    fn compress(self, mask: bool, to: &mut [u32]) -> usize {
        to[0] = self.0;
        mask.count()
    }

    #[inline(always)]
    fn gather(table: &[u32], at: Self) -> Self {
        Self(*within(table, at))
    }
}

impl Word for Word1 {
    #[inline(always)]
    fn iota() -> Self {
        Self(0)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self.0 == other.0
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.0 < other.0
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        Self(self.0.reverse_bits())
    }

    #[inline(always)]
    fn leading_zeros(self) -> Self {
        Self(self.0.leading_zeros())
    }
}

impl Lanes for f32 {
    const N: usize = 1;
    type Item = f32;
    type Mask = bool;
    type Word = Word1;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        x
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        from[0]
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }

    #[inline(always)]
    fn compress(self, mask: bool, to: &mut [f32]) -> usize {
        to[0] = self;
        mask.count()
    }

    #[inline(always)]
    fn gather(table: &[f32], at: Word1) -> Self {
        *within(table, at)
    }
}

/// From here on, numbers of single precision are whole.
const WHOLE: f32 = (1 << 23) as f32;

impl Real for f32 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    // The standard library's are calls where the baseline has no instruction for them.
    #[inline(always)]
    fn floor(self) -> Self {
        let near = (self as i32) as f32;
        let floor = if near > self { near - 1.0 } else { near };
        if f32::abs(self) < WHOLE { f32::copysign(floor, self) } else { self }
    }

    #[inline(always)]
    fn round(self) -> Self {
        let rounded = (f32::abs(self) + WHOLE) - WHOLE;
        if f32::abs(self) < WHOLE { f32::copysign(rounded, self) } else { self }
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }

    #[inline(always)]
    fn to_bits(self) -> Word1 {
        Word1(f32::to_bits(self))
    }

    #[inline(always)]
    fn from_bits(bits: Word1) -> Self {
        f32::from_bits(bits.0)
    }

    #[inline(always)]
    fn from_word(word: Word1) -> Self {
        word.0 as i32 as f32
    }

    #[inline(always)]
    fn to_word(self) -> Word1 {
        let inside = f32::abs(self) < -(i32::MIN as f32);
        Word1(if inside { self as i32 as u32 } else { 1 << 31 })
    }

    #[inline(always)]
    fn rows<const K: usize>(table: &[[f32; K]], at: Word1) -> [Self; K] {
        *within(table, at)
    }

    #[inline(always)]
    fn least(self, mask: bool) -> f32 {
        if mask { self } else { f32::INFINITY }
    }

    #[inline(always)]
    fn vectorize<T>(f: impl FnOnce() -> T) -> T {
        f()
    }
}

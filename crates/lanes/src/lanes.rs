//! The vocabulary: what a renderer asks of numbers, so that one source serves one path or many at once.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

/// The largest number of lanes of any instruction set.
pub const MAX_LANES: usize = 16;

/// Chooses between two values lane by lane.
pub trait Select<M> {
    /// `yes` where a lane of `mask` is set, `no` elsewhere.
    fn select(mask: M, yes: Self, no: Self) -> Self;
}

/// One truth a lane.
pub trait Mask:
    Copy
    + Debug
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
    + Select<Self>
{
    /// The number of lanes.
    const N: usize;

    /// Lane `i` from bit `i`; higher bits are ignored.
    fn from_bits(bits: u32) -> Self;

    /// A bit a lane, the first lane lowest.
    fn bits(self) -> u32;

    /// The same in all lanes.
    #[inline(always)]
    fn splat(truth: bool) -> Self {
        Self::from_bits(if truth { u32::MAX } else { 0 })
    }

    /// The first `count` lanes, all if there are no more.
    #[inline(always)]
    fn first(count: usize) -> Self {
        Self::from_bits(((1_u64 << count.min(32)) - 1) as u32)
    }

    /// Is any lane set?
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }

    /// Are all lanes set?
    #[inline(always)]
    fn all(self) -> bool {
        self.bits() == u32::MAX >> (32 - Self::N)
    }

    /// Is no lane set?
    #[inline(always)]
    fn none(self) -> bool {
        self.bits() == 0
    }

    /// How many lanes are set.
    #[inline(always)]
    fn count(self) -> usize {
        self.bits().count_ones() as usize
    }

    /// Is this lane set?
    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        self.bits() >> lane & 1 == 1
    }

    /// The lanes that are set, in order.
    #[inline(always)]
    fn lanes(self) -> SetBits {
        SetBits(self.bits())
    }

    /// `yes` where a lane is set, `no` elsewhere.
    #[inline(always)]
    fn select<T: Select<Self>>(self, yes: T, no: T) -> T {
        T::select(self, yes, no)
    }
}

/// The positions of the bits that are set, lowest first.
#[derive(Clone, Copy, Debug)]
pub struct SetBits(pub u32);

impl Iterator for SetBits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lowest = self.0.trailing_zeros() as usize;
        (self.0 != 0).then(
            #[inline(always)]
            || {
                self.0 &= self.0 - 1;
                lowest
            },
        )
    }
}

/// What numbers of both kinds have in common: [`Real`] and [`Word`].
pub trait Lanes: Copy + Debug + Select<Self::Mask> {
    /// The number of lanes.
    const N: usize;
    /// What a lane holds.
    type Item: Copy + Default + Debug;
    /// What comparisons give.
    type Mask: Mask;
    /// Words, as many: what tables are read by.
    type Word: Word + Lanes<Mask = Self::Mask>;

    /// The same in all lanes.
    fn splat(x: Self::Item) -> Self;

    /// The first numbers of a slice.
    ///
    /// # Panics
    /// If there are fewer than lanes.
    fn load(from: &[Self::Item]) -> Self;

    /// Writes all lanes to the front of a slice.
    ///
    /// # Panics
    /// If it is shorter.
    fn store(self, to: &mut [Self::Item]);

    /// Writes the lanes of `mask`, side by side, to the front of a slice, and says how many there are. The places behind them, as
    /// far as all lanes would reach, are overwritten with anything.
    ///
    /// # Panics
    /// If the slice is shorter than the number of lanes.
    fn compress(self, mask: Self::Mask, to: &mut [Self::Item]) -> usize;

    /// A number of a table for each lane. Indices past its end read the last one.
    ///
    /// # Panics
    /// If the table is empty or has more than 2³¹ numbers.
    fn gather(table: &[Self::Item], at: Self::Word) -> Self;

    /// The first numbers of a slice; zero in the lanes for which it is too short.
    #[inline(always)]
    fn load_part(from: &[Self::Item]) -> Self {
        let mut all = [Self::Item::default(); MAX_LANES];
        let count = from.len().min(Self::N);
        all[..count].copy_from_slice(&from[..count]);
        Self::load(&all)
    }

    /// Writes as many lanes as the slice has room for.
    #[inline(always)]
    fn store_part(self, to: &mut [Self::Item]) {
        let count = to.len().min(Self::N);
        to[..count].copy_from_slice(&self.to_array()[..count]);
    }

    /// All lanes, and zeros behind them.
    #[inline(always)]
    fn to_array(self) -> [Self::Item; MAX_LANES] {
        let mut all = [Self::Item::default(); MAX_LANES];
        self.store(&mut all);
        all
    }

    /// One lane. For cold code: the registers go through memory.
    #[inline(always)]
    fn lane(self, lane: usize) -> Self::Item {
        self.to_array()[lane]
    }

    /// The same with another number in one lane. For cold code: the registers go through memory.
    #[inline(always)]
    fn with_lane(self, lane: usize, x: Self::Item) -> Self {
        let mut all = self.to_array();
        all[lane] = x;
        Self::load(&all)
    }
}

/// The four basic operations, by another of the kind or by one number for all lanes.
pub trait Arithmetic<T>:
    Sized + Add<T, Output = Self> + Sub<T, Output = Self> + Mul<T, Output = Self> + Div<T, Output = Self>
{
}
impl<S, T> Arithmetic<T> for S where
    S: Add<T, Output = S> + Sub<T, Output = S> + Mul<T, Output = S> + Div<T, Output = S>
{
}

/// The operations of whole numbers and of bits, by another of the kind or by one number for all lanes.
pub trait BitArithmetic<T>:
    Sized
    + Add<T, Output = Self>
    + Sub<T, Output = Self>
    + Mul<T, Output = Self>
    + BitAnd<T, Output = Self>
    + BitOr<T, Output = Self>
    + BitXor<T, Output = Self>
    + Shl<T, Output = Self>
    + Shr<T, Output = Self>
{
}
impl<S, T> BitArithmetic<T> for S where
    S: Add<T, Output = S>
        + Sub<T, Output = S>
        + Mul<T, Output = S>
        + BitAnd<T, Output = S>
        + BitOr<T, Output = S>
        + BitXor<T, Output = S>
        + Shl<T, Output = S>
        + Shr<T, Output = S>
{
}

/// Words of 32 bits without sign. Sums and products wrap; shifts by 32 or more give zero.
pub trait Word:
    Lanes<Item = u32, Word = Self> + BitArithmetic<Self> + BitArithmetic<u32> + Not<Output = Self>
{
    /// 0, 1, 2 …
    fn iota() -> Self;
    /// Where both are equal.
    fn eq(self, other: Self) -> Self::Mask;
    /// Where this is smaller.
    fn lt(self, other: Self) -> Self::Mask;
    /// The smaller one.
    fn min(self, other: Self) -> Self;
    /// The larger one.
    fn max(self, other: Self) -> Self;
    /// The bits from last to first.
    fn reverse_bits(self) -> Self;
    /// How many zeros stand before the highest bit that is set; 32 for zero.
    fn leading_zeros(self) -> Self;

    /// How many zeros stand behind the lowest bit that is set; 32 for zero.
    #[inline(always)]
    fn trailing_zeros(self) -> Self {
        Self::splat(32) - (!self & (self - 1)).leading_zeros()
    }
    /// Where they differ.
    #[inline(always)]
    fn ne(self, other: Self) -> Self::Mask {
        !self.eq(other)
    }
}

/// Numbers of single precision, by the rules of IEEE 754: each operation is rounded on its own, to nearest. Which NaN an operation
/// gives is not promised.
pub trait Real: Lanes<Item = f32> + Arithmetic<Self> + Arithmetic<f32> + Neg<Output = Self> {
    /// The square root, rounded to nearest; NaN below zero.
    fn sqrt(self) -> Self;
    /// `if self < other { self } else { other }`: `other` where one is NaN or both are zeros.
    fn min(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`: `other` where one is NaN or both are zeros.
    fn max(self, other: Self) -> Self;
    /// The whole number that is not larger; keeps the sign of zero.
    fn floor(self) -> Self;
    /// The nearest whole number, the even one of two; keeps the sign of zero.
    fn round(self) -> Self;
    /// Where this is smaller.
    fn lt(self, other: Self) -> Self::Mask;
    /// Where this is smaller or equal.
    fn le(self, other: Self) -> Self::Mask;
    /// Where both are equal.
    fn eq(self, other: Self) -> Self::Mask;
    /// The bits of the encoding.
    fn to_bits(self) -> Self::Word;
    /// The number with this encoding.
    fn from_bits(bits: Self::Word) -> Self;
    /// The words as numbers *with* sign, from -2³¹ to 2³¹ - 1, rounded to nearest.
    fn from_word(word: Self::Word) -> Self;
    /// The whole part (towards zero) as a word with sign; 0x8000_0000 if it is not between -2³¹ and 2³¹, or NaN.
    fn to_word(self) -> Self::Word;
    /// For each lane, a row of a table. Indices past its end read the last row. `K` is a multiple of four.
    ///
    /// This is how tables should be read: a row of four costs a load, where a gather of four columns costs four.
    ///
    /// # Panics
    /// If the table is empty, or larger than 32 GiB.
    fn rows<const K: usize>(table: &[[f32; K]], at: Self::Word) -> [Self; K];
    /// The smallest lane among those of `mask`, infinity if there are none. Of two zeros any; the lanes must not be NaN.
    fn least(self, mask: Self::Mask) -> f32;
    /// Runs a closure that was compiled for the instruction set of this type. Mark it `#[inline(always)]`, and what it calls too.
    fn vectorize<T>(f: impl FnOnce() -> T) -> T;

    /// Zero in all lanes.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// One in all lanes.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    /// Where this is larger.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// Where this is larger or equal.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// Where they differ, or one is NaN.
    #[inline(always)]
    fn ne(self, other: Self) -> Self::Mask {
        !self.eq(other)
    }
    /// Where this is NaN.
    #[inline(always)]
    fn is_nan(self) -> Self::Mask {
        self.ne(self)
    }
    /// Where this is neither infinite nor NaN.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().le(Self::splat(f32::MAX))
    }
    /// The number without its sign.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::from_bits(self.to_bits() & !SIGN)
    }
    /// Minus zero where the sign is negative, zero elsewhere.
    #[inline(always)]
    fn sign(self) -> Self {
        Self::from_bits(self.to_bits() & SIGN)
    }
    /// The number with its sign turned where that of `other` is negative.
    #[inline(always)]
    fn mul_sign(self, other: Self) -> Self {
        Self::from_bits(self.to_bits() ^ (other.to_bits() & SIGN))
    }
    /// The number with the sign of `other`.
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        Self::from_bits((self.to_bits() & !SIGN) | (other.to_bits() & SIGN))
    }
    /// The number times itself.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// The number in the lanes of `mask`, zero elsewhere.
    #[inline(always)]
    fn only(self, mask: Self::Mask) -> Self {
        mask.select(self, Self::zero())
    }
    /// The square root, of zero for numbers below it (and NaN): for squares that rounding made negative.
    #[inline(always)]
    fn safe_sqrt(self) -> Self {
        self.max(Self::zero()).sqrt()
    }
    /// The number brought into a range. NaN becomes `low`.
    #[inline(always)]
    fn clamp(self, low: f32, high: f32) -> Self {
        self.max(Self::splat(low)).min(Self::splat(high))
    }
}

/// The bit of the sign.
const SIGN: u32 = 1 << 31;

impl<M: Copy, T: Select<M>, const K: usize> Select<M> for [T; K]
where
    T: Copy,
{
    #[inline(always)]
    fn select(mask: M, yes: Self, no: Self) -> Self {
        let mut chosen = no;
        for k in 0..K {
            chosen[k] = T::select(mask, yes[k], no[k]);
        }
        chosen
    }
}

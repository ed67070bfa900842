//! The same code, compiled for several instruction sets; the best one that the machine has is chosen at run time.
//!
//! Additions, products and comparisons are neither fused nor reordered, so all instruction sets give the same bits. The
//! one exception says so: [`Floats::mul_sub`], for bounds that have room for both roundings.

mod portable;
#[cfg(target_arch = "x86_64")]
mod x86;

use std::ops::{Add, BitAnd, Div, Mul, Sub};

pub(crate) use portable::Portable;

/// Registers of one instruction set.
pub(crate) trait Simd: Copy {
    /// Four numbers.
    type F4: Floats<4>;
    /// Eight numbers.
    type F8: Floats<8>;
    /// Sixteen numbers.
    type F16: Floats<16>;

    /// Small whole numbers.
    fn numbers(bytes: &[u8; 8]) -> Self::F8;

    /// Four quads side by side.
    fn join(quads: [Self::F4; 4]) -> Self::F16;
    /// The quads of sixteen numbers.
    fn quads(joined: Self::F16) -> [Self::F4; 4];
    /// Transposes the square that the same quads of four rows are: number `i` of row `j` becomes number `j` of row `i`.
    fn transpose(rows: [Self::F16; 4]) -> [Self::F16; 4];
    /// `yes` where a bit is set, `no` elsewhere.
    fn select(bits: u32, yes: Self::F16, no: Self::F16) -> Self::F16;

    /// Asks for memory that will be read soon.
    #[inline(always)]
    fn prefetch<T>(_soon: &T) {}
}

/// Numbers side by side.
pub(crate) trait Floats<const N: usize>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// What comparisons give.
    type Mask: Mask;

    fn splat(x: f32) -> Self;
    fn load(from: &[f32; N]) -> Self;
    fn to_array(self) -> [f32; N];
    /// The smaller ones; those of `other` where one is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger ones; those of `other` where one is NaN.
    fn max(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// `self · b - c`, rounded once or twice.
    fn mul_sub(self, b: Self, c: Self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn less_or_equal(self, other: Self) -> Self::Mask;
}

/// One truth for each number.
pub(crate) trait Mask: Copy + BitAnd<Output = Self> {
    /// A bit for each.
    fn bits(self) -> u32;
}

/// Copies of three numbers. (Arrays' own `map` is not compiled into the code around it, and so not for its instruction set.)
#[inline(always)]
pub(crate) fn splat3<const N: usize, F: Floats<N>>(x: [f32; 3]) -> [F; 3] {
    [F::splat(x[0]), F::splat(x[1]), F::splat(x[2])]
}

/// Three registers from memory.
#[inline(always)]
pub(crate) fn load3<const N: usize, F: Floats<N>>(x: &[[f32; N]; 3]) -> [F; 3] {
    [F::load(&x[0]), F::load(&x[1]), F::load(&x[2])]
}

/// Work to be done with some instruction set. Its `run` and all that it calls should insist on being inlined.
pub(crate) trait Kernel {
    type Output;
    /// Does the work.
    fn run<S: Simd>(self) -> Self::Output;
}

/// Runs a kernel with the widest instructions that this machine has.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    return x86::run(kernel);
    #[cfg(not(target_arch = "x86_64"))]
    kernel.run::<Portable>()
}

/// The positions of the bits that are set, lowest first.
#[inline(always)]
pub(crate) fn lanes(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            lane
        })
    })
}

#[cfg(test)]
mod tests;

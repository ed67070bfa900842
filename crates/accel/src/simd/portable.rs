//! Plain arrays, for any machine.

use std::ops::{Add, BitAnd, Div, Mul, Sub};

use super::{Floats, Mask, Simd};

/// No particular instruction set.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl Simd for Portable {
    type F4 = Lanes<4>;
    type F8 = Lanes<8>;
    type F16 = Lanes<16>;

    #[inline(always)]
    fn numbers(bytes: &[u8; 8]) -> Lanes<8> {
        Lanes(std::array::from_fn(|i| bytes[i].into()))
    }

    #[inline(always)]
    fn join(quads: [Lanes<4>; 4]) -> Lanes<16> {
        Lanes(std::array::from_fn(|i| quads[i / 4].0[i % 4]))
    }

    #[inline(always)]
    fn quads(joined: Lanes<16>) -> [Lanes<4>; 4] {
        std::array::from_fn(|quad| Lanes(std::array::from_fn(|i| joined.0[4 * quad + i])))
    }

    #[inline(always)]
    fn transpose(rows: [Lanes<16>; 4]) -> [Lanes<16>; 4] {
        std::array::from_fn(|row| Lanes(std::array::from_fn(|i| rows[i % 4].0[i / 4 * 4 + row])))
    }

    #[inline(always)]
    fn select(bits: u32, yes: Lanes<16>, no: Lanes<16>) -> Lanes<16> {
        Lanes(std::array::from_fn(|i| if bits >> i & 1 == 1 { yes.0[i] } else { no.0[i] }))
    }
}

#[derive(Clone, Copy, Debug)]
#[repr(align(16))]
pub(crate) struct Lanes<const N: usize>([f32; N]);

impl<const N: usize> Lanes<N> {
    #[inline(always)]
    fn zip(self, other: Self, op: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| op(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn compare(self, other: Self, op: impl Fn(&f32, &f32) -> bool) -> Bits {
        Bits((0..N).fold(0, |bits, i| bits | u32::from(op(&self.0[i], &other.0[i])) << i))
    }
}

macro_rules! operators {
    ($($name:ident $method:ident $op:tt),*) => {$(
        impl<const N: usize> $name for Lanes<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| a $op b)
            }
        }
    )*};
}
operators!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const N: usize> Floats<N> for Lanes<N> {
    type Mask = Bits;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; N])
    }

    #[inline(always)]
    fn load(from: &[f32; N]) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn to_array(self) -> [f32; N] {
        self.0
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self * b - c
    }

    #[inline(always)]
    fn less(self, other: Self) -> Bits {
        self.compare(other, f32::lt)
    }

    #[inline(always)]
    fn less_or_equal(self, other: Self) -> Bits {
        self.compare(other, f32::le)
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Bits(u32);

impl BitAnd for Bits {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl Mask for Bits {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0
    }
}

//! Four lanes of a spectral quantity.

use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Neg, Sub};

use glam::Vec4;

/// Four values of a spectral quantity: R, G, B and a spare lane, or one value per hero wavelength.
///
/// In RGB mode the spare lane carries no meaning and never reaches an image. So what decides about paths, such as the largest
/// lane, looks at the other three alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Spectrum(Vec4);

impl Spectrum {
    /// All lanes zero.
    pub const ZERO: Self = Self(Vec4::ZERO);
    /// All lanes one.
    pub const ONE: Self = Self(Vec4::ONE);

    /// The same value in every lane.
    #[inline]
    pub const fn splat(value: f32) -> Self {
        Self(Vec4::splat(value))
    }

    /// Lanes from an array.
    #[inline]
    pub const fn new(lanes: [f32; 4]) -> Self {
        Self(Vec4::from_array(lanes))
    }

    /// Linear Rec. 709 values; the spare lane takes the luminance, so that it stays of the same magnitude.
    #[inline]
    pub fn from_rgb([r, g, b]: [f32; 3]) -> Self {
        Self(Vec4::new(r, g, b, crate::luminance([r, g, b])))
    }

    /// The first three lanes: linear Rec. 709 in RGB mode.
    #[inline]
    pub fn rgb(self) -> [f32; 3] {
        [self.0.x, self.0.y, self.0.z]
    }

    /// All four lanes.
    #[inline]
    pub fn to_array(self) -> [f32; 4] {
        self.0.to_array()
    }

    /// The largest lane that has a meaning.
    #[inline]
    pub fn max_element(self) -> f32 {
        self.0.x.max(self.0.y).max(self.0.z)
    }

    /// The mean of the lanes that have a meaning.
    #[inline]
    pub fn average(self) -> f32 {
        (self.0.x + self.0.y + self.0.z) * (1.0 / 3.0)
    }

    /// Whether every lane that has a meaning is exactly zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.0.cmpeq(Vec4::ZERO).bitmask() & 0b111 == 0b111
    }

    /// Whether no lane that has a meaning is infinite or NaN.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.0.is_finite_mask().bitmask() & 0b111 == 0b111
    }

    /// Lane-wise maximum with zero.
    #[inline]
    pub fn max_zero(self) -> Self {
        Self(self.0.max(Vec4::ZERO))
    }

    /// Lane-wise clamp to `[low, high]`.
    #[inline]
    pub fn clamp(self, low: f32, high: f32) -> Self {
        Self(self.0.clamp(Vec4::splat(low), Vec4::splat(high)))
    }

    /// Lane-wise square root.
    #[inline]
    pub fn sqrt(self) -> Self {
        Self(Vec4::new(self.0.x.sqrt(), self.0.y.sqrt(), self.0.z.sqrt(), self.0.w.sqrt()))
    }

    /// Lane-wise `e^x`.
    #[inline]
    pub fn exp(self) -> Self {
        self.map(f32::exp)
    }

    /// Applies a function to each lane.
    #[inline]
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        let [a, b, c, d] = self.to_array();
        Self::new([f(a), f(b), f(c), f(d)])
    }

    /// Lane-wise `self * (1 - t) + other * t`.
    #[inline]
    pub fn lerp(self, other: Self, t: f32) -> Self {
        Self(self.0.lerp(other.0, t))
    }

    /// Lane-wise `self * a + b`.
    #[inline]
    pub fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0 * a.0 + b.0)
    }
}

impl Index<usize> for Spectrum {
    type Output = f32;
    #[inline]
    fn index(&self, lane: usize) -> &f32 {
        &self.0[lane]
    }
}

macro_rules! lane_wise {
    ($($Trait:ident, $method:ident);*) => {$(
        impl $Trait for Spectrum {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self($Trait::$method(self.0, other.0))
            }
        }
        impl $Trait<f32> for Spectrum {
            type Output = Self;
            #[inline]
            fn $method(self, other: f32) -> Self {
                Self($Trait::$method(self.0, Vec4::splat(other)))
            }
        }
    )*};
}
lane_wise!(Add, add; Sub, sub; Mul, mul; Div, div);

impl Mul<Spectrum> for f32 {
    type Output = Spectrum;
    #[inline]
    fn mul(self, other: Spectrum) -> Spectrum {
        other * self
    }
}

impl Neg for Spectrum {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Spectrum {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}

impl MulAssign for Spectrum {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        self.0 *= other.0;
    }
}

impl MulAssign<f32> for Spectrum {
    #[inline]
    fn mul_assign(&mut self, other: f32) {
        self.0 *= other;
    }
}

impl Sum for Spectrum {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::ZERO, Add::add)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_is_lane_wise() {
        let a = Spectrum::new([1.0, 2.0, 3.0, 4.0]);
        let b = Spectrum::splat(2.0);
        assert_eq!((a * b + 1.0).to_array(), [3.0, 5.0, 7.0, 9.0]);
        assert!(!a.is_black() && Spectrum::ZERO.is_black());
    }

    /// Red times blue is black, whatever is left in the spare lane.
    #[test]
    fn the_spare_lane_decides_nothing() {
        let a = Spectrum::new([1.0, 2.0, 3.0, 40.0]);
        assert_eq!(a.max_element(), 3.0);
        assert_eq!(a.average(), 2.0);
        let (red, blue) = (Spectrum::from_rgb([1.0, 0.0, 0.0]), Spectrum::from_rgb([0.0, 0.0, 1.0]));
        assert!((red * blue).is_black());
        assert!(Spectrum::new([1.0, 2.0, 3.0, f32::NAN]).is_finite());
        assert!(!Spectrum::new([1.0, f32::INFINITY, 3.0, 4.0]).is_finite());
    }
}

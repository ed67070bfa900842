//! Points, vectors and normals: the same numbers, different meanings, different types.

use std::ops::{Add, AddAssign, Div, DivAssign, Index, Mul, MulAssign, Neg, Sub, SubAssign};

/// Declares a tuple type with what all of them share.
macro_rules! tuple {
    ($(#[$doc:meta])* $T:ident, $n:literal, $($c:ident = $i:literal),+) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        #[expect(missing_docs, reason = "x, y, z")]
        pub struct $T { $(pub $c: f32),+ }

        impl $T {
            /// From components.
            #[inline]
            pub const fn new($($c: f32),+) -> Self {
                Self { $($c),+ }
            }

            /// The same value in every component.
            #[inline]
            pub const fn splat(value: f32) -> Self {
                Self { $($c: value),+ }
            }

            /// Components as an array.
            #[inline]
            pub const fn to_array(self) -> [f32; $n] {
                [$(self.$c),+]
            }

            /// Whether no component is infinite or NaN.
            #[inline]
            pub fn is_finite(self) -> bool {
                $(self.$c.is_finite())&&+
            }

            /// Component-wise minimum.
            #[inline]
            pub fn min(self, other: Self) -> Self {
                Self { $($c: self.$c.min(other.$c)),+ }
            }

            /// Component-wise maximum.
            #[inline]
            pub fn max(self, other: Self) -> Self {
                Self { $($c: self.$c.max(other.$c)),+ }
            }

            /// Component-wise absolute value.
            #[inline]
            pub fn abs(self) -> Self {
                Self { $($c: self.$c.abs()),+ }
            }

            /// `self` at `t = 0`, `other` at `t = 1`.
            #[inline]
            pub fn lerp(self, other: Self, t: f32) -> Self {
                Self { $($c: (1.0 - t) * self.$c + t * other.$c),+ }
            }
        }

        impl From<[f32; $n]> for $T {
            #[inline]
            fn from([$($c),+]: [f32; $n]) -> Self {
                Self { $($c),+ }
            }
        }

        impl Index<usize> for $T {
            type Output = f32;
            #[inline]
            fn index(&self, i: usize) -> &f32 {
                match i { $($i => &self.$c,)+ _ => panic!("axis {i} of a {}-tuple", $n) }
            }
        }

        impl Mul<f32> for $T {
            type Output = Self;
            #[inline]
            fn mul(self, s: f32) -> Self {
                Self { $($c: self.$c * s),+ }
            }
        }

        impl Mul<$T> for f32 {
            type Output = $T;
            #[inline]
            fn mul(self, t: $T) -> $T {
                t * self
            }
        }

        impl Div<f32> for $T {
            type Output = Self;
            #[inline]
            fn div(self, s: f32) -> Self {
                self * (1.0 / s)
            }
        }
    };
}

/// `A op B = C`, component-wise.
macro_rules! add_sub {
    ($($A:ident + $B:ident = $C:ident ($($c:ident),+);)*) => {$(
        impl Add<$B> for $A {
            type Output = $C;
            #[inline]
            fn add(self, b: $B) -> $C {
                $C { $($c: self.$c + b.$c),+ }
            }
        }
        impl AddAssign<$B> for $A {
            #[inline]
            fn add_assign(&mut self, b: $B) {
                $(self.$c += b.$c;)+
            }
        }
        impl Sub<$B> for $A {
            type Output = $C;
            #[inline]
            fn sub(self, b: $B) -> $C {
                $C { $($c: self.$c - b.$c),+ }
            }
        }
        impl SubAssign<$B> for $A {
            #[inline]
            fn sub_assign(&mut self, b: $B) {
                $(self.$c -= b.$c;)+
            }
        }
    )*};
}

/// What directions share: negation, scaling in place, lengths and products.
macro_rules! directional {
    ($($T:ident ($($c:ident),+);)*) => {$(
        impl Neg for $T {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self { $($c: -self.$c),+ }
            }
        }
        impl MulAssign<f32> for $T {
            #[inline]
            fn mul_assign(&mut self, s: f32) {
                *self = *self * s;
            }
        }
        impl DivAssign<f32> for $T {
            #[inline]
            fn div_assign(&mut self, s: f32) {
                *self = *self / s;
            }
        }
        impl $T {
            /// The zero vector.
            pub const ZERO: Self = Self::splat(0.0);

            /// Squared Euclidean length.
            #[inline]
            pub fn length_squared(self) -> f32 {
                let mut sum = 0.0;
                $(sum += self.$c * self.$c;)+
                sum
            }

            /// Euclidean length.
            #[inline]
            pub fn length(self) -> f32 {
                self.length_squared().sqrt()
            }

            /// The unit vector of the same direction; NaN for the zero vector.
            #[inline]
            pub fn normalized(self) -> Self {
                self / self.length()
            }

            /// The unit vector of the same direction, if the length is neither zero nor infinite.
            #[inline]
            pub fn try_normalized(self) -> Option<Self> {
                let length = self.length();
                (length > 0.0 && length.is_finite()).then(|| self / length)
            }
        }
    )*};
}

tuple!(/// A point of the plane.
    Point2, 2, x = 0, y = 1);
tuple!(/// A vector of the plane.
    Vector2, 2, x = 0, y = 1);
tuple!(/// A point of space.
    Point3, 3, x = 0, y = 1, z = 2);
tuple!(/// A vector of space.
    Vector3, 3, x = 0, y = 1, z = 2);
tuple!(/// A surface normal: transforms by the inverse transpose.
    Normal3, 3, x = 0, y = 1, z = 2);

add_sub! {
    Vector2 + Vector2 = Vector2 (x, y);
    Point2 + Vector2 = Point2 (x, y);
    Vector3 + Vector3 = Vector3 (x, y, z);
    Point3 + Vector3 = Point3 (x, y, z);
    Normal3 + Normal3 = Normal3 (x, y, z);
}
directional! { Vector2 (x, y); Vector3 (x, y, z); Normal3 (x, y, z); }

impl Sub for Point3 {
    type Output = Vector3;
    #[inline]
    fn sub(self, b: Self) -> Vector3 {
        Vector3::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl Sub for Point2 {
    type Output = Vector2;
    #[inline]
    fn sub(self, b: Self) -> Vector2 {
        Vector2::new(self.x - b.x, self.y - b.y)
    }
}

impl Point3 {
    /// (0, 0, 0).
    pub const ORIGIN: Self = Self::splat(0.0);

    /// The vector from the origin to this point.
    #[inline]
    pub fn to_vector(self) -> Vector3 {
        Vector3::new(self.x, self.y, self.z)
    }

    /// Euclidean distance.
    #[inline]
    pub fn distance(self, other: Self) -> f32 {
        (self - other).length()
    }
}

impl Vector3 {
    /// (1, 0, 0).
    pub const X: Self = Self::new(1.0, 0.0, 0.0);
    /// (0, 1, 0).
    pub const Y: Self = Self::new(0.0, 1.0, 0.0);
    /// (0, 0, 1).
    pub const Z: Self = Self::new(0.0, 0.0, 1.0);

    /// Scalar product.
    #[inline]
    pub fn dot(self, b: Self) -> f32 {
        self.x * b.x + self.y * b.y + self.z * b.z
    }

    /// Absolute value of the scalar product.
    #[inline]
    pub fn abs_dot(self, b: Self) -> f32 {
        self.dot(b).abs()
    }

    /// Vector product.
    #[inline]
    pub fn cross(self, b: Self) -> Self {
        Self::new(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)
    }

    /// The largest component.
    #[inline]
    pub fn max_element(self) -> f32 {
        self.x.max(self.y).max(self.z)
    }

    /// The axis of the largest component.
    #[inline]
    pub fn max_axis(self) -> usize {
        if self.x > self.y && self.x > self.z {
            0
        } else if self.y > self.z {
            1
        } else {
            2
        }
    }

    /// The same numbers as a point.
    #[inline]
    pub fn to_point(self) -> Point3 {
        Point3::new(self.x, self.y, self.z)
    }

    /// The vector, turned if need be into the hemisphere of `n`.
    #[inline]
    pub fn face_forward(self, n: Self) -> Self {
        if self.dot(n) < 0.0 { -self } else { self }
    }
}

impl Normal3 {
    /// Scalar product with a vector.
    #[inline]
    pub fn dot(self, v: Vector3) -> f32 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

impl From<Normal3> for Vector3 {
    #[inline]
    fn from(n: Normal3) -> Self {
        Self::new(n.x, n.y, n.z)
    }
}

impl From<Vector3> for Normal3 {
    #[inline]
    fn from(v: Vector3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products() {
        assert_eq!(Vector3::X.cross(Vector3::Y), Vector3::Z);
        assert_eq!(Vector3::new(1.0, 2.0, 3.0).dot(Vector3::new(4.0, 5.0, 6.0)), 32.0);
        assert_eq!(Point3::new(1.0, 2.0, 3.0) - Point3::ORIGIN, Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(Vector3::new(0.0, 3.0, 4.0).length(), 5.0);
        assert_eq!(Vector3::ZERO.try_normalized(), None);
    }
}

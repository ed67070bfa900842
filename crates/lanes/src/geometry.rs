//! Vectors, spectra and frames in lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::{Real, Select};

/// A point, vector or normal a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3<R> {
    /// First coordinate.
    pub x: R,
    /// Second coordinate.
    pub y: R,
    /// Third coordinate.
    pub z: R,
}

/// Four samples of a spectrum a lane: four wavelengths, or R, G, B and a spare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum4<R>(pub [R; 4]);

impl<R> Vec3<R> {
    /// By coordinates.
    #[inline(always)]
    pub fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }
}

impl<R: Real> Vec3<R> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat([x, y, z]: [f32; 3]) -> Self {
        Self::new(R::splat(x), R::splat(y), R::splat(z))
    }

    /// The dot product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// The square of the length.
    #[inline(always)]
    pub fn length_squared(self) -> R {
        self.dot(self)
    }

    /// The length.
    #[inline(always)]
    pub fn length(self) -> R {
        self.length_squared().sqrt()
    }

    /// The vector of length one in this direction; NaN for the one without length.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        self * (R::one() / self.length())
    }
}

impl<R: Real> Spectrum4<R> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat([a, b, c, d]: [f32; 4]) -> Self {
        Self([R::splat(a), R::splat(b), R::splat(c), R::splat(d)])
    }

    /// The same at all wavelengths.
    #[inline(always)]
    pub fn gray(x: R) -> Self {
        Self([x; 4])
    }

    /// The largest of the four.
    #[inline(always)]
    pub fn max_component(self) -> R {
        let [a, b, c, d] = self.0;
        a.max(b).max(c.max(d))
    }

    /// Where no sample is above zero.
    #[inline(always)]
    pub fn is_black(self) -> R::Mask {
        self.max_component().le(R::zero())
    }
}

macro_rules! vector_operators {
    ($($trait:ident $method:ident $other:ty, |$o:ident| $x:expr, $y:expr, $z:expr;)*) => {$(
        impl<R: Real> $trait<$other> for Vec3<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, $o: $other) -> Self {
                Self::new(self.x.$method($x), self.y.$method($y), self.z.$method($z))
            }
        }
    )*};
}
vector_operators! {
    Add add Self, |o| o.x, o.y, o.z;
    Sub sub Self, |o| o.x, o.y, o.z;
    Mul mul R, |o| o, o, o;
    Div div R, |o| o, o, o;
}

macro_rules! spectrum_operators {
    ($($trait:ident $method:ident $other:ty, |$o:ident| [$($each:expr),*];)*) => {$(
        impl<R: Real> $trait<$other> for Spectrum4<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, $o: $other) -> Self {
                let [a, b, c, d] = self.0;
                spectrum_operators!(@apply $method [a b c d] [$($each)*])
            }
        }
    )*};
    (@apply $method:ident [$($one:ident)*] [$($other:expr)*]) => {
        Self([$($one.$method($other)),*])
    };
}
spectrum_operators! {
    Add add Self, |o| [o.0[0], o.0[1], o.0[2], o.0[3]];
    Sub sub Self, |o| [o.0[0], o.0[1], o.0[2], o.0[3]];
    Mul mul Self, |o| [o.0[0], o.0[1], o.0[2], o.0[3]];
    Div div Self, |o| [o.0[0], o.0[1], o.0[2], o.0[3]];
    Mul mul R, |o| [o, o, o, o];
    Div div R, |o| [o, o, o, o];
}

impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<M: Copy, R: Select<M>> Select<M> for Vec3<R> {
    #[inline(always)]
    fn select(mask: M, yes: Self, no: Self) -> Self {
        Self {
            x: R::select(mask, yes.x, no.x),
            y: R::select(mask, yes.y, no.y),
            z: R::select(mask, yes.z, no.z),
        }
    }
}

impl<M: Copy, R: Select<M> + Copy> Select<M> for Spectrum4<R> {
    #[inline(always)]
    fn select(mask: M, yes: Self, no: Self) -> Self {
        Self(Select::select(mask, yes.0, no.0))
    }
}

/// An orthonormal frame a lane: two tangents and a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<R> {
    /// First tangent: local +X.
    pub s: Vec3<R>,
    /// Second tangent: local +Y.
    pub t: Vec3<R>,
    /// Normal: local +Z.
    pub n: Vec3<R>,
}

impl<R: Real> Frame<R> {
    /// A frame around a unit normal.
    ///
    /// # References
    /// [Duff et al. 2017] "Building an Orthonormal Basis, Revisited", JCGT 6(1).
    #[inline(always)]
    pub fn from_normal(n: Vec3<R>) -> Self {
        let sign = R::one().copysign(n.z);
        let a = -R::one() / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(R::one() + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// World to local.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<R>) -> Vec3<R> {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local to world.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<R>) -> Vec3<R> {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

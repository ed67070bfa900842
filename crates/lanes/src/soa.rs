//! Structures of arrays: many values kept as columns, read and written a group of lanes at a time.
//!
//! ```
//! use aureole_lanes::soa::{F, U, V3};
//! use aureole_lanes::{Vec3, Word1, soa};
//!
//! soa! {
//!     /// A path between two bounces.
//!     pub struct Path in Paths { o: V3, d: V3, pdf: F, slot: U }
//! }
//!
//! let mut paths = Paths::new();
//! let o = Vec3::new(1.0, 2.0, 3.0);
//! for slot in 0..3 {
//!     paths.push::<f32>(slot != 1, Path { o, d: o, pdf: 0.5, slot: Word1(slot) });
//! }
//! assert_eq!(paths.len(), 2);
//! assert_eq!(paths.load::<f32>(1).slot, Word1(2));
//! ```

use std::fmt::Debug;
use std::marker::PhantomData;

use crate::{Lanes, MAX_LANES, Mask, Real, Select, Spectrum4, Vec3};

/// As many values as columns have room for.
pub const CAPACITY: usize = 4096;

/// The length of a column: the last group may reach over, and columns begin an odd number of cache lines from each other, since at a
/// power of two all would collide in the same few places of the cache.
const LENGTH: usize = CAPACITY + MAX_LANES;
const _: () = assert!(LENGTH * 4 / 64 % 2 == 1, "an odd number of cache lines");

/// A column of words, or of the bits of floats.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Column([u32; LENGTH]);

impl Column {
    /// Nothing but zeros.
    pub const ZERO: Self = Self([0; LENGTH]);
}

/// What a field of a structure may be: `F`, `U`, `V3`, `S4`, and the columns of another structure.
pub trait Kind {
    /// The field over lanes.
    type Of<R: Real>: Copy + Debug + Select<R::Mask>;
    /// How many columns it takes.
    const COLUMNS: usize;

    /// The group of lanes from place `at` on.
    fn load<R: Real>(columns: &[Column], at: usize) -> Self::Of<R>;
    /// Writes a group of lanes at place `at`.
    fn store<R: Real>(value: Self::Of<R>, columns: &mut [Column], at: usize);
    /// Writes the lanes of `mask` side by side from place `at` on; what follows is overwritten.
    fn compress<R: Real>(value: Self::Of<R>, mask: R::Mask, columns: &mut [Column], at: usize);
}

/// A word.
#[derive(Debug)]
pub struct U;
/// A float.
#[derive(Debug)]
pub struct F;
/// A [`Vec3`].
#[derive(Debug)]
pub struct V3;
/// A [`Spectrum4`].
#[derive(Debug)]
pub struct S4;

impl Kind for U {
    type Of<R: Real> = R::Word;
    const COLUMNS: usize = 1;

    #[inline(always)]
    fn load<R: Real>(columns: &[Column], at: usize) -> R::Word {
        R::Word::load(&columns[0].0[at..])
    }

    #[inline(always)]
    fn store<R: Real>(value: R::Word, columns: &mut [Column], at: usize) {
        value.store(&mut columns[0].0[at..]);
    }

    #[inline(always)]
    fn compress<R: Real>(value: R::Word, mask: R::Mask, columns: &mut [Column], at: usize) {
        value.compress(mask, &mut columns[0].0[at..]);
    }
}

/// A kind by its parts, each of another kind.
macro_rules! kind {
    ($name:ty => $of:ty, $columns:literal: $($part:ident $index:literal),*; |$value:ident| [$($take:expr),*] => $make:expr) => {
        impl Kind for $name {
            type Of<R: Real> = $of;
            const COLUMNS: usize = $columns;

            #[inline(always)]
            fn load<R: Real>(columns: &[Column], at: usize) -> $of {
                $(let $part = R::from_bits(U::load::<R>(&columns[$index..], at));)*
                $make
            }

            #[inline(always)]
            fn store<R: Real>($value: $of, columns: &mut [Column], at: usize) {
                $(U::store::<R>($take.to_bits(), &mut columns[$index..], at);)*
            }

            #[inline(always)]
            fn compress<R: Real>($value: $of, mask: R::Mask, columns: &mut [Column], at: usize) {
                $(U::compress::<R>($take.to_bits(), mask, &mut columns[$index..], at);)*
            }
        }
    };
}
kind!(F => R, 1: x 0; |value| [value] => x);
kind!(V3 => Vec3<R>, 3: x 0, y 1, z 2; |value| [value.x, value.y, value.z] => Vec3::new(x, y, z));
kind!(S4 => Spectrum4<R>, 4: a 0, b 1, c 2, d 3;
    |value| [value.0[0], value.0[1], value.0[2], value.0[3]] => Spectrum4([a, b, c, d]));

/// The groups of lanes that cover the first `len` places: where each begins, and which of its lanes are there.
#[inline(always)]
pub fn groups<R: Real>(len: usize) -> Groups<R> {
    Groups { at: 0, len, lanes: PhantomData }
}

/// What [`groups`] gives.
#[derive(Clone, Debug)]
pub struct Groups<R> {
    at: usize,
    len: usize,
    lanes: PhantomData<R>,
}

impl<R: Real> Iterator for Groups<R> {
    type Item = (usize, R::Mask);

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        let at = self.at;
        if at >= self.len {
            return None;
        }
        self.at += R::N;
        Some((at, R::Mask::first(self.len - at)))
    }
}

/// Values of one kind, as columns. There is room for [`CAPACITY`].
#[derive(Clone)]
pub struct Columns<K> {
    columns: Box<[Column]>,
    len: usize,
    kind: PhantomData<K>,
}

impl<K: Kind> Columns<K> {
    /// Without values.
    pub fn new() -> Self {
        Self { columns: vec![Column::ZERO; K::COLUMNS].into(), len: 0, kind: PhantomData }
    }

    /// How many values there are.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Is there none?
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Forgets all values.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Says how many values there are: those that were stored, or anything.
    ///
    /// # Panics
    /// If there is no room for so many.
    #[inline(always)]
    pub fn set_len(&mut self, len: usize) {
        assert!(len <= CAPACITY);
        self.len = len;
    }

    /// The groups of lanes that cover all values: where each begins, and which of its lanes are there.
    #[inline(always)]
    pub fn groups<R: Real>(&self) -> Groups<R> {
        groups(self.len)
    }

    /// The group of lanes from place `at` on. Lanes past the last value hold anything.
    ///
    /// # Panics
    /// If there is no such place.
    #[inline(always)]
    pub fn load<R: Real>(&self, at: usize) -> K::Of<R> {
        assert!(at <= CAPACITY);
        K::load::<R>(&self.columns[..K::COLUMNS], at)
    }

    /// Writes a group of lanes at place `at`, whether there are values yet or not; their number stays.
    ///
    /// # Panics
    /// If there is no such place.
    #[inline(always)]
    pub fn store<R: Real>(&mut self, at: usize, value: K::Of<R>) {
        assert!(at <= CAPACITY);
        K::store::<R>(value, &mut self.columns[..K::COLUMNS], at);
    }

    /// Appends the lanes of `mask`, in order.
    ///
    /// # Panics
    /// If there is no room for them.
    #[inline(always)]
    pub fn push<R: Real>(&mut self, mask: R::Mask, value: K::Of<R>) {
        let (at, count) = (self.len, mask.count());
        assert!(at <= CAPACITY - count);
        K::compress::<R>(value, mask, &mut self.columns[..K::COLUMNS], at);
        self.len = at + count;
    }
}

impl<K: Kind> Default for Columns<K> {
    fn default() -> Self {
        Self::new()
    }
}

/// Columns as a field of others.
impl<K: Kind> Kind for Columns<K> {
    type Of<R: Real> = K::Of<R>;
    const COLUMNS: usize = K::COLUMNS;

    #[inline(always)]
    fn load<R: Real>(columns: &[Column], at: usize) -> K::Of<R> {
        K::load::<R>(columns, at)
    }

    #[inline(always)]
    fn store<R: Real>(value: K::Of<R>, columns: &mut [Column], at: usize) {
        K::store::<R>(value, columns, at);
    }

    #[inline(always)]
    fn compress<R: Real>(value: K::Of<R>, mask: R::Mask, columns: &mut [Column], at: usize) {
        K::compress::<R>(value, mask, columns, at);
    }
}

/// Declares a structure over lanes, and its columns: `soa! { pub struct Path in Paths { o: V3, pdf: F, slot: U } }`. The kinds of
/// fields are types that implement [`Kind`](crate::soa::Kind). See [the module](mod@crate::soa).
#[macro_export]
macro_rules! soa {
    ($(#[$doc:meta])* $visible:vis struct $one:ident in $many:ident {
        $($(#[$field_doc:meta])* $field:ident: $kind:ty),* $(,)?
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        $visible struct $one<R: $crate::Real> {
            $($(#[$field_doc])* $visible $field: <$kind as $crate::soa::Kind>::Of<R>),*
        }

        #[doc = concat!("Columns of [`", stringify!($one), "`].")]
        $visible type $many = $crate::soa::Columns<$one<f32>>;

        impl<R: $crate::Real> $crate::Select<R::Mask> for $one<R> {
            #[inline(always)]
            fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
                Self { $($field: $crate::Mask::select(mask, yes.$field, no.$field)),* }
            }
        }

        impl $crate::soa::Kind for $one<f32> {
            type Of<R: $crate::Real> = $one<R>;
            const COLUMNS: usize = 0 $(+ <$kind as $crate::soa::Kind>::COLUMNS)*;

            #[inline(always)]
            fn load<R: $crate::Real>(columns: &[$crate::soa::Column], at: usize) -> $one<R> {
                let rest = columns;
                $(
                    let (own, rest) = rest.split_at(<$kind as $crate::soa::Kind>::COLUMNS);
                    let $field = <$kind as $crate::soa::Kind>::load::<R>(own, at);
                )*
                let _ = rest;
                $one { $($field),* }
            }

            #[inline(always)]
            fn store<R: $crate::Real>(value: $one<R>, columns: &mut [$crate::soa::Column], at: usize) {
                let rest = columns;
                $(
                    let (own, rest) = rest.split_at_mut(<$kind as $crate::soa::Kind>::COLUMNS);
                    <$kind as $crate::soa::Kind>::store::<R>(value.$field, own, at);
                )*
                let _ = rest;
            }

            #[inline(always)]
            fn compress<R: $crate::Real>(
                value: $one<R>,
                mask: R::Mask,
                columns: &mut [$crate::soa::Column],
                at: usize,
            ) {
                let rest = columns;
                $(
                    let (own, rest) = rest.split_at_mut(<$kind as $crate::soa::Kind>::COLUMNS);
                    <$kind as $crate::soa::Kind>::compress::<R>(value.$field, mask, own, at);
                )*
                let _ = rest;
            }
        }
    };
}

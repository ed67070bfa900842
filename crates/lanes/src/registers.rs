//! What the files of all instruction sets repeat.
//!
//! **Why this is sound.** A register type is private to its file. Code of other files meets it only as the type parameter of
//! [`Kernel::run`](crate::Kernel::run), and that instance is named in one place, `run` of the file, which looks first whether the
//! processor has the instructions. So wherever a register type can be named, by a value or without one, its instructions exist.

/// Calls an intrinsic that works on registers alone.
macro_rules! simd {
    ($call:expr) => {
        // SAFETY: the processor has the instruction, see `registers`; memory is not touched.
        unsafe { $call }
    };
}

/// Operators between two registers, and between a register and one number for all lanes.
macro_rules! operators {
    ($type:ident, $item:ty: $($trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(simd!($intrinsic(self.0, other.0)))
            }
        }
        impl $trait<$item> for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: $item) -> Self {
                self.$method(Self::splat(other))
            }
        }
    )*};
}

/// Comparisons and other methods of two registers.
macro_rules! methods {
    ($($method:ident -> $result:ident |$a:ident $(, $b:ident)?| $call:expr;)*) => {$(
        #[inline(always)]
        fn $method(self $(, $b: Self)?) -> $result {
            let $a = self.0;
            $(let $b = $b.0;)?
            $result(simd!($call))
        }
    )*};
}

/// Selection, memory and tables. `$pack` moves the lanes of a mask to the front, `$gather` reads a table.
macro_rules! lanes {
    ($type:ident of $n:literal $item:ident, $mask:ident, $word:ident: $select:ident $splat:ident $load:ident $store:ident $pack:ident $gather:ident) => {
        impl Select<$mask> for $type {
            #[inline(always)]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                Self($select(mask.0, yes.0, no.0))
            }
        }

        impl Lanes for $type {
            const N: usize = $n;
            type Item = $item;
            type Mask = $mask;
            type Word = $word;

            #[inline(always)]
            fn splat(x: $item) -> Self {
                Self(simd!($splat(x as _)))
            }

            #[inline(always)]
            fn load(from: &[$item]) -> Self {
                let from = &from[..$n];
                // SAFETY: as many numbers are read as the slice has, and no alignment is asked for.
                Self(unsafe { $load(from.as_ptr().cast()) })
            }

            #[inline(always)]
            fn store(self, to: &mut [$item]) {
                let to = &mut to[..$n];
                // SAFETY: as many numbers are written as the slice has, and no alignment is asked for.
                unsafe { $store(to.as_mut_ptr().cast(), self.0) }
            }

            #[inline(always)]
            fn compress(self, mask: $mask, to: &mut [$item]) -> usize {
                Self($pack(self.0, mask)).store(to);
                mask.count()
            }

            #[inline(always)]
            fn gather(table: &[$item], at: $word) -> Self {
                assert!(!table.is_empty() && table.len() <= 1 << 31);
                let at = at.min($word::splat((table.len() - 1) as u32));
                // SAFETY: the indices are within the table.
                Self(unsafe { $gather(table.as_ptr(), at) })
            }
        }
    };
}

/// A look at a table by rows, whose indices `$rows` expects within it and in units of eight bytes.
macro_rules! rows {
    ($word:ident, $rows:ident) => {
        #[inline(always)]
        fn rows<const K: usize>(table: &[[f32; K]], at: $word) -> [Self; K] {
            const { assert!(K.is_multiple_of(4)) }
            assert!(!table.is_empty() && size_of_val(table) <= 1 << 35);
            let at = at.min($word::splat((table.len() - 1) as u32));
            // SAFETY: the indices are within the table, and so are `K` numbers from there.
            unsafe { $rows(table.as_ptr().cast(), at * (K / 2) as u32) }
        }
    };
}

pub(crate) use {lanes, methods, operators, rows, simd};

//! Large arrays in large pages.

use std::ops::{Deref, DerefMut};

use bytemuck::Pod;
use memmap2::MmapMut;

/// An array of fixed length. A large one lies in memory that the system is asked to map by pages of megabytes: a walk through
/// a large hierarchy would otherwise wait for page tables as often as for data.
#[derive(Debug)]
pub(crate) enum Big<T> {
    Heap(Vec<T>),
    Mapped(MmapMut),
}

/// Bytes from which large pages are asked for.
const LARGE: usize = 1 << 22;

impl<T: Pod> Big<T> {
    pub(crate) fn zeroed(len: usize) -> Self {
        if len.saturating_mul(size_of::<T>()) >= LARGE
            && let Ok(map) = MmapMut::map_anon(len * size_of::<T>())
        {
            // Without large pages it is merely slower.
            #[cfg(target_os = "linux")]
            let _ = map.advise(memmap2::Advice::HugePage);
            return Self::Mapped(map);
        }
        Self::Heap(vec![T::zeroed(); len])
    }
}

impl<T> Default for Big<T> {
    fn default() -> Self {
        Self::Heap(Vec::new())
    }
}

impl<T: Pod> Deref for Big<T> {
    type Target = [T];
    #[inline]
    fn deref(&self) -> &[T] {
        match self {
            Self::Heap(vec) => vec,
            Self::Mapped(map) => bytemuck::cast_slice(map),
        }
    }
}

impl<T: Pod> DerefMut for Big<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        match self {
            Self::Heap(vec) => vec,
            Self::Mapped(map) => bytemuck::cast_slice_mut(map),
        }
    }
}

impl<T: Pod> Clone for Big<T> {
    fn clone(&self) -> Self {
        let mut copy = Self::zeroed(self.len());
        copy.copy_from_slice(self);
        copy
    }
}

impl<T: Pod> From<Vec<T>> for Big<T> {
    fn from(vec: Vec<T>) -> Self {
        if size_of_val(&vec[..]) < LARGE {
            return Self::Heap(vec);
        }
        let mut copy = Self::zeroed(vec.len());
        copy.copy_from_slice(&vec);
        copy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_hold_what_was_put_in() {
        for len in [0, 1, 1000, 3 << 20] {
            let numbers: Vec<u32> = (0..len).collect();
            let big = Big::from(numbers.clone());
            assert_eq!(matches!(big, Big::Mapped(_)), len > 1000);
            assert_eq!(big.clone()[..], numbers[..]);
            assert!(Big::<u32>::zeroed(len as usize).iter().all(|&x| x == 0));
        }
    }
}

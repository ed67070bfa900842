//! The same code, compiled for several instruction sets; the best one that the machine has is chosen at run time.
//!
//! No operation is fused or reordered, so all of them give the same bits.
#![expect(unsafe_code, reason = "calling code that was compiled for more than the baseline, and intrinsics")]

/// Work on many rays. Its `run` and all that it calls should insist on being inlined.
pub(crate) trait Kernel {
    /// Does the work.
    fn run(self);
}

/// Runs a kernel with the widest instructions that this machine has.
#[inline]
pub(crate) fn run<K: Kernel>(kernel: K) {
    #[cfg(target_arch = "x86_64")]
    if has_avx2() {
        // SAFETY: `has_avx2` says that the processor has what `run_avx2` was compiled for.
        return unsafe { run_avx2(kernel) };
    }
    kernel.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn run_avx2<K: Kernel>(kernel: K) {
    kernel.run();
}

/// The slab tests of eight boxes: where the ray enters each, and a bit for each that it meets.
///
/// `near` and `far` are the planes of each axis that the ray meets first and last; `o` and `inv` its origin and the
/// reciprocals of its direction. What comes out is the same with and without AVX2.
#[derive(Clone, Copy)]
pub(crate) struct Slabs<'a> {
    pub near: [&'a [f32; 8]; 3],
    pub far: [&'a [f32; 8]; 3],
    pub o: [f32; 3],
    pub inv: [f32; 3],
    pub far_scale: f32,
    pub t_min: f32,
    pub t_max: f32,
}

/// Proof that this machine has AVX2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// The proof, if it can be given.
    #[inline]
    pub(crate) fn detect() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            return Some(Self(()));
        }
        None
    }
}

impl Slabs<'_> {
    #[inline(always)]
    pub(crate) fn test(&self, avx2: Option<Avx2>) -> ([f32; 8], u32) {
        #[cfg(target_arch = "x86_64")]
        if avx2.is_some() {
            // SAFETY: an `Avx2` exists only where the processor has AVX2.
            return unsafe { self.test_avx2() };
        }
        let _ = avx2;
        self.test_portable()
    }

    #[inline(always)]
    fn test_portable(&self) -> ([f32; 8], u32) {
        let (mut enter, mut leave) = ([self.t_min; 8], [self.t_max; 8]);
        for axis in 0..3 {
            for i in 0..8 {
                let a = (self.near[axis][i] - self.o[axis]) * self.inv[axis];
                let b = (self.far[axis][i] - self.o[axis]) * self.inv[axis] * self.far_scale;
                enter[i] = if a > enter[i] { a } else { enter[i] };
                leave[i] = if b < leave[i] { b } else { leave[i] };
            }
        }
        let mask = (0..8).fold(0, |mask, i| mask | u32::from(enter[i] <= leave[i]) << i);
        (enter, mask)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    #[inline]
    fn test_avx2(&self) -> ([f32; 8], u32) {
        use std::arch::x86_64::{
            _CMP_LE_OQ, _mm256_cmp_ps, _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
            _mm256_mul_ps, _mm256_set1_ps, _mm256_storeu_ps, _mm256_sub_ps,
        };
        let (mut enter, mut leave) = (_mm256_set1_ps(self.t_min), _mm256_set1_ps(self.t_max));
        let far_scale = _mm256_set1_ps(self.far_scale);
        for axis in 0..3 {
            let (o, inv) = (_mm256_set1_ps(self.o[axis]), _mm256_set1_ps(self.inv[axis]));
            // SAFETY: eight floats are read from arrays of eight; no alignment is asked for.
            let (near, far) = unsafe {
                (_mm256_loadu_ps(self.near[axis].as_ptr()), _mm256_loadu_ps(self.far[axis].as_ptr()))
            };
            let a = _mm256_mul_ps(_mm256_sub_ps(near, o), inv);
            let b = _mm256_mul_ps(_mm256_mul_ps(_mm256_sub_ps(far, o), inv), far_scale);
            // Of a NaN and a number these take the second operand, as the comparisons above do.
            enter = _mm256_max_ps(a, enter);
            leave = _mm256_min_ps(b, leave);
        }
        let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave)) as u32;
        let mut out = [0.0; 8];
        // SAFETY: eight floats are written to an array of eight.
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), enter) };
        (out, mask)
    }
}

/// A bit for each of four lanes in which three numbers have one sign, zero counting as either.
#[inline(always)]
pub(crate) fn same_signs(u: &[f32; 4], v: &[f32; 4], w: &[f32; 4]) -> u32 {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{
            _mm_and_ps, _mm_cmpge_ps, _mm_cmple_ps, _mm_loadu_ps, _mm_movemask_ps, _mm_or_ps, _mm_setzero_ps,
        };
        // SAFETY: four floats are read from arrays of four, and SSE2 is part of every x86-64.
        unsafe {
            let zero = _mm_setzero_ps();
            let [u, v, w] = [_mm_loadu_ps(u.as_ptr()), _mm_loadu_ps(v.as_ptr()), _mm_loadu_ps(w.as_ptr())];
            let up =
                _mm_and_ps(_mm_and_ps(_mm_cmpge_ps(u, zero), _mm_cmpge_ps(v, zero)), _mm_cmpge_ps(w, zero));
            let down =
                _mm_and_ps(_mm_and_ps(_mm_cmple_ps(u, zero), _mm_cmple_ps(v, zero)), _mm_cmple_ps(w, zero));
            _mm_movemask_ps(_mm_or_ps(up, down)) as u32
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let all = |i: usize, test: fn(f32) -> bool| test(u[i]) && test(v[i]) && test(w[i]);
        (0..4).fold(0, |mask, i| mask | u32::from(all(i, |x| x >= 0.0) || all(i, |x| x <= 0.0)) << i)
    }
}

/// Whether AVX2 and its companions are available; asked once, then remembered by the standard library.
#[cfg(target_arch = "x86_64")]
#[inline]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("bmi1")
        && std::arch::is_x86_feature_detected!("bmi2")
        && std::arch::is_x86_feature_detected!("lzcnt")
        && std::arch::is_x86_feature_detected!("popcnt")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_and_portable_slabs_agree_bit_by_bit() {
        let mut rng = aureole_math::Pcg32::new(12);
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0];
        for round in 0..20_000 {
            let mut number = || match rng.next_u32() % 20 {
                i if round % 2 == 0 && i < 5 => odd[i as usize],
                _ => rng.next_f32() * 4.0 - 2.0,
            };
            let planes: [[f32; 8]; 6] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
            let slabs = Slabs {
                near: [&planes[0], &planes[1], &planes[2]],
                far: [&planes[3], &planes[4], &planes[5]],
                o: [number(), number(), number()],
                inv: [number(), number(), number()],
                far_scale: 1.000_001,
                t_min: 0.0,
                t_max: 3.0,
            };
            let (a, b) = (slabs.test_portable(), slabs.test(Avx2::detect()));
            assert_eq!((a.0.map(f32::to_bits), a.1), (b.0.map(f32::to_bits), b.1));
        }
    }
}

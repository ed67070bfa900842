//! Every instruction set gives the bits of the portable code.

use aureole_math::Pcg32;

use super::{Floats, Kernel, Mask, Portable, Simd, run};

/// All operations on all widths; the bits of what comes out.
struct Everything([[f32; 16]; 2]);

fn operations<const N: usize, F: Floats<N>>(a: [f32; N], b: [f32; N], out: &mut Vec<u32>) {
    let (x, y) = (F::load(&a), F::load(&b));
    for result in [x + y, x - y, x * y, x / y, x.min(y), x.max(y), x.abs(), F::splat(a[0])] {
        // Which NaN comes out is not promised.
        out.extend(result.to_array().map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() }));
    }
    out.extend([x.less(y).bits(), x.less_or_equal(y).bits(), (x.less(y) & y.less_or_equal(x)).bits()]);
}

fn first<const N: usize>(from: &[f32; 16]) -> [f32; N] {
    std::array::from_fn(|i| from[i])
}

impl Kernel for &Everything {
    type Output = Vec<u32>;
    #[inline(always)]
    fn run<S: Simd>(self) -> Vec<u32> {
        let [a, b] = &self.0;
        let mut out = Vec::new();
        operations::<4, S::F4>(first(a), first(b), &mut out);
        operations::<8, S::F8>(first(a), first(b), &mut out);
        operations::<16, S::F16>(*a, *b, &mut out);
        let (x, y) = (S::F16::load(a), S::F16::load(b));
        let quads = S::quads(x);
        let shuffled = [S::join([quads[2], quads[0], quads[3], quads[1]]), S::select(0xb2c5, x, y)];
        for row in S::transpose([x, y, y, x]).into_iter().chain(shuffled) {
            out.extend(row.to_array().map(f32::to_bits));
        }
        let bytes = a.map(|x| x.to_bits() as u8);
        out.extend(S::numbers(&std::array::from_fn(|i| bytes[i])).to_array().map(f32::to_bits));
        out
    }
}

#[test]
fn wide_and_portable_agree_bit_by_bit() {
    let mut rng = Pcg32::new(12);
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, -0.0, f32::MIN_POSITIVE / 8.0];
    let rounds = if cfg!(miri) { 20 } else { 5000 };
    for _ in 0..rounds {
        let mut number = || match rng.next_u32() % 12 {
            i if i < 6 => odd[i as usize],
            _ => rng.next_f32() * 4.0 - 2.0,
        };
        let work = Everything([(); 2].map(|()| std::array::from_fn(|_| number())));
        let expected = (&work).run::<Portable>();
        assert_eq!(run(&work), expected);
        #[cfg(target_arch = "x86_64")]
        if super::x86::Level::get() >= super::x86::Level::Avx2 {
            assert_eq!(super::x86::avx2(&work), expected);
        }
    }
}

#[test]
fn lanes_are_the_set_bits() {
    assert_eq!(super::lanes(0b1011).collect::<Vec<_>>(), [0, 1, 3]);
    assert_eq!(super::lanes(0).count(), 0);
}

#[test]
fn quads_are_transposed() {
    let row = |j: usize| std::array::from_fn(|i| (16 * j + i) as f32);
    let rows: [[f32; 16]; 4] = std::array::from_fn(row);
    let out = Portable::transpose(rows.map(|row| Floats::load(&row)));
    for (i, row) in out.into_iter().enumerate() {
        for (j, x) in row.to_array().into_iter().enumerate() {
            assert_eq!(x, rows[j % 4][j / 4 * 4 + i]);
        }
    }
}

//! What elementary functions and tables cost, a lane, for each instruction set of this machine.

use std::hint::black_box;

use aureole_lanes::{Kernel, Level, Real, Word, math, run};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const COUNT: usize = 1024;

/// Applies a function to many numbers.
macro_rules! kernel {
    ($name:ident, |$x:ident| $value:expr) => {
        struct $name<'a>(&'a [f32], &'a mut [f32]);
        impl Kernel for $name<'_> {
            type Output = ();
            #[inline(always)]
            fn run<R: Real>(self) {
                for (from, to) in self.0.chunks_exact(R::N).zip(self.1.chunks_exact_mut(R::N)) {
                    let $x = R::load(from);
                    $value.store(to);
                }
            }
        }
    };
}
kernel!(SinCos, |x| {
    let (sin, cos) = math::sin_cos_turns(x);
    sin + cos
});
kernel!(Exp, |x| math::exp(x));
kernel!(Ln, |x| math::ln(x));
kernel!(Pow, |x| math::pow(x, x));
kernel!(Atan2, |x| math::atan2(x, R::one()));
kernel!(Acos, |x| math::acos(x));
kernel!(ErfInv, |x| math::erf_inv(x));

/// Reads rows all over a table.
struct Rows<'a, const K: usize>(&'a [[f32; K]], &'a mut [f32]);
impl<const K: usize> Kernel for Rows<'_, K> {
    type Output = ();
    #[inline(always)]
    fn run<R: Real>(self) {
        for (i, to) in self.1.chunks_exact_mut(R::N).enumerate() {
            let at = ((R::Word::iota() + (i * R::N) as u32) * 0x9e37_79b9) >> 22;
            let mut sum = R::zero();
            for column in R::rows(self.0, at) {
                sum = sum + column;
            }
            sum.store(to);
        }
    }
}

fn lanes(criterion: &mut Criterion) {
    let x: Vec<f32> = (0..COUNT).map(|i| i as f32 / COUNT as f32).collect();
    let mut y = vec![0.0; COUNT];
    let narrow = vec![[1.0; 4]; COUNT];
    let wide = vec![[1.0; 16]; COUNT];
    for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
        let mut group = criterion.benchmark_group(format!("{level:?}"));
        group.throughput(Throughput::Elements(COUNT as u64)).sample_size(20);
        group.measurement_time(std::time::Duration::from_millis(500));
        group.warm_up_time(std::time::Duration::from_millis(100));
        macro_rules! bench {
            ($($name:literal $kernel:expr;)*) => {
                $(group.bench_function($name, |b| b.iter(|| run(level, black_box($kernel))));)*
            };
        }
        bench! {
            "sin_cos_turns" SinCos(&x, &mut y);
            "exp" Exp(&x, &mut y);
            "ln" Ln(&x, &mut y);
            "pow" Pow(&x, &mut y);
            "atan2" Atan2(&x, &mut y);
            "acos" Acos(&x, &mut y);
            "erf_inv" ErfInv(&x, &mut y);
            "rows of 4" Rows(&narrow, &mut y);
            "rows of 16" Rows(&wide, &mut y);
        }
    }
}

criterion_group!(benches, lanes);
criterion_main!(benches);

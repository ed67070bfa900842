//! Every operation gives the same bits on any number of lanes.

mod common;

use aureole_lanes::{Kernel, Lanes, Level, Mask, Real, Word, math, run};
use common::{Random, floats, special, wide_levels};

/// Which NaN comes out is not promised.
fn canonical(bits: u32) -> u32 {
    if f32::from_bits(bits).is_nan() { 0x7fc0_0000 } else { bits }
}

fn bit<R: Real>(mask: R::Mask) -> R {
    R::from_bits(mask.select(R::Word::splat(1), R::Word::splat(0)))
}

macro_rules! named {
    ($($name:literal: $value:expr;)*) => {
        (&[$($name),*], vec![$($value),*])
    };
}

/// The results, by name, of operations on two floats.
#[inline(always)]
fn on_floats<R: Real>(x: R, y: R) -> (&'static [&'static str], Vec<R>) {
    named! {
        "add": x + y; "sub": x - y; "mul": x * y; "div": x / y; "neg": -x;
        "add number": x + 3.0; "div number": x / 3.0; "sqrt": x.sqrt(); "safe_sqrt": x.safe_sqrt();
        "min": x.min(y); "max": x.max(y); "clamp": x.clamp(-1.0, 2.0); "floor": x.floor(); "round": x.round();
        "abs": x.abs(); "sign": x.sign(); "mul_sign": x.mul_sign(y); "copysign": x.copysign(y);
        "lt": bit(x.lt(y)); "le": bit(x.le(y)); "gt": bit(x.gt(y)); "ge": bit(x.ge(y)); "eq": bit(x.eq(y)); "ne": bit(x.ne(y));
        "masks": bit((x.lt(y) | x.is_nan()) ^ (!x.is_finite() & y.gt(x))); "only": x.only(x.lt(y));
        "select of masks": bit(x.lt(y).select(x.lt(R::one()), y.is_nan()));
        "to_word": R::from_bits(x.to_word()); "from_word": R::from_word(x.to_bits());
        "sin": math::sin(x); "cos": math::cos(x); "tan": math::tan(x);
        "sin of turns": math::sin_cos_turns(x).0; "cos of turns": math::sin_cos_turns(x).1;
        "exp": math::exp(x); "exp2": math::exp2(x); "ln": math::ln(x); "log2": math::log2(x);
        "pow": math::pow(x, y); "pow of size": math::pow(x.abs(), y); "atan2": math::atan2(x, y); "atan": math::atan(x);
        "asin": math::asin(x); "acos": math::acos(x); "erf": math::erf(x); "erf_inv": math::erf_inv(x);
    }
}

/// The results, by name, of operations on two words.
#[inline(always)]
fn on_words<R: Real>(x: R::Word, y: R::Word) -> (&'static [&'static str], Vec<R::Word>) {
    let bit = |mask: R::Mask| mask.select(R::Word::splat(1), R::Word::splat(0));
    named! {
        "add": x + y; "sub": x - y; "mul": x * y; "and": x & y; "or": x | y; "xor": x ^ y; "not": !x;
        "add number": x + 77; "mul number": x * 0x9e37_79b9; "shift by number": (x << 7) ^ (x >> 13) ^ (x >> 32);
        "shl": x << (y & 63); "shr": x >> (y & 63); "shl by much": x << y;
        "min": x.min(y); "max": x.max(y); "eq": bit(x.eq(y)); "eq itself": bit(x.eq(x)); "ne": bit(x.ne(y)); "lt": bit(x.lt(y));
        "reverse_bits": x.reverse_bits(); "leading_zeros": x.leading_zeros(); "trailing_zeros": x.trailing_zeros();
        "leading_zeros of few": (x >> (y & 31)).leading_zeros(); "trailing_zeros of few": (x << (y & 63)).trailing_zeros();
    }
}

/// All results for all pairs of numbers: one list an operation.
struct All<'a>(&'a [f32], &'a [f32]);

impl Kernel for All<'_> {
    type Output = Vec<(&'static str, Vec<u32>)>;
    #[inline(always)]
    fn run<R: Real>(self) -> Self::Output {
        let mut all = Vec::new();
        for (x, y) in self.0.chunks(R::N).zip(self.1.chunks(R::N)) {
            let count = x.len();
            let (x, y) = (R::load_part(x), R::load_part(y));
            let (float_names, floats) = on_floats(x, y);
            let (word_names, words) = on_words::<R>(x.to_bits(), y.to_bits());
            let floats = floats.into_iter().map(|x| x.to_bits().to_array().map(canonical));
            let results = floats.chain(words.into_iter().map(|x| x.to_array()));
            all.resize(float_names.len() + word_names.len(), ("", Vec::new()));
            let names = float_names.iter().chain(word_names);
            for ((list, &name), result) in all.iter_mut().zip(names).zip(results) {
                list.0 = name;
                list.1.extend(&result[..count]);
            }
        }
        all
    }
}

#[test]
fn operations_give_the_same_bits_on_all_lanes() {
    let special = special();
    let (mut x, mut y) = (floats(30_000, 1), floats(30_000, 2));
    y[special.len()..].rotate_left(1);
    // All pairs of special numbers, too.
    x.extend(special.iter().flat_map(|&x| vec![x; special.len()]));
    y.extend(special.iter().flat_map(|_| special.clone()));
    let expected = run(Level::One, All(&x, &y));
    for level in wide_levels() {
        for ((name, expected), (_, found)) in expected.iter().zip(run(level, All(&x, &y))) {
            for (i, (&expected, &found)) in expected.iter().zip(&found).enumerate() {
                assert_eq!(
                    found,
                    expected,
                    "{level:?}: {name} of {:?} and {:?} is {:?}, not {:?}",
                    x[i],
                    y[i],
                    f32::from_bits(found),
                    f32::from_bits(expected)
                );
            }
        }
    }
}

/// What the lanes of masks, memory and tables must be, found lane by lane.
struct Moves;

impl Kernel for Moves {
    type Output = ();
    #[inline(always)]
    fn run<R: Real>(self) {
        let mut random = Random(3);
        let floats: Vec<f32> = (0..R::N).map(|_| random.between(-9.0, 9.0)).collect();
        let words: Vec<u32> = floats.iter().map(|x| x.to_bits()).collect();
        let (x, w) = (R::load(&floats), R::Word::load(&words));
        assert_eq!(x.to_bits().to_array(), w.to_array());
        assert_eq!(
            R::Word::iota().to_array()[..R::N],
            std::array::from_fn::<u32, 16, _>(|i| i as u32)[..R::N]
        );
        for bits in 0..1_u32 << R::N {
            let mask = R::Mask::from_bits(bits | 1 << 31 >> (31 - R::N));
            assert_eq!(mask.bits(), bits);
            assert_eq!((mask.any(), mask.none()), (bits != 0, bits == 0));
            assert_eq!((mask.all(), mask.count()), (bits + 1 == 1 << R::N, bits.count_ones() as usize));
            let set: Vec<usize> = (0..R::N).filter(|i| bits >> i & 1 == 1).collect();
            assert_eq!(mask.lanes().collect::<Vec<_>>(), set);
            let (mut packed, mut packed_words) = (vec![0.0; R::N], vec![0; R::N]);
            assert_eq!(
                (x.compress(mask, &mut packed), w.compress(mask, &mut packed_words)),
                (set.len(), set.len())
            );
            assert_eq!(packed[..set.len()], set.iter().map(|&i| floats[i]).collect::<Vec<_>>());
            assert_eq!(packed_words[..set.len()], set.iter().map(|&i| words[i]).collect::<Vec<_>>());
            assert_eq!(x.least(mask), set.iter().map(|&i| floats[i]).fold(f32::INFINITY, f32::min));
        }
        for count in 0..20 {
            assert_eq!(R::Mask::first(count).count(), count.min(R::N));
            let mut part = vec![7.0; count];
            x.store_part(&mut part);
            let expected = floats.iter().copied().chain([7.0; 20]);
            assert_eq!(part, expected.take(count).collect::<Vec<_>>());
            assert_eq!(R::load_part(&part).to_array()[..R::N.min(count)], part[..R::N.min(count)]);
        }
        let changed = x.with_lane(R::N - 1, 5.0);
        assert_eq!((changed.lane(R::N - 1), changed.lane(0) == 5.0), (5.0, R::N == 1));
    }
}

/// Tables of rows of `K`, and columns of them.
struct Tables<const K: usize>;

impl<const K: usize> Kernel for Tables<K> {
    type Output = ();
    #[inline(always)]
    fn run<R: Real>(self) {
        let mut random = Random(K as u64);
        for len in [1, 2, 100] {
            let table: Vec<[f32; K]> =
                (0..len).map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect();
            let words: Vec<u32> = table.as_flattened().iter().map(|x| x.to_bits()).collect();
            for limit in [len as u32, u32::MAX] {
                let at: Vec<u32> = (0..R::N).map(|_| random.word() % limit).collect();
                let row = |lane: usize| (at[lane] as usize).min(len - 1);
                let rows = R::rows(&table, R::Word::load(&at));
                for (k, column) in rows.into_iter().enumerate() {
                    for lane in 0..R::N {
                        assert_eq!(column.lane(lane), table[row(lane)][k]);
                    }
                }
                let at = R::Word::load(&at);
                let (floats, words) = (R::gather(table.as_flattened(), at), R::Word::gather(&words, at));
                for lane in 0..R::N {
                    let at = (at.lane(lane) as usize).min(len * K - 1);
                    assert_eq!(floats.lane(lane), table.as_flattened()[at]);
                    assert_eq!(words.lane(lane), table.as_flattened()[at].to_bits());
                }
            }
        }
    }
}

#[test]
fn lanes_move_as_one_by_one() {
    for level in wide_levels().chain([Level::One]) {
        run(level, Moves);
        run(level, Tables::<4>);
        run(level, Tables::<8>);
        run(level, Tables::<12>);
        run(level, Tables::<16>);
    }
}

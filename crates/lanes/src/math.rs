//! Elementary functions, written once for any number of lanes: the same bits everywhere.
//!
//! Polynomials without table or branch; `fit.py` beside the sources finds their coefficients, and `tests/accuracy.rs` holds the errors
//! that are stated here against double precision: below 2 ulp, and below 3 for `tan`, `asin`, `erf` and `erf_inv`. An ulp is the distance between neighbouring numbers at the result. NaN gives NaN.

use std::f32::consts::{FRAC_2_PI, FRAC_2_SQRT_PI, FRAC_PI_2, FRAC_PI_4, LN_2, LOG2_E, PI};

use crate::{Lanes, Mask, Real, Word};

/// A polynomial by Horner's rule, from its highest coefficient down.
#[inline(always)]
fn polynomial<R: Real, const K: usize>(z: R, coefficients: [f32; K]) -> R {
    let mut sum = R::splat(coefficients[0]);
    for &coefficient in &coefficients[1..] {
        sum = sum * z + coefficient;
    }
    sum
}

/// The nearest whole number, as number and as word with sign; below 2²² in size.
#[inline(always)]
fn nearest<R: Real>(x: R) -> (R, R::Word) {
    // Added to this, a number has no digits left behind the point, and its whole part stands in the lowest bits.
    const SHIFT: f32 = (3 << 22) as f32;
    let shifted = x + SHIFT;
    (shifted - SHIFT, shifted.to_bits() - SHIFT.to_bits())
}

/// Sine and cosine of `a` plus `quarters` quarter turns, with `a` at most an eighth of a turn.
#[inline(always)]
fn sin_cos_reduced<R: Real>(a: R, quarters: R::Word) -> (R, R) {
    let z = a * a;
    let sin = a + a * z * polynomial(z, [-0.00019517296, 0.008332178, -0.16666655]);
    let cos = (z * z) * polynomial(z, [2.443845e-5, -0.0013887368, 0.041666646]) - z * 0.5 + 1.0;
    let swapped = (quarters & 1).eq(R::Word::splat(1));
    let sign = |quarters: R::Word| R::from_bits(quarters << 30);
    let (s, c) = (swapped.select(cos, sin), swapped.select(sin, cos));
    (s.mul_sign(sign(quarters)), c.mul_sign(sign(quarters + 1)))
}

/// Sine and cosine of an angle in radians, within 1e-7 for angles up to 10,000 in size. Far beyond, they are of no use.
#[inline(always)]
pub fn sin_cos<R: Real>(x: R) -> (R, R) {
    // π/2 in three parts, of which the first two have so few digits that their multiples are exact [Cody and Waite 1980].
    const PARTS: [f32; 3] = [1.5703125, 0.000_483_751_3, 7.54979e-8];
    let (n, quarters) = nearest(x * FRAC_2_PI);
    let a = x - n * PARTS[0] - n * PARTS[1] - n * PARTS[2];
    sin_cos_reduced(a, quarters)
}

/// The sine of an angle in radians; see [`sin_cos`].
#[inline(always)]
pub fn sin<R: Real>(x: R) -> R {
    sin_cos(x).0
}

/// The cosine of an angle in radians; see [`sin_cos`].
#[inline(always)]
pub fn cos<R: Real>(x: R) -> R {
    sin_cos(x).1
}

/// The tangent of an angle in radians; see [`sin_cos`].
#[inline(always)]
pub fn tan<R: Real>(x: R) -> R {
    let (sin, cos) = sin_cos(x);
    sin / cos
}

/// Sine and cosine of an angle in turns (2π), within 1e-7.
#[inline(always)]
pub fn sin_cos_turns<R: Real>(x: R) -> (R, R) {
    let turn = (x - x.round()) * 4.0;
    let (n, quarters) = nearest(turn);
    sin_cos_reduced((turn - n) * FRAC_PI_2, quarters)
}

/// e to the power of `r`, at most half of ln 2 in size.
#[inline(always)]
fn exp_reduced<R: Real>(r: R) -> R {
    r * r * polynomial(r, [0.0013950489, 0.008368888, 0.041666206, 0.16666518, 0.5]) + r + 1.0
}

/// `x` times 2 to the power of `n` with sign, between -256 and 256. Rounded once, if at all.
#[inline(always)]
fn scale<R: Real>(x: R, n: R::Word) -> R {
    // In two steps, because neither the smallest nor the largest result has a scale that is a number.
    let power = n + 256;
    let half = power >> 1;
    x * R::from_bits((half - 1) << 23) * R::from_bits((power - half - 1) << 23)
}

/// Brought between two limits; NaN stays.
#[inline(always)]
fn limited<R: Real>(x: R, low: f32, high: f32) -> R {
    R::splat(low).max(R::splat(high).min(x))
}

/// e to the power of `x`.
#[inline(always)]
pub fn exp<R: Real>(x: R) -> R {
    // ln 2 in two parts, the first with so few digits that its multiples are exact.
    const PARTS: [f32; 2] = [0.693_359_4, -0.000_212_194_44];
    let x = limited(x, -104.0, 89.0);
    let (n, power) = nearest(x * LOG2_E);
    scale(exp_reduced(x - n * PARTS[0] - n * PARTS[1]), power)
}

/// 2 to the power of `x`.
#[inline(always)]
pub fn exp2<R: Real>(x: R) -> R {
    let x = limited(x, -151.0, 129.0);
    let (n, power) = nearest(x);
    scale(exp_reduced((x - n) * LN_2), power)
}

/// A positive, finite number as `m` times 2 to the power of `e`, with m between √½ and √2.
#[inline(always)]
fn split<R: Real>(x: R) -> (R, R) {
    const ROOT: u32 = 0x3f35_04f3; // √½
    let tiny = x.lt(R::splat(f32::MIN_POSITIVE));
    let bits = tiny.select(x * (1 << 25) as f32, x).to_bits() + (1.0_f32.to_bits() - ROOT);
    let exponent = R::from_word((bits >> 23) - 127) - R::splat(25.0).only(tiny);
    (R::from_bits((bits & 0x007f_ffff) + ROOT), exponent)
}

/// ln(1 + t) - t, for 1 + t between √½ and √2.
#[inline(always)]
fn ln_reduced<R: Real>(t: R) -> R {
    let z = t * t;
    let series = polynomial(
        t,
        [
            0.06915439,
            -0.11789859,
            0.11872972,
            -0.123843394,
            0.14218658,
            -0.16669251,
            0.20002227,
            -0.24999987,
            0.3333331,
        ],
    );
    z * t * series - z * 0.5
}

/// What logarithms give that have no number to give: `x` at infinity, minus infinity for zero, NaN below.
#[inline(always)]
fn logarithm<R: Real>(x: R, value: R) -> R {
    let value = x.lt(R::splat(f32::INFINITY)).select(value, x);
    let value = x.eq(R::zero()).select(R::splat(f32::NEG_INFINITY), value);
    x.lt(R::zero()).select(R::splat(f32::NAN), value)
}

/// The natural logarithm.
#[inline(always)]
pub fn ln<R: Real>(x: R) -> R {
    // ln 2 in two parts, the first with so few digits that its multiples are exact.
    const PARTS: [f32; 2] = [0.693_359_4, -0.000_212_194_44];
    let (m, e) = split(x);
    let t = m - 1.0;
    logarithm(x, (ln_reduced(t) + e * PARTS[1]) + t + e * PARTS[0])
}

/// The logarithm to base 2.
#[inline(always)]
pub fn log2<R: Real>(x: R) -> R {
    const EXCESS: f32 = 0.442_695_04; // 1/ln 2 - 1
    let (m, e) = split(x);
    let t = m - 1.0;
    let rest = ln_reduced(t);
    logarithm(x, (rest * EXCESS + t * EXCESS) + rest + t + e)
}

/// A product and what rounding took from it [Dekker 1971].
#[inline(always)]
fn exact_product<R: Real>(a: R, b: R) -> (R, R) {
    let high = |x: R| R::from_bits(x.to_bits() & 0xffff_f000);
    let (a_high, b_high) = (high(a), high(b));
    let (a_low, b_low) = (a - a_high, b - b_high);
    let product = a * b;
    (product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

/// The logarithm to base 2 as the sum of two numbers, of a positive, finite one.
#[inline(always)]
fn log2_in_two<R: Real>(x: R) -> (R, R) {
    // 2/ln 2 times atanh((m - 1)/(m + 1)).
    const SCALE: [f32; 2] = [2.885_39, 3.851_925_6e-8];
    let (m, e) = split(x);
    let t = m - 1.0;
    let sum = m + 1.0;
    let sum_low = m - (sum - 1.0);
    let s = t / sum;
    let (product, product_low) = exact_product(s, sum);
    let s_low = ((t - product) - product_low - s * sum_low) / sum;
    let z = s * s;
    let series = z * polynomial(z, [0.11791146, 0.1426865, 0.20000167, 0.3333333]);
    let (log, log_low) = exact_product(s, R::splat(SCALE[0]));
    let log_low = log_low + s * SCALE[1] + (s_low + s * series) * SCALE[0];
    let high = e + log;
    (high, log - (high - e) + log_low)
}

/// `x` to the power of `y`, for `x` not below zero; NaN below. Anything to the power of zero is one, but for NaN.
#[inline(always)]
pub fn pow<R: Real>(x: R, y: R) -> R {
    let infinity = R::splat(f32::INFINITY);
    // Larger powers of the neighbours of one are zero or infinite already.
    let y = limited(y, -1e10, 1e10);
    let (log, log_low) = log2_in_two(x);
    let (high, low) = exact_product(y, log);
    let low = (low + y * log_low).only(high.abs().lt(R::splat(160.0)));
    let high = limited(high, -151.0, 129.0);
    let (n, power) = nearest(high);
    let value = scale(exp_reduced(((high - n) + low) * LN_2), power);

    let endless = x.eq(infinity);
    let large = (endless & y.gt(R::zero())) | (!endless & y.lt(R::zero()));
    let value = (endless | x.eq(R::zero())).select(infinity.only(large), value);
    let value = y.eq(R::zero()).select(R::one(), value);
    (x.ge(R::zero()) & !y.is_nan()).select(value, R::splat(f32::NAN))
}

/// The angle of the point (x, y), in radians from -π to π; 0 or ±π for points without size, as their signs say.
#[inline(always)]
pub fn atan2<R: Real>(y: R, x: R) -> R {
    let largest = R::splat(f32::MAX);
    let (width, height) = (largest.min(x.abs()), largest.min(y.abs()));
    let steep = width.lt(height);
    let (short, long) = (steep.select(width, height), steep.select(height, width));
    let slope = short / long.max(R::splat(f32::from_bits(1)));
    let angle = atan_up_to_one(slope);
    let angle = steep.select(R::splat(FRAC_PI_2) - angle, angle);
    let left = x.to_bits().lt(R::Word::splat(1 << 31));
    let angle = left.select(angle, R::splat(PI) - angle).copysign(y);
    (x.is_nan() | y.is_nan()).select(R::splat(f32::NAN), angle)
}

/// The arc tangent of a number from 0 to 1.
#[inline(always)]
fn atan_up_to_one<R: Real>(x: R) -> R {
    // Above tan(π/8), π/8 is taken away.
    let large = x.gt(R::splat(0.414_213_57));
    let a = large.select((x - 1.0) / (x + 1.0), x);
    let z = a * a;
    let arc = a + a * z * polynomial(z, [0.0806022, -0.13879825, 0.19977924, -0.33332956]);
    arc + R::splat(FRAC_PI_4).only(large)
}

/// The arc tangent, in radians from -π/2 to π/2.
#[inline(always)]
pub fn atan<R: Real>(x: R) -> R {
    atan2(x, R::one())
}

/// The arc sine of a number up to one half in size.
#[inline(always)]
fn asin_up_to_half<R: Real>(x: R, squared: R) -> R {
    let series = polynomial(squared, [0.04221869, 0.024147533, 0.04547711, 0.074952416, 0.16666754]);
    x + x * squared * series
}

/// For |x| above one half: (true, asin √((1 - |x|)/2)); otherwise: (false, asin |x|).
#[inline(always)]
fn asin_by_parts<R: Real>(x: R) -> (R::Mask, R) {
    let size = x.abs();
    let large = size.gt(R::splat(0.5));
    let squared = large.select(R::splat(0.5) - size * 0.5, size * size);
    (large, asin_up_to_half(large.select(squared.sqrt(), size), squared))
}

/// The arc sine, in radians from -π/2 to π/2; NaN for numbers beyond one in size.
#[inline(always)]
pub fn asin<R: Real>(x: R) -> R {
    let (large, arc) = asin_by_parts(x);
    large.select(R::splat(FRAC_PI_2) - arc * 2.0, arc).copysign(x)
}

/// The arc cosine, in radians from 0 to π; NaN for numbers beyond one in size.
#[inline(always)]
pub fn acos<R: Real>(x: R) -> R {
    let (large, arc) = asin_by_parts(x);
    let negative = x.lt(R::zero());
    let near_pole = negative.select(R::splat(PI) - arc * 2.0, arc * 2.0);
    large.select(near_pole, R::splat(FRAC_PI_2) - arc.mul_sign(x))
}

/// The error function.
#[inline(always)]
pub fn erf<R: Real>(x: R) -> R {
    let size = limited(x.abs(), 0.0, 4.0);
    let z = size * size;
    let series =
        polynomial(z, [8.223988e-5, -0.0008108083, 0.005197992, -0.026858186, 0.11283674, -0.37612632]);
    let near = size * FRAC_2_SQRT_PI + size * z * series;
    let far = polynomial(
        size,
        [
            -2.3602772e-6,
            3.7527025e-5,
            -0.00023783374,
            0.0005835084,
            0.0016568289,
            -0.021071624,
            0.10402954,
            0.63615614,
            1.1284537,
        ],
    );
    let far = R::one() - exp(-(far * size));
    z.lt(R::splat(0.9)).select(near, far).copysign(x)
}

/// The number whose error function is `x`; infinite for ±1, NaN beyond.
///
/// # References
/// [Giles 2012] "Approximating the erfinv Function", GPU Computing Gems.
#[inline(always)]
pub fn erf_inv<R: Real>(x: R) -> R {
    let w = -ln((R::one() - x) * (x + 1.0));
    let middle = polynomial(
        w - 2.5,
        [
            4.0460738e-10,
            -8.748732e-9,
            1.6963016e-8,
            4.6555385e-7,
            -3.4287723e-6,
            -4.9603295e-6,
            0.0002182697,
            -0.0012527474,
            -0.0041773296,
            0.2466403,
            1.5014094,
        ],
    );
    let tail = polynomial(
        w.sqrt() - 3.0,
        [
            -3.0720144e-5,
            0.00016225783,
            -0.00027597634,
            -0.00012251154,
            0.0014744379,
            -0.0035658814,
            0.0056878375,
            -0.0076429863,
            0.009445289,
            1.0016752,
            2.8329768,
        ],
    );
    let value = w.lt(R::splat(5.0)).select(middle, tail) * x;
    w.eq(R::splat(f32::INFINITY)).select(w.copysign(x), value)
}

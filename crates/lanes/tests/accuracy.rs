//! The errors of elementary functions, against double precision.

#[expect(dead_code, reason = "shared with other tests")]
mod common;

use aureole_lanes::math;
use common::Random;

/// The distance between neighbouring numbers of single precision at `x`.
fn ulp(x: f64) -> f64 {
    let size = (x as f32).abs().clamp(f32::MIN_POSITIVE, 3e38);
    f64::from(size.next_up()) - f64::from(size)
}

/// Holds the largest error over many numbers between two limits below a bound in ulps.
fn within(bound: f64, low: f32, high: f32, f: impl Fn(f32) -> f32, exact: impl Fn(f64) -> f64) {
    let mut random = Random(low.to_bits().into());
    let mut worst = (0.0, 0.0);
    for _ in 0..200_000 {
        let x = random.between(low, high);
        let expected = exact(x.into());
        let error = (f64::from(f(x)) - expected).abs() / ulp(expected);
        if error.is_nan() || error > worst.0 {
            worst = (error, x);
        }
    }
    assert!(worst.0 < bound, "{worst:?} in [{low}, {high}]");
}

/// The inverse of the error function, by Newton's method.
fn erf_inv(x: f64) -> f64 {
    let mut y = f64::from(math::erf_inv(x as f32));
    for _ in 0..4 {
        y -= (libm::erf(y) - x) * (std::f64::consts::PI.sqrt() / 2.0) * (y * y).exp();
    }
    y
}

#[test]
fn trigonometric() {
    use std::f64::consts::TAU;
    // Near the zeros of a sine its error is that of the angle.
    let absolute = |f: fn(f32) -> f32, exact: fn(f64) -> f64, limit: f32| {
        let mut random = Random(9);
        for _ in 0..200_000 {
            let x = random.between(-limit, limit);
            let error = (f64::from(f(x)) - exact(x.into())).abs();
            assert!(error < 1e-7, "{error} at {x}");
        }
    };
    absolute(math::sin, f64::sin, 4.0);
    absolute(math::sin, f64::sin, 1e4);
    absolute(math::cos, f64::cos, 1e4);
    absolute(|x| math::sin_cos_turns(x).0, |x| (x * TAU).sin(), 100.0);
    absolute(|x| math::sin_cos_turns(x).1, |x| (x * TAU).cos(), 100.0);
    within(2.0, -0.8, 0.8, math::sin, f64::sin);
    within(2.0, -3.0, 3.0, math::sin, f64::sin);
    within(2.0, -1.5, 1.5, math::cos, f64::cos);
    within(3.0, -1.5, 1.5, math::tan, f64::tan);
    within(3.0, -1.0, 1.0, math::asin, f64::asin);
    within(2.0, -1.0, 1.0, math::acos, f64::acos);
    within(2.0, -5.0, 5.0, math::atan, f64::atan);
    within(2.0, -5.0, 5.0, |x| math::atan2(x, -0.7), |x| x.atan2(f64::from(-0.7_f32)));
}

#[test]
fn exponential() {
    within(2.0, -87.0, 88.0, math::exp, f64::exp);
    within(2.0, -1.0, 1.0, math::exp, f64::exp);
    within(2.0, -104.0, -87.0, math::exp, f64::exp);
    within(2.0, -126.0, 128.0, math::exp2, f64::exp2);
    within(2.0, -150.0, -126.0, math::exp2, f64::exp2);
    within(2.0, 0.0, 4.0, math::ln, f64::ln);
    within(2.0, 0.9, 1.1, math::ln, f64::ln);
    within(2.0, 0.0, 1e-38, math::ln, f64::ln);
    within(2.0, 0.0, 1e30, math::log2, f64::log2);
    within(2.0, 0.5, 2.0, math::log2, f64::log2);
    within(2.0, 0.0, 4.0, |x| math::pow(x, 2.4), |x| x.powf(f64::from(2.4_f32)));
    within(2.0, -50.0, 50.0, |y| math::pow(5.0, y), |y| 5.0_f64.powf(y));
    within(2.0, -1e6, 1e6, |y| math::pow(1.00005, y), |y| f64::from(1.00005_f32).powf(y));
    within(2.0, 0.0, 1e6, |x| math::pow(x, 6.0), |x| x.powf(6.0));
}

#[test]
fn error_function() {
    within(3.0, -4.5, 4.5, math::erf, libm::erf);
    within(3.0, -0.9, 0.9, math::erf, libm::erf);
    within(3.0, -0.999, 0.999, math::erf_inv, erf_inv);
    within(3.0, -0.1, 0.1, math::erf_inv, erf_inv);
    within(2.0, 0.999, 0.999_999_9, math::erf_inv, erf_inv);
    assert_eq!([math::erf_inv(1.0_f32), math::erf_inv(-1.0)], [f32::INFINITY, f32::NEG_INFINITY]);
}

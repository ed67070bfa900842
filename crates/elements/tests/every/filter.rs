//! Filters: draws, weights and values agree.

use aureole_desc::{Family, Node, Span};
use aureole_elements::Filter;
use aureole_math::{Point2, Vector2};
use aureole_testkit::{Rect, integrate, mean_with_error, z_test};

use crate::world::{World, params};

fn filters() -> impl Iterator<Item = (&'static str, Filter)> {
    Filter::KINDS.iter().map(|kind| {
        let node = Node::new(Family::Filter, *kind, params([]), Span::NONE);
        (*kind, Filter::build(&node, &mut World::default()).unwrap_or_else(|error| panic!("{kind}: {error}")))
    })
}

#[test]
fn filters_are_even_and_end_at_their_radius() {
    for (kind, filter) in filters() {
        let r = filter.radius();
        for i in 0..100 {
            let at = |sx: f32, sy: f32| {
                filter.eval(Vector2::new(sx * r.x * 0.013 * i as f32, sy * r.y * 0.007 * i as f32))
            };
            assert_eq!([at(1.0, 1.0), at(-1.0, 1.0)], [at(-1.0, -1.0), at(1.0, -1.0)], "{kind}");
        }
        assert_eq!(filter.eval(Vector2::new(r.x * 1.001, 0.0)), 0.0, "{kind}");
        assert_eq!(filter.eval(Vector2::new(0.0, -r.y * 1.001)), 0.0, "{kind}");
    }
}

/// Weighted means over draws are those of the normalised filter, for waves of several lengths. False alarm of all
/// together: one in a hundred seeds; tabulated filters may be off by one in a thousand.
#[test]
fn draws_follow_the_filter() {
    for (kind, filter) in filters() {
        let r = filter.radius();
        let [x, y] = [f64::from(r.x), f64::from(r.y)];
        let domain = Rect { x0: -x, x1: x, y0: -y, y1: y };
        let value = |x: f64, y: f64| f64::from(filter.eval(Vector2::new(x as f32, y as f32)));
        let total = integrate(domain, 1e-5, &mut |x, y| value(x, y));
        for wave in [0.0, 0.5, 1.0, 2.0, 3.5] {
            let f = |x: f64, y: f64| (wave * x).cos() * (0.7 * wave * y).cos();
            let expected = integrate(domain, 1e-5, &mut |x, y| f(x, y) * value(x, y)) / total;
            let mean = mean_with_error(50_000, 1, |rng| {
                let s = filter.sample(rng.point2());
                f64::from(s.weight) * f(s.offset.x.into(), s.offset.y.into())
            });
            let is_near = (mean.value - expected).abs() < 2e-3;
            assert!(is_near || z_test(&mean, expected) > 4e-4, "{kind}, wave {wave}: {mean:?} {expected}");
        }
    }
}

#[test]
fn draws_stay_inside_and_carry_the_sign() {
    for (kind, filter) in filters() {
        let r = filter.radius();
        for i in 0..64 {
            for j in 0..64 {
                let s = filter.sample(Point2::new(i as f32 / 63.01, j as f32 / 63.01));
                assert!(s.offset.x.abs() <= r.x && s.offset.y.abs() <= r.y, "{kind}: {s:?}");
                assert!(s.weight.is_finite(), "{kind}: {s:?}");
                let value = filter.eval(s.offset);
                assert!(value.abs() < 0.02 || value * s.weight > 0.0, "{kind}: {s:?} {value}");
            }
        }
    }
}

/// Values at 0.35 and 1.1 over that at the centre, of Mitsuba 3.9.
#[test]
fn values_are_those_of_mitsuba() {
    let expected = [
        ("box", [1.0, 0.0]),
        ("tent", [0.65, 0.0]),
        ("gaussian", [0.783_154, 0.088_656]),
        ("mitchell", [0.780_648, 0.015_187]),
        ("lanczos", [0.792_311, -0.070_917]),
    ];
    for (kind, filter) in filters() {
        let values = expected.iter().find(|(known, _)| *known == kind).map(|(_, values)| *values);
        let values = values.unwrap_or_else(|| panic!("no values for {kind}"));
        for (x, value) in [0.35, 1.1].into_iter().zip(values) {
            let found = filter.eval(Vector2::new(x, 0.0)) / filter.eval(Vector2::new(0.0, 0.0));
            assert!((found - value).abs() < 1e-3, "{kind} at {x}: {found}, not {value}");
        }
    }
}

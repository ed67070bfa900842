//! Reconstruction filters.

mod boxed;
mod gaussian;
mod lanczos;
mod mitchell;
mod tabulated;
mod tent;

use std::fmt::Debug;

use aureole_desc::{Params, SceneError, Value};
use aureole_math::{Point2, Vector2};

pub use boxed::BoxFilter;
pub use gaussian::Gaussian;
pub use lanczos::Lanczos;
pub use mitchell::Mitchell;
pub use tent::Tent;

/// A point drawn from a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSample {
    /// Offset from the pixel's centre, in pixels.
    pub offset: Vector2,
    /// Filter value over pdf, normalised so that its mean is one. Negative in negative lobes.
    pub weight: f32,
}

/// What every reconstruction filter can do.
///
/// Filters are products of an even function of x and one of y. Samples are shared by all pixels whose filters cover them, or,
/// for filters of one pixel and for very wide ones, drawn in proportion to the filter [Ernst et al. 2006].
pub trait FilterOps: Debug + Send + Sync {
    /// Half the extent in x and y, in pixels.
    fn radius(&self) -> Vector2;

    /// The filter's value at an offset from the pixel's centre. Zero outside the radius.
    fn eval(&self, offset: Vector2) -> f32;

    /// Draws an offset in proportion to the filter's absolute value.
    fn sample(&self, u: Point2) -> FilterSample;
}

registry! {
    ($)
    /// Any built-in filter.
    Filter: FilterOps, match with each_filter;
    boxed::BoxFilter as Box = "box",
    tent::Tent as Tent = "tent",
    gaussian::Gaussian as Gaussian = "gaussian",
    mitchell::Mitchell as Mitchell = "mitchell",
    lanczos::Lanczos as Lanczos = "lanczos",
}

impl Filter {
    /// Half the extent in x and y, in pixels.
    pub fn radius(&self) -> Vector2 {
        each_filter!(self, f => f.radius())
    }

    /// The filter's value at an offset from the pixel's centre.
    pub fn eval(&self, offset: Vector2) -> f32 {
        each_filter!(self, f => f.eval(offset))
    }

    /// Draws an offset in proportion to the filter's absolute value.
    #[inline]
    pub fn sample(&self, u: Point2) -> FilterSample {
        each_filter!(self, f => f.sample(u))
    }
}

/// The `radius` parameter: one number for both axes, or two.
fn radius(params: &mut Params, default: f32) -> Result<Vector2, SceneError> {
    if let Some(Value::Vec2(_)) = params.get("radius") {
        let [x, y] = params.vec2("radius", [default; 2])?;
        if x > 0.0 && y > 0.0 {
            return Ok(Vector2::new(x.min(64.0), y.min(64.0)));
        }
        return Err(SceneError::invalid("`radius` must be positive", params.span("radius")));
    }
    let r = params.float_in("radius", default, 1e-3, 64.0)?;
    Ok(Vector2::new(r, r))
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_desc::{Family, Node, Params, Span};
    use aureole_math::Pcg32;

    /// Draws weighted by their weights must have the filter's own mean of x², within five standard errors.
    #[test]
    fn draws_follow_the_filter() {
        for kind in Filter::KINDS {
            let node = Node::new(Family::Filter, *kind, Params::new(), Span::NONE);
            let filter = Filter::build(&node, &mut crate::element::tests::NoResolver::default()).unwrap();
            let (mut drawn, mut mean, n) = (0.0_f64, 0.0_f64, 200_000);
            let mut rng = Pcg32::new(3);
            for _ in 0..n {
                let s = filter.sample(rng.point2());
                drawn += f64::from(s.weight * s.offset.x * s.offset.x) / f64::from(n);
                mean += f64::from(s.weight) / f64::from(n);
            }
            let r = filter.radius();
            let (mut second, mut total) = (0.0_f64, 0.0_f64);
            for i in 0..400 {
                for j in 0..400 {
                    let at = |i: i32, r: f32| (2.0 * (i as f32 + 0.5) / 400.0 - 1.0) * r;
                    let value = f64::from(filter.eval(Vector2::new(at(i, r.x), at(j, r.y))));
                    second += value * f64::from(at(i, r.x).powi(2));
                    total += value;
                }
            }
            assert!((mean - 1.0).abs() < 0.02, "{kind}: mean weight {mean}");
            assert!((drawn - second / total).abs() < 0.02, "{kind}: {drawn} {}", second / total);
        }
    }
}

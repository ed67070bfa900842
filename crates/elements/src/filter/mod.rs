//! Reconstruction filters.

mod boxed;

use std::fmt::Debug;

use aureole_math::{Point2, Vector2};

pub use boxed::BoxFilter;

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
/// Pixels are estimated by filter importance sampling [Ernst et al. 2006]: each sample belongs to one pixel, so an image
/// does not depend on the order in which tiles are drawn.
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

//! `box`: every sample within the radius counts the same.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radius` | float | 0.5 | half the width, in pixels |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector2};

use super::{FilterOps, FilterSample, radius};
use crate::{Element, Resolver};

/// The box filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxFilter {
    radius: Vector2,
}

impl BoxFilter {
    /// A box of the given half extent, in pixels.
    pub fn new(radius: Vector2) -> Self {
        Self { radius }
    }
}

impl Element for BoxFilter {
    const SUMMARY: &'static str = "Every sample within the radius counts the same.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "radius", ty: "float or pair", default: "0.5", doc: "half the width, in pixels" }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self::new(radius(params, 0.5)?))
    }
}

impl FilterOps for BoxFilter {
    fn radius(&self) -> Vector2 {
        self.radius
    }

    fn eval(&self, offset: Vector2) -> f32 {
        if offset.x.abs() <= self.radius.x && offset.y.abs() <= self.radius.y { 1.0 } else { 0.0 }
    }

    #[inline]
    fn sample(&self, u: Point2) -> FilterSample {
        let offset = Vector2::new((2.0 * u.x - 1.0) * self.radius.x, (2.0 * u.y - 1.0) * self.radius.y);
        FilterSample { offset, weight: 1.0 }
    }
}

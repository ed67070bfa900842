//! `tent`: falls off linearly from the centre.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radius` | float or pair | 1 | half the width, in pixels |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector2, warp};

use super::{FilterOps, FilterSample, radius};
use crate::{Element, Resolver};

/// The tent or triangle filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tent {
    radius: Vector2,
}

impl Element for Tent {
    const SUMMARY: &'static str = "Falls off linearly from the centre.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "radius", ty: "float or pair", default: "1", doc: "half the width, in pixels" }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self { radius: radius(params, 1.0)? })
    }
}

impl FilterOps for Tent {
    fn radius(&self) -> Vector2 {
        self.radius
    }

    fn eval(&self, offset: Vector2) -> f32 {
        let side = |x: f32, r: f32| (1.0 - x.abs() / r).max(0.0);
        side(offset.x, self.radius.x) * side(offset.y, self.radius.y)
    }

    fn sample(&self, u: Point2) -> FilterSample {
        let offset = Vector2::new(
            warp::interval_to_tent(u.x) * self.radius.x,
            warp::interval_to_tent(u.y) * self.radius.y,
        );
        FilterSample { offset, weight: 1.0 }
    }
}

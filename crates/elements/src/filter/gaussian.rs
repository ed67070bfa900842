//! `gaussian`: a bell curve, lowered so that it ends at zero.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radius` | float or pair | 2 | half the width, in pixels |
//! | `std_dev` | float | 0.5 | standard deviation, in pixels |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector2};

use super::tabulated::FilterTable;
use super::{FilterOps, FilterSample, radius};
use crate::{Element, Resolver};

/// A bell curve, lowered so that it ends at zero.
#[derive(Clone, Debug)]
pub struct Gaussian {
    radius: Vector2,
    std_dev: f32,
    table: FilterTable,
}

impl Gaussian {
    fn new(radius: Vector2, std_dev: f32) -> Self {
        let table = FilterTable::new(radius, |offset| {
            profile(offset.x, radius.x, std_dev) * profile(offset.y, radius.y, std_dev)
        });
        Self { radius, std_dev, table }
    }
}

/// One dimension of the bell, zero at and beyond the radius.
fn profile(x: f32, radius: f32, std_dev: f32) -> f32 {
    let bell = |x: f32| (-x * x / (2.0 * std_dev * std_dev)).exp();
    if x.abs() >= radius { 0.0 } else { (bell(x) - bell(radius)).max(0.0) }
}

impl Element for Gaussian {
    const SUMMARY: &'static str = "A bell curve, lowered so that it ends at zero.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "radius", ty: "float or pair", default: "2", doc: "half the width, in pixels" },
        ParamDoc { name: "std_dev", ty: "float", default: "0.5", doc: "standard deviation, in pixels" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let std_dev = params.float_in("std_dev", 0.5, 1e-3, 64.0)?;
        Ok(Self::new(radius(params, 2.0)?, std_dev))
    }
}

impl FilterOps for Gaussian {
    fn radius(&self) -> Vector2 {
        self.radius
    }

    fn eval(&self, offset: Vector2) -> f32 {
        profile(offset.x, self.radius.x, self.std_dev) * profile(offset.y, self.radius.y, self.std_dev)
    }

    fn sample(&self, u: Point2) -> FilterSample {
        self.table.sample(u)
    }
}

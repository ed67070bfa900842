//! `mitchell`: a cubic that balances blur against ringing.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radius` | float or pair | 2 | half the width, in pixels |
//! | `b` | float | 1/3 | weight of the B-spline |
//! | `c` | float | 1/3 | weight of the cardinal spline |
//!
//! References: [Mitchell and Netravali 1988] "Reconstruction Filters in Computer Graphics", SIGGRAPH.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector2};

use super::tabulated::FilterTable;
use super::{FilterOps, FilterSample, radius};
use crate::{Element, Resolver};

/// A cubic that balances blur against ringing.
#[derive(Clone, Debug)]
pub struct Mitchell {
    radius: Vector2,
    b: f32,
    c: f32,
    table: FilterTable,
}

impl Mitchell {
    fn new(radius: Vector2, b: f32, c: f32) -> Self {
        let table = FilterTable::new(radius, |offset| {
            profile(offset.x, radius.x, b, c) * profile(offset.y, radius.y, b, c)
        });
        Self { radius, b, c, table }
    }
}

/// One dimension of the cubic.
fn profile(x: f32, radius: f32, b: f32, c: f32) -> f32 {
    let x = (2.0 * x / radius).abs();
    if x >= 2.0 {
        0.0
    } else if x >= 1.0 {
        ((-b - 6.0 * c) * x * x * x
            + (6.0 * b + 30.0 * c) * x * x
            + (-12.0 * b - 48.0 * c) * x
            + (8.0 * b + 24.0 * c))
            / 6.0
    } else {
        ((12.0 - 9.0 * b - 6.0 * c) * x * x * x + (-18.0 + 12.0 * b + 6.0 * c) * x * x + (6.0 - 2.0 * b))
            / 6.0
    }
}

impl Element for Mitchell {
    const SUMMARY: &'static str = "A cubic that balances blur against ringing.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "radius", ty: "float or pair", default: "2", doc: "half the width, in pixels" },
        ParamDoc { name: "b", ty: "float", default: "1/3", doc: "weight of the B-spline" },
        ParamDoc { name: "c", ty: "float", default: "1/3", doc: "weight of the cardinal spline" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let b = params.float("b", 1.0 / 3.0)?;
        let c = params.float("c", 1.0 / 3.0)?;
        Ok(Self::new(radius(params, 2.0)?, b, c))
    }
}

impl FilterOps for Mitchell {
    fn radius(&self) -> Vector2 {
        self.radius
    }

    fn eval(&self, offset: Vector2) -> f32 {
        profile(offset.x, self.radius.x, self.b, self.c) * profile(offset.y, self.radius.y, self.b, self.c)
    }

    fn sample(&self, u: Point2) -> FilterSample {
        self.table.sample(u)
    }
}

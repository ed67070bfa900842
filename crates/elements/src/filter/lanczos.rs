//! `lanczos`: a windowed sinc: sharp, with ringing.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radius` | float or pair | 3 | half the width, in pixels |
//! | `tau` | float | 3 | period of the window, in pixels |
//!
//! References: [Duchon 1979] "Lanczos Filtering in One and Two Dimensions".

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector2};

use super::tabulated::FilterTable;
use super::{FilterOps, FilterSample, radius};
use crate::{Element, Resolver};

/// A windowed sinc: sharp, with ringing.
#[derive(Clone, Debug)]
pub struct Lanczos {
    radius: Vector2,
    tau: f32,
    table: FilterTable,
}

impl Lanczos {
    fn new(radius: Vector2, tau: f32) -> Self {
        let table = FilterTable::new(radius, |offset| {
            profile(offset.x, radius.x, tau) * profile(offset.y, radius.y, tau)
        });
        Self { radius, tau, table }
    }
}

/// One dimension of the windowed sinc.
fn profile(x: f32, radius: f32, tau: f32) -> f32 {
    let sinc = |x: f32| {
        let x = x * std::f32::consts::PI;
        if x.abs() < 1e-4 { 1.0 } else { x.sin() / x }
    };
    if x.abs() >= radius { 0.0 } else { sinc(x) * sinc(x / tau) }
}

impl Element for Lanczos {
    const SUMMARY: &'static str = "A windowed sinc: sharp, with ringing.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "radius", ty: "float or pair", default: "3", doc: "half the width, in pixels" },
        ParamDoc { name: "tau", ty: "float", default: "3", doc: "period of the window, in pixels" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let tau = params.float_in("tau", 3.0, 1e-3, 64.0)?;
        Ok(Self::new(radius(params, 3.0)?, tau))
    }
}

impl FilterOps for Lanczos {
    fn radius(&self) -> Vector2 {
        self.radius
    }

    fn eval(&self, offset: Vector2) -> f32 {
        profile(offset.x, self.radius.x, self.tau) * profile(offset.y, self.radius.y, self.tau)
    }

    fn sample(&self, u: Point2) -> FilterSample {
        self.table.sample(u)
    }
}

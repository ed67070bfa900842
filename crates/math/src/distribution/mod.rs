//! Tabulated distributions.

mod discrete;
mod piecewise;

pub use discrete::{Discrete, DiscreteSample};
pub use piecewise::{PiecewiseConstant1D, PiecewiseConstant2D, PiecewiseSample1D, PiecewiseSample2D};

//! What a chi-square test finds.

use std::fmt;

use crate::Rect;

/// The result of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chi2Outcome {
    /// Σ (observed - expected)² / expected.
    pub statistic: f64,
    /// Cells after pooling, less one.
    pub dof: usize,
    /// The probability of a statistic at least as large if the density is right.
    pub p_value: f64,
    /// The integral of the density.
    pub density_integral: f64,
}

/// Why draws and density disagree.
#[derive(Clone, Debug, PartialEq)]
pub enum Chi2Error {
    /// The density is negative, infinite or NaN.
    BadDensity {
        /// Where in the domain (azimuth and polar angle, angle and radius, or x and y).
        at: (f64, f64),
        /// The density there.
        value: f32,
    },
    /// A draw is not finite, or outside the domain.
    BadDraw(String),
    /// The density integrates to more than one.
    TooMuchDensity {
        /// Its integral.
        integral: f64,
    },
    /// Draws fell where the density is zero.
    ImpossibleDraws {
        /// The cell, or `None` for refused draws.
        cell: Option<Rect>,
        /// How many.
        observed: f64,
    },
    /// Fewer than two cells after pooling: nothing to compare. Use more cells or draws.
    TooFewCells,
    /// The test rejects.
    Rejected {
        /// The result.
        outcome: Chi2Outcome,
        /// The threshold below which `p_value` rejects.
        threshold: f64,
        /// The cell that contributes most, or `None` for refused draws.
        worst: Option<Rect>,
        /// Its observed count.
        observed: f64,
        /// Its expected count.
        expected: f64,
    },
}

impl fmt::Display for Chi2Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadDensity { at, value } => write!(f, "the density at {at:?} is {value}"),
            Self::BadDraw(what) => write!(f, "not a draw of the domain: {what}"),
            Self::TooMuchDensity { integral } => write!(f, "the density integrates to {integral}"),
            Self::ImpossibleDraws { cell: Some(cell), observed } => {
                write!(f, "{observed} draws in {cell:?}, where the density is zero")
            }
            Self::ImpossibleDraws { cell: None, observed } => {
                write!(f, "{observed} draws refused, but the density integrates to one")
            }
            Self::TooFewCells => write!(f, "fewer than two cells after pooling"),
            Self::Rejected { outcome, threshold, worst, observed, expected } => write!(
                f,
                "p = {:.3e} < {threshold:.3e} (chi2 = {:.1}, {} dof, density integrates to {:.6}); \
                 worst cell {worst:?}: observed {observed}, expected {expected:.1}",
                outcome.p_value, outcome.statistic, outcome.dof, outcome.density_integral
            ),
        }
    }
}

impl std::error::Error for Chi2Error {}

//! Pearson's statistic over cells, small ones pooled.

use super::{Chi2Config, Chi2Error, Chi2Outcome, quadrature_tolerance};
use crate::{Rect, chi2_survival, sidak};

/// Tests counts against expected counts of the same sum, for a domain that is a list of choices.
pub fn chi2_counts(
    config: &Chi2Config,
    observed: &[f64],
    expected: &[f64],
) -> Result<Chi2Outcome, Chi2Error> {
    let n = observed.len() as f64;
    let at = |i: usize| Some(Rect { x0: i as f64 / n, x1: (i + 1) as f64 / n, ..Rect::UNIT });
    compare(config, observed, expected, expected.iter().sum::<f64>() / observed.iter().sum::<f64>(), at)
}

/// Share of the draws below which a cell counts as one where the density is zero; small enough that the many cells
/// in the tail of a peak still expect none in all.
const ZERO_SHARE: f64 = 1e-9;
/// Share of the draws that may fall in such cells: a density may be exactly zero one ulp beside a draw, and the
/// quadrature overlooks what is smaller than a hundredth of a cell.
const FORGIVEN_SHARE: f64 = 5e-5;

/// Cells taken together until they expect enough draws.
#[derive(Clone, Copy, Default)]
struct Pool {
    observed: f64,
    expected: f64,
    /// The last cell that joined: the largest.
    cell: usize,
}

impl Pool {
    fn join(&mut self, other: Self) {
        self.observed += other.observed;
        self.expected += other.expected;
        self.cell = other.cell;
    }

    fn term(&self) -> f64 {
        (self.observed - self.expected).powi(2) / self.expected
    }
}

/// Pools small cells and takes the statistic.
pub(super) fn compare(
    config: &Chi2Config,
    observed: &[f64],
    expected: &[f64],
    density_integral: f64,
    rect: impl Fn(usize) -> Option<Rect>,
) -> Result<Chi2Outcome, Chi2Error> {
    let total: f64 = observed.iter().sum();
    let mut order: Vec<usize> = (0..observed.len()).collect();
    order.sort_by(|&a, &b| expected[a].total_cmp(&expected[b]));

    let mut pools: Vec<Pool> = Vec::new();
    let (mut open, mut misplaced) = (Pool::default(), 0.0);
    for cell in order {
        // The share of refused draws is a difference, and so as uncertain as the quadrature.
        let zero = if rect(cell).is_some() { ZERO_SHARE } else { quadrature_tolerance(total) };
        if expected[cell] <= zero * total {
            misplaced += observed[cell];
            if misplaced > FORGIVEN_SHARE * total {
                return Err(Chi2Error::ImpossibleDraws { cell: rect(cell), observed: observed[cell] });
            }
            continue;
        }
        open.join(Pool { observed: observed[cell], expected: expected[cell], cell });
        if open.expected >= config.min_expected {
            pools.push(std::mem::take(&mut open));
        }
    }
    // What is left over is too little for a pool of its own.
    if let Some(last) = pools.last_mut().filter(|_| open.expected > 0.0) {
        last.join(open);
    }
    judge(config, &pools, density_integral, rect)
}

/// Takes the statistic of the pools and compares its probability with the threshold.
fn judge(
    config: &Chi2Config,
    pools: &[Pool],
    density_integral: f64,
    rect: impl Fn(usize) -> Option<Rect>,
) -> Result<Chi2Outcome, Chi2Error> {
    let Some(worst) = pools.iter().max_by(|a, b| a.term().total_cmp(&b.term())).filter(|_| pools.len() > 1)
    else {
        return Err(Chi2Error::TooFewCells);
    };
    let statistic = pools.iter().map(Pool::term).sum();
    let dof = pools.len() - 1;
    let outcome = Chi2Outcome { statistic, dof, p_value: chi2_survival(statistic, dof), density_integral };
    let threshold = sidak(config.significance, config.test_count);
    // Written so that NaN rejects.
    if outcome.p_value >= threshold {
        return Ok(outcome);
    }
    Err(Chi2Error::Rejected {
        outcome,
        threshold,
        worst: rect(worst.cell),
        observed: worst.observed,
        expected: worst.expected,
    })
}

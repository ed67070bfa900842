//! Pearson's chi-square test: do draws follow the density that is claimed for them?
//!
//! The domain is cut into cells. The density, integrated over a cell, gives the expected count; draws give the observed
//! one. Draws that a sampler refuses (`None`) form one more cell, whose share is what the density leaves up to one.
//!
//! # References
//! [Jakob] "Chi-square tests for samplers", as practised in Mitsuba and [PBRT4] `bsdfs_test`.

mod outcome;
mod pool;

use std::f64::consts::TAU;

use aureole_math::{Pcg32, Point2, Vector3};

use crate::quadrature::{Rect, direction, integrate, integrate_closely};

pub use outcome::{Chi2Error, Chi2Outcome};
pub use pool::chi2_counts;
use pool::compare;

/// How a chi-square test is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chi2Config {
    /// Cells along the azimuth, the angle, or x.
    pub columns: usize,
    /// Cells along the polar angle, the radius, or y. An even number puts a border on the equator.
    pub rows: usize,
    /// How many draws.
    pub sample_count: usize,
    /// Cells are pooled until they expect at least this many draws; 5 is the textbook's rule.
    pub min_expected: f64,
    /// The seed of the draws.
    pub seed: u64,
    /// The probability that a family of `test_count` correct samplers sees a false alarm.
    pub significance: f64,
    /// How many tests share that probability ([`sidak`](crate::sidak)).
    pub test_count: usize,
}

impl Default for Chi2Config {
    /// 40 × 20 cells, 200,000 draws, false alarm in one of a hundred runs.
    fn default() -> Self {
        Self {
            columns: 40,
            rows: 20,
            sample_count: 200_000,
            min_expected: 5.0,
            seed: 0,
            significance: 0.01,
            test_count: 1,
        }
    }
}

/// Tests directions against a density per steradian.
///
/// `sample` returns `None` when it has no direction (say, an absorbed path) or one that the density leaves out (say, a
/// mirror's); the density then integrates to less than one.
pub fn chi2_sphere(
    config: &Chi2Config,
    mut sample: impl FnMut(&mut Pcg32) -> Option<Vector3>,
    pdf_omega: impl Fn(Vector3) -> f32,
) -> Result<Chi2Outcome, Chi2Error> {
    let draw = |rng: &mut Pcg32| {
        sample(rng).map(|w| {
            if !w.is_finite() || (w.length() - 1.0).abs() > 1e-3 {
                return Err(Chi2Error::BadDraw(format!("{w:?}")));
            }
            let phi = f64::from(w.y).atan2(f64::from(w.x)).rem_euclid(TAU);
            let theta = f64::from(w.x).hypot(f64::from(w.y)).atan2(f64::from(w.z));
            Ok((phi, theta))
        })
    };
    run(config, Rect::SPHERE, draw, |phi, theta| (pdf_omega(direction(phi, theta)), theta.sin()))
}

/// Tests points of the unit square against a density per area.
pub fn chi2_square(
    config: &Chi2Config,
    mut sample: impl FnMut(&mut Pcg32) -> Option<Point2>,
    pdf: impl Fn(Point2) -> f32,
) -> Result<Chi2Outcome, Chi2Error> {
    let draw = |rng: &mut Pcg32| {
        sample(rng).map(|p| {
            let inside = (0.0..=1.0).contains(&p.x) && (0.0..=1.0).contains(&p.y);
            if inside {
                Ok((f64::from(p.x), f64::from(p.y)))
            } else {
                Err(Chi2Error::BadDraw(format!("{p:?}")))
            }
        })
    };
    run(config, Rect::UNIT, draw, |x, y| (pdf(Point2::new(x as f32, y as f32)), 1.0))
}

/// Tests points of the unit disk against a density per area. Cells are polar: columns of angle, rows of radius.
pub fn chi2_disk(
    config: &Chi2Config,
    mut sample: impl FnMut(&mut Pcg32) -> Option<Point2>,
    pdf: impl Fn(Point2) -> f32,
) -> Result<Chi2Outcome, Chi2Error> {
    let draw = |rng: &mut Pcg32| {
        sample(rng).map(|p| {
            let (x, y) = (f64::from(p.x), f64::from(p.y));
            let radius = x.hypot(y);
            // Rounding may put a point of the rim outside by an ulp or two.
            let inside = radius <= 1.0 + 1e-6;
            if inside {
                Ok((y.atan2(x).rem_euclid(TAU), radius.min(1.0)))
            } else {
                Err(Chi2Error::BadDraw(format!("{p:?}")))
            }
        })
    };
    let disk = Rect { x0: 0.0, x1: TAU, y0: 0.0, y1: 1.0 };
    run(config, disk, draw, |phi, r| (pdf(Point2::new((r * phi.cos()) as f32, (r * phi.sin()) as f32)), r))
}

/// Absolute error of the density's integral over the domain that the quadrature aims at: one draw.
fn quadrature_tolerance(sample_count: f64) -> f64 {
    1.0 / sample_count
}

/// How far above one a density may integrate: the quadrature's error at discontinuities.
const MAX_EXCESS: f64 = 2e-3;

/// Draws, integrates and compares. `density` returns the density and the domain's Jacobian at (x, y).
fn run(
    config: &Chi2Config,
    domain: Rect,
    mut draw: impl FnMut(&mut Pcg32) -> Option<Result<(f64, f64), Chi2Error>>,
    density: impl Fn(f64, f64) -> (f32, f64),
) -> Result<Chi2Outcome, Chi2Error> {
    let (columns, rows) = (config.columns, config.rows);
    // The last cell is that of refused draws.
    let mut observed = vec![0.0; columns * rows + 1];
    let mut rng = Pcg32::new(config.seed);
    let index = |value: f64, start: f64, end: f64, n: usize| {
        (((value - start) / (end - start) * n as f64) as usize).min(n - 1)
    };
    for _ in 0..config.sample_count {
        let cell = match draw(&mut rng).transpose()? {
            Some((x, y)) => {
                index(y, domain.y0, domain.y1, rows) * columns + index(x, domain.x0, domain.x1, columns)
            }
            None => columns * rows,
        };
        observed[cell] += 1.0;
    }

    let mut bad = None;
    let mut weighted = |x: f64, y: f64| {
        let (value, jacobian) = density(x, y);
        if !(value >= 0.0 && value.is_finite()) {
            bad = Some(Chi2Error::BadDensity { at: (x, y), value });
        }
        f64::from(value) * jacobian
    };
    let tolerance = quadrature_tolerance(config.sample_count as f64) / (columns * rows) as f64;
    let cell = |i: usize| domain.cell(columns, rows, i % columns, i / columns);
    let mut expected: Vec<f64> = (0..columns * rows)
        .map(|i| {
            let share = integrate(cell(i), tolerance, &mut weighted);
            // A sliver of density that reaches into a cell is easily overlooked, but not by draws.
            let overlooked = share < tolerance && observed[i] > 0.0;
            if overlooked { integrate_closely(cell(i), tolerance, &mut weighted) } else { share }
        })
        .collect();
    if let Some(bad) = bad {
        return Err(bad);
    }
    let integral: f64 = expected.iter().sum();
    if integral > 1.0 + MAX_EXCESS {
        return Err(Chi2Error::TooMuchDensity { integral });
    }
    expected.push((1.0 - integral).max(0.0));
    for share in &mut expected {
        *share *= config.sample_count as f64;
    }

    let at = |i: usize| (i < columns * rows).then(|| cell(i));
    compare(config, &observed, &expected, integral, at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::warp;

    #[test]
    fn p_values_of_a_right_sampler_are_uniform() {
        // 200 tests of 20 choices: of their p-values, a tenth should lie in each tenth.
        let mut tenths = [0.0; 10];
        for seed in 0..200 {
            let config = Chi2Config { significance: 1e-9, ..Chi2Config::default() };
            let mut rng = Pcg32::new(seed);
            let mut counts = [0.0; 20];
            for _ in 0..2_000 {
                counts[(rng.next_f32() * 20.0) as usize] += 1.0;
            }
            let p = chi2_counts(&config, &counts, &[100.0; 20]).unwrap().p_value;
            tenths[((p * 10.0) as usize).min(9)] += 1.0;
        }
        let config = Chi2Config { significance: 1e-4, ..Chi2Config::default() };
        chi2_counts(&config, &tenths, &[20.0; 10]).unwrap();
    }

    #[test]
    fn a_slightly_wrong_density_is_rejected() {
        let config = Chi2Config::default();
        let sample = |rng: &mut Pcg32| Some(warp::square_to_cosine_hemisphere(rng.point2()));
        let tilted = |w: Vector3| if w.z > 0.0 { (w.z + 0.05 * w.x) / std::f32::consts::PI } else { 0.0 };
        let result = chi2_sphere(&config, sample, |w| tilted(w).max(0.0));
        assert!(matches!(result, Err(Chi2Error::Rejected { .. })), "{result:?}");
    }

    #[test]
    fn refused_draws_are_a_cell() {
        let config = Chi2Config::default();
        let sample = |rng: &mut Pcg32| {
            let w = warp::square_to_uniform_sphere(rng.point2());
            (rng.next_f32() < 0.75).then_some(w)
        };
        let pdf = |share: f32| move |_: Vector3| share * warp::UNIFORM_SPHERE_PDF;
        chi2_sphere(&config, sample, pdf(0.75)).unwrap();
        assert!(chi2_sphere(&config, sample, pdf(0.77)).is_err());
        assert!(matches!(
            chi2_sphere(&config, sample, pdf(1.0)),
            Err(Chi2Error::ImpossibleDraws { cell: None, .. })
        ));
        assert!(matches!(chi2_sphere(&config, sample, pdf(1.1)), Err(Chi2Error::TooMuchDensity { .. })));
    }

    #[test]
    fn draws_where_the_density_is_zero_are_named() {
        let config = Chi2Config::default();
        let sample = |rng: &mut Pcg32| Some(warp::square_to_uniform_sphere(rng.point2()));
        let result =
            chi2_sphere(&config, sample, |w| if w.z > 0.0 { warp::UNIFORM_HEMISPHERE_PDF } else { 0.0 });
        assert!(matches!(result, Err(Chi2Error::ImpossibleDraws { cell: Some(_), .. })), "{result:?}");
        let result = chi2_sphere(&config, sample, |_| f32::NAN);
        assert!(matches!(result, Err(Chi2Error::BadDensity { .. })), "{result:?}");
        let result = chi2_sphere(&config, |_| Some(Vector3::ZERO), |_| warp::UNIFORM_SPHERE_PDF);
        assert!(matches!(result, Err(Chi2Error::BadDraw(_))), "{result:?}");
    }
}

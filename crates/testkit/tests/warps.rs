//! Every warp and distribution of the maths crate against its density.
//!
//! Twelve tests share a false-alarm rate of 1 % by Šidák's correction; seeds are fixed.

use std::f32::consts::FRAC_1_PI;

use aureole_math::{Discrete, Pcg32, PiecewiseConstant1D, PiecewiseConstant2D, Point2, Vector3, warp};
use aureole_testkit::{Chi2Config, chi2_counts, chi2_disk, chi2_sphere, chi2_square};

fn config() -> Chi2Config {
    Chi2Config { test_count: 12, ..Chi2Config::default() }
}

#[test]
fn concentric_disk() {
    chi2_disk(&config(), |rng| Some(warp::square_to_disk_concentric(rng.point2())), |_| FRAC_1_PI).unwrap();
}

#[test]
fn cosine_hemisphere() {
    let sample = |rng: &mut Pcg32| Some(warp::square_to_cosine_hemisphere(rng.point2()));
    chi2_sphere(&config(), sample, |w| warp::cosine_hemisphere_pdf(w.z)).unwrap();
}

#[test]
fn uniform_sphere() {
    let sample = |rng: &mut Pcg32| Some(warp::square_to_uniform_sphere(rng.point2()));
    chi2_sphere(&config(), sample, |_| warp::UNIFORM_SPHERE_PDF).unwrap();
}

#[test]
fn uniform_hemisphere() {
    let pdf = |w: Vector3| if w.z > 0.0 { warp::UNIFORM_HEMISPHERE_PDF } else { 0.0 };
    chi2_sphere(&config(), |rng| Some(warp::square_to_uniform_hemisphere(rng.point2())), pdf).unwrap();
}

#[test]
fn uniform_cones() {
    // Half angles of 60 and 90 degrees: borders of cells, since the density jumps there.
    for one_minus_cos in [0.5, 1.0] {
        let config = Chi2Config { rows: 18, ..config() };
        let pdf =
            |w: Vector3| if w.z > 1.0 - one_minus_cos { warp::uniform_cone_pdf(one_minus_cos) } else { 0.0 };
        let sample = |rng: &mut Pcg32| Some(warp::square_to_uniform_cone(rng.point2(), one_minus_cos));
        chi2_sphere(&config, sample, pdf).unwrap();
    }
}

#[test]
fn equal_area_sphere() {
    let sample = |rng: &mut Pcg32| Some(warp::sphere_from_square_equal_area(rng.point2()));
    chi2_sphere(&config(), sample, |_| warp::UNIFORM_SPHERE_PDF).unwrap();
}

#[test]
fn triangle() {
    // Folded onto the square by the half turn that maps the missing half onto the triangle.
    let sample = |rng: &mut Pcg32| {
        let b = warp::square_to_triangle(rng.point2());
        Some(if rng.next_f32() < 0.5 { b } else { Point2::new(1.0 - b.x, 1.0 - b.y) })
    };
    chi2_square(&config(), sample, |_| 1.0).unwrap();
}

#[test]
fn tent() {
    let to_unit = |t: f32| 0.5 * (t + 1.0);
    let sample = |rng: &mut Pcg32| {
        let u = rng.point2();
        Some(Point2::new(to_unit(warp::interval_to_tent(u.x)), to_unit(warp::interval_to_tent(u.y))))
    };
    let tent = |x: f32| 2.0 * (1.0 - (2.0 * x - 1.0).abs());
    chi2_square(&config(), sample, |p| tent(p.x) * tent(p.y)).unwrap();
}

#[test]
fn piecewise_constant() {
    let values = [1.0, 2.0, 0.0, 4.0, 0.5, 3.0, 0.0, 0.0, 0.0, 0.0, 7.0, 1.0];
    let config = Chi2Config { columns: 20, rows: 15, ..config() };
    let d = PiecewiseConstant2D::new(&values, 4).unwrap();
    chi2_square(&config, |rng| d.sample(rng.point2()).map(|s| s.p), |p| d.pdf(p)).unwrap();
    let d = PiecewiseConstant1D::new(values).unwrap();
    let config = Chi2Config { columns: 24, rows: 2, ..config };
    let sample = |rng: &mut Pcg32| Some(Point2::new(d.sample(rng.next_f32()).x, rng.next_f32()));
    chi2_square(&config, sample, |p| d.pdf(p.x)).unwrap();
}

#[test]
fn discrete() {
    let weights: Vec<f32> = (0..50).map(|i| ((i * 7) % 11) as f32).collect();
    let d = Discrete::new(weights.iter().copied()).unwrap();
    let mut rng = Pcg32::new(1);
    let mut counts = vec![0.0; weights.len()];
    let n = 100_000;
    for _ in 0..n {
        counts[d.sample(rng.next_f32()).index] += 1.0;
    }
    let expected: Vec<f64> = (0..weights.len()).map(|i| f64::from(d.pmf(i)) * f64::from(n)).collect();
    chi2_counts(&config(), &counts, &expected).unwrap();
}

//! Maps from the unit square to other domains, area-preserving or with a stated density.

mod equal_area;
mod spherical;

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, PI, TAU};

use crate::{Point2, Vector3};

pub use equal_area::{sphere_from_square_equal_area, square_from_sphere_equal_area};
pub use spherical::{SphericalRectangle, SphericalTriangle};

/// Uniform on the unit disk.
///
/// # References
/// [Shirley and Chiu 1997] "A Low Distortion Map Between Disk and Square", JGT 2(3).
#[inline]
pub fn square_to_disk_concentric(u: Point2) -> Point2 {
    let (x, y) = (2.0 * u.x - 1.0, 2.0 * u.y - 1.0);
    if x == 0.0 && y == 0.0 {
        return Point2::new(0.0, 0.0);
    }
    let (r, phi) =
        if x.abs() > y.abs() { (x, FRAC_PI_4 * (y / x)) } else { (y, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (x / y)) };
    let (sin, cos) = phi.sin_cos();
    Point2::new(r * cos, r * sin)
}

/// The upper hemisphere in proportion to the cosine with +Z.
#[inline]
pub fn square_to_cosine_hemisphere(u: Point2) -> Vector3 {
    let d = square_to_disk_concentric(u);
    Vector3::new(d.x, d.y, (1.0 - d.x * d.x - d.y * d.y).max(1e-14).sqrt())
}

/// Density of [`square_to_cosine_hemisphere`] per steradian.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Uniform on the sphere.
#[inline]
pub fn square_to_uniform_sphere(u: Point2) -> Vector3 {
    let z = 1.0 - 2.0 * u.y;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    Vector3::new(r * cos, r * sin, z)
}

/// Density of [`square_to_uniform_sphere`] per steradian.
pub const UNIFORM_SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// Uniform on the upper hemisphere.
#[inline]
pub fn square_to_uniform_hemisphere(u: Point2) -> Vector3 {
    let r = (1.0 - u.y * u.y).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    Vector3::new(r * cos, r * sin, u.y)
}

/// Density of [`square_to_uniform_hemisphere`] per steradian.
pub const UNIFORM_HEMISPHERE_PDF: f32 = 0.5 * FRAC_1_PI;

/// Uniform in the cone around +Z with `1 - cos` of its half angle given; exact for thin cones.
#[inline]
pub fn square_to_uniform_cone(u: Point2, one_minus_cos: f32) -> Vector3 {
    let h = u.y * one_minus_cos;
    let r = (h * (2.0 - h)).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.x).sin_cos();
    Vector3::new(r * cos, r * sin, 1.0 - h)
}

/// Density of [`square_to_uniform_cone`] per steradian.
#[inline]
pub fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (TAU * one_minus_cos)
}

/// Uniform barycentric weights of the second and third vertex of a triangle.
///
/// # References
/// [Heitz 2019] "A Low-Distortion Map Between Triangle and Square".
#[inline]
pub fn square_to_triangle(u: Point2) -> Point2 {
    if u.x < u.y {
        let b = 0.5 * u.x;
        Point2::new(b, u.y - b)
    } else {
        let b = 0.5 * u.y;
        Point2::new(u.x - b, b)
    }
}

/// A tent on [-1, 1] with its peak at zero.
#[inline]
pub fn interval_to_tent(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).max(0.0).sqrt() }
}

/// Azimuth in [0, 2π) of a direction.
#[inline]
pub fn azimuth(y: f32, x: f32) -> f32 {
    let phi = y.atan2(x);
    if phi < 0.0 { (phi + TAU).min(TAU * (1.0 - f32::EPSILON)) } else { phi }
}

/// The polar angle from +Z, accurate near the poles too.
#[inline]
pub fn polar_angle(w: Vector3) -> f32 {
    let chord = |z: f32| Vector3::new(w.x, w.y, z).length() * 0.5;
    if w.z >= 0.0 {
        2.0 * chord(w.z - 1.0).min(1.0).asin()
    } else {
        PI - 2.0 * chord(w.z + 1.0).min(1.0).asin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pcg32;

    /// Mean of `f` over 200,000 draws; its standard error is below 0.003 for |f| <= 1.
    fn mean(f: impl Fn(Point2) -> f32) -> f32 {
        let mut rng = Pcg32::new(7);
        (0..200_000).map(|_| f64::from(f(rng.point2()))).sum::<f64>() as f32 / 200_000.0
    }

    // Five standard errors: a false alarm in fewer than one of a million runs (and the seed is fixed).
    const TOLERANCE: f32 = 0.008;

    #[test]
    fn moments_of_the_warps() {
        assert!((mean(|u| square_to_cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < TOLERANCE);
        assert!((mean(|u| square_to_uniform_hemisphere(u).z) - 0.5).abs() < TOLERANCE);
        assert!((mean(|u| square_to_uniform_sphere(u).z.powi(2)) - 1.0 / 3.0).abs() < TOLERANCE);
        assert!((mean(|u| square_to_uniform_sphere(u).x.powi(2)) - 1.0 / 3.0).abs() < TOLERANCE);
        assert!((mean(|u| square_to_uniform_cone(u, 0.5).z) - 0.75).abs() < TOLERANCE);
        assert!((mean(|u| interval_to_tent(u.x).abs()) - 1.0 / 3.0).abs() < TOLERANCE);
        assert!((mean(|u| interval_to_tent(u.x)) - 0.0).abs() < TOLERANCE);
        let disk = |u| square_to_disk_concentric(u);
        assert!((mean(|u| disk(u).x.powi(2) + disk(u).y.powi(2)) - 0.5).abs() < TOLERANCE);
        for pick in [|b: Point2| b.x, |b: Point2| b.y, |b: Point2| 1.0 - b.x - b.y] {
            assert!((mean(|u| pick(square_to_triangle(u))) - 1.0 / 3.0).abs() < TOLERANCE);
            assert!((mean(|u| pick(square_to_triangle(u)).powi(2)) - 1.0 / 6.0).abs() < TOLERANCE);
        }
    }

    #[test]
    fn angles_are_recovered() {
        let mut rng = Pcg32::new(3);
        for _ in 0..1000 {
            let (theta, phi) = (rng.next_f32() * PI, rng.next_f32() * TAU);
            let w = crate::spherical_direction(theta, phi);
            assert!((polar_angle(w) - theta).abs() < 1e-5);
            assert!(theta.sin() < 1e-3 || (azimuth(w.y, w.x) - phi).abs() < 1e-3);
        }
    }
}

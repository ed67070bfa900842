//! The equal-area map between square and sphere, which pbrt-v4's environment images use.
//!
//! # References
//! [Clarberg 2008] "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", JGT 13(3).

use std::f32::consts::{FRAC_2_PI, FRAC_PI_4};

use crate::{Point2, Vector3};

/// The unit vector at a point of the unit square.
pub fn sphere_from_square_equal_area(p: Point2) -> Vector3 {
    let (u, v) = (2.0 * p.x - 1.0, 2.0 * p.y - 1.0);
    let (u_abs, v_abs) = (u.abs(), v.abs());
    // The signed distance to the diagonal decides between the hemispheres.
    let signed = 1.0 - (u_abs + v_abs);
    let r = 1.0 - signed.abs();
    let phi = if r == 0.0 { 1.0 } else { (v_abs - u_abs) / r + 1.0 } * FRAC_PI_4;
    let z = (1.0 - r * r).copysign(signed);
    let s = r * (2.0 - r * r).max(0.0).sqrt();
    Vector3::new((phi.cos() * s).copysign(u), (phi.sin() * s).copysign(v), z)
}

/// The point of the unit square at a unit vector.
pub fn square_from_sphere_equal_area(w: Vector3) -> Point2 {
    let (x, y, z) = (w.x.abs(), w.y.abs(), w.z.abs());
    let r = (1.0 - z).max(0.0).sqrt();
    let phi = if x == 0.0 && y == 0.0 { 0.0 } else { y.atan2(x) * FRAC_2_PI };
    let (mut u, mut v) = (r - phi * r, phi * r);
    if w.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    Point2::new((u.copysign(w.x) + 1.0) * 0.5, (v.copysign(w.y) + 1.0) * 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pcg32;

    #[test]
    fn round_trips_and_keeps_area() {
        let mut rng = Pcg32::new(11);
        let mut z2 = 0.0;
        for _ in 0..50_000 {
            let p = rng.point2();
            let w = sphere_from_square_equal_area(p);
            assert!((w.length() - 1.0).abs() < 1e-5);
            let back = square_from_sphere_equal_area(w);
            assert!((back - p).length() < 2e-3, "{p:?} {back:?}");
            z2 += w.z * w.z;
        }
        assert!((z2 / 50_000.0 - 1.0 / 3.0).abs() < 0.01);
    }
}

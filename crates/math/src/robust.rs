//! Rounding: bounds on it and ways around it.

use crate::{Point3, Vector3};

/// The bound γₙ = nε / (1 - nε) on the relative error of n floating-point operations [Higham 2002].
#[inline]
pub const fn gamma(n: u32) -> f32 {
    const UNIT_ROUNDOFF: f32 = f32::EPSILON * 0.5;
    let ne = n as f32 * UNIT_ROUNDOFF;
    ne / (1.0 - ne)
}

/// The next larger number.
#[inline]
pub fn next_up(x: f32) -> f32 {
    x.next_up()
}

/// The next smaller number.
#[inline]
pub fn next_down(x: f32) -> f32 {
    x.next_down()
}

/// `a·b - c·d` without catastrophic cancellation [Kahan 2004].
#[inline]
pub fn difference_of_products(a: f32, b: f32, c: f32, d: f32) -> f32 {
    // Exact products in double precision: cheaper than fused operations where the hardware lacks them.
    (f64::from(a) * f64::from(b) - f64::from(c) * f64::from(d)) as f32
}

/// Where a ray that leaves a surface towards `w` must start so that it cannot hit that surface again by rounding.
///
/// `error` bounds the absolute error of each coordinate of `p`; `n` is the geometric normal.
///
/// # References
/// [Pharr 2023] section 6.8.6.
#[inline]
pub fn offset_ray_origin(p: Point3, error: Vector3, n: Vector3, w: Vector3) -> Point3 {
    let distance = n.abs().dot(error).copysign(w.dot(n));
    let offset = n * distance;
    // The sum rounds by at most half a unit in its last place: go a whole one further out.
    let away = |x: f32, by: f32| {
        let sum = x + by;
        sum + (sum.abs() * f32::EPSILON).copysign(by)
    };
    Point3::new(away(p.x, offset.x), away(p.y, offset.y), away(p.z, offset.z))
}

//! Derivatives by central differences, to check analytic ones.

use aureole_math::{Point2, Point3, Vector3};

/// f'(x), from steps `h` and `h/2` with Richardson's extrapolation: the error is O(h⁴) plus rounding O(ε/h).
pub fn derivative(x: f64, h: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let mut central = |h: f64| (f(x + h) - f(x - h)) / (2.0 * h);
    (4.0 * central(0.5 * h) - central(h)) / 3.0
}

/// The gradient of a scalar field at `p`, with step `h`.
pub fn gradient3(p: Point3, h: f32, f: impl Fn(Point3) -> f32) -> Vector3 {
    let along = |axis: Vector3| derivative(0.0, f64::from(h), |t| f64::from(f(p + axis * t as f32))) as f32;
    Vector3::new(along(Vector3::X), along(Vector3::Y), along(Vector3::Z))
}

/// ∂p/∂u and ∂p/∂v of a surface `p(u, v)`, with step `h`.
pub fn jacobian2(uv: Point2, h: f32, p: impl Fn(Point2) -> Point3) -> [Vector3; 2] {
    let step = |du: f32, dv: f32| p(Point2::new(uv.x + du, uv.y + dv));
    [(step(h, 0.0) - step(-h, 0.0)) / (2.0 * h), (step(0.0, h) - step(0.0, -h)) / (2.0 * h)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_known_functions() {
        assert!((derivative(0.7, 1e-2, f64::sin) - 0.7_f64.cos()).abs() < 1e-9);
        let gradient = gradient3(Point3::new(1.0, 2.0, 3.0), 1e-2, |p| p.x * p.y + p.z * p.z);
        assert!((gradient - Vector3::new(2.0, 1.0, 6.0)).length() < 1e-2);
        let [du, dv] = jacobian2(Point2::new(0.5, 0.25), 1e-2, |uv| Point3::new(uv.x, uv.y, uv.x * uv.y));
        assert!((du - Vector3::new(1.0, 0.0, 0.25)).length() < 1e-3);
        assert!((dv - Vector3::new(0.0, 1.0, 0.5)).length() < 1e-3);
    }
}

//! Directions drawn uniformly from what triangles and rectangles cover of the sphere around a point.
//!
//! # References
//! [Van Oosterom and Strackee 1983] "The Solid Angle of a Plane Triangle"; [Arvo 1995] "Stratified Sampling of Spherical
//! Triangles"; [Ureña et al. 2013] "An Area-Preserving Parametrization for Spherical Rectangles".

use std::f64::consts::{PI, TAU};

use crate::{Point2, Point3, Vector3};

type Wide = [f64; 3];

fn wide(v: Vector3) -> Wide {
    v.to_array().map(f64::from)
}

fn narrow(v: Wide) -> Vector3 {
    Vector3::from(v.map(|x| x as f32))
}

fn dot(a: Wide, b: Wide) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Wide, b: Wide) -> Wide {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// a + s b.
fn add(a: Wide, b: Wide, s: f64) -> Wide {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// A unit vector; `None` of zero or what is not finite.
fn unit(a: Wide) -> Option<Wide> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}

/// What a triangle covers of the sphere around a point.
#[derive(Clone, Copy, Debug)]
pub struct SphericalTriangle {
    corners: [Wide; 3],
    solid_angle: f64,
}

impl SphericalTriangle {
    /// The triangle seen from `reference`; `None` where the point lies in a corner.
    #[inline]
    pub fn new(reference: Point3, triangle: [Point3; 3]) -> Option<Self> {
        let [a, b, c] = triangle.map(|p| unit(wide(p - reference)));
        let [a, b, c] = [a?, b?, c?];
        let volume = dot(a, cross(b, c)).abs();
        let solid_angle = 2.0 * volume.atan2(1.0 + dot(a, b) + dot(b, c) + dot(c, a));
        Some(Self { corners: [a, b, c], solid_angle })
    }

    /// The solid angle, steradian.
    #[inline]
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// A unit direction, uniform over the solid angle [Arvo 1995]; `None` where the triangle is seen from its side.
    pub fn sample(&self, u: Point2) -> Option<Vector3> {
        let [a, b, c] = self.corners;
        let (ab, bc, ca) = (unit(cross(a, b))?, unit(cross(b, c))?, unit(cross(c, a))?);
        // Interior angles, and the excess of the part that the first number cuts off.
        let angle = |m: Wide, n: Wide| (-dot(m, n)).clamp(-1.0, 1.0).acos();
        let (alpha, beta, gamma) = (angle(ab, ca), angle(bc, ab), angle(ca, bc));
        let excess = (alpha + beta + gamma - PI) * f64::from(u.x);
        let (sin_alpha, cos_alpha) = alpha.sin_cos();
        let (sin_phi, cos_phi) = (excess - alpha).sin_cos();
        let (k1, k2) = (cos_phi - cos_alpha, sin_phi + sin_alpha * dot(a, b));
        let below = (k2 * sin_phi + k1 * cos_phi) * sin_alpha;
        let cos_b = if below == 0.0 { 1.0 } else { ((k2 * cos_phi - k1 * sin_phi) * cos_alpha - k2) / below };
        let cos_b = cos_b.clamp(-1.0, 1.0);
        let sin_b = (1.0 - cos_b * cos_b).sqrt();
        let towards_c = unit(add(c, a, -dot(c, a)))?;
        let third = add(a.map(|x| x * cos_b), towards_c, sin_b);
        let cos_theta = 1.0 - f64::from(u.y) * (1.0 - dot(third, b));
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let Some(away) = unit(add(third, b, -dot(third, b))) else { return Some(narrow(b)) };
        Some(narrow(add(b.map(|x| x * cos_theta), away, sin_theta)))
    }
}

/// What a rectangle covers of the sphere around a point [Ureña et al. 2013].
#[derive(Clone, Copy, Debug)]
pub struct SphericalRectangle {
    /// Ends of the rectangle along its sides, and its distance, from the point.
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    b0: f64,
    b1: f64,
    k: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle with a corner, two sides at right angles and their lengths, seen from `reference`. `None` from points of
    /// its plane.
    #[inline]
    pub fn new(reference: Point3, corner: Point3, sides: [Vector3; 2]) -> Option<Self> {
        let d = wide(corner - reference);
        let [ex, ey] = sides.map(wide);
        let lengths = [dot(ex, ex).sqrt(), dot(ey, ey).sqrt()];
        let (x, y) = (unit(ex)?, unit(ey)?);
        let (x0, y0, z) = (dot(d, x), dot(d, y), -dot(d, cross(x, y)).abs());
        let (x1, y1) = (x0 + lengths[0], y0 + lengths[1]);
        if z >= 0.0 {
            return None;
        }
        // Normals of the planes through the point and a side each: along z, and along the side's distance.
        let n = |a: f64| {
            let length = (z * z + a * a).sqrt();
            (z / length, a / length)
        };
        let [(_, ny0), (_, nx1), (_, ny1), (_, nx0)] = [n(y0), n(x1), n(y1), n(x0)];
        let (n0, n1, n2, n3) = (-ny0, nx1, ny1, -nx0);
        let angle = |p: f64, q: f64| (-(p * q)).clamp(-1.0, 1.0).acos();
        let (g0, g1, g2, g3) = (angle(n0, n1), angle(n1, n2), angle(n2, n3), angle(n3, n0));
        let k = TAU - g2 - g3;
        let solid_angle = g0 + g1 - k;
        Some(Self { x: [x0, x1], y: [y0, y1], z, b0: n0, b1: n2, k, solid_angle })
    }

    /// The solid angle, steradian.
    #[inline]
    pub fn solid_angle(&self) -> f32 {
        self.solid_angle as f32
    }

    /// A place on the rectangle in [0, 1]², whose direction is uniform over the solid angle.
    pub fn sample(&self, u: Point2) -> Point2 {
        let (sin, cos) = (f64::from(u.x) * self.solid_angle + self.k).sin_cos();
        let f = (cos * self.b0 - self.b1) / sin;
        let c = (1.0 / (f * f + self.b0 * self.b0).sqrt()).copysign(f).clamp(-1.0, 1.0);
        let [x0, x1] = self.x;
        let x = (-(c * self.z) / (1.0 - c * c).max(1e-300).sqrt()).clamp(x0, x1);
        let d2 = x * x + self.z * self.z;
        let [y0, y1] = self.y;
        let [h0, h1] = [y0, y1].map(|y| y / (d2 + y * y).sqrt());
        let h = h0 + f64::from(u.y) * (h1 - h0);
        let y = if h * h < 1.0 - 1e-12 { h * d2.sqrt() / (1.0 - h * h).sqrt() } else { y1 };
        let place = |v: f64, [low, high]: [f64; 2]| ((v - low) / (high - low)).clamp(0.0, 1.0) as f32;
        Point2::new(place(x, self.x), place(y, self.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let corners = [Vector3::X, Vector3::Y, Vector3::Z].map(|v| Point3::ORIGIN + v * 3.0);
        let octant = SphericalTriangle::new(Point3::ORIGIN, corners).unwrap();
        assert!((octant.solid_angle() - std::f32::consts::FRAC_PI_2).abs() < 1e-6);
        // A square seen from the middle of its cube covers a sixth.
        let sides = [Vector3::X * 2.0, Vector3::Y * 2.0];
        let face = SphericalRectangle::new(Point3::ORIGIN, Point3::new(-1.0, -1.0, 1.0), sides).unwrap();
        assert!((f64::from(face.solid_angle()) - 4.0 * PI / 6.0).abs() < 1e-6, "{face:?}");
        assert!(SphericalRectangle::new(Point3::ORIGIN, Point3::new(-1.0, -1.0, 0.0), sides).is_none());
    }

    /// Uniform in solid angle: the mean of a place's density by area is what the geometry says.
    #[test]
    fn draws_cover_the_solid_angle_evenly() {
        let reference = Point3::new(0.3, -0.2, 0.1);
        let corner = Point3::new(-1.0, -0.5, 0.6);
        let sides = [Vector3::X * 1.5, Vector3::Y * 1.0];
        let rectangle = SphericalRectangle::new(reference, corner, sides).unwrap();
        let triangles = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0_f32]]
            .map(|[s, t]| corner + sides[0] * s + sides[1] * t);
        let [a, b, c, d] = triangles;
        let halves = [[a, b, c], [a, c, d]].map(|t| SphericalTriangle::new(reference, t).unwrap());
        let sum = halves[0].solid_angle() + halves[1].solid_angle();
        assert!((sum - rectangle.solid_angle()).abs() < 1e-5 * sum, "{sum} {rectangle:?}");
        // Regular numbers: the integral of 1 and of x over the solid angle, by area and by draws.
        const N: usize = 300;
        let grid = |i: usize| (i as f32 + 0.5) / N as f32;
        let (mut by_area, mut by_rectangle, mut by_triangles) = ([0.0_f64; 3], [0.0_f64; 3], [0.0_f64; 3]);
        for i in 0..N * N {
            let u = Point2::new(grid(i % N), grid(i / N));
            let moments = |w: Vector3, weight: f32, sums: &mut [f64; 3]| {
                for (sum, x) in sums.iter_mut().zip([1.0, w.x, w.y]) {
                    *sum += f64::from(x * weight) / (N * N) as f64;
                }
            };
            let p = corner + sides[0] * u.x + sides[1] * u.y - reference;
            let area = p.z / (p.length() * p.length_squared()) * 1.5;
            moments(p.normalized(), area, &mut by_area);
            let s = rectangle.sample(u);
            let w = (corner + sides[0] * s.x + sides[1] * s.y - reference).normalized();
            moments(w, rectangle.solid_angle(), &mut by_rectangle);
            for half in &halves {
                moments(half.sample(u).unwrap(), half.solid_angle(), &mut by_triangles);
            }
        }
        for i in 0..3 {
            assert!((by_area[i] - by_rectangle[i]).abs() < 1e-4, "{by_area:?} {by_rectangle:?}");
            assert!((by_area[i] - by_triangles[i]).abs() < 1e-4, "{by_area:?} {by_triangles:?}");
        }
    }
}

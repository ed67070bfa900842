//! Rays against the tube that a circle sweeps along a cubic curve.
//!
//! The curve is halved until its pieces are nearly straight, in a frame where the ray is an axis, so that pieces the ray
//! cannot meet are dropped by a box test. What is left starts Newton's method from a straight cylinder.

use aureole_math::{Bounds3, Point3, Ray};

use crate::shape::spline::Cubic;

/// A hit with a curve: ray parameter and curve parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub t: f64,
    pub u: f64,
}

type Vec3 = [f64; 3];

fn dot(a: &Vec3, b: &Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn spatial(p: &[f64; 4]) -> Vec3 {
    [p[0], p[1], p[2]]
}

/// The box around a tube, from the hull of its control points.
pub(super) fn bounds(curve: &Cubic<4>) -> Bounds3 {
    curve.0.iter().fold(Bounds3::EMPTY, |all, p| {
        let corner = |sign: f64| Point3::from(std::array::from_fn(|i| (p[i] + sign * p[3]) as f32));
        all.union(Bounds3::new(corner(-1.0), corner(1.0)))
    })
}

/// The nearest hit within a ray's range; of the outside alone, or of both sides.
pub(super) fn closest_hit(curve: &Cubic<4>, ray: &Ray, cull_back: bool) -> Option<Hit> {
    let frame = RayFrame::new(ray)?;
    let curve = Cubic(curve.0.map(|p| frame.local(p)));
    let radius = curve.0.iter().map(|p| p[3]).fold(0.0, f64::max);
    if radius <= 0.0 {
        return None;
    }
    // A tenth of the radius off its chord: near enough for Newton's method.
    let depth = curve.halvings(0.1 * radius, 10);
    let mut search = Search { t_min: frame.t_min, t_max: frame.t_max, cull_back, best: None };
    search.descend(&curve, 0.0, 1.0, depth);
    search.best.map(|hit| Hit { t: hit.t / frame.speed, ..hit })
}

/// Space with the ray's origin at 0 and its direction along Z; lengths are kept.
struct RayFrame {
    origin: Vec3,
    axes: [Vec3; 3],
    speed: f64,
    t_min: f64,
    t_max: f64,
}

impl RayFrame {
    fn new(ray: &Ray) -> Option<Self> {
        let d = ray.direction.to_array().map(f64::from);
        let speed = dot(&d, &d).sqrt();
        if !(speed > 0.0 && speed.is_finite()) {
            return None;
        }
        let z = d.map(|x| x / speed);
        // [Duff et al. 2017] "Building an Orthonormal Basis, Revisited".
        let sign = 1f64.copysign(z[2]);
        let a = -1.0 / (sign + z[2]);
        let b = z[0] * z[1] * a;
        let x = [1.0 + sign * z[0] * z[0] * a, sign * b, -sign * z[0]];
        let y = [b, sign + z[1] * z[1] * a, -z[1]];
        let origin = ray.origin.to_array().map(f64::from);
        let [t_min, t_max] = [ray.t_min, ray.t_max].map(|t| f64::from(t) * speed);
        Some(Self { origin, axes: [x, y, z], speed, t_min, t_max })
    }

    fn local(&self, p: [f64; 4]) -> [f64; 4] {
        let from = std::array::from_fn(|i| p[i] - self.origin[i]);
        let [x, y, z] = [0, 1, 2].map(|i| dot(&self.axes[i], &from));
        [x, y, z, p[3]]
    }
}

/// The search for the nearest hit along +Z.
struct Search {
    t_min: f64,
    t_max: f64,
    cull_back: bool,
    best: Option<Hit>,
}

impl Search {
    fn descend(&mut self, piece: &Cubic<4>, u0: f64, u1: f64, depth: u32) {
        if !self.may_meet(piece) {
            return;
        }
        if depth == 0 {
            return self.straight(piece, u0, u1);
        }
        let middle = 0.5 * (u0 + u1);
        let [low, high] = piece.halves();
        self.descend(&low, u0, middle, depth - 1);
        self.descend(&high, middle, u1, depth - 1);
    }

    /// Whether the ray runs through the box around a piece.
    fn may_meet(&self, piece: &Cubic<4>) -> bool {
        let radius = piece.0.iter().map(|p| p[3]).fold(0.0, f64::max);
        let range = |axis: usize| {
            let each = piece.0.iter().map(|p| p[axis]);
            each.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let around_ray = |[low, high]: [f64; 2]| low <= radius && high >= -radius;
        let [low, high] = range(2);
        around_ray(range(0))
            && around_ray(range(1))
            && low - radius < self.t_max
            && high + radius > self.t_min
    }

    /// Meets a nearly straight piece: the roots of the cylinder around its chord are where Newton's method starts.
    fn straight(&mut self, piece: &Cubic<4>, u0: f64, u1: f64) {
        let (a, b) = (spatial(&piece.0[0]), spatial(&piece.0[3]));
        let chord: Vec3 = std::array::from_fn(|i| b[i] - a[i]);
        let length2 = dot(&chord, &chord);
        if length2 <= 0.0 {
            return;
        }
        let radius = 0.5 * (piece.0[0][3] + piece.0[3][3]);
        // Distance from the axis: |q⊥|² with q = t Z - a, both freed of their part along the chord.
        let across: Vec3 =
            std::array::from_fn(|i| f64::from(u8::from(i == 2)) - chord[2] * chord[i] / length2);
        let along = dot(&a, &chord) / length2;
        let from: Vec3 = std::array::from_fn(|i| along * chord[i] - a[i]);
        let qa = dot(&across, &across);
        let (qb, qc) = (dot(&across, &from), dot(&from, &from) - radius * radius);
        let (middle, half) = if qa > 1e-9 {
            (-qb / qa, (qb * qb - qa * qc).max(0.0).sqrt() / qa)
        } else {
            // Along the axis: somewhere about the middle.
            (0.5 * (a[2] + b[2]), 0.5 * chord[2].abs())
        };
        let sides: &[f64] = if self.cull_back { &[-1.0] } else { &[-1.0, 1.0] };
        for side in sides {
            let t = middle + side * half;
            let u = ((t * chord[2]) / length2 - along).clamp(0.0, 1.0);
            self.refine(piece, t, u, u0, u1);
        }
    }

    /// Newton's method for (q·c', |q|² - r²) = 0 with q = t Z - c(u): q is perpendicular to the curve, and r long.
    fn refine(&mut self, piece: &Cubic<4>, mut t: f64, mut u: f64, u0: f64, u1: f64) {
        const STEPS: usize = 16;
        const SLACK: f64 = 1e-7;
        for _ in 0..STEPS {
            let at = piece.at(u);
            let (c, d1, d2) = (spatial(&at.value), spatial(&at.first), spatial(&at.second));
            let (r, dr) = (at.value[3], at.first[3]);
            let q = [-c[0], -c[1], t - c[2]];
            let f = [dot(&q, &d1), dot(&q, &q) - r * r];
            let du = [dot(&q, &d2) - dot(&d1, &d1), -2.0 * (f[0] + r * dr)];
            let dt = [d1[2], 2.0 * q[2]];
            let det = du[0] * dt[1] - du[1] * dt[0];
            let step_u = (f[0] * dt[1] - f[1] * dt[0]) / det;
            let step_t = (du[0] * f[1] - du[1] * f[0]) / det;
            if !(step_u.is_finite() && step_t.is_finite()) {
                return;
            }
            u = (u - step_u.clamp(-0.5, 0.5)).clamp(-0.5, 1.5);
            // Beyond its ends the radius may be negative.
            let stride = 4.0 * r.abs();
            t -= step_t.clamp(-stride, stride);
            if step_u.abs() < 1e-8 && step_t.abs() < 1e-8 * (r + t.abs()) {
                let is_inside = (-SLACK..=1.0 + SLACK).contains(&u);
                // Outside, the gradient of |q| - r along the curve's normal plane faces the ray.
                let stretch = -du[0];
                let normal_z = q[2] * stretch - r * dr * d1[2];
                let is_seen = !self.cull_back || normal_z < 0.0;
                if is_inside && is_seen && t > self.t_min && t < self.t_max {
                    self.t_max = t;
                    self.best = Some(Hit { t, u: u0 + u.clamp(0.0, 1.0) * (u1 - u0) });
                }
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_below_zero_are_met_by_nothing_worse_than_a_miss() {
        // From thick to thinner than nothing: Newton's method wanders where the radius is negative.
        let point = |x: f64, r: f64| [x, 0.1, 2.0 + 0.3 * x, r];
        let piece = Cubic([point(-1.0, 1.0), point(-0.3, -3.0), point(0.3, -3.0), point(1.0, 1.0)]);
        for i in 0..64 {
            let u = f64::from(i) / 63.0;
            let mut search = Search { t_min: 0.0, t_max: f64::INFINITY, cull_back: false, best: None };
            search.refine(&piece, 1.0, u, 0.0, 1.0);
            assert!(search.best.is_none_or(|hit| hit.t.is_finite()));
        }
    }
}

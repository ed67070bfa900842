//! Straight pieces of a tube: the hull of two balls, which is a cone with round ends.

use aureole_math::{Bounds3, Point3, Ray};

use super::sweep::Hit;

type Vec3 = [f64; 3];

fn dot(a: &Vec3, b: &Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sub(a: &Vec3, b: &Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The hull of two balls.
///
/// Its side touches both balls where their normals n have n·D = s, with D the unit axis and s = (r0 - r1) / length.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoundCone {
    ends: [Vec3; 2],
    radii: [f64; 2],
    axis: Vec3,
    length: f64,
    /// Unit axis; zero where there is no side because one ball contains the other.
    direction: Vec3,
    sine: f64,
}

/// The pieces before and after in a chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbours {
    pub previous: Option<RoundCone>,
    pub next: Option<RoundCone>,
}

impl RoundCone {
    pub(super) fn new(a: [f64; 4], b: [f64; 4]) -> Self {
        let ends = [[a[0], a[1], a[2]], [b[0], b[1], b[2]]];
        let radii = [a[3], b[3]];
        let axis = sub(&ends[1], &ends[0]);
        let length = dot(&axis, &axis).sqrt();
        let has_side = length > (radii[0] - radii[1]).abs();
        let direction = if has_side { axis.map(|x| x / length) } else { [0.0; 3] };
        let sine = if has_side { (radii[0] - radii[1]) / length } else { 0.0 };
        Self { ends, radii, axis, length, direction, sine }
    }

    fn has_side(&self) -> bool {
        self.direction != [0.0; 3]
    }

    /// From the first end to the second.
    pub(super) fn axis(&self) -> Vec3 {
        self.axis
    }

    /// By how much the radius grows from the first end to the second.
    fn widening(&self) -> f64 {
        self.radii[1] - self.radii[0]
    }

    /// Centre and radius of the ball at a place along the piece.
    pub(super) fn ball(&self, v: f64) -> (Vec3, f64) {
        (std::array::from_fn(|i| self.ends[0][i] + v * self.axis[i]), self.radii[0] + v * self.widening())
    }

    pub(super) fn bounds(&self) -> Bounds3 {
        let around = |(p, r): (&Vec3, f64)| {
            let corner = |sign: f64| Point3::from(std::array::from_fn(|i| (p[i] + sign * r) as f32));
            Bounds3::new(corner(-1.0), corner(1.0))
        };
        around((&self.ends[0], self.radii[0])).union(around((&self.ends[1], self.radii[1])))
    }

    /// Where along the piece the ball is that touches the surface nearest to a point.
    fn touching(&self, p: &Vec3) -> f64 {
        if !self.has_side() {
            return if self.radii[1] > self.radii[0] { 1.0 } else { 0.0 };
        }
        let q = sub(p, &self.ends[0]);
        let z = dot(&q, &self.direction);
        let rho = (dot(&q, &q) - z * z).max(0.0).sqrt();
        let cosine = (1.0 - self.sine * self.sine).sqrt();
        ((z - rho * self.sine / cosine) / self.length).clamp(0.0, 1.0)
    }

    /// Whether a point lies inside, by more than rounding.
    fn contains(&self, p: &Vec3) -> bool {
        let (center, radius) = self.ball(self.touching(p));
        let q = sub(p, &center);
        dot(&q, &q) < radius * radius * (1.0 - 1e-6)
    }

    /// The nearest hit with what is left of the piece's surface in its chain. `u` of a hit is its [`ball`](Self::ball).
    pub(super) fn closest_hit(&self, ray: &Ray, neighbours: &Neighbours, cull_back: bool) -> Option<Hit> {
        let o = ray.origin.to_array().map(f64::from);
        let d = ray.direction.to_array().map(f64::from);
        let [t_min, mut t_max] = [ray.t_min, ray.t_max].map(f64::from);
        let mut best = None;
        let mut consider = |t: f64, v: f64, ends: [bool; 2]| {
            if !(t > t_min && t < t_max) {
                return;
            }
            let p: Vec3 = std::array::from_fn(|i| o[i] + t * d[i]);
            let (center, _) = self.ball(v);
            let is_seen = !cull_back || dot(&sub(&p, &center), &d) < 0.0;
            // The far ball belongs to this piece, the near one to the piece before if there is one.
            let is_hidden = (ends[0] && neighbours.previous.is_some())
                || (ends != [false; 2] && self.has_side() && (1e-9..1.0 - 1e-9).contains(&self.touching(&p)))
                || neighbours.previous.is_some_and(|other| other.contains(&p))
                || neighbours.next.is_some_and(|other| other.contains(&p));
            if is_seen && !is_hidden {
                t_max = t;
                best = Some(Hit { t, u: v });
            }
        };
        for (t, v) in self.side_hits(&o, &d).into_iter().flatten() {
            consider(t, v, [false; 2]);
        }
        for end in [0, 1] {
            if !self.has_side() && self.radii[end] < self.radii[1 - end] {
                continue;
            }
            let q = sub(&o, &self.ends[end]);
            for t in
                roots(dot(&d, &d), dot(&q, &d), dot(&q, &q) - self.radii[end].powi(2)).into_iter().flatten()
            {
                consider(t, end as f64, [end == 0, end == 1]);
            }
        }
        best
    }

    /// Hits of a line with the side: |q|² - z² = (r0 - z s)² / (1 - s²), z the height along the axis.
    fn side_hits(&self, o: &Vec3, d: &Vec3) -> Option<[(f64, f64); 2]> {
        if !self.has_side() {
            return None;
        }
        let (s, r0) = (self.sine, self.radii[0]);
        let cos2 = 1.0 - s * s;
        let q = sub(o, &self.ends[0]);
        let (z, dz) = (dot(&q, &self.direction), dot(d, &self.direction));
        let (w, dw) = (r0 - z * s, -dz * s);
        let [t0, t1] = roots(
            dot(d, d) - dz * dz - dw * dw / cos2,
            dot(&q, d) - z * dz - w * dw / cos2,
            dot(&q, &q) - z * z - w * w / cos2,
        )?;
        let place = |t: f64| {
            let v = (z + t * dz - s * r0) / (cos2 * self.length);
            let on_cone = w + t * dw >= 0.0 && (0.0..=1.0).contains(&v);
            (if on_cone { t } else { f64::NAN }, v)
        };
        Some([place(t0), place(t1)])
    }
}

/// Roots of a t² + 2 b t + c = 0.
fn roots(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    Some([q / a, c / q])
}

#[cfg(test)]
mod tests {
    use super::*;
    use aureole_math::Vector3;

    const ALONE: Neighbours = Neighbours { previous: None, next: None };

    fn hit(cone: &RoundCone, o: [f32; 3], d: [f32; 3]) -> Option<f64> {
        cone.closest_hit(&Ray::new(Point3::from(o), Vector3::from(d)), &ALONE, true).map(|hit| hit.t)
    }

    #[test]
    fn a_capsule_is_a_cylinder_with_balls() {
        let capsule = RoundCone::new([0.0, 0.0, 0.0, 0.5], [2.0, 0.0, 0.0, 0.5]);
        assert!((hit(&capsule, [1.0, 0.0, 3.0], [0.0, 0.0, -1.0]).expect("side") - 2.5).abs() < 1e-9);
        assert!((hit(&capsule, [5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]).expect("end") - 2.5).abs() < 1e-9);
        assert!(hit(&capsule, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]).is_none());
    }

    #[test]
    fn a_ball_may_contain_the_other() {
        let nested = RoundCone::new([0.0, 0.0, 0.0, 1.0], [0.2, 0.0, 0.0, 0.1]);
        assert!((hit(&nested, [3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]).expect("the large one") - 2.0).abs() < 1e-9);
        let point = RoundCone::new([0.0; 4], [0.0; 4]);
        assert!(hit(&point, [0.0, 0.0, 3.0], [0.0, 0.0, -1.0]).is_none());
    }
}

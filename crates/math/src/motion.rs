//! Transforms that change with time.

use glam::{DMat3, DMat4, DQuat, DVec3};

use crate::{Bounds3, Point3, Transform};

/// A map that moves from one transform to another while time goes from 0 to 1.
///
/// # Maths
/// Each end is taken apart into M = T R S: translation, rotation and a symmetric stretch (polar decomposition). T and S are
/// interpolated linearly, R along the shorter great arc of unit quaternions, so that a turning wheel keeps its size.
///
/// # References
/// [Shoemake and Duff 1992] "Matrix Animation and Polar Decomposition".
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    keys: [Transform; 2],
    translation: [DVec3; 2],
    rotation: [DQuat; 2],
    stretch: [DMat3; 2],
}

/// Pieces of the arc whose ends are in [`Motion::bounds`] themselves.
const PIECES: u32 = 32;

impl Motion {
    /// From where it is at time 0 to where it is at time 1; `None` where one of the two is projective or has no inverse.
    pub fn new(start: Transform, end: Transform) -> Option<Self> {
        let [(t0, r0, s0), (t1, r1, s1)] = [decomposed(&start)?, decomposed(&end)?];
        let r1 = if r0.dot(r1) < 0.0 { -r1 } else { r1 };
        Some(Self { keys: [start, end], translation: [t0, t1], rotation: [r0, r1], stretch: [s0, s1] })
    }

    /// Where it is at times 0 and 1.
    pub fn keys(&self) -> &[Transform; 2] {
        &self.keys
    }

    /// Where it is at a time; before 0 and after 1 it rests.
    ///
    /// Without inverse where a map turns into its mirror image on the way.
    pub fn at(&self, time: f32) -> Transform {
        if time <= 0.0 || time.is_nan() || self.keys[0] == self.keys[1] {
            return self.keys[0];
        }
        if time >= 1.0 {
            return self.keys[1];
        }
        let s = f64::from(time);
        let [t0, t1] = self.translation;
        let [s0, s1] = self.stretch;
        let rotation = DMat3::from_quat(self.turned(s));
        let stretch = s0 + (s1 - s0) * s;
        let translation = t0 + (t1 - t0) * s;
        let matrix = rotation * stretch;
        let inverse = stretch.inverse() * rotation.transpose();
        let affine = |linear: DMat3, shift: DVec3| {
            let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis].map(|axis| axis.extend(0.0));
            DMat4::from_cols(x, y, z, shift.extend(1.0))
        };
        Transform::of(affine(matrix, translation), affine(inverse, -(inverse * translation)))
    }

    /// Half the angle between the ends.
    fn half_angle(&self) -> f64 {
        self.rotation[0].dot(self.rotation[1]).clamp(-1.0, 1.0).acos()
    }

    /// The rotation at a time, at constant speed.
    fn turned(&self, s: f64) -> DQuat {
        let [a, b] = self.rotation;
        let half = self.half_angle();
        let (a_share, b_share) =
            if half < 1e-6 { (1.0 - s, s) } else { ((half * (1.0 - s)).sin(), (half * s).sin()) };
        (a * a_share + b * b_share).normalize()
    }

    /// A box around a box at all times from 0 to 1.
    ///
    /// # Maths
    /// A corner p is at x(s) = T(s) + R(s) S(s) p, whose acceleration is at most ω² |S p| + 2 ω |S' p|, with ω the angle from
    /// end to end. Between two places h apart in time it leaves their chord by no more than h²/8 times that.
    pub fn bounds(&self, b: &Bounds3) -> Bounds3 {
        if b.is_empty() {
            return *b;
        }
        let omega = 2.0 * self.half_angle();
        let [s0, s1] = self.stretch;
        let pieces = if omega == 0.0 { 1 } else { PIECES };
        let step = 1.0 / f64::from(pieces);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut acceleration: f64 = 0.0;
        for corner in b.corners() {
            let p = DVec3::from_array(corner.to_array().map(f64::from));
            let reach = (s0 * p).length().max((s1 * p).length());
            acceleration = acceleration.max(omega * omega * reach + 2.0 * omega * ((s1 - s0) * p).length());
            for i in 0..=pieces {
                let at = self.at(i as f32 / pieces as f32).point_f64(p.to_array());
                low = low.min(DVec3::from_array(at));
                high = high.max(DVec3::from_array(at));
            }
        }
        // The rest is rounding: of single precision where boxes and rays are moved.
        let slack = acceleration * step * step / 8.0 + 1e-6 * low.abs().max(high.abs()).max_element();
        let point = |p: DVec3| Point3::new(p.x as f32, p.y as f32, p.z as f32);
        Bounds3 { min: point(low - slack), max: point(high + slack) }
    }
}

/// Translation, rotation and stretch.
fn decomposed(transform: &Transform) -> Option<(DVec3, DQuat, DMat3)> {
    let rows = transform.rows();
    if rows[3] != [0.0, 0.0, 0.0, 1.0] || !transform.is_invertible() {
        return None;
    }
    let matrix = DMat4::from_cols_array_2d(&rows).transpose();
    let linear = DMat3::from_mat4(matrix);
    // The nearest rotation: the average with its own inverse transpose, over and over. Scaled first, to converge quickly.
    let mut rotation = linear * linear.determinant().abs().cbrt().recip();
    for _ in 0..100 {
        let next = (rotation + rotation.inverse().transpose()) * 0.5;
        let change =
            (next - rotation).to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        rotation = next;
        if change < 1e-14 {
            break;
        }
    }
    if rotation.determinant() < 0.0 {
        rotation *= -1.0; // a mirror is part of the stretch
    }
    let stretch = rotation.transpose() * linear;
    let quaternion = DQuat::from_mat3(&rotation).normalize();
    (quaternion.is_finite() && stretch.is_finite()).then(|| (matrix.w_axis.truncate(), quaternion, stretch))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pcg32, Vector3};

    fn placed(rng: &mut Pcg32) -> Transform {
        let mut number = || rng.next_f32() * 2.0 - 1.0;
        let mut vector = || Vector3::new(number(), number(), number());
        Transform::translate(vector() * 3.0)
            * Transform::rotate(vector(), 170.0)
            * Transform::scale(vector().abs() + Vector3::splat(0.2))
            * Transform::rotate(vector(), 50.0)
    }

    #[test]
    fn begins_and_ends_at_its_keys() {
        let mut rng = Pcg32::new(5);
        for _ in 0..200 {
            let [start, end] = [placed(&mut rng), placed(&mut rng)];
            let motion = Motion::new(start, end).unwrap();
            let p = Point3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            assert_eq!(motion.at(0.0), start);
            assert_eq!(motion.at(1.0), end);
            assert_eq!(motion.at(f32::NAN), start);
            // Nor does it jump beside them.
            assert!(motion.at(1e-6).point(p).distance(start.point(p)) < 1e-4);
            assert!(motion.at(1.0 - 1e-6).point(p).distance(end.point(p)) < 1e-4);
            let between = motion.at(0.4);
            assert!(between.inverse().point(between.point(p)).distance(p) < 1e-4);
        }
    }

    #[test]
    fn a_turn_keeps_its_radius() {
        let motion = Motion::new(Transform::IDENTITY, Transform::rotate(Vector3::Z, 120.0)).unwrap();
        let p = motion.at(0.5).point(Point3::new(1.0, 0.0, 0.0));
        assert!(p.distance(Point3::new(0.5, 0.75_f32.sqrt(), 0.0)) < 1e-6, "{p:?}");
    }

    #[test]
    fn the_box_holds_the_path() {
        let mut rng = Pcg32::new(6);
        for _ in 0..100 {
            let motion = Motion::new(placed(&mut rng), placed(&mut rng)).unwrap();
            let inner = Bounds3::new(Point3::new(-0.5, 0.2, 0.0), Point3::new(1.0, 0.3, 0.7));
            let outer = motion.bounds(&inner);
            let mut reached = Bounds3::EMPTY;
            for i in 0..=1000 {
                for corner in inner.corners() {
                    let p = motion.at(i as f32 / 1000.0).point(corner);
                    assert!(outer.contains(p), "{p:?} {outer:?}");
                    reached = reached.extend(p);
                }
            }
            assert!(outer.diagonal().length() < 1.03 * reached.diagonal().length());
        }
    }

    #[test]
    fn no_way_through_nothing() {
        let flat = Transform::scale(Vector3::new(1.0, 0.0, 1.0));
        assert!(Motion::new(Transform::IDENTITY, flat).is_none());
        let mirror = Transform::scale(Vector3::new(-1.0, 1.0, 1.0));
        assert!(Motion::new(mirror, mirror * Transform::translate(Vector3::X)).is_some());
    }
}

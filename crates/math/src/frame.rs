//! Orthonormal frames, and mirror and refracted directions within them.

use crate::Vector3;

/// An orthonormal frame: two tangents and a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First tangent: local +X.
    pub s: Vector3,
    /// Second tangent: local +Y.
    pub t: Vector3,
    /// Normal: local +Z.
    pub n: Vector3,
}

impl Frame {
    /// A frame around a unit normal.
    ///
    /// # References
    /// [Duff et al. 2017] "Building an Orthonormal Basis, Revisited", JCGT 6(1).
    #[inline]
    pub fn from_normal(n: Vector3) -> Self {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vector3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vector3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// A frame around a unit normal whose first tangent is as near to `tangent` as can be.
    #[inline]
    pub fn from_normal_and_tangent(n: Vector3, tangent: Vector3) -> Self {
        match (tangent - n * n.dot(tangent)).try_normalized() {
            Some(s) => Self { s, t: n.cross(s), n },
            None => Self::from_normal(n),
        }
    }

    /// World to local.
    #[inline]
    pub fn to_local(&self, v: Vector3) -> Vector3 {
        Vector3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local to world.
    #[inline]
    pub fn to_world(&self, v: Vector3) -> Vector3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }

    /// The frame seen from the other side: the normal turned round, the tangents kept.
    #[inline]
    pub fn flipped(&self) -> Self {
        Self { n: -self.n, ..*self }
    }
}

/// The unit vector at polar angle `theta` and azimuth `phi`, in radians.
#[inline]
pub fn spherical_direction(theta: f32, phi: f32) -> Vector3 {
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_phi, cos_phi) = phi.sin_cos();
    Vector3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// `wo` mirrored about `n`; both point away from the surface.
#[inline]
pub fn reflect(wo: Vector3, n: Vector3) -> Vector3 {
    n * (2.0 * wo.dot(n)) - wo
}

/// A refracted direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// The transmitted direction, away from the surface.
    pub wt: Vector3,
    /// The relative index along the path: transmitted side over incident side.
    pub eta: f32,
}

/// `wo` refracted through a surface with normal `n`; `None` under total internal reflection.
///
/// `eta` is the index on the side opposite to `n` over that on the side of `n`; `wo` may lie on either side.
///
/// # References
/// Snell's law as in [Pharr 2023] section 9.3.3.
#[inline]
pub fn refract(wo: Vector3, n: Vector3, eta: f32) -> Option<Refraction> {
    let cos = n.dot(wo);
    let (n, cos, eta) = if cos < 0.0 { (-n, -cos, 1.0 / eta) } else { (n, cos, eta) };
    let sin2_t = (1.0 - cos * cos).max(0.0) / (eta * eta);
    if sin2_t >= 1.0 {
        return None;
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    Some(Refraction { wt: -wo / eta + n * (cos / eta - cos_t), eta })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pcg32;

    #[test]
    fn frames_are_orthonormal() {
        let mut rng = Pcg32::new(1);
        for _ in 0..1000 {
            let n = crate::warp::square_to_uniform_sphere(rng.point2());
            for frame in [Frame::from_normal(n), Frame::from_normal_and_tangent(n, Vector3::X)] {
                assert!(frame.s.dot(frame.t).abs() < 1e-5 && frame.s.dot(frame.n).abs() < 1e-5);
                assert!((frame.s.cross(frame.t) - frame.n).length() < 1e-5);
                let v = Vector3::new(0.3, -0.4, 0.5);
                assert!((frame.to_local(frame.to_world(v)) - v).length() < 1e-5);
            }
        }
    }

    #[test]
    fn snells_law_holds_from_both_sides() {
        for z in [0.8_f32, -0.8] {
            let wo = Vector3::new((1.0 - z * z).sqrt(), 0.0, z);
            let eta = 1.5;
            let refraction = refract(wo, Vector3::Z, eta).unwrap();
            let ratio = if z > 0.0 { eta } else { 1.0 / eta };
            assert!((refraction.eta - ratio).abs() < 1e-6);
            assert!((wo.x - -refraction.wt.x * ratio).abs() < 1e-6);
            assert!(refraction.wt.z * z < 0.0);
        }
        assert_eq!(refract(Vector3::new(0.9, 0.0, -0.19_f32.sqrt()), Vector3::Z, 1.5), None);
    }
}

//! What a pixel covers of a surface.
//!
//! References: [Igehy 1999] "Tracing Ray Differentials"; [PBRT4, section 10.1] for the differentials that only know the camera.

use aureole_math::{Vector2, Vector3};

/// How position and surface parameters change from a pixel to the next, across and down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Change of position.
    pub dp: [Vector3; 2],
    /// Change of the surface's parameters.
    pub duv: [Vector2; 2],
}

impl Footprint {
    /// The footprint of changes of position on a surface whose position changes with its parameters by `dp_duv`; the parameters
    /// follow by least squares. `None` where the surface has no parameters.
    pub fn new(dp: [Vector3; 2], dp_duv: [Vector3; 2]) -> Option<Self> {
        let [u, v] = dp_duv;
        let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
        let inverse = 1.0 / (uu * vv - uv * uv);
        let solve = |p: Vector3| {
            let (pu, pv) = (u.dot(p), v.dot(p));
            Vector2::new(vv * pu - uv * pv, uu * pv - uv * pu) * inverse
        };
        let duv = dp.map(solve);
        duv.iter().all(|d| d.x.is_finite() && d.y.is_finite()).then_some(Self { dp, duv })
    }
}

/// A step from a pixel to the next at distance `d` from the camera, moved along the line of sight onto the plane with normal `n`.
/// Where the plane is seen from its edge the step stays finite.
pub(crate) fn onto_plane(step: Vector3, d: Vector3, n: Vector3) -> Vector3 {
    const MIN_COS: f32 = 0.01;
    let along = n.dot(d);
    let least = MIN_COS * d.length();
    let along = if along.abs() < least { least.copysign(along) } else { along };
    if along == 0.0 { step } else { step - d * (n.dot(step) / along) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_follow_positions() {
        let dp_duv = [Vector3::new(2.0, 0.0, 0.0), Vector3::new(1.0, 4.0, 0.0)];
        let dp = [dp_duv[0] * 0.3 + dp_duv[1] * 0.1, dp_duv[1] * -0.2];
        let found = Footprint::new(dp, dp_duv).unwrap();
        assert!((found.duv[0] - Vector2::new(0.3, 0.1)).length() < 1e-6, "{found:?}");
        assert!((found.duv[1] - Vector2::new(0.0, -0.2)).length() < 1e-6, "{found:?}");
        assert!(Footprint::new(dp, [Vector3::X, Vector3::X]).is_none());
    }

    #[test]
    fn steps_stay_on_the_plane() {
        let n = Vector3::new(0.2, 0.5, -1.0).normalized();
        let step = onto_plane(Vector3::X * 0.1, Vector3::new(0.3, 0.1, 2.0), n);
        assert!(n.dot(step).abs() < 1e-6);
        assert!(onto_plane(Vector3::X, Vector3::Y, Vector3::X).is_finite());
    }
}

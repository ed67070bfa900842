//! Helmholtz reciprocity: light may walk a path either way.

use aureole_math::{Pcg32, Vector3, warp};

/// A pair of directions that a function treats unequally.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymmetry {
    /// One direction.
    pub wo: Vector3,
    /// The other.
    pub wi: Vector3,
    /// f(wo, wi).
    pub forward: f32,
    /// f(wi, wo).
    pub backward: f32,
    /// |forward - backward| over the larger of the two, or over the floor; NaN and infinity count as 1.
    pub relative: f32,
}

/// The most unequal of `count` random pairs of directions over the sphere.
///
/// `f` is the value without cosine; values far below `floor` may differ, since rounding eats the tails of peaks. For transmission between media of index η, pass f · η² of the side that the
/// light arrives in ([Veach 1997], section 5.2). Deterministic for a seed: compare `relative` with a rounding bound such as 1e-3.
pub fn worst_asymmetry(
    count: usize,
    seed: u64,
    floor: f32,
    f: impl Fn(Vector3, Vector3) -> f32,
) -> Option<Asymmetry> {
    let mut rng = Pcg32::new(seed);
    let pairs = (0..count).map(|_| {
        let wo = warp::square_to_uniform_sphere(rng.point2());
        let wi = warp::square_to_uniform_sphere(rng.point2());
        let (forward, backward) = (f(wo, wi), f(wi, wo));
        Asymmetry { wo, wi, forward, backward, relative: relative_difference(forward, backward, floor) }
    });
    pairs.max_by(|a, b| a.relative.total_cmp(&b.relative))
}

fn relative_difference(a: f32, b: f32, floor: f32) -> f32 {
    if !(a.is_finite() && b.is_finite()) {
        return 1.0;
    }
    let largest = a.abs().max(b.abs()).max(floor);
    if largest > 0.0 { (a - b).abs() / largest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_is_not_symmetric() {
        let symmetric = worst_asymmetry(1000, 0, 0.0, |wo, wi| (wo.z * wi.z).max(0.0)).unwrap();
        assert!(symmetric.relative < 1e-6);
        let skewed = worst_asymmetry(1000, 0, 0.0, |wo, wi| (2.0 + wo.z + 1.1 * wi.z).max(0.0)).unwrap();
        assert!(skewed.relative > 0.02);
        assert_eq!(worst_asymmetry(10, 0, 0.0, |_, _| f32::NAN).unwrap().relative, 1.0);
    }
}

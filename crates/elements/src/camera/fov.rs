//! What an angle of view is measured along.

use aureole_desc::{Params, SceneError};

/// The side or diagonal of the image that an angle of view belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FovAxis {
    /// Its width.
    X,
    /// Its height.
    Y,
    /// Its diagonal.
    Diagonal,
    /// The shorter side.
    Smaller,
    /// The longer side.
    Larger,
}

impl FovAxis {
    pub(crate) fn from_params(params: &mut Params) -> Result<Self, SceneError> {
        params.one_of(
            "fov_axis",
            &[
                ("x", Self::X),
                ("y", Self::Y),
                ("diagonal", Self::Diagonal),
                ("smaller", Self::Smaller),
                ("larger", Self::Larger),
            ],
        )
    }

    /// The horizontal angle of view, in radians, for an angle along this axis and a ratio of width to height.
    pub fn horizontal(self, fov: f32, aspect: f32) -> f32 {
        let half = (0.5 * fov).tan();
        let half_width = match self {
            Self::X => half,
            Self::Y => half * aspect,
            Self::Diagonal => half * aspect / (1.0 + aspect * aspect).sqrt(),
            Self::Smaller => half * aspect.max(1.0),
            Self::Larger => half * aspect.min(1.0),
        };
        2.0 * half_width.atan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_agree() {
        let (fov, aspect) = (0.9_f32, 1.5);
        let wide = FovAxis::X.horizontal(fov, aspect);
        assert_eq!(wide, FovAxis::Larger.horizontal(fov, aspect));
        assert_eq!(FovAxis::Y.horizontal(fov, aspect), FovAxis::Smaller.horizontal(fov, aspect));
        assert!((wide - fov).abs() < 1e-6);
        let diagonal = 2.0 * ((0.45_f32).tan() * (1.0 + 1.0 / (aspect * aspect)).sqrt()).atan();
        assert!((FovAxis::Diagonal.horizontal(diagonal, aspect) - fov).abs() < 1e-6);
    }
}

//! A dielectric boundary, smooth or rough, drawn from both sides or from one.

use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::dielectric::Glass;
use super::lobe::Sides;
use super::microfacet::Microfacet;
use super::{DielectricLobe, LobeOps, LobeSample, RoughDielectricLobe, TransportMode};

/// A boundary, ready to be asked.
pub(super) enum Coat {
    Smooth(DielectricLobe),
    Rough(RoughDielectricLobe),
}

impl Coat {
    /// The boundary with these facets; none if it is smooth.
    pub(super) fn new(glass: Glass, surface: Option<Microfacet>) -> Self {
        match surface {
            Some(surface) => Self::Rough(RoughDielectricLobe { glass, surface }),
            None => Self::Smooth(DielectricLobe { glass }),
        }
    }

    pub(super) fn is_delta(&self) -> bool {
        matches!(self, Self::Smooth(_))
    }

    pub(super) fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        match self {
            Self::Smooth(_) => Spectrum::ZERO,
            Self::Rough(lobe) => lobe.eval(wo, wi, mode),
        }
    }

    pub(super) fn sample(
        &self,
        sides: Sides,
        wo: Vector3,
        uc: f32,
        u: Point2,
        mode: TransportMode,
    ) -> Option<LobeSample> {
        let drawn = match self {
            Self::Smooth(lobe) => lobe.sample_from(sides, wo, uc, mode),
            Self::Rough(lobe) => lobe.sample_from(sides, wo, uc, u, mode),
        };
        drawn.filter(|s| s.pdf_omega > 0.0 && s.wi.z != 0.0)
    }

    pub(super) fn pdf(&self, sides: Sides, wo: Vector3, wi: Vector3) -> f32 {
        match self {
            Self::Smooth(_) => 0.0,
            Self::Rough(lobe) => lobe.pdf_from(sides, wo, wi),
        }
    }
}

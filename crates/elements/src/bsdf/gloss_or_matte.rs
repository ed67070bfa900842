//! How directions are drawn from a gloss over a matte base.

use aureole_math::{Point2, Vector3, reflect, warp};

use super::microfacet::Microfacet;

/// Directions mirrored by visible facets, or spread by cosine. Both directions point to the upper side.
#[derive(Clone, Copy, Debug)]
pub(super) struct GlossOrMatte<'a> {
    /// The facets.
    pub surface: &'a Microfacet,
    /// The probability of drawing from them.
    pub gloss: f32,
}

impl GlossOrMatte<'_> {
    /// A direction; it may lie below the surface.
    #[inline]
    pub(super) fn sample(&self, wo: Vector3, uc: f32, u: Point2) -> Vector3 {
        if uc < self.gloss {
            reflect(wo, self.surface.sample_visible(wo, u))
        } else {
            warp::square_to_cosine_hemisphere(u)
        }
    }

    /// Its density per steradian.
    #[inline]
    pub(super) fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        self.gloss * self.surface.pdf_mirrored(wo, wi)
            + (1.0 - self.gloss) * warp::cosine_hemisphere_pdf(wi.z)
    }
}

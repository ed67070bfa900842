//! Rougher lobes, which let light be found that mirrors and windows hide from light samples.
//!
//! Surfaces on a path after its first bounce that was no mirror's or window's may be roughened without much harm: what
//! they show is blurred already. The picture changes a little, its noise much.
//!
//! # References
//! [Pharr, Jakob and Humphreys 2023] "Physically Based Rendering", section 14.3.4: "Path Regularization".

use super::layered::Base;
use super::microfacet::{Distribution, Microfacet, Shadowing};
use super::{LayeredLobe, Lobe, RoughConductorLobe, RoughDielectricLobe};

/// A width of facets, or a wider one.
fn roughened(alpha: f32) -> f32 {
    if alpha < 0.3 { (2.0 * alpha).clamp(0.1, 0.3) } else { alpha }
}

impl Microfacet {
    fn regularized(self) -> Self {
        Self { alpha_u: roughened(self.alpha_u), alpha_v: roughened(self.alpha_v), ..self }
    }
}

/// Facets, also for what had none.
fn facets(surface: Option<Microfacet>) -> Microfacet {
    let smooth = || Microfacet::new(Distribution::Ggx, 0.0, 0.0).with_shadowing(Shadowing::HeightCorrelated);
    surface.unwrap_or_else(smooth).regularized()
}

impl Lobe {
    /// The lobe with facets of a roughness of at least 0.1, and twice its own up to 0.3, if it is that of a metal, of glass or
    /// of a coat; itself otherwise.
    pub(super) fn regularized(&self) -> Self {
        match self {
            Self::Conductor(lobe) => RoughConductorLobe { metal: lobe.metal, surface: facets(None) }.into(),
            Self::RoughConductor(lobe) => {
                RoughConductorLobe { surface: lobe.surface.regularized(), ..*lobe }.into()
            }
            Self::Dielectric(lobe) => RoughDielectricLobe { glass: lobe.glass, surface: facets(None) }.into(),
            Self::RoughDielectric(lobe) => {
                RoughDielectricLobe { surface: lobe.surface.regularized(), ..*lobe }.into()
            }
            Self::Layered(lobe) => {
                let base = match lobe.base {
                    Base::Metal(metal, surface) => Base::Metal(metal, Some(facets(surface))),
                    matte @ Base::Matte(_) => matte,
                };
                LayeredLobe { coat: Some(facets(lobe.coat)), base, ..*lobe }.into()
            }
            other => other.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_double_between_their_bounds() {
        for (given, expected) in [(0.0, 0.1), (0.02, 0.1), (0.1, 0.2), (0.2, 0.3), (0.3, 0.3), (0.5, 0.5)] {
            assert!((roughened(given) - expected).abs() < 1e-6, "{given}");
        }
    }
}

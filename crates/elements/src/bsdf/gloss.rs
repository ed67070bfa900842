//! What a dielectric coat reflects, without what it passes: the specular layer of layered materials.

use aureole_math::{Point2, Vector3, reflect};
use aureole_spectrum::Spectrum;

use super::dielectric::Glass;
use super::lobe::reflected;
use super::microfacet::Microfacet;
use super::{LobeFlags, LobeOps, LobeSample, TransportMode};

/// Reflection by a dielectric boundary, mirror-like where it has no facets.
#[derive(Clone, Copy, Debug)]
pub struct GlossLobe {
    /// The boundary.
    pub glass: Glass,
    /// Its facets; none if it is smooth.
    pub surface: Option<Microfacet>,
}

impl GlossLobe {
    #[inline]
    fn fresnel(&self, cos: f32) -> Spectrum {
        self.glass.fresnel(cos).0 * self.glass.reflectance
    }
}

impl LobeOps for GlossLobe {
    #[inline]
    fn eval(&self, wo: Vector3, wi: Vector3, _: TransportMode) -> Spectrum {
        match self.surface {
            Some(surface) if wo.z > 0.0 && wi.z > 0.0 => {
                let m = (wo + wi).normalized();
                self.fresnel(wo.dot(m)) * (surface.d(m) * surface.g(wo, wi, m) / (4.0 * wo.z * wi.z))
            }
            _ => Spectrum::ZERO,
        }
    }

    #[inline]
    fn sample(&self, wo: Vector3, _: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let Some(surface) = self.surface else {
            return Some(LobeSample {
                wi: Vector3::new(-wo.x, -wo.y, wo.z),
                value: self.fresnel(wo.z) / wo.z,
                pdf_omega: 1.0,
                flags: LobeFlags::DELTA_REFLECTION,
                eta: 1.0,
            });
        };
        let wi = reflect(wo, surface.sample_visible(wo, u));
        reflected(self, wo, wi, mode)
    }

    #[inline]
    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        match self.surface {
            Some(surface) if wo.z > 0.0 && wi.z > 0.0 => surface.pdf_mirrored(wo, wi),
            _ => 0.0,
        }
    }

    fn is_delta(&self) -> bool {
        self.surface.is_none()
    }

    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.fresnel(wo.z.abs())
    }
}

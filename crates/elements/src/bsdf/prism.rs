//! Smooth glass that breaks colours apart: three indices, one a colour.

use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::dielectric::Glass;
use super::lobe::Sides;
use super::{DielectricLobe, LobeFlags, LobeOps, LobeSample, TransportMode, fresnel};

/// Mirror reflection and refraction with an index of its own for red, green and blue.
///
/// Refraction draws a colour, and only that one goes on. What is mirrored keeps all colours.
///
/// # References
/// [Evans and McCool 1999] "Stratified Wavelength Clusters for Efficient Spectral Monte Carlo Rendering": splitting by colour.
#[derive(Clone, Copy, Debug)]
pub struct PrismLobe {
    /// The boundary; its index is the middle one.
    pub glass: Glass,
    /// Indices of red, green and blue over the middle one.
    pub spread: [f32; 3],
}

impl PrismLobe {
    fn colored(&self, c: usize) -> DielectricLobe {
        DielectricLobe { glass: Glass { eta: self.glass.eta * self.spread[c], ..self.glass } }
    }
}

impl LobeOps for PrismLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    fn sample(&self, wo: Vector3, uc: f32, _: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z == 0.0 {
            return None;
        }
        let reflectance = [0, 1, 2].map(|c| self.colored(c).glass.fresnel(wo.z).0[c]);
        let mean = reflectance.iter().sum::<f32>() / 3.0;
        if uc < mean {
            let mirrored = Vector3::new(-wo.x, -wo.y, wo.z);
            let value = self.glass.reflectance * Spectrum::from_rgb(reflectance) / wo.z.abs();
            let flags = LobeFlags::DELTA_REFLECTION;
            return Some(LobeSample { wi: mirrored, value, pdf_omega: mean, flags, eta: 1.0 });
        }
        let c = (((uc - mean) / (1.0 - mean) * 3.0) as usize).min(2);
        let lobe = self.colored(c);
        let bare = fresnel::dielectric(wo.z, lobe.glass.eta);
        if bare.cos_t == 0.0 {
            return None;
        }
        let through = lobe.sample_from(Sides::Transmission, wo, uc, mode)?;
        let only = Spectrum::new([0, 1, 2, 3].map(|lane| f32::from(u8::from(lane == c))));
        Some(LobeSample { value: through.value * only, pdf_omega: (1.0 - mean) / 3.0, ..through })
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        self.glass.albedo(wo.z)
    }
}

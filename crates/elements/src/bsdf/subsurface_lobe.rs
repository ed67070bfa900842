//! The boundary of a body that scatters inside, with light that leaves it spread out.

use std::f32::consts::FRAC_1_PI;

use aureole_math::{Point2, Vector3, warp};
use aureole_spectrum::Spectrum;

use super::coat::Coat;
use super::dielectric::Glass;
use super::lobe::Sides;
use super::microfacet::Microfacet;
use super::{LobeFlags, LobeOps, LobeSample, TransportMode, fresnel};

/// A boundary that is entered by refraction and left in directions that do not depend on where light comes from: in
/// proportion to what Fresnel's equations let pass from each.
///
/// How much leaves is exact, and also what is thrown back inside; only the directions are those of light that has
/// forgotten its own. So light samples work at the exit even of a smooth boundary.
///
/// # References
/// [Pharr, Jakob and Humphreys 2023] "Physically Based Rendering", 3rd edition's section 11.4.1: the factor S_ω.
#[derive(Clone, Copy, Debug)]
pub struct SubsurfaceLobe {
    /// The boundary.
    pub glass: Glass,
    /// Its facets, seen from outside; none if it is smooth.
    pub surface: Option<Microfacet>,
    /// An estimate of the share of entering light that comes back, for albedo images.
    pub returned: Spectrum,
}

impl SubsurfaceLobe {
    fn coat(&self) -> Coat {
        Coat::new(self.glass, self.surface)
    }

    fn passes(&self, cos: f32) -> f32 {
        1.0 - fresnel::dielectric(cos, self.glass.eta).reflectance
    }

    /// From inside `wo` to outside.
    fn leaves(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        // Radiance was squeezed on its way in, and spreads again.
        let squeeze = if mode == TransportMode::Radiance { self.glass.eta * self.glass.eta } else { 1.0 };
        let directions = self.passes(wi.z) * FRAC_1_PI / (1.0 - fresnel::mean_reflectance(self.glass.eta));
        self.glass.transmittance * (self.passes(wo.z) * directions * squeeze)
    }
}

impl LobeOps for SubsurfaceLobe {
    fn eval(&self, wo: Vector3, wi: Vector3, mode: TransportMode) -> Spectrum {
        if wo.z > 0.0 {
            self.coat().eval(wo, wi, mode)
        } else if wi.z > 0.0 {
            self.leaves(wo, wi, mode)
        } else {
            Spectrum::ZERO
        }
    }

    fn sample(&self, wo: Vector3, uc: f32, u: Point2, mode: TransportMode) -> Option<LobeSample> {
        if wo.z > 0.0 {
            return self.coat().sample(Sides::Both, wo, uc, u, mode);
        }
        let passes = self.passes(wo.z);
        if uc >= passes {
            let wi = Vector3::new(-wo.x, -wo.y, wo.z);
            let reflectance = 1.0 - passes;
            let value = Spectrum::splat(reflectance / wi.z.abs());
            let flags = LobeFlags::DELTA_REFLECTION;
            return (wi.z < 0.0).then_some(LobeSample { wi, value, pdf_omega: reflectance, flags, eta: 1.0 });
        }
        let wi = warp::square_to_cosine_hemisphere(u);
        let pdf_omega = self.pdf_omega(wo, wi);
        let (flags, eta) = (LobeFlags::TRANSMISSION, 1.0 / self.glass.eta);
        (pdf_omega > 0.0).then(|| LobeSample { wi, value: self.leaves(wo, wi, mode), pdf_omega, flags, eta })
    }

    fn pdf_omega(&self, wo: Vector3, wi: Vector3) -> f32 {
        if wo.z > 0.0 {
            self.coat().pdf(Sides::Both, wo, wi)
        } else if wi.z > 0.0 {
            self.passes(wo.z) * wi.z * FRAC_1_PI
        } else {
            0.0
        }
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let passes = self.passes(wo.z);
        self.glass.reflectance * (1.0 - passes) + self.returned * passes
    }
}

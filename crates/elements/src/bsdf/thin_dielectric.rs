//! `thin_dielectric`: a thin pane of glass: light passes without bending.
//!
//! Parameters: those of `dielectric` but the film.
//!
//! All orders of reflection between the two faces are summed: R' = R + T²R / (1 - R²) = 2R / (1 + R).

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::dielectric::{BOUNDARY_PARAMS, Boundary, Glass};
use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode, fresnel};
use crate::{Element, Resolver};

/// A thin pane.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectric {
    boundary: Boundary,
}

impl Element for ThinDielectric {
    const SUMMARY: &'static str = "A thin pane of glass: light passes without bending.";
    const PARAMS: &'static [ParamDoc] = &BOUNDARY_PARAMS;

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self { boundary: Boundary::from_params(params, resolver)? })
    }
}

impl MaterialOps for ThinDielectric {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(ThinDielectricLobe { glass: self.boundary.at(&at.texture) }, weight, at.frame, at.frame.n);
    }
}

/// Mirror reflection and straight transmission.
#[derive(Clone, Copy, Debug)]
pub struct ThinDielectricLobe {
    /// One face of the pane.
    pub glass: Glass,
}

impl ThinDielectricLobe {
    #[inline]
    fn reflectance(&self, cos: f32) -> f32 {
        let r = fresnel::dielectric(cos.abs(), self.glass.eta).reflectance;
        2.0 * r / (1.0 + r)
    }
}

impl LobeOps for ThinDielectricLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    fn sample(&self, wo: Vector3, uc: f32, _: Point2, _: TransportMode) -> Option<LobeSample> {
        if wo.z == 0.0 {
            return None;
        }
        let r = self.reflectance(wo.z);
        let (wi, factor, pdf_omega, flags) = if uc < r {
            (Vector3::new(-wo.x, -wo.y, wo.z), self.glass.reflectance, r, LobeFlags::DELTA_REFLECTION)
        } else {
            (-wo, self.glass.transmittance, 1.0 - r, LobeFlags::DELTA_TRANSMISSION)
        };
        Some(LobeSample { wi, value: factor * (pdf_omega / wo.z.abs()), pdf_omega, flags, eta: 1.0 })
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    fn albedo(&self, wo: Vector3) -> Spectrum {
        let r = self.reflectance(wo.z);
        self.glass.reflectance * r + self.glass.transmittance * (1.0 - r)
    }
}

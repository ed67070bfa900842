//! `null`: a surface that is not there; light passes straight on.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Vector3};
use aureole_spectrum::Spectrum;

use super::{Bsdf, LobeFlags, LobeOps, LobeSample, MaterialContext, MaterialOps, TransportMode};
use crate::{Element, Resolver};

/// No surface.
#[derive(Clone, Copy, Debug)]
pub struct Null;

impl Element for Null {
    const SUMMARY: &'static str = "A surface that is not there; light passes straight on.";
    const PARAMS: &'static [ParamDoc] = &[];

    fn from_params(_: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self)
    }
}

impl MaterialOps for Null {
    fn evaluate(&self, at: &MaterialContext<'_>, weight: f32, out: &mut Bsdf) {
        out.push(NullLobe, weight, at.frame, at.frame.n);
    }
}

/// Straight transmission.
#[derive(Clone, Copy, Debug)]
pub struct NullLobe;

impl LobeOps for NullLobe {
    fn eval(&self, _: Vector3, _: Vector3, _: TransportMode) -> Spectrum {
        Spectrum::ZERO
    }

    fn sample(&self, wo: Vector3, _: f32, _: Point2, _: TransportMode) -> Option<LobeSample> {
        (wo.z != 0.0).then(|| LobeSample {
            wi: -wo,
            value: Spectrum::splat(1.0 / wo.z.abs()),
            pdf_omega: 1.0,
            flags: LobeFlags::DELTA_TRANSMISSION,
            eta: 1.0,
        })
    }

    fn pdf_omega(&self, _: Vector3, _: Vector3) -> f32 {
        0.0
    }

    fn is_delta(&self) -> bool {
        true
    }

    #[inline]
    fn has_choice(&self) -> bool {
        false
    }

    fn albedo(&self, _: Vector3) -> Spectrum {
        Spectrum::ONE
    }
}

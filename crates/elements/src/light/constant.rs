//! `constant`: the same radiance from everywhere.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `radiance` | spectrum | 1 | radiance of the surroundings |

use std::f32::consts::PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Point2, Point3, Vector3, warp};
use aureole_spectrum::{PreparedSpectrum, Spectrum, SpectrumRole, Wavelengths, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver, SurfacePoint};

/// Even surroundings.
#[derive(Clone, Debug)]
pub struct ConstantEnvironment {
    radiance: PreparedSpectrum,
}

impl Element for ConstantEnvironment {
    const SUMMARY: &'static str = "The same radiance from everywhere.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "radiance", ty: "spectrum", default: "1", doc: "radiance of the surroundings" }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        params.transform("world_from_light")?; // turning it changes nothing
        Ok(Self { radiance: params.spectrum("radiance", 1.0)?.prepare(SpectrumRole::Illuminant) })
    }
}

impl LightOps for ConstantEnvironment {
    fn sample(&self, at: &LightContext<'_>, _: Point3, u: Point2) -> Option<LightSample> {
        Some(LightSample {
            wi: warp::square_to_uniform_sphere(u),
            target: None,
            radiance: self.radiance.eval(&at.wavelengths),
            pdf_omega: warp::UNIFORM_SPHERE_PDF,
            is_delta: false,
        })
    }

    fn pdf_omega(&self, _: &LightContext<'_>, _: Point3, _: Vector3, _: Option<&SurfacePoint>) -> f32 {
        warp::UNIFORM_SPHERE_PDF
    }

    fn environment(&self, at: &LightContext<'_>, _: Point3, _: Vector3) -> Spectrum {
        self.radiance.eval(&at.wavelengths)
    }

    fn is_environment(&self) -> bool {
        true
    }

    fn power(&self, _: &LightContext<'_>, scene: &Bounds3) -> f32 {
        let radius = scene.radius();
        luminance(self.radiance.eval(&Wavelengths::RGB).rgb()) * 4.0 * PI * PI * radius * radius
    }
}

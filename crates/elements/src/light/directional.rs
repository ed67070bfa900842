//! `directional`: parallel light from infinitely far away.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `direction` | vector | 0, 0, 1 | the way the light travels |
//! | `irradiance` | spectrum | 1 | on a surface that faces the light, W/m² |
//! | `world_from_light` | transform | identity | applied to `direction` |

use std::f32::consts::PI;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Bounds3, Point2, Point3, Vector3};
use aureole_spectrum::{PreparedSpectrum, SpectrumRole, Wavelengths, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver};

/// Parallel light.
#[derive(Clone, Debug)]
pub struct Directional {
    /// Unit vector to the light.
    wi: Vector3,
    irradiance: PreparedSpectrum,
}

impl Element for Directional {
    const SUMMARY: &'static str = "Parallel light from infinitely far away.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "direction", ty: "vector", default: "0, 0, 1", doc: "the way the light travels" },
        ParamDoc {
            name: "irradiance",
            ty: "spectrum",
            default: "1",
            doc: "on a surface that faces the light, W/m²",
        },
        ParamDoc {
            name: "world_from_light",
            ty: "transform",
            default: "identity",
            doc: "applied to `direction`",
        },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let place = params.transform("world_from_light")?;
        let travels = place.vector(Vector3::from(params.vec3("direction", [0.0, 0.0, 1.0])?));
        let wi = (-travels)
            .try_normalized()
            .ok_or_else(|| SceneError::invalid("the light's `direction` must not be zero", Span::NONE))?;
        Ok(Self { wi, irradiance: params.spectrum("irradiance", 1.0)?.prepare(SpectrumRole::Illuminant) })
    }
}

impl LightOps for Directional {
    fn sample(&self, at: &LightContext<'_>, _: Point3, _: Point2) -> Option<LightSample> {
        Some(LightSample {
            wi: self.wi,
            target: None,
            radiance: self.irradiance.eval(&at.wavelengths),
            pdf_omega: 1.0,
            is_delta: true,
        })
    }

    fn power(&self, _: &LightContext<'_>, scene: &Bounds3) -> f32 {
        let radius = scene.radius();
        luminance(self.irradiance.eval(&Wavelengths::RGB).rgb()) * PI * radius * radius
    }
}

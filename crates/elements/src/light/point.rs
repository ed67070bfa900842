//! `point`: light from one point, the same in all directions.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `position` | point | 0, 0, 0 | in the light's space |
//! | `intensity` | spectrum | 1 | radiant intensity, W/sr |
//! | `world_from_light` | transform | identity | |

use std::f32::consts::PI;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Bounds3, Point2, Point3};
use aureole_spectrum::{PreparedSpectrum, SpectrumRole, Wavelengths, luminance};

use super::{LightContext, LightOps, LightSample};
use crate::{Element, Resolver};

/// A point light.
#[derive(Clone, Debug)]
pub struct PointLight {
    position: Point3,
    intensity: PreparedSpectrum,
}

impl Element for PointLight {
    const SUMMARY: &'static str = "Light from one point, the same in all directions.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "position", ty: "point", default: "0, 0, 0", doc: "in the light's space" },
        ParamDoc { name: "intensity", ty: "spectrum", default: "1", doc: "radiant intensity, W/sr" },
        ParamDoc {
            name: "world_from_light",
            ty: "transform",
            default: "identity",
            doc: "where the light is",
        },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let place = params.transform("world_from_light")?;
        let position = place.point(Point3::from(params.vec3("position", [0.0; 3])?));
        Ok(Self { position, intensity: params.spectrum("intensity", 1.0)?.prepare(SpectrumRole::Illuminant) })
    }
}

impl LightOps for PointLight {
    #[inline]
    fn sample(&self, at: &LightContext<'_>, reference: Point3, _: Point2) -> Option<LightSample> {
        let d = self.position - reference;
        let d2 = d.length_squared();
        (d2 > 0.0).then(|| LightSample {
            wi: d / d2.sqrt(),
            target: Some(self.position),
            radiance: self.intensity.eval(&at.wavelengths) / d2,
            pdf_omega: 1.0,
            is_delta: true,
        })
    }

    fn power(&self, _: &LightContext<'_>, _: &Bounds3) -> f32 {
        luminance(self.intensity.eval(&Wavelengths::RGB).rgb()) * 4.0 * PI
    }
}

//! `radiance_meter`: one ray along +Z, for all pixels the same.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `world_from_camera` | transform | identity | where the meter is; it looks along +Z |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point3, Ray, Transform, Vector3};

use super::{CameraOps, CameraRay, CameraSample};
use crate::{Element, Resolver};

/// A meter of radiance.
#[derive(Clone, Copy, Debug)]
pub struct RadianceMeter {
    origin: Point3,
    direction: Vector3,
}

/// The unit direction of +Z.
pub(super) fn axis(place: &Transform) -> Vector3 {
    place.vector(Vector3::Z).normalized()
}

impl Element for RadianceMeter {
    const SUMMARY: &'static str = "One ray along +Z, for all pixels the same.";
    const PARAMS: &'static [ParamDoc] = &[ParamDoc {
        name: "world_from_camera",
        ty: "transform",
        default: "identity",
        doc: "where the meter is; it looks along +Z",
    }];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        let place = params.transform("world_from_camera")?;
        Ok(Self { origin: place.point(Point3::ORIGIN), direction: axis(&place) })
    }
}

impl CameraOps for RadianceMeter {
    fn generate_ray(&self, _: &CameraSample) -> CameraRay {
        Ray { origin: self.origin, direction: self.direction, t_min: 0.0, t_max: f32::INFINITY, time: 0.0 }
            .into()
    }
}

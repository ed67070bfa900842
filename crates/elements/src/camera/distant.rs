//! `distant`: what leaves a scene towards one faraway place, as a satellite sees it; all pixels see the same.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `world_from_camera` | transform | identity | looks along +Z |
//! | `target` | point | | all rays go to this point in the world |
//! | `scene_center`, `scene_radius` | point, float | 0, 1 | a ball around the scene; without a target, rays cover its cross-section |

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Frame, Point3, Ray, Vector3, warp};

use super::radiance_meter::axis;
use super::{CameraOps, CameraRay, CameraSample};
use crate::{Element, Resolver};

/// A sensor infinitely far away.
#[derive(Clone, Copy, Debug)]
pub struct Distant {
    direction: Vector3,
    target: Option<Point3>,
    center: Point3,
    radius: f32,
}

impl Element for Distant {
    const SUMMARY: &'static str = "What leaves a scene towards one faraway place.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "world_from_camera", ty: "transform", default: "identity", doc: "looks along +Z" },
        ParamDoc { name: "target", ty: "point", default: "", doc: "all rays go to this point in the world" },
        ParamDoc { name: "scene_center", ty: "point", default: "0, 0, 0", doc: "of a ball around the scene" },
        ParamDoc { name: "scene_radius", ty: "float", default: "1", doc: "of that ball" },
    ];

    fn from_params(params: &mut Params, _: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            direction: axis(&params.transform("world_from_camera")?),
            target: params.try_vec3("target")?.map(Point3::from),
            center: Point3::from(params.vec3("scene_center", [0.0; 3])?),
            radius: params.float_in("scene_radius", 1.0, 0.0, f32::INFINITY)?,
        })
    }
}

impl CameraOps for Distant {
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
        let middle = self.target.unwrap_or_else(|| {
            let disk = warp::square_to_disk_concentric(sample.lens);
            let frame = Frame::from_normal(self.direction);
            self.center + (frame.s * disk.x + frame.t * disk.y) * self.radius
        });
        let back = match self.target {
            Some(target) => (target - self.center).length() + self.radius,
            None => self.radius,
        };
        Ray {
            origin: middle - self.direction * back,
            direction: self.direction,
            t_min: 0.0,
            t_max: f32::INFINITY,
            time: 0.0,
        }
        .into()
    }
}

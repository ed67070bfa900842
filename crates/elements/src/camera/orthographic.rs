//! `orthographic`: parallel rays along +Z; the image is two units wide before `world_from_camera` scales it.
//!
//! Parameters: the shared ones of `perspective`.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point3, Ray, Vector3, warp};

use super::projective::{self, Projective};
use super::{CameraOps, CameraRay, CameraSample};
use crate::texture::onto_plane;
use crate::{Element, Resolver};

/// A camera without perspective.
#[derive(Clone, Debug)]
pub struct Orthographic {
    projective: Projective,
}

impl Element for Orthographic {
    const SUMMARY: &'static str = "Parallel rays along +Z; the image is two units wide.";
    const PARAMS: &'static [ParamDoc] = &projective::PARAMS;

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self { projective: Projective::from_params(params, resolver, 1.0, 1e4)? })
    }
}

impl CameraOps for Orthographic {
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
        let camera = &self.projective;
        let screen = camera.screen(sample.film);
        let mut origin = Point3::new(-screen.x, screen.y, 0.0);
        let mut direction = Vector3::Z;
        if camera.aperture_radius > 0.0 {
            let lens = warp::square_to_disk_concentric(sample.lens);
            let focus = origin + direction * camera.focus_distance;
            origin += Vector3::new(lens.x, lens.y, 0.0) * camera.aperture_radius;
            direction = (focus - origin).normalized();
        }
        let time = camera.place.time(sample.time);
        camera
            .place
            .at(time, |place| {
                let axis = place.vector(direction);
                let length = axis.length();
                Ray {
                    origin: place.point(origin),
                    direction: axis / length,
                    t_min: camera.near * length,
                    t_max: camera.far * length,
                    time,
                }
            })
            .into()
    }

    fn footprint(&self, _: Point3, n: Vector3) -> [Vector3; 2] {
        let axis = self.projective.place.start.vector(Vector3::Z);
        self.projective.pixel_steps().map(|step| onto_plane(step, axis, n))
    }
}

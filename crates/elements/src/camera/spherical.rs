//! `spherical`: all directions at once, +Y up in camera space.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `mapping` | string | latlong | `latlong` or `equal_area` |
//! | `world_from_camera` | transform | identity | |

use std::f32::consts::{PI, TAU};

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Point3, Ray, Transform, Vector3, warp};

use super::{CameraOps, CameraSample, cone_footprint};
use crate::{Element, FilmSpec, Resolver};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mapping {
    LatLong,
    EqualArea,
}

/// A panoramic camera.
#[derive(Clone, Copy, Debug)]
pub struct Spherical {
    world_from_camera: Transform,
    mapping: Mapping,
    film: FilmSpec,
}

impl Element for Spherical {
    const SUMMARY: &'static str = "All directions at once, +Y up.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "mapping", ty: "string", default: "latlong", doc: "`latlong` or `equal_area`" },
        ParamDoc {
            name: "world_from_camera",
            ty: "transform",
            default: "identity",
            doc: "where the camera is",
        },
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        for name in ["shutter_open", "shutter_close"] {
            params.float(name, 0.0)?; // nothing moves yet
        }
        Ok(Self {
            world_from_camera: params.transform("world_from_camera")?,
            mapping: params
                .one_of("mapping", &[("latlong", Mapping::LatLong), ("equal_area", Mapping::EqualArea)])?,
            film: resolver.film(),
        })
    }
}

impl CameraOps for Spherical {
    fn generate_ray(&self, sample: &CameraSample) -> Ray {
        let uv = Point2::new(sample.film.x / self.film.width as f32, sample.film.y / self.film.height as f32);
        let direction = match self.mapping {
            Mapping::LatLong => {
                let (sin_theta, cos_theta) = (PI * uv.y).sin_cos();
                let (sin_phi, cos_phi) = (TAU * uv.x).sin_cos();
                Vector3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi)
            }
            Mapping::EqualArea => {
                let w = warp::sphere_from_square_equal_area(uv);
                Vector3::new(w.x, w.z, w.y)
            }
        };
        Ray::new(
            self.world_from_camera.point(Point3::ORIGIN),
            self.world_from_camera.vector(direction).normalized(),
        )
    }
    fn footprint(&self, p: Point3, n: Vector3) -> [Vector3; 2] {
        let d = p - self.world_from_camera.point(Point3::ORIGIN);
        cone_footprint(d, n, PI / self.film.height as f32)
    }
}

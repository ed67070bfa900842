//! `spherical`: all directions at once, +Y up in camera space.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `mapping` | string | latlong | `latlong` or `equal_area` |
//! | `world_from_camera` | transform | identity | |
//! | `world_from_camera_end` | transform | the same | where it is at time 1, if it moves from time 0 on |
//! | `shutter_open`, `shutter_close` | float | 0 | the exposure |

use std::f32::consts::{PI, TAU};

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point2, Point3, Ray, Vector3, warp};

use super::placed::{self, Placed};
use super::{CameraOps, CameraRay, CameraSample, cone_footprint};
use crate::{Element, FilmSpec, Resolver};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mapping {
    LatLong,
    EqualArea,
}

/// A panoramic camera.
#[derive(Clone, Debug)]
pub struct Spherical {
    place: Placed,
    mapping: Mapping,
    film: FilmSpec,
}

impl Element for Spherical {
    const SUMMARY: &'static str = "All directions at once, +Y up.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc { name: "mapping", ty: "string", default: "latlong", doc: "`latlong` or `equal_area`" },
        placed::PARAMS[0],
        placed::PARAMS[1],
        placed::PARAMS[2],
        placed::PARAMS[3],
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        Ok(Self {
            place: Placed::from_params(params)?,
            mapping: params
                .one_of("mapping", &[("latlong", Mapping::LatLong), ("equal_area", Mapping::EqualArea)])?,
            film: resolver.film(),
        })
    }
}

impl CameraOps for Spherical {
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
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
        let time = self.place.time(sample.time);
        self.place
            .at(time, |place| {
                let ray = Ray::new(place.point(Point3::ORIGIN), place.vector(direction).normalized());
                Ray { time, ..ray }
            })
            .into()
    }
    fn footprint(&self, p: Point3, n: Vector3) -> [Vector3; 2] {
        let d = p - self.place.start.point(Point3::ORIGIN);
        cone_footprint(d, n, PI / self.film.height as f32)
    }
}

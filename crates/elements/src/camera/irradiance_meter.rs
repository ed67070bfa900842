//! `irradiance_meter`: the light that arrives at a shape from outside. The film lies over the square that points of the shape are
//! drawn from: its pixels are parts of the shape, of equal area.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `shape` | shape | | the shape; its area must be known |
//!
//! Directions are drawn by cosine; the mean of what they see times π is the irradiance, in W·m⁻².

use std::f32::consts::PI;

use aureole_desc::{ParamDoc, Params, SceneError, Span};
use aureole_math::{Frame, Point2, Point3, Ray, Vector3, offset_ray_origin, warp};

use super::{CameraOps, CameraRay, CameraSample};
use crate::{Element, FilmSpec, Resolver, Shape};

/// A meter of irradiance.
#[derive(Clone, Debug)]
pub struct IrradianceMeter {
    shape: Shape,
    film: FilmSpec,
}

impl Element for IrradianceMeter {
    const SUMMARY: &'static str = "The light that arrives at a shape from outside.";
    const PARAMS: &'static [ParamDoc] =
        &[ParamDoc { name: "shape", ty: "shape", default: "", doc: "the shape; its area must be known" }];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        params.try_node("shape")?;
        match resolver.measured_shape() {
            Some(shape) if shape.area().is_finite() => Ok(Self { shape, film: resolver.film() }),
            Some(_) => {
                Err(SceneError::invalid("this shape cannot measure: its area is not known", Span::NONE))
            }
            None => Err(SceneError::invalid(
                "an `irradiance_meter` needs the scene's shape that it is on",
                Span::NONE,
            )),
        }
    }
}

impl CameraOps for IrradianceMeter {
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
        let inside = |x: f32, size: u32| (x / size as f32).clamp(0.0, 1.0 - f32::EPSILON);
        let place =
            Point2::new(inside(sample.film.x, self.film.width), inside(sample.film.y, self.film.height));
        let (origin, direction) = match self.shape.sample_area(place) {
            Some(drawn) => {
                let wi =
                    Frame::from_normal(drawn.ng).to_world(warp::square_to_cosine_hemisphere(sample.lens));
                (offset_ray_origin(drawn.p, drawn.error, drawn.ng, wi), wi)
            }
            // A shape without area: nothing arrives.
            None => (Point3::ORIGIN, Vector3::Z),
        };
        Ray { origin, direction, t_min: 0.0, t_max: f32::INFINITY, time: 0.0 }.into()
    }

    fn gain(&self) -> f32 {
        PI
    }
}

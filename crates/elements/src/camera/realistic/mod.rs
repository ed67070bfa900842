//! `realistic`: a lens of several glasses, through which each ray is followed from the film.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `lens` | floats | | rows of four in millimetres, scene side first: radius of curvature (0 for the stop), distance to the next surface, refractive index behind it, diameter |
//! | `aperture_diameter` | float | 1 | of the stop, millimetres |
//! | `aperture` | string | circular | the stop's shape: also `gaussian`, `square`, `pentagon`, `star` |
//! | `aperture_picture` | file | | a picture in its place |
//! | `focus_distance` | float | 10 | from the film to what is sharp, metres |
//! | `film_diagonal` | float | 35 | millimetres |
//!
//! and the shared ones: `world_from_camera`, `world_from_camera_end`, `shutter_open`, `shutter_close`.
//!
//! The film measures irradiance: radiance times the solid angle of the exit pupil and the cosines at the film and at the
//! pupil. What the lens stops is black.
//!
//! References: [Kolb 1995] "A Realistic Camera Model for Computer Graphics"; [Pharr 2023] section 5.5.

mod aperture;
mod lens;
mod pupil;

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point3, Ray, Vector3};

use super::placed::{self, Placed};
use super::{CameraOps, CameraRay, CameraSample, cone_footprint};
use crate::{Element, FilmSpec, Resolver};
use aperture::Aperture;
use lens::{Lens, Segment};
use pupil::Bounds;

/// A camera with a lens of several glasses.
#[derive(Clone, Debug)]
pub struct Realistic {
    place: Placed,
    lens: Lens,
    aperture: Aperture,
    film: FilmSpec,
    /// Half the diagonal.
    film_radius: f64,
    /// A pixel's side.
    pixel: f64,
    /// What light passes, from the film's middle to its corners.
    pupils: Vec<Option<Bounds>>,
}

impl Element for Realistic {
    const SUMMARY: &'static str =
        "A lens of several glasses, through which each ray is followed from the film.";
    const PARAMS: &'static [ParamDoc] = &[
        ParamDoc {
            name: "lens",
            ty: "floats",
            default: "",
            doc: "radius, thickness, index, diameter; again",
        },
        ParamDoc { name: "aperture_diameter", ty: "float", default: "1", doc: "of the stop, millimetres" },
        ParamDoc { name: "aperture", ty: "string", default: "circular", doc: "the stop's shape" },
        ParamDoc { name: "aperture_picture", ty: "file", default: "", doc: "a picture in its place" },
        ParamDoc { name: "focus_distance", ty: "float", default: "10", doc: "from the film, metres" },
        ParamDoc { name: "film_diagonal", ty: "float", default: "35", doc: "millimetres" },
        placed::PARAMS[0],
        placed::PARAMS[1],
        placed::PARAMS[2],
        placed::PARAMS[3],
    ];

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let film = resolver.film();
        let film_radius = f64::from(params.float_in("film_diagonal", 35.0, 1e-3, 1e6)?) / 2000.0;
        let diagonal = f64::from(film.width).hypot(f64::from(film.height));
        let pixel = 2.0 * film_radius / diagonal;
        let aperture = Aperture::from_params(params, resolver)?;
        let lens = stopped_lens(params, resolver)?;
        let pupils = pupil::exit_pupils(&lens, &aperture, film_radius);
        if pupils.iter().all(Option::is_none) {
            let at = params.span("lens");
            resolver.report().warn("no light gets through this lens: the image will be black", at);
        }
        Ok(Self { place: Placed::from_params(params)?, lens, aperture, film, film_radius, pixel, pupils })
    }
}

/// The lens, focused and stopped down.
fn stopped_lens(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Lens, SceneError> {
    let at = params.span("lens");
    let rows = params.try_floats("lens")?.ok_or_else(|| SceneError::MissingParam {
        element: "realistic".into(),
        param: "lens".into(),
        wanted: "rows of radius, thickness, refractive index and diameter".into(),
        at: aureole_desc::Span::NONE,
    })?;
    let focus = params.float_in("focus_distance", 10.0, f32::MIN_POSITIVE, f32::MAX)?;
    let mut lens = Lens::new(&rows, f64::from(focus), at)?;
    let wanted = params.float_in("aperture_diameter", 1.0, f32::MIN_POSITIVE, f32::MAX)?;
    let is_given = params.has("aperture_diameter");
    let at = params.span("aperture_diameter");
    match lens.stop_down(f64::from(wanted) / 2000.0) {
        None if is_given => {
            resolver.report().warn("this lens has no stop: `aperture_diameter` does not count", at);
        }
        Some(widest) if f64::from(wanted) > 2000.0 * widest => {
            let widest = 2000.0 * widest;
            let message = format!("this stop opens to {widest:.3} mm only, not to {wanted} mm");
            resolver.report().warn(message, at);
        }
        _ => {}
    }
    Ok(lens)
}

impl Realistic {
    /// Light's way to a place on the film, in camera space, and its weight.
    fn trace(&self, sample: &CameraSample) -> Option<(Segment, f64)> {
        // The image is upside down on the film: its left is seen through the lens from the right.
        let x = (f64::from(sample.film.x) - 0.5 * f64::from(self.film.width)) * self.pixel;
        let y = (f64::from(sample.film.y) - 0.5 * f64::from(self.film.height)) * self.pixel;
        let r = x.hypot(y);
        let ring = (r / self.film_radius * self.pupils.len() as f64) as usize;
        let pupil = self.pupils[ring.min(self.pupils.len() - 1)]?;
        let [u, v]: [f64; 2] = std::array::from_fn(|i| {
            let share = f64::from([sample.lens.x, sample.lens.y][i]);
            pupil.min[i] + share * (pupil.max[i] - pupil.min[i])
        });
        let [cos, sin] = if r > 0.0 { [x / r, y / r] } else { [1.0, 0.0] };
        let rear = self.lens.rear().0;
        let direction = [cos * u - sin * v - x, sin * u + cos * v - y, rear];
        let from = Segment { origin: [x, y, 0.0], direction };
        let (out, passed) = self.lens.trace(from, |p| self.aperture.transmittance(p))?;
        // Irradiance: radiance over the pupil's area, with both cosines, over the squared distance.
        let cos2 = rear * rear / direction.iter().map(|d| d * d).sum::<f64>();
        Some((out, passed * cos2 * cos2 * pupil.area() / (rear * rear)))
    }
}

impl CameraOps for Realistic {
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
        let Some((Segment { origin, direction }, weight)) = self.trace(sample) else {
            return CameraRay::stopped();
        };
        let [origin, direction] = [origin, direction].map(|v| v.map(|x| x as f32));
        let time = self.place.time(sample.time);
        let ray = self.place.at(time, |place| Ray {
            time,
            ..Ray::new(
                place.point(Point3::new(origin[0], origin[1], origin[2])),
                place.vector(Vector3::new(direction[0], direction[1], direction[2])).normalized(),
            )
        });
        CameraRay { ray, weight: weight as f32 }
    }

    fn footprint(&self, p: Point3, n: Vector3) -> [Vector3; 2] {
        let d = p - self.place.start.point(Point3::ORIGIN);
        cone_footprint(d, n, (self.pixel / self.lens.image_distance) as f32)
    }
}

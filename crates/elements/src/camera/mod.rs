//! Cameras.
//!
//! Camera space looks along +Z with +Y up; the right of the image is −X (right-handed).

mod batch;
mod distant;
mod fov;
mod irradiance_meter;
mod orthographic;
mod perspective;
mod placed;
mod radiance_meter;
mod realistic;
mod spherical;

use std::fmt::Debug;

use aureole_math::{Frame, Point2, Point3, Ray, Vector3};

use crate::texture::onto_plane;

pub use batch::Batch;
pub use distant::Distant;
pub use fov::FovAxis;
pub use irradiance_meter::IrradianceMeter;
pub use orthographic::Orthographic;
pub use perspective::Perspective;
pub use radiance_meter::RadianceMeter;
pub use realistic::Realistic;
pub use spherical::Spherical;

/// Which ray of a camera is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSample {
    /// Place on the film in pixels, from the top left corner.
    pub film: Point2,
    /// Place on the lens, in the unit square.
    pub lens: Point2,
    /// Time within the shutter's interval, in [0, 1).
    pub time: f32,
}

/// A ray that carries light to a place on the film.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// The ray, with a unit direction in the world.
    pub ray: Ray,
    /// What its radiance counts for; zero where no light reaches the film that way.
    pub weight: f32,
}

impl From<Ray> for CameraRay {
    fn from(ray: Ray) -> Self {
        Self { ray, weight: 1.0 }
    }
}

impl CameraRay {
    /// A ray that meets nothing, for light that is stopped within the camera.
    fn stopped() -> Self {
        let ray = Ray { t_max: -1.0, ..Ray::new(Point3::ORIGIN, Vector3::Z) };
        Self { ray, weight: 0.0 }
    }
}

/// What every camera can do.
pub trait CameraOps: Debug + Send + Sync {
    /// The ray that carries light to a place on the film.
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay;

    /// How far a place with unit normal `n` moves on its plane from a pixel to the next, across and down, if the camera sees it
    /// directly; zero where that is not known.
    fn footprint(&self, _p: Point3, _n: Vector3) -> [Vector3; 2] {
        [Vector3::ZERO; 2]
    }

    /// What radiance is multiplied by to be what the camera measures.
    fn gain(&self) -> f32 {
        1.0
    }
}

/// Steps of an angle of one pixel in any two directions across the line of sight.
fn cone_footprint(d: Vector3, n: Vector3, angle: f32) -> [Vector3; 2] {
    let Some(w) = d.try_normalized() else { return [Vector3::ZERO; 2] };
    let frame = Frame::from_normal(w);
    [frame.s, frame.t].map(|side| onto_plane(side * (angle * d.length()), d, n))
}

registry! {
    ($)
    /// Any built-in camera.
    Camera: CameraOps, match with each_camera;
    perspective::Perspective as Perspective = "perspective",
    orthographic::Orthographic as Orthographic = "orthographic",
    spherical::Spherical as Spherical = "spherical",
    realistic::Realistic as Realistic = "realistic",
    radiance_meter::RadianceMeter as RadianceMeter = "radiance_meter",
    distant::Distant as Distant = "distant",
    irradiance_meter::IrradianceMeter as IrradianceMeter = "irradiance_meter",
    batch::Batch as Batch = "batch",
}

impl Camera {
    /// The ray that carries light to a place on the film.
    #[inline]
    pub fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
        each_camera!(self, c => c.generate_ray(sample))
    }

    /// How far a place moves on its plane from a pixel to the next.
    pub fn footprint(&self, p: Point3, n: Vector3) -> [Vector3; 2] {
        each_camera!(self, c => c.footprint(p, n))
    }

    /// What radiance is multiplied by to be what the camera measures.
    pub fn gain(&self) -> f32 {
        each_camera!(self, c => c.gain())
    }
}

/// Parameters that projective cameras share.
mod projective {
    use aureole_desc::{ParamDoc, Params, SceneError};
    use aureole_math::{Point2, Vector3};

    use super::placed::{self, Placed};
    use crate::{FilmSpec, Resolver};

    pub(super) const PARAMS: [ParamDoc; 9] = [
        placed::PARAMS[0],
        placed::PARAMS[1],
        ParamDoc { name: "near_clip", ty: "float", default: "0.01", doc: "nothing nearer is seen" },
        ParamDoc { name: "far_clip", ty: "float", default: "10000", doc: "nothing farther is seen" },
        ParamDoc { name: "aperture_radius", ty: "float", default: "0", doc: "of the lens; 0 for a pinhole" },
        ParamDoc {
            name: "focus_distance",
            ty: "float",
            default: "1",
            doc: "along the axis, to the plane in focus",
        },
        placed::PARAMS[2],
        placed::PARAMS[3],
        ParamDoc {
            name: "screen_window",
            ty: "floats",
            default: "by fov",
            doc: "x0 x1 y0 y1 of the image at z = 1",
        },
    ];

    /// Where the camera is, what its lens does, and which part of the plane z = 1 its film shows.
    #[derive(Clone, Debug)]
    pub(super) struct Projective {
        pub place: Placed,
        pub near: f32,
        pub far: f32,
        pub aperture_radius: f32,
        pub focus_distance: f32,
        film: FilmSpec,
        /// Left, right, bottom, top; x grows to the right of the image.
        pub window: [f32; 4],
    }

    impl Projective {
        /// Reads the shared parameters; `default_half_width` is that of the window when none is given.
        pub(super) fn from_params(
            params: &mut Params,
            resolver: &dyn Resolver,
            default_half_width: f32,
            default_far: f32,
        ) -> Result<Self, SceneError> {
            let film = resolver.film();
            let half_height = default_half_width / film.aspect();
            let window = match params.try_floats("screen_window")? {
                Some(list) => match *list {
                    [x0, x1, y0, y1] if x0 != x1 && y0 != y1 => [x0, x1, y0, y1],
                    _ => {
                        let at = params.span("screen_window");
                        return Err(SceneError::invalid(
                            "`screen_window` must be four numbers: x0 x1 y0 y1",
                            at,
                        ));
                    }
                },
                None => [-default_half_width, default_half_width, -half_height, half_height],
            };
            Ok(Self {
                place: Placed::from_params(params)?,
                near: params.float_in("near_clip", 0.01, 0.0, f32::INFINITY)?,
                far: params.float_in("far_clip", default_far, 0.0, f32::INFINITY)?,
                aperture_radius: params.float_in("aperture_radius", 0.0, 0.0, f32::INFINITY)?,
                focus_distance: params.float_in("focus_distance", 1.0, f32::MIN_POSITIVE, f32::INFINITY)?,
                film,
                window,
            })
        }

        /// The place in the window, x to the right, of a place on the film in pixels from the top left.
        #[inline]
        pub(super) fn screen(&self, film: Point2) -> Point2 {
            let [x0, x1, y0, y1] = self.window;
            Point2::new(
                x0 + (x1 - x0) * film.x / self.film.width as f32,
                y1 + (y0 - y1) * film.y / self.film.height as f32,
            )
        }

        /// Steps from a pixel to the next at distance one along the axis, in the world.
        pub(super) fn pixel_steps(&self) -> [Vector3; 2] {
            let [x0, x1, y0, y1] = self.window;
            let (across, down) = ((x1 - x0) / self.film.width as f32, (y0 - y1) / self.film.height as f32);
            [Vector3::new(-across, 0.0, 0.0), Vector3::new(0.0, down, 0.0)]
                .map(|v| self.place.start.vector(v))
        }
    }
}

#[cfg(test)]
mod tests {
    use aureole_desc::{Family, Node, Params, Span, Value};
    use aureole_math::Transform;

    use super::*;
    use crate::element::tests::NoResolver;

    /// What a ray through the next pixel meets on the plane is one footprint away.
    #[test]
    fn footprints_are_the_way_to_the_next_pixel() {
        let place = Transform::translate(Vector3::new(0.5, 1.0, -2.0))
            * Transform::rotate(Vector3::new(0.1, 1.0, 0.2), 25.0);
        for kind in ["perspective", "orthographic"] {
            let params = Params::new().with("world_from_camera", Value::Transform(place));
            let node = Node::new(Family::Camera, kind, params, Span::NONE);
            let camera = Camera::build(&node, &mut NoResolver::default()).expect("is sound");
            let ray = |x: f32, y: f32| {
                let lens = Point2::new(0.5, 0.5);
                camera.generate_ray(&CameraSample { film: Point2::new(x, y), lens, time: 0.0 }).ray
            };
            let n = Vector3::new(0.3, 0.8, -0.7).normalized();
            let p = ray(60.0, 150.0).at(5.0);
            let meets = |ray: Ray| ray.at((p - ray.origin).dot(n) / ray.direction.dot(n));
            let [across, down] = camera.footprint(p, n);
            let [right, below] = [ray(61.0, 150.0), ray(60.0, 151.0)].map(|ray| meets(ray) - p);
            assert!((across - right).length() < 0.02 * right.length(), "{kind}: {across:?} {right:?}");
            assert!((down - below).length() < 0.02 * below.length(), "{kind}: {down:?} {below:?}");
        }
    }
}

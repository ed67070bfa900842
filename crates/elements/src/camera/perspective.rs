//! `perspective`: a pinhole camera, or a thin lens when it has an aperture.
//!
//! | parameter | type | default | meaning |
//! |---|---|---|---|
//! | `fov` | float | 45 | angle of view along `fov_axis`, degrees |
//! | `fov_axis` | string | x | `x`, `y`, `diagonal`, `smaller`, `larger` |
//! | `principal_point_x`, `_y` | float | 0 | how far right and down on the film each pixel looks from, in fractions of its size |
//! | `aperture_radius` | float | 0 | of the lens |
//! | `focus_distance` | float | 1 | to the plane in focus |
//!
//! and the shared ones: `world_from_camera`, `near_clip`, `far_clip`, `shutter_open`, `shutter_close`, `screen_window`.

use aureole_desc::{ParamDoc, Params, SceneError};
use aureole_math::{Point3, Ray, Vector3, warp};

use super::projective::{self, Projective};
use super::{CameraOps, CameraRay, CameraSample, FovAxis, cone_footprint};
use crate::texture::onto_plane;
use crate::{Element, Resolver};

/// A pinhole or thin-lens camera.
#[derive(Clone, Debug)]
pub struct Perspective {
    projective: Projective,
}

impl Element for Perspective {
    const SUMMARY: &'static str = "A pinhole camera, or a thin lens when it has an aperture.";
    const PARAMS: &'static [ParamDoc] = &{
        let [a, b, c, d, e, f, g, h, i] = projective::PARAMS;
        [
            ParamDoc {
                name: "fov",
                ty: "float",
                default: "45",
                doc: "angle of view along `fov_axis`, degrees",
            },
            ParamDoc {
                name: "fov_axis",
                ty: "string",
                default: "x",
                doc: "`x`, `y`, `diagonal`, `smaller` or `larger`",
            },
            ParamDoc {
                name: "principal_point_x",
                ty: "float",
                default: "0",
                doc: "how far right on the film each pixel looks from, as a fraction of the width",
            },
            ParamDoc {
                name: "principal_point_y",
                ty: "float",
                default: "0",
                doc: "how far down on the film each pixel looks from, as a fraction of the height",
            },
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
            i,
        ]
    };

    fn from_params(params: &mut Params, resolver: &mut dyn Resolver) -> Result<Self, SceneError> {
        let fov = params.float_in("fov", 45.0, 1e-3, 179.9)?.to_radians();
        let aspect = resolver.film().aspect();
        let half_width = (0.5 * FovAxis::from_params(params)?.horizontal(fov, aspect)).tan();
        let mut projective = Projective::from_params(params, resolver, half_width, 1e4)?;
        let [shift_x, shift_y] =
            [params.float("principal_point_x", 0.0)?, params.float("principal_point_y", 0.0)?];
        let [x0, x1, y0, y1] = projective.window;
        let (dx, dy) = (shift_x * (x1 - x0), shift_y * (y1 - y0));
        projective.window = [x0 + dx, x1 + dx, y0 - dy, y1 - dy];
        Ok(Self { projective })
    }
}

impl CameraOps for Perspective {
    #[inline]
    fn generate_ray(&self, sample: &CameraSample) -> CameraRay {
        let camera = &self.projective;
        let screen = camera.screen(sample.film);
        let mut origin = Point3::ORIGIN;
        let mut direction = Vector3::new(-screen.x, screen.y, 1.0);
        if camera.aperture_radius > 0.0 {
            let lens = warp::square_to_disk_concentric(sample.lens);
            let focus = Point3::ORIGIN + direction * camera.focus_distance;
            origin = Point3::new(lens.x * camera.aperture_radius, lens.y * camera.aperture_radius, 0.0);
            direction = focus - origin;
        }
        let direction = direction.normalized();
        // Clipping planes are measured along the axis.
        let per_depth = 1.0 / direction.z;
        let time = camera.place.time(sample.time);
        camera
            .place
            .at(time, |place| Ray {
                origin: place.point(origin),
                direction: place.vector(direction).normalized(),
                t_min: camera.near * per_depth,
                t_max: camera.far * per_depth,
                time,
            })
            .into()
    }

    fn footprint(&self, p: Point3, n: Vector3) -> [Vector3; 2] {
        let camera = &self.projective;
        let place = &camera.place.start;
        let d = p - place.point(Point3::ORIGIN);
        let steps = camera.pixel_steps();
        let Some(axis) = place.vector(Vector3::Z).try_normalized() else { return [Vector3::ZERO; 2] };
        let depth = axis.dot(d);
        // What is behind or far aside counts as if the camera turned towards it.
        if depth < 0.1 * d.length() {
            return cone_footprint(d, n, steps[0].length().min(steps[1].length()));
        }
        steps.map(|step| onto_plane(step * depth, d, n))
    }
}

//! Cameras.

use aureole_desc::{Family, Params, SceneError, Value};
use aureole_math::{Transform, Vector3};

use super::params::ParamSet;
use super::state::{PendingCamera, Reader};
use crate::spectrum_file;

/// Shapes of a stop that have names; any other name is a picture's.
const APERTURES: [&str; 5] = ["circular", "gaussian", "pentagon", "square", "star"];

impl Reader<'_, '_> {
    /// Adds a camera, whose film has so many pixels and a diagonal in millimetres.
    pub(super) fn camera_node(
        &mut self,
        camera: &PendingCamera,
        size: [i64; 2],
        diagonal: f64,
    ) -> Result<(), SceneError> {
        let PendingCamera { kind, params: given, world_from_camera } = camera;
        let at = given.span;
        // pbrt's camera space is left-handed: its x axis points to the right of the image.
        let mirrored = world_from_camera.map(|place| place * Transform::scale(Vector3::new(-1.0, 1.0, 1.0)));
        let place = if kind == "spherical" { *world_from_camera } else { mirrored };
        let mut params = Params::new();
        self.place(place, given, &mut params)?;
        let kind = match kind.as_str() {
            "spherical" => spherical(given, &mut params)?,
            "realistic" => {
                params.push("film_diagonal", Value::Float(diagonal), at);
                self.realistic(given, &mut params)?
            }
            "perspective" | "orthographic" => projective(kind, given, size, &mut params)?,
            other => {
                self.warn(format!("camera `{other}` is not known: `perspective` stands in for it"), at);
                projective("perspective", given, size, &mut params)?
            }
        };
        given.finish("Camera", self.context.report);
        let id = self.add(Family::Camera, kind, params, at);
        self.desc.cameras.push(id);
        Ok(())
    }

    /// Where a camera is, and when. Time counts from the first of the transform times, in their distance.
    fn place(
        &mut self,
        [start, end]: [Transform; 2],
        given: &ParamSet,
        params: &mut Params,
    ) -> Result<(), SceneError> {
        let at = given.span;
        params.push("world_from_camera", Value::Transform(start), at);
        if start != end {
            params.push("world_from_camera_end", Value::Transform(end), at);
        }
        let [first, last] = self.transform_times;
        for (theirs, ours, default) in
            [("shutteropen", "shutter_open", 0.0), ("shutterclose", "shutter_close", 1.0)]
        {
            let time = given.float(theirs, default)?;
            if self.has_motion || start != end {
                params.push(ours, Value::Float((time - first) / (last - first)), given.at(theirs));
            }
        }
        Ok(())
    }

    /// A lens from a file of its own.
    fn realistic(&mut self, given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
        let Some(path) = given.path("lensfile", self)? else {
            let message = "a `realistic` camera needs a `lensfile`";
            return Err(SceneError::invalid(message, given.span));
        };
        let at = given.at("lensfile");
        let rows = spectrum_file::read_numbers(&path, self.limits(), at)?;
        params.push("lens", Value::Floats(rows.into()), at);
        for (theirs, ours, default) in
            [("aperturediameter", "aperture_diameter", 1.0), ("focusdistance", "focus_distance", 10.0)]
        {
            if given.try_float(theirs)?.is_some() {
                params.push(ours, Value::Float(given.float(theirs, default)?), given.at(theirs));
            }
        }
        match given.text("aperture")?.unwrap_or_default() {
            "" => {}
            name if APERTURES.contains(&name) => {
                params.push("aperture", Value::String(name.to_owned()), given.at("aperture"));
            }
            _ => {
                let path = given.path("aperture", self)?.unwrap_or_default();
                params.push("aperture_picture", Value::Path(path), given.at("aperture"));
            }
        }
        Ok("realistic")
    }
}

/// A camera that sees all around.
fn spherical(given: &ParamSet, params: &mut Params) -> Result<&'static str, SceneError> {
    let mapping = match given.text("mapping")?.unwrap_or("equalarea") {
        "equalarea" => "equal_area",
        "equirectangular" => "latlong",
        other => {
            let message = format!("`mapping` is `equalarea` or `equirectangular`, not `{other}`");
            return Err(SceneError::invalid(message, given.at("mapping")));
        }
    };
    params.push("mapping", Value::String(mapping.into()), given.span);
    // pbrt reads these and does not use them either.
    for name in ["lensradius", "focaldistance", "frameaspectratio", "screenwindow"] {
        given.get(name);
    }
    Ok("spherical")
}

/// A perspective or orthographic camera; which of them stands for it.
fn projective(
    kind: &str,
    given: &ParamSet,
    size: [i64; 2],
    params: &mut Params,
) -> Result<&'static str, SceneError> {
    let at = given.span;
    let aspect = given.float("frameaspectratio", size[0] as f64 / size[1] as f64)?;
    let default =
        if aspect > 1.0 { [-aspect, aspect, -1.0, 1.0] } else { [-1.0, 1.0, -1.0 / aspect, 1.0 / aspect] };
    let window = match given.floats("screenwindow")? {
        Some(list) => <[f32; 4]>::try_from(list)
            .map_err(|_| SceneError::invalid("`screenwindow` must be four numbers: x0 x1 y0 y1", at))?
            .map(f64::from),
        None => default,
    };
    let (lens, focus) = (given.float("lensradius", 0.0)?, given.float("focaldistance", 1e6)?);
    // How far the window at distance one reaches, of that of the screen.
    let (kind, reach) = match kind {
        "perspective" => ("perspective", (given.float("fov", 90.0)?.to_radians() * 0.5).tan()),
        // In pbrt all rays start on one lens in the middle of the image, and meet their pixel's place at the focus.
        _ if lens > 0.0 => ("perspective", 1.0 / focus),
        _ => ("orthographic", 1.0),
    };
    let window: Vec<f32> = window.iter().map(|x| (x * reach) as f32).collect();
    params.push("screen_window", Value::Floats(window.into()), at);
    params.push("near_clip", Value::Float(0.0), at);
    params.push("far_clip", Value::Float(1e30), at);
    params.push("aperture_radius", Value::Float(lens), at);
    params.push("focus_distance", Value::Float(focus), at);
    Ok(kind)
}

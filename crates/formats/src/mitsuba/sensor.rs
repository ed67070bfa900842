//! Cameras.

use aureole_desc::{Family, SceneError, Value};
use aureole_math::{Point3, Transform, Vector3};

use super::film;
use super::scope::Scope;
use super::translate::Translator;
use super::tree::{ObjectId, Tag};

/// Mitsuba's plugins and Aureole's words for them. Not all of the latter can be rendered yet.
const KINDS: &[(&str, &str)] = &[
    ("perspective", "perspective"),
    ("thinlens", "perspective"),
    ("orthographic", "orthographic"),
    ("radiancemeter", "radiance_meter"),
    ("irradiancemeter", "irradiance_meter"),
    ("distant", "distant"),
    ("batch", "batch"),
];

/// Adds a camera. The first one's film, filter and sampler are the scene's.
pub(super) fn root(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<(), SceneError> {
    let tree = t.tree;
    let mut scope = Scope::new(tree, tree.get(id))?;
    let kind = t.kind(&scope, Family::Camera, KINDS)?;
    scope.rename("to_world", "world_from_camera");
    scope.rename("principal_point_offset_x", "principal_point_x");
    scope.rename("principal_point_offset_y", "principal_point_y");
    match scope.object.plugin.as_str() {
        "perspective" => {
            field_of_view(&mut scope)?;
            // A pinhole is in focus everywhere.
            scope.ignore(&["focus_distance"]);
        }
        "thinlens" => {
            field_of_view(&mut scope)?;
            if !scope.has("aperture_radius") {
                return Err(scope.missing("aperture_radius", "the radius of the lens"));
            }
            scope.default("focus_distance", Value::Float(10_000.0));
        }
        "radiancemeter" | "distant" => directed(&mut scope)?,
        _ => scope.ignore(&["focus_distance"]),
    }

    let is_first = t.scene.cameras.is_empty();
    if let Some(film) = scope.take_child(&[Tag::Film]).filter(|_| is_first) {
        t.scene.film = Some(film::film(t, film.id)?);
    }
    if let Some(sampler) = scope.take_child(&[Tag::Sampler]).filter(|_| is_first) {
        t.scene.sampler = Some(film::sampler(t, sampler.id)?);
    }
    let camera = t.finish(scope, Family::Camera, kind)?;
    t.scene.cameras.push(camera);
    Ok(())
}

/// A meter's place and direction, in place of `to_world`.
fn directed(scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let at = scope.values.span("direction");
    if let Some(direction) = scope.values.try_vec3("direction")? {
        let origin = Point3::from(scope.values.vec3("origin", [0.0; 3])?);
        let direction = Vector3::from(direction);
        let up = if direction.x.abs() + direction.y.abs() > 1e-3 * direction.length() {
            Vector3::Z
        } else {
            Vector3::Y
        };
        let place = Transform::look_at(origin, origin + direction, up)
            .ok_or_else(|| SceneError::invalid("`direction` must not be zero", at))?;
        scope.out.push("world_from_camera", Value::Transform(place), at);
    }
    scope.ignore(&["origin", "direction", "shutter_open", "shutter_close"]);
    Ok(())
}

/// The diagonal of 35 mm film (36 by 24 millimetres), to which focal lengths refer.
const FILM_DIAGONAL: f64 = 43.266_615_305_567_87;

/// The field of view: an angle with its axis, or a focal length in millimetres (50 mm when there is neither).
pub(super) fn field_of_view(scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let at = scope.values.span("focal_length");
    let focal_length = match scope.values.get("focal_length") {
        Some(Value::String(_)) => scope.string("focal_length")?,
        _ => scope.float("focal_length")?.map(|x| x.to_string()),
    };
    if scope.has("fov") {
        scope.default("fov_axis", Value::String("x".to_owned()));
        return Ok(());
    }
    let text = focal_length.unwrap_or_else(|| "50mm".to_owned());
    let millimetres = text.trim().trim_end_matches("mm").trim().parse().ok().filter(|x: &f64| *x > 0.0);
    let millimetres = millimetres.ok_or_else(|| SceneError::BadParam {
        param: "focal_length".to_owned(),
        wanted: "a length such as `50mm`".to_owned(),
        found: format!("`{text}`"),
        at,
    })?;
    let fov = 2.0 * (FILM_DIAGONAL / 2.0 / millimetres).atan().to_degrees();
    scope.take("fov_axis");
    scope.out.push("fov", Value::Float(fov), at);
    scope.out.push("fov_axis", Value::String("diagonal".to_owned()), at);
    Ok(())
}

//! Cameras.

use aureole_desc::{Family, NodeId, Param, Params, SceneError, Value};
use aureole_math::{Point3, Transform, Vector3};

use super::film;
use super::scope::Scope;
use super::translate::Translator;
use super::tree::{ObjectId, Tag};

/// Mitsuba's plugins and Aureole's words for them.
pub(super) const KINDS: &[(&str, &str)] = &[
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
    let is_first = t.scene.cameras.is_empty();
    let camera = translate(t, id, None, is_first)?;
    t.scene.cameras.push(camera);
    Ok(())
}

/// Adds a camera that sits on a shape.
pub(super) fn on_shape(
    t: &mut Translator<'_, '_, '_>,
    id: ObjectId,
    shape: NodeId,
) -> Result<(), SceneError> {
    let is_first = t.scene.cameras.is_empty();
    let camera = translate(t, id, Some(shape), is_first)?;
    t.scene.cameras.push(camera);
    Ok(())
}

/// A camera's node; the scene gets the film, filter and sampler of one that is its first.
fn translate(
    t: &mut Translator<'_, '_, '_>,
    id: ObjectId,
    shape: Option<NodeId>,
    is_first: bool,
) -> Result<NodeId, SceneError> {
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
        "irradiancemeter" => {
            let shape = shape.ok_or_else(|| {
                SceneError::invalid("an `irradiancemeter` belongs inside of a shape", scope.span())
            })?;
            scope.out.push("shape", Value::Node(shape), scope.span());
            scope.ignore(&["world_from_camera", "shutter_open", "shutter_close"]);
        }
        "batch" => batch(t, &mut scope)?,
        _ => scope.ignore(&["focus_distance"]),
    }

    if let Some(film) = scope.take_child(&[Tag::Film]) {
        match t.first_film {
            None if is_first => {
                t.first_film = Some(film.id);
                t.scene.film = Some(film::film(t, film.id)?);
            }
            Some(first) if t.tree.get(first).values != t.tree.get(film.id).values => {
                let message = "the film of the scene's first sensor counts for all of them, not this one";
                t.context.report.warn(message, film.span);
            }
            _ => {}
        }
    }
    if let Some(sampler) = scope.take_child(&[Tag::Sampler]).filter(|_| is_first) {
        t.scene.sampler = Some(film::sampler(t, sampler.id)?);
    }
    t.finish(scope, Family::Camera, kind)
}

/// The cameras of a batch; their own films and samplers do not count.
fn batch(t: &mut Translator<'_, '_, '_>, scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let mut cameras = Vec::new();
    while let Some(child) = scope.take_child(&[Tag::Sensor]) {
        if t.tree.get(child.id).plugin == "batch" {
            return Err(SceneError::invalid("a `batch` inside of a `batch`", child.span));
        }
        let camera = translate(t, child.id, None, false)?;
        let aspect = aspect_of_own_film(t, child.id)?;
        let params = &mut t.scene[camera].params;
        if let Some(fov) = horizontal(params, aspect)? {
            let span = params.span("fov");
            params.set(Param { name: "fov".to_owned(), value: Value::Float(fov), span });
            params.set(Param { name: "fov_axis".to_owned(), value: Value::String("x".to_owned()), span });
        }
        cameras.push(camera);
    }
    if cameras.is_empty() {
        return Err(scope.missing("sensor", "at least one sensor inside"));
    }
    scope.out.push("cameras", Value::Nodes(cameras), scope.span());
    scope.ignore(&["world_from_camera", "shutter_open", "shutter_close", "srf"]);
    Ok(())
}

/// Width over height of the film that a sensor names, by its size or Mitsuba's default.
fn aspect_of_own_film(t: &Translator<'_, '_, '_>, sensor: ObjectId) -> Result<f64, SceneError> {
    let mut scope = Scope::new(t.tree, t.tree.get(sensor))?;
    let mut size = [768, 576];
    if let Some(film) = scope.take_child(&[Tag::Film]) {
        let mut film = Scope::new(t.tree, t.tree.get(film.id))?;
        for (side, name) in size.iter_mut().zip(["width", "height"]) {
            *side = film.int(name)?.unwrap_or(*side);
        }
    }
    Ok(size[0].max(1) as f64 / size[1].max(1) as f64)
}

/// The horizontal field of view in degrees, where it is told by another axis. Mitsuba takes that from a sensor's own film, whatever
/// film a batch then gives to it.
fn horizontal(params: &Params, aspect: f64) -> Result<Option<f64>, SceneError> {
    let mut params = params.clone();
    let (Some(fov), Some(axis)) = (params.try_float("fov")?, params.try_string("fov_axis")?) else {
        return Ok(None);
    };
    let factor = match axis.as_str() {
        "y" => aspect,
        "smaller" => aspect.max(1.0),
        "larger" => aspect.min(1.0),
        "diagonal" => aspect / aspect.hypot(1.0),
        _ => return Ok(None),
    };
    Ok(Some(2.0 * ((0.5 * f64::from(fov)).to_radians().tan() * factor).atan().to_degrees()))
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

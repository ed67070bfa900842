//! Lights.

use aureole_desc::{Family, NodeId, SceneError, Value};

use super::scope::Scope;
use super::sensor;
use super::translate::Translator;
use super::tree::{ObjectId, Tag};

/// Mitsuba's plugins and Aureole's words for them. Not all of the latter can be rendered yet.
pub(super) const KINDS: &[(&str, &str)] = &[
    ("area", "area"),
    ("point", "point"),
    ("spot", "spot"),
    ("directional", "directional"),
    ("constant", "constant"),
    ("envmap", "envmap"),
    ("projector", "projector"),
    ("sunsky", "sunsky"),
    ("timed_sunsky", "sunsky"),
    // Half of it each, as in Mitsuba 0.6.
    ("sky", "sunsky"),
    ("sun", "sunsky"),
];

/// Adds a light of the scene. Area lights shine only from a shape that refers to them.
pub(super) fn root(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<(), SceneError> {
    if matches!(t.tree.get(id).plugin.as_str(), "area" | "directionalarea") {
        return Ok(());
    }
    if let Value::Node(light) = t.value(id)? {
        t.scene.lights.push(light);
    }
    Ok(())
}

pub(super) fn translate<'a>(
    t: &mut Translator<'a, '_, '_>,
    mut scope: Scope<'a>,
) -> Result<NodeId, SceneError> {
    let kind = t.kind(&scope, Family::Light, KINDS)?;
    scope.rename("to_world", "world_from_light");
    // How often a light is picked changes noise, not pictures.
    scope.ignore(&["sampling_weight", "mis_compensation"]);
    match kind {
        "point" if scope.has("position") && scope.has("world_from_light") => {
            let at = scope.values.span("position");
            return Err(SceneError::invalid("a point light has either `position` or `to_world`", at));
        }
        "envmap" => {
            t.put_path(&mut scope)?;
            scope.out.push("mapping", Value::String("latlong".to_owned()), scope.span());
        }
        "projector" => {
            sensor::field_of_view(&mut scope)?;
            // Mitsuba's slide hangs with v = 0 at the top, and its irradiance is short of a factor π.
            scope.out.push("flip_v", Value::Bool(true), scope.span());
            let scale = scope.float("scale")?.unwrap_or(1.0);
            scope.out.push("scale", Value::Float(scale * std::f64::consts::PI), scope.span());
        }
        "sunsky" => sun_and_sky(t, &mut scope)?,
        _ => {}
    }
    t.finish(scope, Family::Light, kind)
}

fn sun_and_sky(t: &mut Translator<'_, '_, '_>, scope: &mut Scope<'_>) -> Result<(), SceneError> {
    match scope.object.plugin.as_str() {
        "sky" => scope.default("sun_scale", Value::Float(0.0)),
        "sun" => scope.default("sky_scale", Value::Float(0.0)),
        _ => {}
    }
    scope.rename("complex_sun", "limb_darkening");
    if scope.object.plugin == "timed_sunsky" { timed(t, scope) } else { Ok(()) }
}

/// A sky over a span of time, as it is when the shutter opens: on the first day, at the window's first hour.
fn timed(t: &mut Translator<'_, '_, '_>, scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let shutter = |name: &str| {
        let mut sensors = t.tree.objects().filter(|object| object.tag == Tag::Sensor);
        sensors.find_map(|sensor| sensor.values.clone().try_float(name).ok().flatten()).unwrap_or(0.0)
    };
    if shutter("shutter_close") > shutter("shutter_open") {
        let message = "time does not move the sun: the sky is that of the moment in which the shutter opens";
        t.context.report.warn(message, scope.span());
    }
    for (theirs, ours, default) in
        [("start_year", "year", 2025), ("start_month", "month", 1), ("start_day", "day", 1)]
    {
        let value = scope.int(theirs)?.unwrap_or(default);
        scope.out.push(ours, Value::Int(value), scope.span());
    }
    let hour = scope.float("window_start_time")?.unwrap_or(7.0);
    scope.out.push("hour", Value::Float(hour), scope.span());
    scope.ignore(&["end_year", "end_month", "end_day", "window_end_time", "shutter_open", "shutter_close"]);
    Ok(())
}

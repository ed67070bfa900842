//! Textures, and spectra written as plugins.

use std::sync::Arc;

use aureole_desc::{Family, SceneError, Value};
use aureole_math::{Transform, Vector3};
use aureole_spectrum::{SpectrumSource, Tabulated, blackbody};

use super::scope::Scope;
use super::translate::Translator;
use super::xml::numbers;
use crate::mesh::vol;

/// Mitsuba's plugins and Aureole's words for them; the constant ones become spectra.
pub(super) const KINDS: &[(&str, &str)] = &[
    ("bitmap", "bitmap"),
    ("checkerboard", "checkerboard"),
    ("mesh_attribute", "mesh_attribute"),
    ("volume", "volume"),
    ("uniform", "constant"),
    ("rawconstant", "constant"),
    ("srgb", "constant"),
    ("d65", "constant"),
    ("blackbody", "constant"),
    ("regular", "constant"),
    ("irregular", "constant"),
];

pub(super) fn translate<'a>(
    t: &mut Translator<'a, '_, '_>,
    mut scope: Scope<'a>,
) -> Result<Value, SceneError> {
    let kind = t.kind(&scope, Family::Texture, KINDS)?;
    match kind {
        "constant" => {
            let spectrum = constant(&mut scope)?;
            t.leave(&scope);
            return Ok(Value::Spectrum(spectrum));
        }
        "volume" => {
            let (volume, constant) = (scope.take_named("volume"), scope.spectrum("volume")?);
            t.leave(&scope);
            return match volume {
                Some(volume) => volume_texture(t, Scope::new(t.tree, t.tree.get(volume.id))?),
                None => Ok(Value::Spectrum(constant.unwrap_or(SpectrumSource::Uniform(0.75)))),
            };
        }
        "bitmap" => {
            t.put_path(&mut scope)?;
            scope.rename("filter_type", "filter");
            scope.rename("wrap_mode", "wrap");
            let encoding = if scope.bool("raw", false)? { "linear" } else { "auto" };
            scope.out.push("encoding", Value::String(encoding.to_owned()), scope.span());
            // How texels are kept in memory.
            scope.ignore(&["accel", "format"]);
            place(&mut scope)?;
            flip_v(&mut scope)?;
        }
        "checkerboard" => {
            place(&mut scope)?;
            // Mitsuba's `eval_1` takes the other colour than its `eval`; its images depend on it.
            scope.out.push("swap_numbers", Value::Bool(true), scope.span());
        }
        _ => {}
    }
    t.finish(scope, Family::Texture, kind).map(Value::Node)
}

/// A quantity in space, shown where a surface is.
fn volume_texture<'a>(t: &mut Translator<'a, '_, '_>, mut scope: Scope<'a>) -> Result<Value, SceneError> {
    if t.kind(&scope, Family::Texture, &[("gridvolume", "grid"), ("constvolume", "constant")])? == "constant"
    {
        let value = match scope.take_named("value") {
            Some(child) => Some(t.value(child.id)?),
            None => scope.spectrum("value")?.map(Value::Spectrum),
        };
        t.leave(&scope);
        return Ok(value.unwrap_or(Value::Spectrum(SpectrumSource::Uniform(1.0))));
    }
    let (path, at) = t.path(&mut scope, "filename")?;
    let grid = vol::read(&path, &t.context.options.limits, at)?;
    let mut grid_from_world = scope.values.transform("to_world")?.inverse();
    if scope.bool("use_grid_bbox", false)? {
        let [low, high] = grid.bounds;
        let size: [f32; 3] = std::array::from_fn(|i| high[i] - low[i]);
        let box_from_unit = Transform::translate(Vector3::from(low)) * Transform::scale(Vector3::from(size));
        if !box_from_unit.is_invertible() {
            let message = "the grid's box is empty".to_owned();
            return Err(SceneError::Asset { path, message, at });
        }
        grid_from_world = box_from_unit.inverse() * grid_from_world;
    }
    scope.values.remove("to_world");
    // Colours are taken as they are with or without it, and how texels are kept is our affair.
    scope.ignore(&["raw", "accel"]);
    scope.rename("filter_type", "filter");
    scope.rename("wrap_mode", "wrap");
    scope.out.push("values", Value::Floats(grid.values), at);
    scope.out.push("resolution", Value::Ints(grid.resolution.map(|n| n as i32).as_slice().into()), at);
    scope.out.push("channels", Value::Int(grid.channels as i64), at);
    scope.out.push("texture_from_world", Value::Transform(grid_from_world), at);
    t.finish(scope, Family::Texture, "grid").map(Value::Node)
}

/// Scale and offset of version 0.6 as a transform.
fn place(scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let mut get = |long: &str, short: &str| -> Result<Option<f64>, SceneError> {
        Ok(scope.float(long)?.or(scope.float(short)?))
    };
    let scale = [get("uscale", "u_scale")?, get("vscale", "v_scale")?];
    let offset = [get("uoffset", "u_offset")?, get("voffset", "v_offset")?];
    if scale.iter().chain(&offset).all(Option::is_none) {
        return Ok(());
    }
    let pair = |v: [Option<f64>; 2], default: f64| v.map(|x| x.unwrap_or(default) as f32);
    let ([su, sv], [ou, ov]) = (pair(scale, 1.0), pair(offset, 0.0));
    let to_uv = Transform::translate(Vector3::new(ou, ov, 0.0)) * Transform::scale(Vector3::new(su, sv, 1.0));
    scope.values.push("to_uv", Value::Transform(to_uv), scope.object.span);
    Ok(())
}

/// Mitsuba counts rows of a bitmap from the top, Aureole from the bottom.
fn flip_v(scope: &mut Scope<'_>) -> Result<(), SceneError> {
    let at = scope.values.span("to_uv");
    let to_uv = scope.values.transform("to_uv")?;
    let flip = Transform::translate(Vector3::Y) * Transform::scale(Vector3::new(1.0, -1.0, 1.0));
    scope.values.push("to_uv", Value::Transform(flip * to_uv), at);
    Ok(())
}

fn constant(scope: &mut Scope<'_>) -> Result<SpectrumSource, SceneError> {
    match scope.object.plugin.as_str() {
        // White of any strength: in RGB the illuminant is white by definition.
        "d65" => {
            let scale = scope.float("scale")?.or(scope.float("value")?).unwrap_or(1.0) as f32;
            let color = scope.values.vec3("color", [1.0; 3])?;
            scope.take("color");
            Ok(SpectrumSource::Rgb(color.map(|x| x * scale)))
        }
        "blackbody" => {
            let kelvin = scope.float("temperature")?.filter(|kelvin| *kelvin > 0.0);
            let kelvin = kelvin.ok_or_else(|| scope.missing("temperature", "a temperature in kelvin"))?;
            let mut table = blackbody(kelvin as f32);
            let scale = scope.float("scale")?.unwrap_or(1.0) as f32;
            table.values.iter_mut().for_each(|value| *value *= scale);
            Ok(SpectrumSource::Tabulated(Arc::new(table)))
        }
        "regular" => regular(scope),
        "irregular" => irregular(scope),
        "srgb" => Ok(scope.spectrum("color")?.unwrap_or(SpectrumSource::Uniform(1.0))),
        _ => Ok(scope.spectrum("value")?.unwrap_or(SpectrumSource::Uniform(1.0))),
    }
}

/// A list of numbers in a string.
fn list(scope: &mut Scope<'_>, name: &str) -> Result<Vec<f32>, SceneError> {
    let at = scope.values.span(name);
    let text = scope.string(name)?.ok_or_else(|| scope.missing(name, "numbers"))?;
    let found = numbers(&text).filter(|list| !list.is_empty());
    found.map(|list| list.into_iter().map(|x| x as f32).collect()).ok_or_else(|| SceneError::BadParam {
        param: name.to_owned(),
        wanted: "numbers".to_owned(),
        found: format!("`{text}`"),
        at,
    })
}

fn regular(scope: &mut Scope<'_>) -> Result<SpectrumSource, SceneError> {
    let values = list(scope, "values")?;
    let mut end = |name: &str, old: &str| -> Result<f64, SceneError> {
        let found = scope.float(name)?.or(scope.float(old)?);
        found.ok_or_else(|| scope.missing(name, "a wavelength in nanometres"))
    };
    let (low, high) = (end("wavelength_min", "lambda_min")?, end("wavelength_max", "lambda_max")?);
    let step = (high - low) / (values.len() - 1).max(1) as f64;
    let lambda = (0..values.len()).map(|i| (low + step * i as f64) as f32).collect();
    table(scope, lambda, values)
}

fn irregular(scope: &mut Scope<'_>) -> Result<SpectrumSource, SceneError> {
    let (lambda, values) = (list(scope, "wavelengths")?, list(scope, "values")?);
    table(scope, lambda, values)
}

fn table(scope: &Scope<'_>, lambda: Vec<f32>, values: Vec<f32>) -> Result<SpectrumSource, SceneError> {
    if lambda.len() != values.len() || lambda.windows(2).any(|pair| pair[0] >= pair[1]) {
        let message = "a spectrum needs as many values as wavelengths, and wavelengths that ascend";
        return Err(SceneError::invalid(message, scope.span()));
    }
    Ok(SpectrumSource::Tabulated(Arc::new(Tabulated { lambda, values })))
}

//! Plain properties: numbers, words, points, colours, spectra.

use std::sync::Arc;

use aureole_desc::{SceneError, Span, Value};
use aureole_spectrum::{SpectrumSource, Tabulated, blackbody, srgb_to_linear};

use super::Parser;
use super::element::Element;
use crate::spectrum_file;

/// The elements that make plain properties, for messages.
const TAGS: [&str; 13] = [
    "float",
    "integer",
    "boolean",
    "string",
    "point",
    "vector",
    "rgb",
    "srgb",
    "color",
    "spectrum",
    "blackbody",
    "transform",
    "ref",
];

/// Parses a property; gives its name too.
pub(super) fn parse(
    element: &Element<'_>,
    inside_emitter: bool,
    parser: &mut Parser<'_, '_>,
) -> Result<(String, Value), SceneError> {
    let value = match element.tag() {
        "float" => Value::Float(number(element)?),
        "integer" => Value::Int(integer(element)?),
        "boolean" => Value::Bool(boolean(element)?),
        "string" => Value::String(plain(element)?.to_owned()),
        "point" | "vector" => {
            element.allow(&["name", "value", "x", "y", "z"])?;
            Value::Vec3(vector(element, 0.0)?)
        }
        "rgb" | "color" => Value::Spectrum(SpectrumSource::Rgb(rgb(element)?)),
        "srgb" => Value::Spectrum(SpectrumSource::Rgb(rgb(element)?.map(srgb_to_linear))),
        "spectrum" => Value::Spectrum(spectrum(element, inside_emitter, parser)?),
        "blackbody" => Value::Spectrum(temperature(element)?),
        unknown => {
            let tags = TAGS
                .iter()
                .chain(&["default", "include", "path", "alias", "shape", "bsdf", "emitter", "sensor"]);
            return Err(SceneError::UnknownName {
                what: "element",
                name: unknown.to_owned(),
                known: tags.map(|&tag| tag.to_owned()).collect(),
                at: element.span(),
            });
        }
    };
    Ok((element.required("name")?, value))
}

/// The `value` of an element that has only that and a name.
fn plain<'a>(element: &'a Element<'_>) -> Result<&'a str, SceneError> {
    element.allow(&["name", "value"])?;
    element.required("value")?;
    Ok(element.get("value").unwrap_or("").trim())
}

fn number(element: &Element<'_>) -> Result<f64, SceneError> {
    let text = plain(element)?;
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| element.bad("value", "a finite number"))
}

fn integer(element: &Element<'_>) -> Result<i64, SceneError> {
    plain(element)?.parse().map_err(|_| element.bad("value", "an integer"))
}

fn boolean(element: &Element<'_>) -> Result<bool, SceneError> {
    match plain(element)?.to_ascii_lowercase().as_str() {
        "true" => Ok(true),
        "false" => Ok(false),
        _ => Err(element.bad("value", "`true` or `false`")),
    }
}

/// Numbers between commas, semicolons or blanks.
pub(in crate::mitsuba) fn numbers(text: &str) -> Option<Vec<f64>> {
    text.split(|c: char| c == ',' || c == ';' || c.is_whitespace())
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()))
        .collect()
}

/// Three numbers: `value="x, y, z"`, one number for all three, or `x=`, `y=`, `z=` with a default for what is missing.
pub(super) fn vector(element: &Element<'_>, default: f64) -> Result<[f64; 3], SceneError> {
    if let Some(text) = element.get("value") {
        return match numbers(text).as_deref() {
            Some(&[x]) => Ok([x; 3]),
            Some(&[x, y, z]) => Ok([x, y, z]),
            _ => Err(element.bad("value", "three numbers")),
        };
    }
    let axis = |name| match element.get(name) {
        None => Ok(default),
        Some(text) => {
            let found = text.trim().parse().ok().filter(|x: &f64| x.is_finite());
            found.ok_or_else(|| element.bad(name, "a finite number"))
        }
    };
    Ok([axis("x")?, axis("y")?, axis("z")?])
}

/// A colour: three numbers, one for all three, or hexadecimal sRGB.
fn rgb(element: &Element<'_>) -> Result<[f32; 3], SceneError> {
    let text = plain(element)?;
    if let Some(hex) = text.strip_prefix('#') {
        let hex = (hex.len() == 6).then(|| u32::from_str_radix(hex, 16).ok()).flatten();
        let hex = hex.ok_or_else(|| element.bad("value", "six hexadecimal digits"))?;
        let encoded = [16, 8, 0].map(|shift| (hex >> shift & 0xff) as f32 / 255.0);
        return Ok(if element.tag() == "srgb" { encoded } else { encoded.map(srgb_to_linear) });
    }
    match numbers(text).as_deref() {
        Some(&[x]) => Ok([x as f32; 3]),
        Some(&[r, g, b]) => Ok([r, g, b].map(|x| x as f32)),
        _ => Err(element.bad("value", "three numbers, one number, or `#rrggbb`")),
    }
}

/// One number for all wavelengths, pairs `wavelength:value`, or a file of such pairs.
fn spectrum(
    element: &Element<'_>,
    inside_emitter: bool,
    parser: &mut Parser<'_, '_>,
) -> Result<SpectrumSource, SceneError> {
    element.allow(&["name", "value", "filename"])?;
    if let Some(name) = element.get("filename") {
        return spectrum_file(name, element.attribute_span("filename"), parser);
    }
    element.required("value")?;
    let text = element.get("value").unwrap_or("").trim();
    if let Ok(value) = text.parse::<f32>() {
        // A light of constant power per wavelength is not white but slightly red, so it must stay a table.
        return Ok(if inside_emitter { flat(value) } else { SpectrumSource::Uniform(value) });
    }
    let pairs =
        text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty()).map(|word| {
            let (lambda, value) = word.split_once(':')?;
            Some((lambda.trim().parse().ok()?, value.trim().parse().ok()?))
        });
    let wanted = "one number, or pairs of wavelength and value such as `400:0.1, 700:0.3`";
    let pairs: Vec<(f32, f32)> = pairs.collect::<Option<_>>().ok_or_else(|| element.bad("value", wanted))?;
    let table = table(pairs).ok_or_else(|| element.bad("value", "pairs with ascending wavelengths"))?;
    Ok(SpectrumSource::Tabulated(Arc::new(table)))
}

/// The same value over the visible wavelengths.
fn flat(value: f32) -> SpectrumSource {
    SpectrumSource::Tabulated(Arc::new(Tabulated { lambda: vec![360.0, 830.0], values: vec![value; 2] }))
}

fn table(pairs: Vec<(f32, f32)>) -> Option<Tabulated> {
    let finite = pairs.iter().all(|(lambda, value)| lambda.is_finite() && value.is_finite());
    let ascending = pairs.windows(2).all(|pair| pair[0].0 < pair[1].0);
    let (lambda, values) = pairs.into_iter().unzip();
    let table = Tabulated { lambda, values };
    (finite && ascending && !table.lambda.is_empty()).then_some(table)
}

/// A file with a wavelength and a value on each line.
fn spectrum_file(name: &str, at: Span, parser: &mut Parser<'_, '_>) -> Result<SpectrumSource, SceneError> {
    let folder =
        parser.context.sources.path(at).and_then(|file| file.parent()).unwrap_or("".as_ref()).to_owned();
    let mut search = parser.search.clone();
    search.push_front(folder);
    let path = search.resolve(name);
    let table = spectrum_file::read(&path, &parser.context.options.limits, at)?;
    Ok(SpectrumSource::Tabulated(Arc::new(table)))
}

/// `<blackbody temperature="5000K" scale="1"/>` of old scenes.
fn temperature(element: &Element<'_>) -> Result<SpectrumSource, SceneError> {
    element.allow(&["name", "temperature", "scale"])?;
    let text = element.required("temperature")?;
    let kelvin: Option<f32> = text.trim().trim_end_matches(['K', 'k']).trim().parse().ok();
    let kelvin = kelvin.filter(|k| *k > 0.0 && k.is_finite());
    let kelvin = kelvin.ok_or_else(|| element.bad("temperature", "a temperature in kelvin"))?;
    let scale: f32 = match element.get("scale") {
        Some(text) => text.trim().parse().map_err(|_| element.bad("scale", "a number"))?,
        None => 1.0,
    };
    let mut table = blackbody(kelvin);
    table.values.iter_mut().for_each(|value| *value *= scale);
    Ok(SpectrumSource::Tabulated(Arc::new(table)))
}

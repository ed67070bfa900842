//! Films, reconstruction filters and samplers: what hangs below a sensor.

use aureole_desc::{Family, NodeId, SceneError, Value};

use super::scope::Scope;
use super::translate::Translator;
use super::tree::{ObjectId, Tag};

pub(super) const FILMS: &[(&str, &str)] = &[("hdrfilm", "film"), ("ldrfilm", "film"), ("specfilm", "film")];

pub(super) const FILTERS: &[(&str, &str)] = &[
    ("box", "box"),
    ("tent", "tent"),
    ("gaussian", "gaussian"),
    ("mitchell", "mitchell"),
    ("catmullrom", "mitchell"),
    ("lanczos", "lanczos"),
];

/// All samplers but `stratified` have the same mean as Sobol points and more noise.
pub(super) const SAMPLERS: &[(&str, &str)] = &[
    ("independent", "sobol"),
    ("stratified", "stratified"),
    ("multijitter", "sobol"),
    ("orthogonal", "sobol"),
    ("ldsampler", "sobol"),
];

/// Translates a film and its filter, which the scene gets.
pub(super) fn film(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<NodeId, SceneError> {
    let tree = t.tree;
    let mut scope = Scope::new(tree, tree.get(id))?;
    let kind = t.kind(&scope, Family::Film, FILMS)?;
    if scope.object.plugin == "specfilm" {
        t.context.report.warn("`specfilm` is rendered as a film of colours", scope.span());
        scope.children.retain(|child| !matches!(child.tag, Tag::Spectrum | Tag::Texture));
    }
    scope.default("width", Value::Int(768));
    scope.default("height", Value::Int(576));
    scope.rename("crop_offset_x", "crop_x");
    scope.rename("crop_offset_y", "crop_y");
    // The file's format follows from its name; borders do not change what is inside.
    scope.ignore(&[
        "file_format",
        "component_format",
        "sample_border",
        "compensate",
        "banner",
        "attach_log",
        "high_quality_edges",
        "label",
    ]);
    if let Some(format) = scope.string("pixel_format")? {
        // Version 0.6 has lists of them, for several pictures.
        let first = format.split([',', ' ']).next().unwrap_or_default();
        let first = match first {
            "luminanceAlpha" => "luminance_alpha".to_owned(),
            "spectrum" | "spectrumAlpha" => "rgb".to_owned(),
            other => other.to_owned(),
        };
        scope.out.push("pixel_format", Value::String(first), scope.span());
    }
    match scope.take_child(&[Tag::Filter]) {
        Some(child) => t.scene.filter = Some(filter(t, child.id)?),
        None => t.scene.filter = Some(default_filter(t, &scope)),
    }
    t.finish(scope, Family::Film, kind)
}

/// Mitsuba's filter when a film names none.
fn default_filter(t: &mut Translator<'_, '_, '_>, scope: &Scope<'_>) -> NodeId {
    let node = aureole_desc::Node::new(Family::Filter, "gaussian", Default::default(), scope.span());
    t.scene.add(node)
}

fn filter(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<NodeId, SceneError> {
    let tree = t.tree;
    let mut scope = Scope::new(tree, tree.get(id))?;
    let kind = t.kind(&scope, Family::Filter, FILTERS)?;
    match scope.object.plugin.as_str() {
        // A member of the family of Mitchell and Netravali.
        "catmullrom" => {
            scope.out.push("b", Value::Float(0.0), scope.span());
            scope.out.push("c", Value::Float(0.5), scope.span());
        }
        // Mitsuba cuts the Gaussian off at four standard deviations.
        "gaussian" => {
            if let Some(std_dev) = scope.float("stddev")? {
                scope.out.push("std_dev", Value::Float(std_dev), scope.span());
                scope.out.push("radius", Value::Float(4.0 * std_dev), scope.span());
            }
        }
        "lanczos" => {
            if let Some(lobes) = scope.float("lobes")? {
                scope.out.push("radius", Value::Float(lobes), scope.span());
                scope.out.push("tau", Value::Float(lobes), scope.span());
            }
        }
        "mitchell" => {
            scope.rename("B", "b");
            scope.rename("C", "c");
            scope.rename("A", "b");
        }
        _ => {}
    }
    t.finish(scope, Family::Filter, kind)
}

pub(super) fn sampler(t: &mut Translator<'_, '_, '_>, id: ObjectId) -> Result<NodeId, SceneError> {
    let tree = t.tree;
    let mut scope = Scope::new(tree, tree.get(id))?;
    let kind = t.kind(&scope, Family::Sampler, SAMPLERS)?;
    scope.default("sample_count", Value::Int(4));
    // Which noise it is is a matter of the render's own seed.
    scope.ignore(&["seed", "jitter", "strength", "dimension", "scramble"]);
    t.finish(scope, Family::Sampler, kind)
}

//! Small scenes in, nodes out; wrong scenes in, messages with places out.

mod errors;
mod families;
mod files;
mod nothing_lost;

use aureole_desc::{Node, NodeId, Report, SceneDesc, SceneError, Sources, Value};

use crate::{LoadOptions, load_text};

/// Everything that reading gives.
struct Outcome {
    result: Result<SceneDesc, SceneError>,
    sources: Sources,
    report: Report,
}

fn read_with(text: &str, options: &LoadOptions) -> Outcome {
    let (mut sources, mut report) = (Sources::default(), Report::default());
    let result = load_text("mitsuba", "scene.xml", text, options, &mut sources, &mut report);
    Outcome { result, sources, report }
}

/// Reads the inside of a scene, which must be right.
fn read(inside: &str) -> (SceneDesc, Vec<String>) {
    let outcome = read_with(&format!("<scene version=\"3.0.0\">{inside}</scene>"), &LoadOptions::default());
    let warnings = outcome.report.warnings.into_iter().map(|warning| warning.message).collect();
    (outcome.result.unwrap(), warnings)
}

/// A node as text: its kind and its parameters, nested nodes in brackets.
fn show(scene: &SceneDesc, id: NodeId) -> String {
    let node: &Node = &scene[id];
    let params: Vec<String> = node
        .params
        .iter()
        .map(|param| format!("{}={}", param.name, show_value(scene, &param.value)))
        .collect();
    format!("{}({})", node.kind, params.join(" "))
}

fn show_value(scene: &SceneDesc, value: &Value) -> String {
    match value {
        Value::Node(id) => show(scene, *id),
        Value::Nodes(ids) => {
            format!("[{}]", ids.iter().map(|id| show(scene, *id)).collect::<Vec<_>>().join(", "))
        }
        Value::Bool(b) => b.to_string(),
        Value::Int(i) => i.to_string(),
        Value::Float(x) => x.to_string(),
        Value::String(s) => s.clone(),
        Value::Path(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        Value::Vec3(v) => format!("{v:?}"),
        Value::Spectrum(spectrum) => format!("{spectrum:?}"),
        Value::Transform(t) if t.is_identity() => "identity".to_owned(),
        Value::Transform(t) => format!("{:?}", t.rows().map(|row| row.map(|x| (x * 1e3).round() / 1e3))),
        other => other.type_name().to_owned(),
    }
}

/// The only shape of a scene as text.
fn show_shape(inside: &str) -> String {
    let (scene, warnings) = read(inside);
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(scene.shapes.len(), 1);
    show(&scene, scene.shapes[0])
}

/// A material, on a sphere, as text.
fn show_bsdf(inside: &str) -> String {
    let shape = show_shape(&format!("<shape type=\"sphere\">{inside}</shape>"));
    shape.strip_prefix("sphere(bsdf=").and_then(|rest| rest.strip_suffix(')')).unwrap().to_owned()
}

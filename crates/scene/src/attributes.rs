//! Whether meshes have what textures ask them for.

use aureole_desc::{Family, Node, NodeId, Report, SceneDesc, Value, suggest};
use rustc_hash::{FxHashMap, FxHashSet};

/// The texture that shows a quantity of a mesh.
const KIND: &str = "mesh_attribute";

/// Warns about textures that ask a shape for a quantity that it does not have: they are black there.
pub(crate) fn check(desc: &SceneDesc, report: &mut Report) {
    let is_asked = |node: &Node| node.family == Family::Texture && node.kind == KIND;
    if !desc.nodes().any(|(_, node)| is_asked(node)) {
        return;
    }
    let mut asked_below: FxHashMap<NodeId, Vec<NodeId>> = FxHashMap::default();
    let is_solid =
        |node: &Node| node.family == Family::Shape && !matches!(node.kind.as_str(), "group" | "instance");
    for (_, shape) in desc.nodes().filter(|(_, node)| is_solid(node)) {
        for child in children(shape) {
            for &texture in asked_below.entry(child).or_insert_with(|| below(desc, child, is_asked)).iter() {
                check_shape(shape, &desc[texture], report);
            }
        }
    }
}

fn check_shape(shape: &Node, texture: &Node, report: &mut Report) {
    let attributes = match shape.params.get("mesh") {
        Some(Value::Mesh(mesh)) => &mesh.attributes[..],
        _ => &[],
    };
    let name = match texture.params.get("name") {
        Some(Value::String(name)) => name.as_str(),
        _ => "vertex_color",
    };
    let known = || attributes.iter().map(|attribute| attribute.name.as_str());
    if known().any(|known| known == name) {
        return;
    }
    let near = suggest(name, known()).map(|near| format!("did you mean `{near}`?"));
    let all = || format!("it has {}", known().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "));
    let help = near.or_else(|| (!attributes.is_empty()).then(all));
    let message = format!("a {} has no attribute `{name}`: the texture is black there", shape.kind);
    let at = if texture.params.has("name") { texture.params.span("name") } else { texture.span };
    report.warn_with_help(message, help, at);
}

fn children(node: &Node) -> impl Iterator<Item = NodeId> {
    node.params.iter().flat_map(|param| match &param.value {
        Value::Node(child) => std::slice::from_ref(child).iter().copied(),
        Value::Nodes(children) => children.iter().copied(),
        _ => [].iter().copied(),
    })
}

/// The nodes of a kind at and below one that belong to its surface.
fn below(desc: &SceneDesc, root: NodeId, is_wanted: impl Fn(&Node) -> bool) -> Vec<NodeId> {
    let mut seen = FxHashSet::default();
    let mut open = vec![root];
    let mut found = Vec::new();
    while let Some(id) = open.pop() {
        if desc[id].family == Family::Shape || !seen.insert(id) {
            continue;
        }
        if is_wanted(&desc[id]) {
            found.push(id);
        }
        open.extend(children(&desc[id]));
    }
    found
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use aureole_desc::{Attribute, AttributeDomain, Mesh, Params, Span};

    use super::*;

    fn warnings(attribute: &str, asked: &str) -> Vec<(String, Option<String>)> {
        let mesh = Mesh {
            positions: vec![[0.0; 3]; 3],
            indices: vec![[0, 1, 2]],
            attributes: vec![Attribute {
                name: attribute.to_owned(),
                domain: AttributeDomain::Face,
                channels: 1,
                data: vec![1.0],
            }],
            ..Mesh::default()
        };
        let mut desc = SceneDesc::default();
        let mut add = |family, kind: &str, params| desc.add(Node::new(family, kind, params, Span::NONE));
        let texture = add(Family::Texture, KIND, Params::new().with("name", Value::String(asked.to_owned())));
        let diffuse = add(Family::Bsdf, "diffuse", Params::new().with("reflectance", Value::Node(texture)));
        let bsdf = add(Family::Bsdf, "two_sided", Params::new().with("bsdf", Value::Node(diffuse)));
        for _ in 0..2 {
            let params = Params::new().with("mesh", Value::Mesh(Arc::new(mesh.clone())));
            add(Family::Shape, "mesh", params.with("bsdf", Value::Node(bsdf)));
        }
        let mut report = Report::default();
        check(&desc, &mut report);
        report.warnings.into_iter().map(|warning| (warning.message, warning.help)).collect()
    }

    #[test]
    fn what_a_mesh_does_not_have_is_said_once() {
        assert_eq!(warnings("face_heat", "face_heat"), []);
        let message = "a mesh has no attribute `face_heta`: the texture is black there".to_owned();
        let help = "did you mean `face_heat`?".to_owned();
        assert_eq!(warnings("face_heat", "face_heta"), [(message, Some(help))]);
        let [(_, help)] = &warnings("face_heat", "vertex_color")[..] else { panic!() };
        assert_eq!(help.as_deref(), Some("it has `face_heat`"));
    }
}

//! Faces of four corners in PLY files: to pbrt they are bilinear patches, which are curved where the corners are not in a plane.

use std::sync::Arc;

use aureole_desc::{Mesh, NodeId, Params, SceneDesc, Span, Value};
use rustc_hash::FxHashMap;

/// A mesh whose faces of four corners are patches.
pub(super) struct Parts {
    /// All other faces; none if there are none.
    triangles: Option<Arc<Mesh>>,
    /// What a `bilinear_mesh` needs.
    patches: Params,
}

impl Parts {
    /// `None` where no face has four corners.
    pub(super) fn of(mesh: &Arc<Mesh>) -> Option<Self> {
        if !mesh.polygons.contains(&4) {
            return None;
        }
        let mut triangles = Mesh { indices: Vec::new(), polygons: Vec::new(), ..Mesh::clone(mesh) };
        let mut corners: Vec<i32> = Vec::new();
        for (face, _) in mesh.faces() {
            match face[..] {
                [a, b, c, d] => corners.extend([a, b, d, c].map(|i| i as i32)),
                _ => {
                    triangles.add_face(&face);
                }
            }
        }
        let mut patches = Params::new()
            .with("positions", Value::Floats(mesh.positions.concat().into()))
            .with("indices", Value::Ints(corners.into()));
        for (name, list) in [("normals", mesh.normals.concat()), ("uvs", mesh.uvs.concat())] {
            if !list.is_empty() {
                patches = patches.with(name, Value::Floats(list.into()));
            }
        }
        // Nothing of pbrt's reads attributes, whose faces are numbered otherwise now.
        triangles.attributes.clear();
        let triangles = (!triangles.indices.is_empty()).then(|| Arc::new(triangles));
        Some(Self { triangles, patches })
    }

    /// Makes a shape one of patches; or, if there are triangles too, of these, and adds another one of patches, which is given
    /// back.
    pub(super) fn put_into(&self, desc: &mut SceneDesc, id: NodeId, at: Span) -> Option<NodeId> {
        let mut patches = desc[id].clone();
        patches.kind = "bilinear_mesh".to_owned();
        for name in ["mesh", "default_uvs"] {
            patches.params.remove(name);
        }
        for param in self.patches.iter() {
            patches.params.push(&param.name, param.value.clone(), at);
        }
        match &self.triangles {
            Some(triangles) => {
                desc[id].params.push("mesh", Value::Mesh(triangles.clone()), at);
                Some(desc.add(patches))
            }
            None => {
                desc[id] = patches;
                None
            }
        }
    }
}

/// Adds the patches of some shapes to the lists that have these.
pub(super) fn add_beside(desc: &mut SceneDesc, patches_of: &FxHashMap<NodeId, NodeId>) {
    if patches_of.is_empty() {
        return;
    }
    let with_patches = |shapes: &[NodeId]| -> Vec<NodeId> {
        shapes.iter().flat_map(|id| [Some(*id), patches_of.get(id).copied()]).flatten().collect()
    };
    desc.shapes = with_patches(&desc.shapes);
    let groups: Vec<_> = desc.nodes().filter(|(_, node)| node.kind == "group").map(|(id, _)| id).collect();
    for id in groups {
        let params = &mut desc[id].params;
        let Some(Value::Nodes(shapes)) = params.get("shapes") else { continue };
        let (shapes, at) = (with_patches(shapes), params.span("shapes"));
        params.push("shapes", Value::Nodes(shapes), at);
    }
}

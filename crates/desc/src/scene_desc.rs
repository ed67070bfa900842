//! A whole scene as its files describe it.

use std::ops::{Index, IndexMut};

use aureole_math::Transform;

use crate::{Family, Node, NodeId, Param, Params, SceneError, Span, Value, suggest};

/// A group of shapes where it stands still, in as few bytes as there may be millions: one that moves is a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    /// The group.
    pub group: NodeId,
    /// The first three rows of the map from the group into the world; the fourth is that of affine maps.
    pub world_from_object: [[f64; 4]; 3],
    /// Where it was written.
    pub span: Span,
}

impl Instance {
    /// An instance; `None` for a map that is not affine.
    pub fn new(group: NodeId, world_from_object: &Transform, span: Span) -> Option<Self> {
        let [x, y, z, w] = world_from_object.rows();
        (w == [0.0, 0.0, 0.0, 1.0]).then_some(Self { group, world_from_object: [x, y, z], span })
    }

    /// The map from the group into the world; `None` if it has no inverse.
    pub fn transform(&self) -> Option<Transform> {
        let [x, y, z] = self.world_from_object;
        Transform::from_rows([x, y, z, [0.0, 0.0, 0.0, 1.0]])
    }
}

/// A scene as plain data: nodes that name each other by [`NodeId`].
///
/// World space is right-handed. `shapes` and `lights` are the roots of what is rendered; textures, materials, shape
/// groups and area lights hang below them.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    nodes: Vec<Node>,
    /// Cameras; the first one is rendered unless another is asked for.
    pub cameras: Vec<NodeId>,
    /// Resolution and crop.
    pub film: Option<NodeId>,
    /// Reconstruction filter.
    pub filter: Option<NodeId>,
    /// Sample generator.
    pub sampler: Option<NodeId>,
    /// Light transport algorithm.
    pub integrator: Option<NodeId>,
    /// Shapes of the world, also instances.
    pub shapes: Vec<NodeId>,
    /// Further shapes of the world: groups, each where it stands still.
    pub instances: Vec<Instance>,
    /// Lights other than area lights, which hang on their shapes as `emission`.
    pub lights: Vec<NodeId>,
}

impl SceneDesc {
    /// Adds a node; it is rendered only when something names it.
    pub fn add(&mut self, node: Node) -> NodeId {
        self.nodes.push(node);
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// All nodes with their ids.
    pub fn nodes(&self) -> impl Iterator<Item = (NodeId, &Node)> {
        self.nodes.iter().enumerate().map(|(i, node)| (NodeId(i as u32), node))
    }

    /// How many nodes there are.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Lets go of meshes and long lists. What a scene was compiled from needs them no more, but names and places are still
    /// wanted for messages.
    pub fn release_bulk(&mut self) {
        self.nodes.iter_mut().for_each(|node| node.params.release_bulk());
    }

    /// The root slot that a `--set` path's first word names.
    fn slot(&mut self, family: &str) -> Option<(Family, &mut Option<NodeId>)> {
        match family {
            "film" => Some((Family::Film, &mut self.film)),
            "filter" => Some((Family::Filter, &mut self.filter)),
            "sampler" => Some((Family::Sampler, &mut self.sampler)),
            "integrator" => Some((Family::Integrator, &mut self.integrator)),
            _ => None,
        }
    }

    /// Overrides a parameter by path: `integrator.max_depth`, `sampler.kind`, `camera.fov`, or `NAME.param` for a named node.
    ///
    /// # Errors
    /// [`SceneError::UnknownName`] when nothing has that name.
    pub fn set(&mut self, path: &str, text: &str) -> Result<(), SceneError> {
        let (target, param) = path.rsplit_once('.').ok_or_else(|| {
            SceneError::invalid(format!("`{path}` is not of the form ELEMENT.PARAMETER"), Span::NONE)
        })?;
        let id = self.find(target)?;
        if param == "kind" {
            self[id].kind = text.to_owned();
        } else {
            self[id].params.set(Param {
                name: param.to_owned(),
                value: Value::parse(text),
                span: Span::NONE,
            });
        }
        Ok(())
    }

    fn find(&mut self, target: &str) -> Result<NodeId, SceneError> {
        if target == "camera"
            && let Some(&id) = self.cameras.first()
        {
            return Ok(id);
        }
        if let Some((family, slot)) = self.slot(target) {
            if let Some(id) = *slot {
                return Ok(id);
            }
            let id = self.add(Node::new(family, default_kind(family), Params::new(), Span::NONE));
            if let Some((_, slot)) = self.slot(target) {
                *slot = Some(id);
            }
            return Ok(id);
        }
        let named = self.nodes().find(|(_, node)| node.name.as_deref() == Some(target)).map(|(id, _)| id);
        named.ok_or_else(|| {
            let mut known: Vec<String> =
                ["camera", "film", "filter", "sampler", "integrator"].map(str::to_owned).to_vec();
            known.extend(self.nodes.iter().filter_map(|node| node.name.clone()));
            let near = suggest(target, known.iter().map(String::as_str)).map(str::to_owned);
            SceneError::UnknownName {
                what: "element",
                name: target.to_owned(),
                known: near.into_iter().collect(),
                at: Span::NONE,
            }
        })
    }
}

/// The kind that a root has when a scene says nothing.
fn default_kind(family: Family) -> &'static str {
    match family {
        Family::Filter => "box",
        Family::Sampler => "sobol",
        Family::Integrator => "path",
        _ => "film",
    }
}

impl Index<NodeId> for SceneDesc {
    type Output = Node;
    fn index(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }
}

impl IndexMut<NodeId> for SceneDesc {
    fn index_mut(&mut self, id: NodeId) -> &mut Node {
        &mut self.nodes[id.index()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_overrides_and_creates() {
        let mut scene = SceneDesc::default();
        scene.set("integrator.max_depth", "3").unwrap();
        scene.set("sampler.kind", "independent").unwrap();
        let integrator = scene.integrator.unwrap();
        assert_eq!(scene[integrator].params.get("max_depth"), Some(&Value::Int(3)));
        assert_eq!(scene[scene.sampler.unwrap()].kind, "independent");
        assert!(scene.set("intergrator.max_depth", "3").unwrap_err().help().unwrap().contains("integrator"));
    }
}

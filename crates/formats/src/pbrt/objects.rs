//! Objects, and their instances, which may move.

use aureole_desc::{Family, Instance, NodeId, Params, SceneError, Span, Value};
use aureole_math::Transform;

use super::state::{OpenObject, Reader, Saved, unknown};

impl Reader<'_, '_> {
    pub(super) fn object_begin(&mut self, name: String, at: Span) -> Result<(), SceneError> {
        if self.open_object.is_some() {
            return Err(SceneError::syntax("an object cannot be begun inside another", at));
        }
        self.save(Saved::Object(Box::new(self.state.clone())), at)?;
        self.open_object = Some(OpenObject { name, shapes: Vec::new(), span: at });
        Ok(())
    }

    pub(super) fn object_end(&mut self) {
        if let Some(object) = self.open_object.take() {
            let params = Params::new().with("shapes", Value::Nodes(object.shapes));
            let id = self.add(Family::Shape, "group", params, object.span);
            self.desc[id].name = Some(object.name.clone());
            self.objects.insert(object.name, id);
        }
    }

    pub(super) fn object_instance(&mut self, name: &str, at: Span) -> Result<(), SceneError> {
        if self.open_object.is_some() {
            return Err(SceneError::syntax("an object cannot be instanced inside another", at));
        }
        let Some(&group) = self.objects.get(name) else {
            return Err(unknown("object", name, self.objects.keys(), at));
        };
        let places = self.moving_ctm(at)?;
        self.instance(group, places, at);
        Ok(())
    }

    /// Adds an instance of a group, which may move.
    pub(super) fn instance(&mut self, group: NodeId, [start, end]: [Transform; 2], at: Span) {
        let still = Instance::new(group, &start, at).filter(|_| start == end);
        if let Some(instance) = still {
            self.desc.instances.push(instance);
            return;
        }
        let mut params = Params::new();
        params.push("group", Value::Node(group), at);
        params.push("world_from_object", Value::Transform(start), at);
        if start != end {
            self.has_motion = true;
            params.push("world_from_object_end", Value::Transform(end), at);
        }
        let id = self.add(Family::Shape, "instance", params, at);
        self.desc.shapes.push(id);
    }
}

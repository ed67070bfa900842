//! From the tree of plugins to nodes: the walk, and what all families share.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aureole_desc::{Family, Mesh, Node, NodeId, SceneDesc, SceneError, Span, Value};
use rustc_hash::FxHashMap;

use super::scope::{Nested, Scope, resolve};
use super::tree::{ObjectId, Tag, Tree};
use super::xml::Parsed;
use super::{bsdf, emitter, integrator, medium, sensor, shape, texture};
use crate::file::SearchPath;
use crate::format::Context;

/// Translates a parsed scene. Errors of several objects are collected in the report; the first one is given back.
pub(super) fn translate(parsed: &Parsed, context: &mut Context<'_>) -> Result<SceneDesc, SceneError> {
    let mut translator = Translator {
        tree: &parsed.tree,
        search: &parsed.search,
        context,
        scene: SceneDesc::default(),
        first_film: None,
        state: vec![State::New; parsed.tree.len()],
        depth: 0,
        gathered: 0,
        meshes: FxHashMap::default(),
    };
    shape::read_meshes(&mut translator);
    let before = translator.context.report.errors.len();
    translator.root(parsed.root)?;
    let errors = &mut translator.context.report.errors;
    if errors.len() > before { Err(errors.remove(before)) } else { Ok(translator.scene) }
}

/// How far an object is.
#[derive(Clone, Debug)]
enum State {
    New,
    Open,
    Done(Box<Value>),
}

/// What a mesh depends on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct MeshKey {
    pub(super) path: PathBuf,
    /// In the file.
    pub(super) index: usize,
    pub(super) flip_v: bool,
    /// Whether normals are dropped.
    pub(super) face_normals: bool,
    /// The bits of the degrees up to which edges are smooth.
    pub(super) max_smooth_angle: Option<u64>,
}

/// A mesh that was read.
#[derive(Clone, Debug)]
pub(super) struct ReadMesh {
    pub(super) mesh: Arc<Mesh>,
    pub(super) orientation: Orientation,
    /// What is left out of the file.
    pub(super) notes: Arc<[String]>,
}

/// What tells the outside of a mesh from its inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Orientation {
    /// The normals in its file.
    ByNormals,
    /// How its faces are wound.
    ByFaces,
}

/// The state of a translation.
pub(super) struct Translator<'a, 'c, 'r> {
    pub(super) tree: &'a Tree,
    search: &'a SearchPath,
    pub(super) context: &'c mut Context<'r>,
    pub(super) scene: SceneDesc,
    /// The film of the first sensor.
    pub(super) first_film: Option<ObjectId>,
    state: Vec<State>,
    depth: usize,
    /// Shapes met while merged ones were gathered.
    gathered: u64,
    /// Meshes that were read.
    pub(super) meshes: FxHashMap<MeshKey, ReadMesh>,
}

impl<'a> Translator<'a, '_, '_> {
    /// Translates the scene's own children.
    fn root(&mut self, root: ObjectId) -> Result<(), SceneError> {
        for param in self.tree.get(root).values.iter() {
            let message = format!("`{}` of the scene itself is ignored", param.name);
            self.context.report.warn(message, param.span);
        }
        for child in &self.tree.get(root).children {
            // An error in one child leaves the others alone.
            let result = resolve(self.tree, child).and_then(|nested| self.root_child(nested.id, nested.tag));
            if let Err(error) = result {
                self.context.report.collect(error)?;
            }
        }
        Ok(())
    }

    fn root_child(&mut self, id: ObjectId, tag: Tag) -> Result<(), SceneError> {
        match tag {
            Tag::Sensor => sensor::root(self, id),
            Tag::Integrator => integrator::root(self, id),
            Tag::Shape => shape::root(self, id),
            Tag::Emitter => emitter::root(self, id),
            // Materials, textures and media do nothing until something refers to them.
            Tag::Bsdf | Tag::Texture | Tag::Spectrum | Tag::Medium | Tag::Phase | Tag::Volume => Ok(()),
            Tag::Scene | Tag::Film | Tag::Filter | Tag::Sampler => {
                let message = format!("a <{}> outside of a sensor is ignored", tag.word());
                self.context.report.warn(message, self.tree.get(id).span);
                Ok(())
            }
        }
    }

    /// The value that an object stands for: a node, or a spectrum. Each object is translated once.
    pub(super) fn value(&mut self, id: ObjectId) -> Result<Value, SceneError> {
        let tree = self.tree;
        let object = tree.get(id);
        match &self.state[id.index()] {
            State::Done(value) => return Ok(Value::clone(value)),
            State::Open => {
                let name = object.id.as_deref().unwrap_or(&object.plugin);
                return Err(SceneError::invalid(format!("`{name}` contains itself"), object.span));
            }
            State::New => {}
        }
        let limit = self.context.options.limits.max_nesting;
        if self.depth >= limit {
            let (what, found) = ("nesting of objects".to_owned(), self.depth as u64 + 1);
            let name = Some("max-nesting");
            return Err(SceneError::Limit { what, found, limit: limit as u64, name, at: object.span });
        }
        self.state[id.index()] = State::Open;
        self.depth += 1;
        let scope = Scope::new(tree, object);
        let value = scope.and_then(|scope| match object.tag {
            Tag::Texture | Tag::Spectrum => texture::translate(self, scope),
            Tag::Bsdf => bsdf::translate(self, scope).map(Value::Node),
            Tag::Shape => shape::translate(self, scope).map(Value::Node),
            Tag::Emitter => emitter::translate(self, scope).map(Value::Node),
            Tag::Medium => medium::translate(self, scope).map(Value::Node),
            Tag::Volume => medium::volume(self, scope),
            _ => {
                Err(SceneError::invalid(format!("a <{}> has no place here", object.tag.word()), object.span))
            }
        });
        self.depth -= 1;
        let value = value.inspect_err(|_| self.state[id.index()] = State::New)?;
        self.state[id.index()] = State::Done(Box::new(value.clone()));
        Ok(value)
    }

    /// Counts a shape that is gathered: merged shapes that refer to merged shapes multiply.
    pub(super) fn count_gathered(&mut self, at: Span) -> Result<(), SceneError> {
        // Each shape is met once or a few times; in small scenes the depth of nesting ends a circle before this does.
        const TIMES: u64 = 16;
        const FREE: u64 = 4096;
        self.gathered += 1;
        let (found, limit) = (self.gathered, FREE + TIMES * self.tree.len() as u64);
        let what = "the number of merged shapes".to_owned();
        if found > limit { Err(SceneError::Limit { what, found, limit, name: None, at }) } else { Ok(()) }
    }

    /// A child as a parameter of the node.
    pub(super) fn put(
        &mut self,
        scope: &mut Scope<'a>,
        name: &str,
        child: Nested<'a>,
    ) -> Result<(), SceneError> {
        let value = self.value(child.id)?;
        scope.out.push(name, value, child.span);
        Ok(())
    }

    /// Takes a child of a family that must be there and makes it a parameter.
    pub(super) fn put_required(
        &mut self,
        scope: &mut Scope<'a>,
        name: &str,
        tag: Tag,
    ) -> Result<(), SceneError> {
        let child = scope.take_child(&[tag]);
        let child = child.ok_or_else(|| scope.missing(tag.word(), "a nested element or <ref>"))?;
        self.put(scope, name, child)
    }

    /// Makes a node of what is left: properties keep their names; children without a name have no use.
    pub(super) fn finish(
        &mut self,
        mut scope: Scope<'a>,
        family: Family,
        kind: &str,
    ) -> Result<NodeId, SceneError> {
        for param in scope.values.iter() {
            scope.out.set(param.clone());
        }
        for child in std::mem::take(&mut scope.children) {
            let is_parameter = matches!(child.tag, Tag::Texture | Tag::Spectrum | Tag::Bsdf | Tag::Volume);
            match child.name {
                Some(name) if is_parameter => self.put(&mut scope, name, child)?,
                _ => {
                    let message = format!("<{}> inside of {} is ignored", child.tag.word(), scope.describe());
                    self.context.report.warn(message, child.span);
                }
            }
        }
        let mut node = Node::new(family, kind, scope.out, scope.object.span);
        node.name.clone_from(&scope.object.id);
        Ok(self.scene.add(node))
    }

    /// Warns about what is left of an object that does not become a node.
    pub(super) fn leave(&mut self, scope: &Scope<'_>) {
        for param in scope.values.iter() {
            let message = format!("`{}` of {} is ignored", param.name, scope.describe());
            self.context.report.warn(message, param.span);
        }
        for child in &scope.children {
            let message = format!("<{}> inside of {} is ignored", child.tag.word(), scope.describe());
            self.context.report.warn(message, child.span);
        }
    }

    /// Aureole's word for a plugin, from a family's table.
    pub(super) fn kind(
        &self,
        scope: &Scope<'_>,
        family: Family,
        table: &'static [(&'static str, &'static str)],
    ) -> Result<&'static str, SceneError> {
        let found = table.iter().find(|(plugin, _)| *plugin == scope.object.plugin);
        found.map(|(_, kind)| *kind).ok_or_else(|| SceneError::UnknownKind {
            family,
            kind: scope.object.plugin.clone(),
            known: table.iter().map(|(plugin, _)| (*plugin).to_owned()).collect(),
            at: scope.span(),
        })
    }

    /// A file that the property `name` asks for, beside the file that asks or in the search folders. Whoever reads it says
    /// what happens when there is none.
    pub(super) fn path(&mut self, scope: &mut Scope<'_>, name: &str) -> Result<(PathBuf, Span), SceneError> {
        let at = scope.values.span(name);
        let file = scope.string(name)?.ok_or_else(|| scope.missing(name, "a file name"))?;
        let folder = self.context.sources.path(scope.span()).and_then(Path::parent).unwrap_or("".as_ref());
        let mut search = self.search.clone();
        search.push_front(folder.to_owned());
        Ok((search.resolve(&file), at))
    }

    /// Makes the file that `filename` asks for a parameter.
    pub(super) fn put_path(&mut self, scope: &mut Scope<'_>) -> Result<(), SceneError> {
        let (path, at) = self.path(scope, "filename")?;
        scope.out.push("filename", Value::Path(path), at);
        Ok(())
    }
}

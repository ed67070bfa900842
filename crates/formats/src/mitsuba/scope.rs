//! One object on its way into a node.

use aureole_desc::{Param, Params, SceneError, Span, Value};
use aureole_spectrum::SpectrumSource;

use super::tree::{Child, Object, ObjectId, Tag, Target, Tree};

/// An object's properties and children as they are taken out, and the parameters that come of them.
#[derive(Debug)]
pub(super) struct Scope<'a> {
    pub(super) object: &'a Object,
    /// Plain properties that are left.
    pub(super) values: Params,
    /// Children that are left.
    pub(super) children: Vec<Nested<'a>>,
    /// The node's parameters so far.
    pub(super) out: Params,
}

/// A child whose reference is resolved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nested<'a> {
    pub(super) name: Option<&'a str>,
    pub(super) id: ObjectId,
    pub(super) tag: Tag,
    pub(super) span: Span,
}

impl<'a> Scope<'a> {
    /// Opens an object.
    ///
    /// # Errors
    /// A reference to nothing.
    pub(super) fn new(tree: &'a Tree, object: &'a Object) -> Result<Self, SceneError> {
        let children = object.children.iter().map(|child| resolve(tree, child)).collect::<Result<_, _>>()?;
        Ok(Self { object, values: object.values.clone(), children, out: Params::new() })
    }

    pub(super) fn span(&self) -> Span {
        self.object.span
    }

    /// The object in words.
    pub(super) fn describe(&self) -> String {
        format!("{} `{}`", self.object.tag.word(), self.object.plugin)
    }

    /// Whether a property or a child has that name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.values.has(name) || self.children.iter().any(|child| child.name == Some(name))
    }

    /// Takes a plain property out.
    pub(super) fn take(&mut self, name: &str) -> Option<Param> {
        self.values.remove(name)
    }

    /// Forgets properties that say nothing about the picture.
    pub(super) fn ignore(&mut self, names: &[&str]) {
        for name in names {
            self.values.remove(name);
        }
    }

    /// Gives a property or child another name.
    pub(super) fn rename(&mut self, old: &str, new: &'static str) {
        if let Some(param) = self.values.remove(old) {
            self.values.set(Param { name: new.to_owned(), ..param });
        }
        for child in self.children.iter_mut().filter(|child| child.name == Some(old)) {
            child.name = Some(new);
        }
    }

    /// Sets a parameter of the node unless the object says something about it.
    pub(super) fn default(&mut self, name: &str, value: Value) {
        if !self.has(name) && !self.out.has(name) {
            self.out.push(name, value, self.span());
        }
    }

    /// Takes the first child of a family out.
    pub(super) fn take_child(&mut self, tags: &[Tag]) -> Option<Nested<'a>> {
        let i = self.children.iter().position(|child| tags.contains(&child.tag))?;
        Some(self.children.remove(i))
    }

    /// Takes a named child out.
    pub(super) fn take_named(&mut self, name: &str) -> Option<Nested<'a>> {
        let i = self.children.iter().position(|child| child.name == Some(name))?;
        Some(self.children.remove(i))
    }

    /// The error of a child or property that must be there.
    pub(super) fn missing(&self, param: &str, wanted: &str) -> SceneError {
        SceneError::MissingParam {
            element: self.describe(),
            param: param.to_owned(),
            wanted: wanted.to_owned(),
            at: self.span(),
        }
    }

    /// Takes a number.
    pub(super) fn float(&mut self, name: &str) -> Result<Option<f64>, SceneError> {
        let found = self.values.try_float(name)?;
        self.values.remove(name);
        Ok(found.map(f64::from))
    }

    /// Takes a colour or spectrum.
    pub(super) fn spectrum(&mut self, name: &str) -> Result<Option<SpectrumSource>, SceneError> {
        let found = self.values.try_spectrum(name)?;
        self.values.remove(name);
        Ok(found)
    }

    /// Takes a word.
    pub(super) fn string(&mut self, name: &str) -> Result<Option<String>, SceneError> {
        let found = self.values.try_string(name)?;
        self.values.remove(name);
        Ok(found)
    }

    /// Takes a switch.
    pub(super) fn bool(&mut self, name: &str, default: bool) -> Result<bool, SceneError> {
        let found = self.values.bool(name, default)?;
        self.values.remove(name);
        Ok(found)
    }

    /// Takes a whole number.
    pub(super) fn int(&mut self, name: &str) -> Result<Option<i64>, SceneError> {
        let found = self.values.try_int(name)?;
        self.values.remove(name);
        Ok(found)
    }
}

/// The object that a child is.
///
/// # Errors
/// A reference to nothing.
pub(super) fn resolve<'a>(tree: &'a Tree, child: &'a Child) -> Result<Nested<'a>, SceneError> {
    let id = match &child.target {
        Target::Object(id) => *id,
        Target::Reference(name) => tree
            .find(name)
            .ok_or_else(|| SceneError::unknown_name("id", name, tree.known_ids(), child.span))?,
    };
    Ok(Nested { name: child.name.as_deref(), id, tag: tree.get(id).tag, span: child.span })
}

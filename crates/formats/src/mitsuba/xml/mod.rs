//! XML files to a [`Tree`]: includes, search folders, definitions, references, properties.

mod define;
mod document;
mod element;
mod include;
mod property;
mod tidy;
mod transform;
mod upgrade;

use std::path::{Path, PathBuf};

use aureole_desc::{SceneError, SourceId, Span};
use roxmltree::Node;

use super::tree::{Child, Object, ObjectId, Tag, Target, Tree};
use crate::Context;
use crate::file::SearchPath;
use define::Defines;
use element::Element;

pub(super) use property::numbers;

/// What was read: the objects, and the folders that the files named.
#[derive(Debug)]
pub(super) struct Parsed {
    pub(super) tree: Tree,
    pub(super) root: ObjectId,
    pub(super) search: SearchPath,
}

/// Reads a scene's files.
///
/// Wrong elements are collected in the report while reading goes on; a file that cannot be read at all stops it.
pub(super) fn parse(
    path: &Path,
    text: Option<&str>,
    context: &mut Context<'_>,
) -> Result<Parsed, SceneError> {
    let defines = Defines::new(&context.options.defines);
    let scene = Object {
        tag: Tag::Scene,
        plugin: "scene".to_owned(),
        id: None,
        values: Default::default(),
        children: Vec::new(),
        span: Span::NONE,
    };
    let mut tree = Tree::default();
    let root = tree.add(scene);
    let mut parser =
        Parser { context, tree, defines, search: SearchPath::beside(path), open: Vec::new(), depth: 0 };
    parser.read_file(path, text, Span::NONE, root)?;
    for name in parser.defines.unused() {
        parser
            .context
            .report
            .warn(format!("the scene has no parameter `${name}`: its definition is not used"), Span::NONE);
    }
    Ok(Parsed { tree: parser.tree, root, search: parser.search })
}

/// The state of reading.
struct Parser<'a, 'c> {
    context: &'a mut Context<'c>,
    tree: Tree,
    defines: Defines,
    search: SearchPath,
    /// The files that are being read, outermost first.
    open: Vec<PathBuf>,
    /// Nested objects.
    depth: usize,
}

/// What is common to the elements of one file.
#[derive(Clone, Debug)]
struct FileInfo {
    source: SourceId,
    path: PathBuf,
    /// Written for a version before 2.0, with names in camel case.
    legacy: bool,
}

impl Parser<'_, '_> {
    /// Takes in the children of an XML element.
    fn children(&mut self, node: Node<'_, '_>, file: &FileInfo, parent: ObjectId) -> Result<(), SceneError> {
        for child in node.children() {
            if child.is_text() && child.text().is_some_and(|text| !text.trim().is_empty()) {
                let at = Span::new(file.source, child.range().start, child.range().end);
                self.collect(SceneError::syntax("text between elements has no meaning here", at))?;
            }
            if !child.is_element() {
                continue;
            }
            match self.element(child, file, parent) {
                Ok(()) => {}
                // Too deep or too many: going on would only repeat it.
                Err(error @ SceneError::Limit { .. }) => return Err(error),
                Err(error) => self.collect(error)?,
            }
        }
        Ok(())
    }

    fn collect(&mut self, error: SceneError) -> Result<(), SceneError> {
        self.context.report.collect(error)
    }

    /// Takes in one XML element.
    fn element(&mut self, node: Node<'_, '_>, file: &FileInfo, parent: ObjectId) -> Result<(), SceneError> {
        let element = Element::new(node, file, &mut self.defines)?;
        let is_object = match element.tag() {
            "spectrum" => element.has("type"),
            tag => Tag::parse(tag).is_some(),
        };
        if is_object {
            element.warn_others(&["type", "id", "name", "version"], self.context.report);
            return self.object(node, &element, file, parent);
        }
        if element.tag() != "transform" {
            self.warn_inside(node, file);
        }
        match element.tag() {
            "default" => self.default(&element),
            "include" => self.include(&element, file, parent),
            "path" => self.path(&element, file),
            "alias" => self.alias(&element),
            "ref" => self.reference(&element, file, parent),
            "transform" => {
                element.allow(&["name"])?;
                let (name, value) = transform::parse(node, &element, file, &mut self.defines)?;
                node.children().filter(Node::is_element).for_each(|step| self.warn_inside(step, file));
                self.set(parent, name, value, &element, file)
            }
            _ => {
                let inside_emitter = self.tree.get(parent).tag == Tag::Emitter;
                let (name, value) = property::parse(&element, inside_emitter, self)?;
                self.set(parent, name, value, &element, file)
            }
        }
    }

    /// Warns about what stands inside of an element that has only attributes.
    fn warn_inside(&mut self, node: Node<'_, '_>, file: &FileInfo) {
        let is_something = |child: &Node<'_, '_>| {
            child.is_element() || child.text().is_some_and(|text| !text.trim().is_empty())
        };
        for child in node.children().filter(is_something) {
            let at = Span::new(file.source, child.range().start, child.range().end);
            let message = format!("what is inside of <{}> is ignored", node.tag_name().name());
            self.context.report.warn(message, at);
        }
    }

    /// Sets a plain property.
    fn set(
        &mut self,
        parent: ObjectId,
        name: String,
        value: aureole_desc::Value,
        element: &Element<'_>,
        file: &FileInfo,
    ) -> Result<(), SceneError> {
        let name = if file.legacy { upgrade::snake_case(&name) } else { name };
        let at = element.value_span();
        let object = self.tree.get_mut(parent);
        if object.values.has(&name) {
            self.context.report.warn(format!("`{name}` is given twice: the last one counts"), at);
        }
        object.values.push(name, value, at);
        self.context.options.limits.check_params(object.values.len(), at)
    }

    /// Takes in an object and what it contains.
    fn object(
        &mut self,
        node: Node<'_, '_>,
        element: &Element<'_>,
        file: &FileInfo,
        parent: ObjectId,
    ) -> Result<(), SceneError> {
        let limit = self.context.options.limits.max_nesting;
        if self.depth >= limit {
            let what = "nesting of objects".to_owned();
            return Err(SceneError::Limit {
                what,
                found: self.depth as u64 + 1,
                limit: limit as u64,
                name: Some("max-nesting"),
                at: element.span(),
            });
        }
        let Some(tag) = Tag::parse(element.tag()) else { return Ok(()) };
        if tag == Tag::Scene {
            return Err(SceneError::syntax("a scene inside of a scene: use <include>", element.span()));
        }
        let plugin = element.required("type")?;
        let id = element.get("id").map(str::to_owned);
        let object = Object {
            tag,
            plugin: if file.legacy { upgrade::plugin(tag, &plugin).to_owned() } else { plugin },
            id: id.clone(),
            values: Default::default(),
            children: Vec::new(),
            span: element.span(),
        };
        let object = self.tree.add(object);
        let name = element
            .get("name")
            .map(|name| if file.legacy { upgrade::snake_case(name) } else { name.to_owned() });
        if let Some(id) = id.or_else(|| name.clone().filter(|_| parent.index() == 0)) {
            self.register(&id, object, element)?;
        }
        self.tree.get_mut(parent).children.push(Child {
            name,
            target: Target::Object(object),
            span: element.span(),
        });

        self.depth += 1;
        let result = self.children(node, file, object);
        self.depth -= 1;
        result
    }

    fn register(&mut self, id: &str, object: ObjectId, element: &Element<'_>) -> Result<(), SceneError> {
        let Some(old) = self.tree.register(id, object) else { return Ok(()) };
        let place = self.context.sources.locate(self.tree.get(old).span);
        let place = place.map_or_else(String::new, |place| format!(": it is at {place} already"));
        Err(SceneError::invalid(format!("the id `{id}` is taken{place}"), element.attribute_span("id")))
    }

    fn default(&mut self, element: &Element<'_>) -> Result<(), SceneError> {
        element.allow(&["name", "value"])?;
        let (name, value) = (element.required("name")?, element.required("value")?);
        self.defines.set_default(name, value);
        self.context.options.limits.check_params(self.defines.len(), element.span())
    }

    fn alias(&mut self, element: &Element<'_>) -> Result<(), SceneError> {
        element.allow(&["id", "as"])?;
        let (id, alias) = (element.required("id")?, element.required("as")?);
        self.tree.add_alias(id, alias);
        Ok(())
    }

    fn reference(
        &mut self,
        element: &Element<'_>,
        file: &FileInfo,
        parent: ObjectId,
    ) -> Result<(), SceneError> {
        element.allow(&["id", "name"])?;
        let id = element.required("id")?;
        let name = element
            .get("name")
            .map(|name| if file.legacy { upgrade::snake_case(name) } else { name.to_owned() });
        let child = Child { name, target: Target::Reference(id), span: element.span() };
        self.tree.get_mut(parent).children.push(child);
        Ok(())
    }
}

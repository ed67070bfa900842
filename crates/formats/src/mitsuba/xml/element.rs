//! An XML element with its attributes, parameters put in.

use aureole_desc::{Report, SceneError, Span, suggest};
use roxmltree::Node;

use super::define::Defines;
use super::{FileInfo, tidy};

/// An attribute after substitution.
#[derive(Debug)]
struct Attribute<'a> {
    name: &'a str,
    text: String,
    at: Span,
}

/// An element and its attributes.
#[derive(Debug)]
pub(super) struct Element<'a> {
    tag: &'a str,
    attributes: Vec<Attribute<'a>>,
    span: Span,
}

impl<'a> Element<'a> {
    /// Puts the values of parameters into the attributes.
    pub(super) fn new(
        node: Node<'a, '_>,
        file: &FileInfo,
        defines: &mut Defines,
    ) -> Result<Self, SceneError> {
        let range = node.range();
        let mut end = range.start + 1 + node.tag_name().name().len();
        let mut attributes = Vec::new();
        for attribute in node.attributes() {
            let value = attribute.range_value();
            let at = Span::new(file.source, value.start, value.end);
            let text = defines.substitute(&tidy::restore(attribute.value()), at)?;
            attributes.push(Attribute { name: attribute.name(), text, at });
            end = end.max(attribute.range().end);
        }
        Ok(Self { tag: node.tag_name().name(), attributes, span: Span::new(file.source, range.start, end) })
    }

    /// The element's name.
    pub(super) fn tag(&self) -> &'a str {
        self.tag
    }

    /// The start tag.
    pub(super) fn span(&self) -> Span {
        self.span
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.attributes.iter().any(|attribute| attribute.name == name)
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|attribute| attribute.name == name)
            .map(|attribute| attribute.text.as_str())
    }

    /// An attribute that must be there.
    pub(super) fn required(&self, name: &str) -> Result<String, SceneError> {
        self.get(name).map(str::to_owned).ok_or_else(|| SceneError::MissingParam {
            element: format!("<{}>", self.tag),
            param: name.to_owned(),
            wanted: "this attribute must be there".to_owned(),
            at: self.span,
        })
    }

    /// Where an attribute's value is; the start tag when it is not there.
    pub(super) fn attribute_span(&self, name: &str) -> Span {
        self.attributes
            .iter()
            .find(|attribute| attribute.name == name)
            .map_or(self.span, |attribute| attribute.at)
    }

    /// Where the element's value is, for messages.
    pub(super) fn value_span(&self) -> Span {
        self.attribute_span("value")
    }

    /// An error about the value of an attribute.
    pub(super) fn bad(&self, attribute: &str, wanted: &str) -> SceneError {
        let param = self.get("name").unwrap_or(self.tag).to_owned();
        let found = format!("`{}`", self.get(attribute).unwrap_or(""));
        SceneError::BadParam { param, wanted: wanted.to_owned(), found, at: self.attribute_span(attribute) }
    }

    /// Warns about attributes that an object does not have.
    pub(super) fn warn_others(&self, known: &[&str], report: &mut Report) {
        for attribute in self.attributes.iter().filter(|attribute| !known.contains(&attribute.name)) {
            let message = format!("attribute `{}` of <{}> is ignored", attribute.name, self.tag);
            let near = suggest(attribute.name, known.iter().copied());
            report.warn_with_help(message, near.map(|near| format!("did you mean `{near}`?")), attribute.at);
        }
    }

    /// Refuses attributes that the element does not have.
    pub(super) fn allow(&self, allowed: &[&str]) -> Result<(), SceneError> {
        let unknown = self.attributes.iter().find(|attribute| !allowed.contains(&attribute.name));
        unknown.map_or(Ok(()), |attribute| {
            Err(SceneError::UnknownName {
                what: "attribute",
                name: attribute.name.to_owned(),
                known: allowed.iter().map(|&name| name.to_owned()).collect(),
                at: attribute.at,
            })
        })
    }
}

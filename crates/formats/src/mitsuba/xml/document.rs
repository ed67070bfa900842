//! Text to an XML document.

use aureole_desc::{SceneError, SourceId, Span};
use roxmltree::{Document, Error};

/// Parses a text that [`tidy`](super::tidy::tidy) has gone over.
pub(super) fn parse(text: &str, source: SourceId) -> Result<Document<'_>, SceneError> {
    Document::parse(text).map_err(|error| {
        let start = match &error {
            Error::UnclosedRootNode => text.trim_end().len(),
            other => offset(text, other.pos().row, other.pos().col),
        };
        let message = match &error {
            Error::UnexpectedCloseTag(expected, found, _) => {
                format!("`</{found}>` closes `<{expected}>`: one of the two is missing its partner")
            }
            Error::UnclosedRootNode => "the file ends before all elements are closed".to_owned(),
            Error::NoRootNode => {
                "no element in the file: a scene starts with <scene version=\"3.0.0\">".to_owned()
            }
            other => without_position(&other.to_string()),
        };
        SceneError::syntax(message, Span::new(source, start, start + 1))
    })
}

/// The library ends its messages with the position, which the span gives already.
fn without_position(message: &str) -> String {
    match message.rsplit_once(" at ") {
        Some((start, place)) if place.chars().all(|c| c.is_ascii_digit() || c == ':') => start.to_owned(),
        _ => message.to_owned(),
    }
}

/// The byte at a row and column, both counted from one, columns in characters.
fn offset(text: &str, row: u32, column: u32) -> usize {
    let before: usize = text.split_inclusive('\n').take((row as usize).saturating_sub(1)).map(str::len).sum();
    let line = &text[before..];
    before + line.char_indices().nth((column as usize).saturating_sub(1)).map_or(line.len(), |(i, _)| i)
}

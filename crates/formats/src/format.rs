//! The list of formats, and how a file's format is found.

use std::path::Path;

use aureole_desc::{Limits, Report, SceneDesc, SceneError, Sources, Span};
use aureole_image::stray;

use crate::{LoadOptions, file};

/// A format that scenes can be read from.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// The name, for [`load_text`](crate::load_text) and lists.
    pub name: &'static str,
    /// What it is, in a few words.
    pub summary: &'static str,
    /// File suffixes without the dot, in lower case; a `.gz` after them is understood.
    pub suffixes: &'static [&'static str],
    /// Whether a file that starts like this is of the format, for files whose suffix says nothing.
    pub sniff: fn(start: &[u8]) -> bool,
    /// The reader.
    pub read: fn(Input<'_>, &mut Context<'_>) -> Result<SceneDesc, SceneError>,
}

/// What is read: a file, or a text that stands for one.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The file; relative names inside it count from its folder.
    pub path: &'a Path,
    /// The file's content when it is not on disk.
    pub text: Option<&'a str>,
}

/// What every reader is given besides its input.
#[derive(Debug)]
pub struct Context<'a> {
    /// Definitions, limits, colour mode.
    pub options: &'a LoadOptions,
    /// Files that were read, for spans.
    pub sources: &'a mut Sources,
    /// Warnings, and errors after which reading went on.
    pub report: &'a mut Report,
}

/// All formats.
pub const FORMATS: &[Format] =
    &[crate::pbrt::FORMAT, crate::mitsuba::FORMAT, crate::object::PLY, crate::object::OBJ];

/// All suffixes, for messages.
pub fn known_suffixes() -> Vec<String> {
    FORMATS.iter().flat_map(|format| format.suffixes).map(|suffix| format!(".{suffix}")).collect()
}

/// The format of that name.
pub(crate) fn by_name(name: &str) -> Result<&'static Format, SceneError> {
    FORMATS.iter().find(|format| format.name == name).ok_or_else(|| SceneError::UnknownName {
        what: "format",
        name: name.to_owned(),
        known: FORMATS.iter().map(|format| format.name.to_owned()).collect(),
        at: Span::NONE,
    })
}

/// A file's format: by its suffix, else by its first bytes.
pub(crate) fn of_file(path: &Path, limits: &Limits) -> Result<&'static Format, SceneError> {
    if let Some(format) = by_suffix(path) {
        return Ok(format);
    }
    let start = file::read_start(path, limits, Span::NONE)?;
    if let Some(what) = stray(&start) {
        return Err(SceneError::Asset { path: path.to_owned(), message: what.to_owned(), at: Span::NONE });
    }
    FORMATS.iter().find(|format| (format.sniff)(&start)).ok_or_else(|| SceneError::UnknownName {
        what: "scene format",
        name: path.display().to_string(),
        known: known_suffixes(),
        at: Span::NONE,
    })
}

fn by_suffix(path: &Path) -> Option<&'static Format> {
    let name = path.file_name()?.to_str()?.to_lowercase();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let (_, suffix) = name.rsplit_once('.')?;
    FORMATS.iter().find(|format| format.suffixes.contains(&suffix))
}

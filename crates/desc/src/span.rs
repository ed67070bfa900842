//! Where in which file something was written.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::{Limits, SceneError};

/// Names a file in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SourceId(u32);

/// A range of bytes in a source file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Span {
    /// The file.
    pub source: SourceId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// A span for things that no file mentions (built by a program, or a default).
    pub const NONE: Self = Self { source: SourceId(u32::MAX), start: 0, end: 0 };

    /// The bytes `start..end` of a source; offsets beyond 4 GiB saturate.
    pub fn new(source: SourceId, start: usize, end: usize) -> Self {
        let clip = |x: usize| u32::try_from(x).unwrap_or(u32::MAX);
        Self { source, start: clip(start), end: clip(end) }
    }

    /// Whether this is [`Span::NONE`].
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// From the start of `self` to the end of `other`, when both lie in one file.
    pub fn to(self, other: Self) -> Self {
        if self.source == other.source { Self { end: other.end.max(self.end), ..self } } else { self }
    }
}

/// A file that was read. Binary files (meshes) have no text.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// The path as the user would name it.
    pub path: PathBuf,
    /// The content, for line numbers and excerpts.
    pub text: Option<Arc<str>>,
}

/// A position for people: the file, and the line and column, both counted from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub path: PathBuf,
    /// Line and column (in characters), absent for binary files.
    pub line_column: Option<(usize, usize)>,
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.path.display())?;
        match self.line_column {
            Some((line, column)) => write!(f, ":{line}:{column}"),
            None => Ok(()),
        }
    }
}

/// All files that make up a scene.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<SourceFile>,
    texts: BTreeMap<PathBuf, SourceId>,
    /// How often files were read once more.
    repeats: u64,
    text_bytes: u64,
    distinct_text_bytes: u64,
}

impl Sources {
    /// Adds a text file.
    pub fn add_text(&mut self, path: impl Into<PathBuf>, text: impl Into<Arc<str>>) -> SourceId {
        let (path, text) = (path.into(), text.into());
        self.text_bytes += text.len() as u64;
        self.distinct_text_bytes += text.len() as u64;
        let id = self.add(SourceFile { path: path.clone(), text: Some(text) });
        self.texts.insert(path, id);
        id
    }

    /// A text file that was read before, and is read once more without being kept twice.
    pub fn again(&mut self, path: &Path) -> Option<(SourceId, Arc<str>)> {
        let id = *self.texts.get(path)?;
        let text = self.get(id)?.text.clone()?;
        self.text_bytes += text.len() as u64;
        self.repeats += 1;
        Some((id, text))
    }

    /// Checks that there are not too many files, and that including some of them again and again has not made far more text
    /// of a few small ones.
    ///
    /// # Errors
    /// [`SceneError::Limit`], at the place that asked for the last file.
    pub fn check(&self, limits: &Limits, at: Span) -> Result<(), SceneError> {
        let files = self.files.len() as u64 + self.repeats;
        let most = limits.max_included(self.distinct_text_bytes);
        for (what, found, limit, name) in [
            ("the number of files of a scene", files, limits.max_files, "max-files"),
            ("the text of all included files in bytes", self.text_bytes, most, "max-unpack-ratio"),
        ] {
            if found > limit {
                return Err(SceneError::Limit { what: what.to_owned(), found, limit, name: Some(name), at });
            }
        }
        Ok(())
    }

    /// Adds a binary file: messages about it name the path only.
    pub fn add_binary(&mut self, path: impl Into<PathBuf>) -> SourceId {
        self.add(SourceFile { path: path.into(), text: None })
    }

    fn add(&mut self, file: SourceFile) -> SourceId {
        self.files.push(file);
        SourceId(self.files.len() as u32 - 1)
    }

    /// The file, unless the id is that of [`Span::NONE`].
    pub fn get(&self, id: SourceId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }

    /// The path of the file that a span lies in.
    pub fn path(&self, span: Span) -> Option<&Path> {
        self.get(span.source).map(|file| file.path.as_path())
    }

    /// Line and column of a span's start.
    pub fn locate(&self, span: Span) -> Option<Location> {
        let file = self.get(span.source)?;
        let line_column = file.text.as_ref().map(|text| line_column(text, span.start as usize));
        Some(Location { path: file.path.clone(), line_column })
    }
}

fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text.as_bytes()[..offset.min(text.len())];
    let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
    let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
    // Characters, not bytes: count everything but UTF-8 continuation bytes.
    let column = 1 + before[line_start..].iter().filter(|&&b| b & 0xC0 != 0x80).count();
    (line, column)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one() {
        let mut sources = Sources::default();
        let id = sources.add_text("a.xml", "one\ntwö three\n");
        let at = |offset| sources.locate(Span::new(id, offset, offset)).unwrap().line_column.unwrap();
        assert_eq!(at(0), (1, 1));
        assert_eq!(at(4), (2, 1));
        assert_eq!(at(9), (2, 5));
        assert_eq!(at(1000), (3, 1));
    }

    #[test]
    fn including_a_file_again_and_again_meets_a_limit() {
        let limits = Limits { max_files: 1000, ..Limits::default() };
        let text: Arc<str> = " ".repeat(1 << 20).into();
        let most = |name: fn(usize) -> String| {
            let mut sources = Sources::default();
            (0..2000).find_map(|i| {
                let name = name(i);
                if sources.again(name.as_ref()).is_none() {
                    sources.add_text(name, text.clone());
                }
                let error = sources.check(&limits, Span::NONE).err()?;
                Some((i, error.help().unwrap_or_default()))
            })
        };
        let (count, help) = most(|_| "same".into()).unwrap();
        assert_eq!(count, 256, "256 MiB");
        assert!(help.contains("`--max-unpack-ratio N`"), "{help}");
        let (count, help) = most(|i| i.to_string()).unwrap();
        assert_eq!(count, 1000, "the limit of files");
        assert!(help.contains("`--max-files N`"), "{help}");
    }

    #[test]
    fn no_span_has_no_location() {
        assert_eq!(Sources::default().locate(Span::NONE), None);
    }
}

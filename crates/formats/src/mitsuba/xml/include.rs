//! Files inside files: `<include>` and `<path>`.

use std::path::{Path, PathBuf};

use aureole_desc::{SceneError, Span};

use super::element::Element;
use super::{FileInfo, Parser, document, tidy, upgrade};
use crate::file;
use crate::mitsuba::tree::ObjectId;

impl Parser<'_, '_> {
    /// Reads a file, or a text that stands for it, into `parent`.
    pub(super) fn read_file(
        &mut self,
        path: &Path,
        text: Option<&str>,
        at: Span,
        parent: ObjectId,
    ) -> Result<(), SceneError> {
        let limit = self.context.options.limits.max_include_depth;
        if self.open.len() > limit {
            let (what, found) = ("depth of includes".to_owned(), self.open.len() as u64);
            let name = Some("max-include-depth");
            return Err(SceneError::Limit { what, found, limit: limit as u64, name, at });
        }
        // The same file by another way is still a cycle.
        let identity = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if let Some(start) = self.open.iter().position(|open| *open == identity) {
            return Err(cycle(&self.open[start..], at));
        }

        let (source, text) = match text {
            Some(text) => (self.context.sources.add_text(path, text), text.into()),
            None => file::read_text(path, &self.context.options.limits, self.context.sources, at)?,
        };
        let tidied = tidy::tidy(&text);
        let document = document::parse(&tidied, source)?;
        let root = document.root_element();
        let info =
            FileInfo { source, path: path.to_owned(), legacy: upgrade::is_legacy(root.attribute("version")) };
        self.open.push(identity);
        let result = match root.tag_name().name() {
            "scene" => {
                let element = Element::new(root, &info, &mut self.defines)?;
                if parent.index() == 0 && at.is_none() {
                    self.tree.get_mut(parent).span = element.span();
                }
                self.children(root, &info, parent)
            }
            // A file may hold a single object, to be included where it belongs.
            _ if !at.is_none() => self.element(root, &info, parent),
            other => {
                let at = Span::new(source, root.range().start, root.range().start + 1 + other.len());
                Err(SceneError::syntax(format!("a scene starts with <scene>, not with <{other}>"), at))
            }
        };
        self.open.pop();
        result
    }

    pub(super) fn include(
        &mut self,
        element: &Element<'_>,
        file: &FileInfo,
        parent: ObjectId,
    ) -> Result<(), SceneError> {
        element.allow(&["filename"])?;
        let name = element.required("filename")?;
        let path = self.find(&name, file);
        self.read_file(&path, None, element.attribute_span("filename"), parent)
    }

    /// `<path>`: one more folder to look for files in.
    pub(super) fn path(&mut self, element: &Element<'_>, file: &FileInfo) -> Result<(), SceneError> {
        element.allow(&["value"])?;
        let folder = self.find(&element.required("value")?, file);
        if !folder.is_dir() {
            let message = format!("there is no folder `{}`", folder.display());
            self.context.report.warn(message, element.value_span());
        }
        self.search.push_back(folder);
        // Every file is looked for in each of them.
        let (found, limit) = (self.search.len() as u64, self.context.options.limits.max_include_depth as u64);
        let what = "the number of search folders".to_owned();
        if found > limit {
            let name = Some("max-include-depth");
            return Err(SceneError::Limit { what, found, limit, name, at: element.span() });
        }
        Ok(())
    }

    /// A file beside the one that names it, or in the search folders.
    pub(super) fn find(&self, name: &str, file: &FileInfo) -> PathBuf {
        let mut search = self.search.clone();
        search.push_front(file.path.parent().unwrap_or(Path::new("")).to_owned());
        search.resolve(name)
    }
}

fn cycle(files: &[PathBuf], at: Span) -> SceneError {
    let name = |path: &PathBuf| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let chain: Vec<String> = files.iter().chain(files.first()).map(name).collect();
    SceneError::invalid(format!("files include each other in a circle: {}", chain.join(" → ")), at)
}

//! Painting errors and warnings: what is wrong, where (file, line and column with an excerpt and a caret), how to mend it.

use std::fmt;
use std::io::{IsTerminal, Write};

use aureole::desc::{Report, SceneError, Sources, Span, Warning};
use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents,
    Severity, SourceCode, SourceSpan, SpanContents,
};

use crate::exit::Failure;

/// More messages than this of one kind are counted, not shown, unless everything is asked for.
const SHOWN: usize = 20;
/// Longer lines are cut around what is wrong with them: a mesh may be a single line of many megabytes.
const EXCERPT: usize = 100;

/// Writes messages to standard error: for people, with colours if that is a terminal and `NO_COLOR` is not set, or for
/// programs, one JSON object a line.
pub(crate) enum Painter {
    /// For people.
    Picture(GraphicalReportHandler),
    /// For programs.
    Json,
}

impl Painter {
    /// A painter for the standard error of this process.
    pub(crate) fn for_terminal() -> Self {
        let is_terminal = std::io::stderr().is_terminal();
        let wants_color = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        let theme = if is_terminal && wants_color {
            GraphicalTheme::unicode()
        } else {
            GraphicalTheme::unicode_nocolor()
        };
        // Scripts and logs want a message on one line, however long it is.
        let handler = GraphicalReportHandler::new_themed(theme).with_context_lines(1).with_links(false);
        Self::Picture(if is_terminal { handler } else { handler.with_wrap_lines(false) })
    }

    /// An error that has no place.
    pub(crate) fn error(&self, message: &str, help: Option<&str>) {
        self.paint(&Message::new(Severity::Error, message, help.map(str::to_owned)));
    }

    /// Why the program gives up, unless that was shown already.
    pub(crate) fn failure(&self, failure: &Failure) {
        if let Failure::Plain { message, help, .. } = failure {
            self.error(message, help.as_deref());
        }
    }

    /// A warning that has no place.
    pub(crate) fn warning(&self, message: &str, help: Option<&str>) {
        self.paint(&Message::new(Severity::Warning, message, help.map(str::to_owned)));
    }

    /// Errors of a scene.
    pub(crate) fn scene_errors<'a>(
        &self,
        errors: impl IntoIterator<Item = &'a SceneError>,
        sources: &Sources,
        show_all: bool,
    ) {
        let message = |error: &SceneError| {
            Message::new(Severity::Error, error.to_string(), error.help()).at(error.span(), sources)
        };
        self.paint_some(errors, message, "errors", show_all);
    }

    /// Warnings about a scene, as what they are or as errors.
    pub(crate) fn warnings(&self, report: &Report, severity: Severity, sources: &Sources, show_all: bool) {
        let message = |warning: &Warning| {
            Message::new(severity, &warning.message, warning.help.clone()).at(warning.at, sources)
        };
        self.paint_some(&report.warnings, message, "warnings", show_all);
    }

    /// Paints the first messages and only counts the others: places in large files take time to find.
    fn paint_some<T>(
        &self,
        items: impl IntoIterator<Item = T>,
        message: impl Fn(T) -> Message,
        what: &str,
        show_all: bool,
    ) {
        let mut items = items.into_iter();
        let shown = if show_all { usize::MAX } else { SHOWN };
        items.by_ref().take(shown).for_each(|item| self.paint(&message(item)));
        let more = items.count();
        if more > 0 {
            let more = format!("{more} more {what} are not shown; `-v` shows all");
            self.paint(&Message::new(Severity::Advice, more, None));
        }
    }

    fn paint(&self, message: &Message) {
        let mut text = String::new();
        match self {
            Self::Json => text = message.to_json() + "\n",
            Self::Picture(handler) if handler.render_report(&mut text, message).is_err() => {
                text = format!("{message}\n");
            }
            Self::Picture(_) => {}
        }
        // Nobody is left to tell when standard error is closed.
        let _ = std::io::stderr().write_all(text.trim_start_matches('\n').as_bytes());
    }
}

/// One message, as miette wants it.
#[derive(Debug)]
struct Message {
    severity: Severity,
    text: String,
    help: Option<String>,
    excerpt: Option<Excerpt>,
}

impl Message {
    fn new(severity: Severity, text: impl Into<String>, help: Option<String>) -> Self {
        Self { severity, text: text.into(), help, excerpt: None }
    }

    /// Adds the place. A file without lines is named in the text.
    fn at(mut self, span: Span, sources: &Sources) -> Self {
        self.excerpt = Excerpt::new(span, sources);
        if let (None, Some(path)) = (&self.excerpt, sources.path(span)) {
            self.text = format!("{}: {}", path.display(), self.text);
        }
        self
    }

    fn to_json(&self) -> String {
        let place = self.excerpt.as_ref();
        let event = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Advice => "advice",
        };
        serde_json::json!({
            "event": event,
            "message": self.text,
            "help": self.help,
            "file": place.map(|place| &place.file),
            "line": place.map(|place| place.line),
            "column": place.map(|place| place.column),
        })
        .to_string()
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for Message {}

impl Diagnostic for Message {
    fn severity(&self) -> Option<Severity> {
        Some(self.severity)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let excerpt = self.excerpt.as_ref()?;
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(None, excerpt.mark))))
    }
}

/// The line that a message is about.
#[derive(Debug)]
struct Excerpt {
    /// File, line and column.
    file: String,
    line: usize,
    column: usize,
    /// What is shown of the line, and what of it is marked.
    text: String,
    mark: SourceSpan,
}

impl Excerpt {
    fn new(span: Span, sources: &Sources) -> Option<Self> {
        let location = sources.locate(span)?;
        let (line, column) = location.line_column?;
        let text = sources.get(span.source)?.text.as_deref()?;
        let start = floor_char(text, span.start as usize);
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let line_end = line_start + text[line_start..line_end].trim_end().len();

        // Marks end with their line, and have a visible length.
        let end = ceil_char(text, span.end as usize).min(line_end).max(start);
        let from =
            if start - line_start > EXCERPT { floor_char(text, start - EXCERPT / 2) } else { line_start };
        let to = ceil_char(text, end.min(start + EXCERPT) + EXCERPT / 2).min(line_end).max(start);
        let (before, after) =
            (if from > line_start { "… " } else { "" }, if to < line_end { " …" } else { "" });
        let length = (end.min(to) - start).max(1);
        // The mark of what is missing at the end of a line needs something to stand under.
        let room = if start + length > to && after.is_empty() { " " } else { "" };
        let shown = format!("{before}{}{after}{room}", &text[from..to]);
        let mark = (before.len() + start - from, length).into();
        let file = location.path.display().to_string();
        Some(Self { file, line, column, text: shown, mark })
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        _: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        // Without context the place of the mark is wanted, else the whole line.
        let (range, column) =
            if lines_before == 0 { (*span, self.column - 1) } else { ((0, self.text.len()).into(), 0) };
        let data = &self.text.as_bytes()[range.offset()..range.offset() + range.len()];
        let contents =
            MietteSpanContents::new_named(self.file.clone(), data, range, self.line - 1, column, 1);
        Ok(Box::new(contents))
    }
}

/// The start of the character at or before a byte.
fn floor_char(text: &str, index: usize) -> usize {
    (0..=index.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

/// The start of the character at or after a byte.
fn ceil_char(text: &str, index: usize) -> usize {
    (index..text.len()).find(|&i| text.is_char_boundary(i)).unwrap_or(text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn painted(text: &str, wrong: &str) -> String {
        let mut sources = Sources::default();
        let start = text.find(wrong).unwrap();
        let id = sources.add_text("scenes/a.xml", text);
        let span = Span::new(id, start, start + wrong.len());
        let message = Message::new(Severity::Error, "unknown shape", None).at(span, &sources);
        let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor());
        let mut painted = String::new();
        handler.with_context_lines(1).render_report(&mut painted, &message).unwrap();
        painted
    }

    #[test]
    fn a_place_has_file_line_column_and_caret() {
        let text = painted("<scene>\n  <shape type=\"spere\"/>\n</scene>\n", "spere");
        assert!(text.contains("scenes/a.xml:2:16"), "{text}");
        assert!(text.contains("<shape type=\"spere\"/>"), "{text}");
        assert!(text.contains("─────"), "{text}");
    }

    #[test]
    fn very_long_lines_are_cut() {
        let numbers = "1.5 ".repeat(100_000);
        let text = painted(&format!("P [{numbers}wrong {numbers}]"), "wrong");
        assert!(text.contains("wrong") && text.len() < 2000, "{text}");
        assert!(text.contains("a.xml:1:400004"), "{text}");
    }

    #[test]
    fn marks_of_many_lines_end_with_the_first() {
        let text = painted("<shape>\n <a/>\n</shape>", "<shape>\n <a/>\n</shape>");
        assert!(text.contains("<shape>") && !text.contains("<a/>"), "{text}");
    }

    #[test]
    fn the_end_of_a_file_can_be_marked() {
        let mut sources = Sources::default();
        let id = sources.add_text("a", "<scene>\nü");
        for end in 0..=11 {
            assert!(Excerpt::new(Span::new(id, end, end), &sources).is_some());
        }
        assert!(Excerpt::new(Span::NONE, &sources).is_none());
    }
}

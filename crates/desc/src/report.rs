//! Warnings for the user, collected on the way.

use std::collections::HashSet;

use crate::{SceneError, Span};

/// Something that people should know but that does not stop a render.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What it is.
    pub message: String,
    /// How to mend it.
    pub help: Option<String>,
    /// Where it was written.
    pub at: Span,
}

/// Warnings, and errors beyond the first, gathered while a scene is read and compiled.
#[derive(Debug, Default)]
pub struct Report {
    /// In the order in which they were found.
    pub warnings: Vec<Warning>,
    /// Errors found after which reading went on, so that people see several at once.
    pub errors: Vec<SceneError>,
    /// What was warned about where: a broken file may give rise to many thousand warnings.
    warned: HashSet<(String, Span)>,
}

impl Report {
    /// Errors that are collected before reading stops.
    pub const MAX_ERRORS: usize = 100;

    /// Adds an error after which reading can go on.
    ///
    /// # Errors
    /// The error itself, where there are too many already: a file with a hundred mistakes is another kind of file.
    pub fn collect(&mut self, error: SceneError) -> Result<(), SceneError> {
        if self.errors.len() >= Self::MAX_ERRORS {
            return Err(error);
        }
        self.errors.push(error);
        Ok(())
    }

    /// Adds a warning; the same one at the same place is kept once.
    pub fn warn(&mut self, message: impl Into<String>, at: Span) {
        self.warn_with_help(message, None, at);
    }

    /// Adds several warnings about one place.
    pub fn warn_all(&mut self, messages: &[String], at: Span) {
        messages.iter().for_each(|message| self.warn(message, at));
    }

    /// Adds a warning that says how to mend it.
    pub fn warn_with_help(&mut self, message: impl Into<String>, help: Option<String>, at: Span) {
        let message = message.into();
        if self.warned.insert((message.clone(), at)) {
            self.warnings.push(Warning { message, help, at });
        }
    }
}

//! How the program ends: the codes that scripts and render farms read.

use std::io;
use std::path::Path;
use std::process::ExitCode;

use aureole::desc::SceneError;
use aureole::image::ImageError;

/// An exit code with a meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Exit {
    /// Everything was done.
    Done = 0,
    /// The work was done and the answer is no: images differ too much, a test failed.
    Failed = 1,
    /// The command line makes no sense.
    Usage = 2,
    /// The scene, or a file that it needs, is wrong or missing.
    Scene = 3,
    /// A result cannot be written.
    Io = 4,
    /// A limit was met.
    Limit = 5,
    /// Ctrl-C (128 + SIGINT), after writing what there was.
    Interrupted = 130,
    /// Asked to end (128 + SIGTERM), after writing what there was.
    Terminated = 143,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why the program gives up.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Something is wrong that has no place in a scene.
    Plain {
        /// What.
        message: String,
        /// How to mend it.
        help: Option<String>,
        /// The code to end with.
        exit: Exit,
    },
    /// Errors in a scene, already shown with their places.
    Shown(Exit),
}

impl Failure {
    /// A failure with a code.
    pub(crate) fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self::Plain { message: message.into(), help: None, exit }
    }

    /// A command line that makes no sense.
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// A result that cannot be written.
    pub(crate) fn write(path: &Path, error: &io::Error) -> Self {
        Self::new(Exit::Io, format!("cannot write `{}`: {error}", path.display()))
    }

    /// The same failure with a sentence on how to mend it.
    pub(crate) fn with_help(self, text: impl Into<String>) -> Self {
        match self {
            Self::Plain { message, exit, .. } => Self::Plain { message, help: Some(text.into()), exit },
            shown @ Self::Shown(_) => shown,
        }
    }

    /// The code to end with.
    pub(crate) fn exit(&self) -> Exit {
        match self {
            Self::Plain { exit, .. } | Self::Shown(exit) => *exit,
        }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        let exit = match &error {
            ImageError::Write { .. } => Exit::Io,
            ImageError::UnknownFormat { .. } => Exit::Usage,
            ImageError::Mismatch(_) => Exit::Failed,
            _ if error.is_limit() => Exit::Limit,
            _ => Exit::Scene,
        };
        Self::new(exit, error.to_string())
    }
}

/// The code of an error in a scene.
pub(crate) fn of_scene_error(error: &SceneError) -> Exit {
    match error {
        SceneError::Limit { .. } => Exit::Limit,
        _ => Exit::Scene,
    }
}

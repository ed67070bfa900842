//! What can be wrong with a mesh file.

use std::path::Path;

use aureole_desc::{Limits, SceneError, Span};

/// A mesh file that cannot be used, in words that name the place in the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The content is wrong.
    #[error("{0}")]
    Content(String),
    /// More elements than the limits allow.
    #[error("{what}: {found} > {limit}")]
    Limit {
        /// What was counted.
        what: String,
        /// How many there are.
        found: u64,
        /// How many there may be.
        limit: u64,
        /// The limit's name.
        name: &'static str,
    },
}

impl MeshError {
    /// A [`MeshError::Content`].
    pub fn content(message: impl Into<String>) -> Self {
        Self::Content(message.into())
    }

    /// The error of a file that lacks something, and what its reader noted instead.
    pub(crate) fn nothing_but(lack: &str, notes: &[String]) -> Self {
        let notes = notes.iter().map(|note| format!("; {note}"));
        Self::Content(std::iter::once(lack.to_owned()).chain(notes).collect())
    }

    /// The same error, of a scene that asks for the file at `at`.
    pub fn in_file(self, path: &Path, at: Span) -> SceneError {
        match self {
            Self::Content(message) => SceneError::Asset { path: path.to_owned(), message, at },
            Self::Limit { what, found, limit, name } => {
                let what = format!("{what} of `{}`", path.display());
                SceneError::Limit { what, found, limit, name: Some(name), at }
            }
        }
    }
}

/// Checks a count of vertices, triangles or the like against the limit.
pub(crate) fn check_count(what: &str, found: u64, limits: &Limits) -> Result<usize, MeshError> {
    let limit = limits.max_mesh_elements.min(u64::from(u32::MAX));
    if found > limit {
        return Err(MeshError::Limit { what: what.to_owned(), found, limit, name: "max-mesh-elements" });
    }
    Ok(found as usize)
}

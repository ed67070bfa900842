//! What can be wrong with a scene.

use std::path::PathBuf;

use crate::{Family, Span};

/// A scene that cannot be built, and where that is written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The text does not follow its format's grammar.
    #[error("{message}")]
    Syntax {
        /// What was expected and what was found.
        message: String,
        /// Where.
        at: Span,
    },
    /// No element of that kind.
    #[error("unknown {family} `{kind}`")]
    UnknownKind {
        /// The family.
        family: Family,
        /// The word in the file.
        kind: String,
        /// The kinds there are.
        known: Vec<String>,
        /// Where.
        at: Span,
    },
    /// A reference to something that does not exist.
    #[error("unknown {what} `{name}`")]
    UnknownName {
        /// What was looked for, e.g. "named material".
        what: &'static str,
        /// The word in the file.
        name: String,
        /// The names there are.
        known: Vec<String>,
        /// Where.
        at: Span,
    },
    /// A parameter of the wrong type or out of range.
    #[error("`{param}` must be {wanted}, found {found}")]
    BadParam {
        /// The parameter.
        param: String,
        /// What it must be.
        wanted: String,
        /// What it is.
        found: String,
        /// Where.
        at: Span,
    },
    /// A parameter that must be there is not.
    #[error("{element} needs `{param}`: {wanted}")]
    MissingParam {
        /// The element, e.g. `sphere`.
        element: String,
        /// The parameter.
        param: String,
        /// What it must be.
        wanted: String,
        /// Where the element is.
        at: Span,
    },
    /// A file that cannot be read.
    #[error("cannot read `{}`: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
        /// Where it is asked for.
        at: Span,
    },
    /// A file whose content is wrong.
    #[error("`{}`: {message}", path.display())]
    Asset {
        /// The file.
        path: PathBuf,
        /// What is wrong, with a place in the file where there is one.
        message: String,
        /// Where it is asked for.
        at: Span,
    },
    /// More than the limits allow.
    #[error("{what} is beyond the limit: {found} > {limit}")]
    Limit {
        /// What was counted.
        what: String,
        /// How many there are.
        found: u64,
        /// How many there may be.
        limit: u64,
        /// The limit's name, by which a flag of the program raises it; none for those that are fixed.
        name: Option<&'static str>,
        /// Where.
        at: Span,
    },
    /// Anything else that cannot be.
    #[error("{message}")]
    Invalid {
        /// What is wrong.
        message: String,
        /// Where.
        at: Span,
    },
}

impl SceneError {
    /// Where the error is.
    pub fn span(&self) -> Span {
        match self {
            Self::Syntax { at, .. }
            | Self::UnknownKind { at, .. }
            | Self::UnknownName { at, .. }
            | Self::BadParam { at, .. }
            | Self::MissingParam { at, .. }
            | Self::Read { at, .. }
            | Self::Asset { at, .. }
            | Self::Limit { at, .. }
            | Self::Invalid { at, .. } => *at,
        }
    }

    /// A sentence that helps to mend it.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::UnknownKind { kind, known, .. } | Self::UnknownName { name: kind, known, .. } => {
                match suggest(kind, known.iter().map(String::as_str)) {
                    Some(near) => Some(format!("did you mean `{near}`?")),
                    None if known.is_empty() => None,
                    None => Some(format!("known: {}", known.join(", "))),
                }
            }
            Self::Limit { name: Some(name), .. } => {
                Some(format!("limits guard against broken or hostile files: `--{name} N` raises this one"))
            }
            _ => None,
        }
    }

    /// A [`SceneError::UnknownName`] that remembers the nearest of the known names, and the first few of many.
    pub fn unknown_name<'a>(
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = &'a str> + Clone,
        at: Span,
    ) -> Self {
        const FEW: usize = 24;
        let mut shown: Vec<&str> = suggest(name, known.clone()).into_iter().collect();
        let mut sorted: Vec<&str> = known.filter(|other| !shown.contains(other)).collect();
        sorted.sort_unstable();
        shown.extend(sorted.into_iter().take(FEW));
        let known = shown.into_iter().map(str::to_owned).collect();
        Self::UnknownName { what, name: name.to_owned(), known, at }
    }

    /// A [`SceneError::Invalid`].
    pub fn invalid(message: impl Into<String>, at: Span) -> Self {
        Self::Invalid { message: message.into(), at }
    }

    /// A [`SceneError::Syntax`].
    pub fn syntax(message: impl Into<String>, at: Span) -> Self {
        Self::Syntax { message: message.into(), at }
    }
}

/// The known name nearest to a misspelt one, when one is near enough.
pub fn suggest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let simple = |s: &str| s.to_lowercase().replace(['_', '-'], "");
    let target = simple(word);
    known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&target, &simple(name)), name))
        .filter(|(score, _)| *score > 0.84)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::suggest;

    #[test]
    fn near_names_are_suggested() {
        let known = ["roughness", "reflectance", "eta"];
        assert_eq!(suggest("roughnes", known), Some("roughness"));
        assert_eq!(suggest("Reflectanse", known), Some("reflectance"));
        assert_eq!(suggest("filename", known), None);
    }
}

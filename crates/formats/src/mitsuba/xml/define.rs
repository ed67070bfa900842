//! Parameters of a scene: `<default>`, `-D name=value`, `$name`.

use std::borrow::Cow;

use aureole_desc::{SceneError, Span};

/// A parameter with its value.
#[derive(Clone, Debug)]
struct Define {
    name: String,
    value: String,
    used: bool,
}

/// The parameters defined so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Defines {
    /// Those given by the user come first and win.
    list: Vec<Define>,
}

impl Defines {
    /// Starts with the definitions of a user; the last one of a name counts.
    pub(super) fn new(given: &[(String, String)]) -> Self {
        let mut defines = Self::default();
        for (name, value) in given.iter().rev() {
            defines.set_default(name.clone(), value.clone());
        }
        defines.list.iter_mut().for_each(|define| define.used = false);
        defines
    }

    /// Gives a parameter a value unless it has one. A default need not be used by the scene.
    pub(super) fn set_default(&mut self, name: String, value: String) {
        match self.list.iter_mut().find(|define| define.name == name) {
            Some(define) => define.used = true,
            None => self.list.push(Define { name, value, used: true }),
        }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Names that the user defined and the scene did not ask for.
    pub(super) fn unused(&self) -> Vec<String> {
        self.list.iter().filter(|define| !define.used).map(|define| define.name.clone()).collect()
    }

    /// Puts values in the place of `$name`. A name is as long as letters, digits and underscores go on, so that `$test`
    /// is not found inside `$testing`; a dollar sign before anything else stays.
    pub(super) fn substitute(&mut self, text: &str, at: Span) -> Result<String, SceneError> {
        let mut result = Cow::Borrowed("");
        let mut rest = text;
        while let Some(dollar) = rest.find('$') {
            let after = &rest[dollar + 1..];
            let length = after.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(after.len());
            result.to_mut().push_str(&rest[..dollar]);
            match &after[..length] {
                "" => result.to_mut().push('$'),
                name => result.to_mut().push_str(self.get(name, at)?),
            }
            rest = &after[length..];
        }
        Ok(result.into_owned() + rest)
    }

    fn get(&mut self, name: &str, at: Span) -> Result<&str, SceneError> {
        match self.list.iter().position(|define| define.name == name) {
            Some(i) => {
                self.list[i].used = true;
                Ok(&self.list[i].value)
            }
            None => Err(SceneError::UnknownName {
                what: "parameter",
                name: format!("${name}"),
                known: self.list.iter().map(|define| format!("${}", define.name)).collect(),
                at,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_name_counts() {
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let mut defines = Defines::new(&[pair("test", "1"), pair("test", "2"), pair("other", "x")]);
        defines.set_default("test".into(), "3".into());
        defines.set_default("testing".into(), "four".into());
        let mut put = |text: &str| defines.substitute(text, Span::NONE).map_err(|error| error.to_string());
        assert_eq!(put("$test, $testing/$test.png $ $$test").unwrap(), "2, four/2.png $ $2");
        assert_eq!(put("$tests").unwrap_err(), "unknown parameter `$tests`");
        assert_eq!(defines.unused(), ["other"]);
    }
}

//! The narrow door through which elements take their parameters.

use std::path::PathBuf;
use std::sync::Arc;

use aureole_math::Transform;
use aureole_spectrum::SpectrumSource;

use crate::{Mesh, NodeId, Report, SceneError, Span, Value, suggest};

/// One parameter of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name in Aureole's vocabulary.
    pub name: String,
    /// Its value.
    pub value: Value,
    /// Where it was written.
    pub span: Span,
}

/// A line of an element's table of parameters, for `aureole list` and "did you mean".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParamDoc {
    /// The name.
    pub name: &'static str,
    /// The type, e.g. `float`, `texture`, `transform`.
    pub ty: &'static str,
    /// The default, as text; empty when the parameter is required.
    pub default: &'static str,
    /// What it means, with unit and range.
    pub doc: &'static str,
}

/// A parameter that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Textured {
    /// A texture node.
    Node(NodeId),
    /// A constant.
    Constant(SpectrumSource),
}

/// A node's parameters. Asking for one takes note of it; what nobody asked for becomes a warning.
#[derive(Clone, Debug, Default)]
pub struct Params {
    list: Vec<Param>,
    used: Vec<bool>,
}

impl PartialEq for Params {
    fn eq(&self, other: &Self) -> bool {
        self.list == other.list
    }
}

impl Params {
    /// No parameters.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a parameter without a span, for scenes built by programs.
    pub fn with(mut self, name: impl Into<String>, value: Value) -> Self {
        self.set(Param { name: name.into(), value, span: Span::NONE });
        self
    }

    /// Adds a parameter, or replaces the one of that name.
    pub fn set(&mut self, param: Param) {
        match self.list.iter_mut().find(|p| p.name == param.name) {
            Some(old) => *old = param,
            None => {
                // Most elements have a few parameters, and there may be many elements.
                if self.list.len() < 4 {
                    self.list.reserve_exact(1);
                }
                self.list.push(param);
                self.used.push(false);
            }
        }
    }

    /// Adds a parameter, or replaces the one of that name.
    pub fn push(&mut self, name: impl Into<String>, value: Value, span: Span) {
        self.set(Param { name: name.into(), value, span });
    }

    /// Removes a parameter and gives it back.
    pub fn remove(&mut self, name: &str) -> Option<Param> {
        let i = self.list.iter().position(|p| p.name == name)?;
        self.used.remove(i);
        Some(self.list.remove(i))
    }

    /// A value, without taking note that it was asked for.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.list.iter().find(|p| p.name == name).map(|p| &p.value)
    }

    /// Whether there is a parameter of that name.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All parameters in the order in which they were written.
    pub fn iter(&self) -> impl Iterator<Item = &Param> {
        self.list.iter()
    }

    /// Where a parameter was written, or [`Span::NONE`].
    pub fn span(&self, name: &str) -> Span {
        self.list.iter().find(|p| p.name == name).map_or(Span::NONE, |p| p.span)
    }

    /// Makes meshes and lists empty.
    pub(crate) fn release_bulk(&mut self) {
        for param in &mut self.list {
            match &mut param.value {
                Value::Mesh(mesh) => *mesh = Arc::default(),
                Value::Floats(list) => *list = Arc::default(),
                Value::Ints(list) => *list = Arc::default(),
                _ => {}
            }
        }
    }

    /// Takes note of a parameter and gives it.
    pub fn take(&mut self, name: &str) -> Option<&Param> {
        let i = self.list.iter().position(|p| p.name == name)?;
        self.used[i] = true;
        Some(&self.list[i])
    }

    /// Converts a parameter, if it is there.
    fn convert<T>(
        &mut self,
        name: &str,
        wanted: &str,
        f: impl Fn(&Value) -> Option<T>,
    ) -> Result<Option<T>, SceneError> {
        let Some(param) = self.take(name) else { return Ok(None) };
        match f(&param.value) {
            Some(value) => Ok(Some(value)),
            None => Err(SceneError::BadParam {
                param: name.to_owned(),
                wanted: wanted.to_owned(),
                found: param.value.type_name().to_owned(),
                at: param.span,
            }),
        }
    }

    /// A number, if given. Non-finite numbers are refused.
    ///
    /// # Errors
    /// As for all the methods below: [`SceneError::BadParam`] for a value of another type.
    pub fn try_float(&mut self, name: &str) -> Result<Option<f32>, SceneError> {
        self.convert(name, "a finite number", |value| {
            let x = match value {
                Value::Float(x) => *x as f32,
                Value::Int(i) => *i as f32,
                Value::Spectrum(SpectrumSource::Uniform(x)) => *x,
                _ => return None,
            };
            x.is_finite().then_some(x)
        })
    }

    /// A number.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn float(&mut self, name: &str, default: f32) -> Result<f32, SceneError> {
        Ok(self.try_float(name)?.unwrap_or(default))
    }

    /// A number within a closed range.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn float_in(&mut self, name: &str, default: f32, low: f32, high: f32) -> Result<f32, SceneError> {
        let x = self.float(name, default)?;
        if (low..=high).contains(&x) {
            return Ok(x);
        }
        let wanted = match (low.is_finite(), high.is_finite()) {
            (true, false) => format!("at least {low}"),
            (false, true) => format!("at most {high}"),
            _ => format!("between {low} and {high}"),
        };
        Err(SceneError::BadParam {
            param: name.to_owned(),
            wanted,
            found: x.to_string(),
            at: self.span(name),
        })
    }

    /// A whole number, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_int(&mut self, name: &str) -> Result<Option<i64>, SceneError> {
        self.convert(name, "an integer", |value| match value {
            Value::Int(i) => Some(*i),
            Value::Float(x) if x.fract() == 0.0 && x.abs() < 9e15 => Some(*x as i64),
            _ => None,
        })
    }

    /// A whole number.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn int(&mut self, name: &str, default: i64) -> Result<i64, SceneError> {
        Ok(self.try_int(name)?.unwrap_or(default))
    }

    /// A whole number within a closed range.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn int_in(&mut self, name: &str, default: i64, low: i64, high: i64) -> Result<i64, SceneError> {
        let x = self.int(name, default)?;
        if (low..=high).contains(&x) {
            return Ok(x);
        }
        let wanted = format!("between {low} and {high}");
        Err(SceneError::BadParam {
            param: name.to_owned(),
            wanted,
            found: x.to_string(),
            at: self.span(name),
        })
    }

    /// A switch.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn bool(&mut self, name: &str, default: bool) -> Result<bool, SceneError> {
        let found = self.convert(name, "`true` or `false`", |value| match value {
            Value::Bool(b) => Some(*b),
            _ => None,
        })?;
        Ok(found.unwrap_or(default))
    }

    /// A word, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_string(&mut self, name: &str) -> Result<Option<String>, SceneError> {
        self.convert(name, "a string", |value| match value {
            Value::String(s) => Some(s.clone()),
            _ => None,
        })
    }

    /// One of several words, each with its meaning; the first is the default.
    ///
    /// # Errors
    /// [`SceneError::BadParam`], naming the words that are allowed.
    pub fn one_of<T: Copy>(&mut self, name: &str, choices: &[(&str, T)]) -> Result<T, SceneError> {
        let Some(word) = self.try_string(name)? else { return Ok(choices[0].1) };
        let found = choices.iter().find(|(key, _)| *key == word).map(|(_, value)| *value);
        found.ok_or_else(|| SceneError::BadParam {
            param: name.to_owned(),
            wanted: format!(
                "one of {}",
                choices.iter().map(|(key, _)| format!("`{key}`")).collect::<Vec<_>>().join(", ")
            ),
            found: format!("`{word}`"),
            at: self.span(name),
        })
    }

    /// A file name, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_path(&mut self, name: &str) -> Result<Option<PathBuf>, SceneError> {
        self.convert(name, "a file name", |value| match value {
            Value::Path(path) => Some(path.clone()),
            Value::String(s) => Some(PathBuf::from(s)),
            _ => None,
        })
    }

    /// Two numbers.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn vec2(&mut self, name: &str, default: [f32; 2]) -> Result<[f32; 2], SceneError> {
        let found = self.convert(name, "two finite numbers", |value| match value {
            Value::Vec2(v) => finite(v.map(|x| x as f32)),
            _ => None,
        })?;
        Ok(found.unwrap_or(default))
    }

    /// A point, vector or normal, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_vec3(&mut self, name: &str) -> Result<Option<[f32; 3]>, SceneError> {
        self.convert(name, "three finite numbers", |value| match value {
            Value::Vec3(v) => finite(v.map(|x| x as f32)),
            Value::Spectrum(SpectrumSource::Rgb(v)) => finite(*v),
            _ => None,
        })
    }

    /// A point, vector or normal.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn vec3(&mut self, name: &str, default: [f32; 3]) -> Result<[f32; 3], SceneError> {
        Ok(self.try_vec3(name)?.unwrap_or(default))
    }

    /// A transform; the identity when absent.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn transform(&mut self, name: &str) -> Result<Transform, SceneError> {
        let found = self.convert(name, "a transform", |value| match value {
            Value::Transform(t) => Some(*t),
            _ => None,
        })?;
        Ok(found.unwrap_or(Transform::IDENTITY))
    }

    /// A constant spectrum, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_spectrum(&mut self, name: &str) -> Result<Option<SpectrumSource>, SceneError> {
        self.convert(name, "a colour, spectrum or number", constant_spectrum)
    }

    /// A constant spectrum.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn spectrum(&mut self, name: &str, default: f32) -> Result<SpectrumSource, SceneError> {
        Ok(self.try_spectrum(name)?.unwrap_or(SpectrumSource::Uniform(default)))
    }

    /// A texture or a constant spectrum, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_textured(&mut self, name: &str) -> Result<Option<Textured>, SceneError> {
        self.convert(name, "a texture, colour, spectrum or number", |value| match value {
            Value::Node(id) => Some(Textured::Node(*id)),
            other => constant_spectrum(other).map(Textured::Constant),
        })
    }

    /// Another element, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_node(&mut self, name: &str) -> Result<Option<NodeId>, SceneError> {
        self.convert(name, "an element", |value| match value {
            Value::Node(id) => Some(*id),
            _ => None,
        })
    }

    /// Several elements; none when absent.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn nodes(&mut self, name: &str) -> Result<Vec<NodeId>, SceneError> {
        let found = self.convert(name, "a list of elements", |value| match value {
            Value::Node(id) => Some(vec![*id]),
            Value::Nodes(ids) => Some(ids.clone()),
            _ => None,
        })?;
        Ok(found.unwrap_or_default())
    }

    /// A mesh, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_mesh(&mut self, name: &str) -> Result<Option<Arc<Mesh>>, SceneError> {
        self.convert(name, "a mesh", |value| match value {
            Value::Mesh(mesh) => Some(mesh.clone()),
            _ => None,
        })
    }

    /// Many numbers, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_floats(&mut self, name: &str) -> Result<Option<Arc<[f32]>>, SceneError> {
        self.convert(name, "a list of numbers", |value| match value {
            Value::Floats(list) => Some(list.clone()),
            Value::Float(x) => Some(Arc::from([*x as f32])),
            Value::Vec2(v) => Some(v.map(|x| x as f32).as_slice().into()),
            Value::Vec3(v) => Some(v.map(|x| x as f32).as_slice().into()),
            _ => None,
        })
    }

    /// Many whole numbers, if given.
    ///
    /// # Errors
    /// [`SceneError::BadParam`].
    pub fn try_ints(&mut self, name: &str) -> Result<Option<Arc<[i32]>>, SceneError> {
        self.convert(name, "a list of integers", |value| match value {
            Value::Ints(list) => Some(list.clone()),
            Value::Int(i) => i32::try_from(*i).ok().map(|i| Arc::from([i])),
            _ => None,
        })
    }

    /// Warns about every parameter that nobody asked for.
    pub fn warn_unused(&self, element: &str, known: &[ParamDoc], report: &mut Report) {
        for (param, _) in self.list.iter().zip(&self.used).filter(|(_, used)| !**used) {
            let help = suggest(&param.name, known.iter().map(|doc| doc.name))
                .map(|near| format!("did you mean `{near}`?"));
            let help = help.or_else(|| {
                let names: Vec<_> = known.iter().map(|doc| format!("`{}`", doc.name)).collect();
                (!names.is_empty()).then(|| format!("{element} knows {}", names.join(", ")))
            });
            report.warn_with_help(
                format!("unknown parameter `{}` of {element} is ignored", param.name),
                help,
                param.span,
            );
        }
    }
}

fn finite<const N: usize>(v: [f32; N]) -> Option<[f32; N]> {
    v.iter().all(|x| x.is_finite()).then_some(v)
}

fn constant_spectrum(value: &Value) -> Option<SpectrumSource> {
    match value {
        Value::Spectrum(s) => Some(s.clone()),
        Value::Float(x) => Some(SpectrumSource::Uniform(*x as f32)),
        Value::Int(i) => Some(SpectrumSource::Uniform(*i as f32)),
        Value::Vec3(v) => Some(SpectrumSource::Rgb(v.map(|x| x as f32))),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_asks_for_is_warned_about() {
        let mut params = Params::new().with("radius", Value::Int(2)).with("roughnes", Value::Float(0.1));
        assert_eq!(params.float("radius", 1.0).unwrap(), 2.0);
        let docs = [ParamDoc { name: "roughness", ty: "float", default: "0", doc: "" }];
        let mut report = Report::default();
        params.warn_unused("sphere", &docs, &mut report);
        assert_eq!(report.warnings.len(), 1);
        assert_eq!(report.warnings[0].help.as_deref(), Some("did you mean `roughness`?"));
    }

    #[test]
    fn a_wrong_type_is_an_error_that_says_both_types() {
        let mut params = Params::new().with("radius", Value::String("big".into()));
        let message = params.float("radius", 1.0).unwrap_err().to_string();
        assert_eq!(message, "`radius` must be a finite number, found a string");
    }

    #[test]
    fn ranges_are_checked() {
        let mut params = Params::new().with("alpha", Value::Float(2.0));
        let message = params.float_in("alpha", 0.1, 0.0, 1.0).unwrap_err().to_string();
        assert_eq!(message, "`alpha` must be between 0 and 1, found 2");
    }
}

//! Typed parameters of directives.

use std::cell::Cell;
use std::path::PathBuf;
use std::sync::Arc;

use aureole_desc::{Limits, Report, SceneError, Span, Value, suggest};
use aureole_spectrum::{SpectrumRole, SpectrumSource, Tabulated, blackbody, named_spectrum, spectrum_names};
use rustc_hash::FxHashSet;

use super::color::ColorSpace;
use super::lexer::{Lexer, Token};
use super::state::{Reader, TextureType};
use crate::spectrum_file;

/// The values of a parameter.
#[derive(Clone, Debug)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    Bools(Vec<bool>),
}

/// A parameter: `"float radius" [1]`.
#[derive(Clone, Debug)]
pub(super) struct PbrtParam {
    pub ty: String,
    pub name: String,
    pub values: Values,
    pub span: Span,
    /// What numbers of an `rgb` mean.
    space: ColorSpace,
    used: Cell<bool>,
}

/// The parameters of a directive. What nobody asks for becomes a warning.
#[derive(Clone, Debug)]
pub(super) struct ParamSet {
    /// The directive's own words.
    pub span: Span,
    /// The space of colours that are not given.
    space: ColorSpace,
    /// The last ones first: of two with the same name the later counts.
    list: Vec<PbrtParam>,
    asked: std::cell::RefCell<Vec<String>>,
}

const TYPES: &[&str] = &[
    "integer",
    "float",
    "point",
    "point2",
    "point3",
    "vector",
    "vector2",
    "vector3",
    "normal",
    "normal3",
    "spectrum",
    "rgb",
    "blackbody",
    "bool",
    "string",
    "texture",
    "color",
    "xyz",
];

/// Reads the parameters that follow a directive.
pub(super) fn parse(
    lexer: &mut Lexer<'_>,
    limits: &Limits,
    span: Span,
    space: ColorSpace,
) -> Result<ParamSet, SceneError> {
    let mut list = Vec::new();
    while let Some(word) = lexer.peek()? {
        let Token::Text(declaration) = &word.token else { break };
        let (declaration, at) = (declaration.clone(), word.span);
        lexer.next()?;
        let mut words = declaration.split_whitespace();
        let (Some(ty), Some(name), None) = (words.next(), words.next(), words.next()) else {
            let message = format!("a parameter is declared as \"type name\", not as \"{declaration}\"");
            return Err(SceneError::syntax(message, at));
        };
        if !TYPES.contains(&ty) {
            return Err(SceneError::UnknownName {
                what: "parameter type",
                name: ty.to_owned(),
                known: TYPES.iter().map(|t| (*t).to_owned()).collect(),
                at,
            });
        }
        let values = values(lexer, at)?;
        let used = Cell::new(false);
        list.push(PbrtParam { ty: ty.into(), name: name.into(), values, span: at, space, used });
        limits.check_params(list.len(), at)?;
    }
    list.reverse();
    Ok(ParamSet { span, space, list, asked: Default::default() })
}

/// One value, or several between brackets.
fn values(lexer: &mut Lexer<'_>, at: Span) -> Result<Values, SceneError> {
    let mut values: Option<Values> = None;
    let mut depth = 0;
    loop {
        let Some(word) = lexer.next()? else {
            let message = if depth > 0 { "this list has no closing bracket" } else { "a value is missing" };
            return Err(SceneError::syntax(message, if depth > 0 { at } else { lexer.end() }));
        };
        match word.token {
            Token::Open if depth == 0 && values.is_none() => depth = 1,
            Token::Close if depth == 1 => break,
            Token::Open | Token::Close => {
                return Err(SceneError::syntax("a bracket is out of place", word.span));
            }
            token => push(&mut values, token, word.span)?,
        }
        if depth == 0 {
            break;
        }
    }
    Ok(values.unwrap_or(Values::Numbers(Vec::new())))
}

fn push(values: &mut Option<Values>, token: Token<'_>, at: Span) -> Result<(), SceneError> {
    match (values.as_mut(), token) {
        (None, Token::Text(text)) => *values = Some(Values::Texts(vec![text])),
        (Some(Values::Texts(list)), Token::Text(text)) => list.push(text),
        (None, Token::Word(word @ ("true" | "false"))) => *values = Some(Values::Bools(vec![word == "true"])),
        (Some(Values::Bools(list)), Token::Word(word @ ("true" | "false"))) => list.push(word == "true"),
        (None, Token::Word(word)) => *values = Some(Values::Numbers(vec![number(word, at)?])),
        (Some(Values::Numbers(list)), Token::Word(word)) => list.push(number(word, at)?),
        _ => return Err(SceneError::syntax("numbers, strings and booleans are mixed in one list", at)),
    }
    Ok(())
}

/// A number as the file writes it.
pub(super) fn number(word: &str, at: Span) -> Result<f64, SceneError> {
    let digits = word.strip_prefix('+').unwrap_or(word);
    fast_float2::parse(digits)
        .map_err(|_| SceneError::syntax(format!("a number is wanted here, not `{word}`"), at))
}

impl ParamSet {
    /// No parameters.
    pub(super) fn empty(span: Span) -> Self {
        Self { span, space: ColorSpace::default(), list: Vec::new(), asked: Default::default() }
    }

    /// Adds those that are not there yet, the later ones of the same name before the earlier.
    pub(super) fn extend(&mut self, others: &[PbrtParam]) {
        let mut names: FxHashSet<&str> = self.list.iter().map(|p| p.name.as_str()).collect();
        let new: Vec<PbrtParam> = others
            .iter()
            .rev()
            .filter(|other| names.insert(&other.name))
            // Defaults for all that follow are not missed by one of them.
            .map(|other| PbrtParam { used: Cell::new(true), ..other.clone() })
            .collect();
        self.list.extend(new);
    }

    /// All parameters in the order of the file.
    pub(super) fn into_list(mut self) -> Vec<PbrtParam> {
        self.list.reverse();
        self.list
    }

    /// A parameter, which is thereby used.
    pub(super) fn get(&self, name: &str) -> Option<&PbrtParam> {
        if !self.asked.borrow().iter().any(|asked| asked == name) {
            self.asked.borrow_mut().push(name.to_owned());
        }
        let found = self.list.iter().find(|p| p.name == name)?;
        found.used.set(true);
        Some(found)
    }

    /// The names of all parameters, and where they are, without taking note.
    pub(super) fn names(&self) -> impl Iterator<Item = (&str, Span)> {
        self.list.iter().map(|p| (p.name.as_str(), p.span))
    }

    /// The first word of a parameter, without taking note.
    pub(super) fn peek_text(&self, name: &str) -> Option<&str> {
        match &self.list.iter().find(|p| p.name == name)?.values {
            Values::Texts(list) => list.first().map(String::as_str),
            _ => None,
        }
    }

    /// Takes all parameters as used: for what is not rendered, and warned about as a whole.
    pub(super) fn touch_all(&self) {
        self.list.iter().for_each(|p| p.used.set(true));
    }

    fn numbers(&self, name: &str, wanted: &str) -> Result<Option<&[f64]>, SceneError> {
        match self.get(name) {
            None => Ok(None),
            Some(PbrtParam { values: Values::Numbers(list), .. }) => Ok(Some(list)),
            Some(param) => Err(bad(param, wanted)),
        }
    }

    /// All numbers of a parameter.
    pub(super) fn floats(&self, name: &str) -> Result<Option<Vec<f32>>, SceneError> {
        Ok(self.numbers(name, "numbers")?.map(|list| list.iter().map(|&x| x as f32).collect()))
    }

    /// All whole numbers of a parameter.
    pub(super) fn ints(&self, name: &str) -> Result<Option<Vec<i32>>, SceneError> {
        Ok(self.numbers(name, "whole numbers")?.map(|list| list.iter().map(|&x| x as i32).collect()))
    }

    fn several<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, SceneError> {
        let wanted = format!("{N} numbers");
        let Some(list) = self.numbers(name, &wanted)? else { return Ok(None) };
        match <[f64; N]>::try_from(list) {
            Ok(numbers) if numbers.iter().all(|x| x.is_finite()) => Ok(Some(numbers)),
            _ => Err(self
                .get(name)
                .map_or_else(|| SceneError::invalid(wanted.clone(), self.span), |p| bad(p, &wanted))),
        }
    }

    pub(super) fn try_float(&self, name: &str) -> Result<Option<f64>, SceneError> {
        Ok(self.several::<1>(name)?.map(|[x]| x))
    }

    pub(super) fn float(&self, name: &str, default: f64) -> Result<f64, SceneError> {
        Ok(self.try_float(name)?.unwrap_or(default))
    }

    pub(super) fn int(&self, name: &str, default: i64) -> Result<i64, SceneError> {
        Ok(self.try_float(name)?.map_or(default, |x| x as i64))
    }

    pub(super) fn point3(&self, name: &str, default: [f64; 3]) -> Result<[f64; 3], SceneError> {
        Ok(self.several::<3>(name)?.unwrap_or(default))
    }

    pub(super) fn bool(&self, name: &str, default: bool) -> Result<bool, SceneError> {
        match self.get(name) {
            None => Ok(default),
            Some(PbrtParam { values: Values::Bools(list), .. }) if list.len() == 1 => Ok(list[0]),
            // Quoted booleans are of older versions.
            Some(PbrtParam { values: Values::Texts(list), .. }) if *list == ["true"] => Ok(true),
            Some(PbrtParam { values: Values::Texts(list), .. }) if *list == ["false"] => Ok(false),
            Some(param) => Err(bad(param, "`true` or `false`")),
        }
    }

    pub(super) fn text(&self, name: &str) -> Result<Option<&str>, SceneError> {
        match self.get(name) {
            None => Ok(None),
            Some(PbrtParam { values: Values::Texts(list), .. }) if list.len() == 1 => Ok(Some(&list[0])),
            Some(param) => Err(bad(param, "a string")),
        }
    }

    /// A file, beside the scene or in the working directory.
    pub(super) fn path(&self, name: &str, reader: &Reader<'_, '_>) -> Result<Option<PathBuf>, SceneError> {
        Ok(self.text(name)?.map(|text| reader.file(text)))
    }

    /// Where a parameter is, or the directive.
    pub(super) fn at(&self, name: &str) -> Span {
        self.list.iter().find(|p| p.name == name).map_or(self.span, |p| p.span)
    }

    /// A spectrum of any kind, if given.
    pub(super) fn spectrum(
        &self,
        name: &str,
        reader: &Reader<'_, '_>,
    ) -> Result<Option<SpectrumSource>, SceneError> {
        let Some(param) = self.get(name) else { return Ok(None) };
        let spectrum = match (param.ty.as_str(), &param.values) {
            ("rgb" | "color", Values::Numbers(c)) if c.len() == 3 => {
                SpectrumSource::Rgb(param.space.surface([c[0] as f32, c[1] as f32, c[2] as f32]))
            }
            ("xyz", Values::Numbers(c)) if c.len() == 3 => {
                SpectrumSource::Rgb(aureole_spectrum::srgb_from_xyz([c[0] as f32, c[1] as f32, c[2] as f32]))
            }
            ("float", Values::Numbers(c)) if c.len() == 1 => SpectrumSource::Uniform(c[0] as f32),
            ("blackbody", Values::Numbers(c)) if !c.is_empty() && c[0] > 0.0 => {
                SpectrumSource::Tabulated(Arc::new(blackbody(c[0] as f32)))
            }
            ("spectrum", Values::Numbers(c)) if c.len() == 1 => SpectrumSource::Uniform(c[0] as f32),
            ("spectrum", Values::Numbers(c)) => SpectrumSource::Tabulated(Arc::new(table(c, param)?)),
            ("spectrum", Values::Texts(names)) if names.len() == 1 => named(&names[0], param, reader)?,
            _ => return Err(bad(param, "a spectrum: rgb, blackbody, or spectrum with its values or name")),
        };
        Ok(Some(spectrum))
    }

    /// A spectrum of light: tables are scaled to luminance one, as pbrt scales them, and all are multiplied by `scale`.
    pub(super) fn light(
        &self,
        name: &str,
        scale: f64,
        reader: &Reader<'_, '_>,
    ) -> Result<SpectrumSource, SceneError> {
        let rgb = match self.spectrum(name, reader)? {
            Some(SpectrumSource::Rgb(rgb)) => match self.get(name) {
                Some(PbrtParam { values: Values::Numbers(c), space, ty, .. }) if ty != "xyz" => {
                    space.light([c[0] as f32, c[1] as f32, c[2] as f32])
                }
                _ => rgb,
            },
            Some(SpectrumSource::Tabulated(table)) => {
                let luminance = table.to_xyz(false)[1].max(f32::MIN_POSITIVE);
                table.to_rgb(SpectrumRole::Illuminant).map(|c| c / luminance)
            }
            // An even spectrum has the colour of equal energy, not of white; without any, the light is white.
            Some(SpectrumSource::Uniform(_)) => {
                let even = Tabulated { lambda: vec![300.0, 900.0], values: vec![1.0, 1.0] };
                even.to_rgb(SpectrumRole::Illuminant)
            }
            None => self.space.light([1.0; 3]),
        };
        Ok(SpectrumSource::Rgb(rgb.map(|c| c * scale as f32)))
    }

    /// A texture of colours or a constant as a value for a description's parameter, if given.
    pub(super) fn textured(&self, name: &str, reader: &Reader<'_, '_>) -> Result<Option<Value>, SceneError> {
        self.textured_as(name, TextureType::Spectrum, reader)
    }

    /// A texture of numbers or a constant, if given.
    pub(super) fn textured_float(
        &self,
        name: &str,
        reader: &Reader<'_, '_>,
    ) -> Result<Option<Value>, SceneError> {
        self.textured_as(name, TextureType::Float, reader)
    }

    /// A texture or a constant, if given.
    pub(super) fn textured_as(
        &self,
        name: &str,
        ty: TextureType,
        reader: &Reader<'_, '_>,
    ) -> Result<Option<Value>, SceneError> {
        let Some(param) = self.get(name) else { return Ok(None) };
        if param.ty == "texture" {
            let Values::Texts(names) = &param.values else { return Err(bad(param, "a texture's name")) };
            return reader.texture(names.first().map_or("", String::as_str), ty, param.span).map(Some);
        }
        Ok(self.spectrum(name, reader)?.map(Value::Spectrum))
    }

    /// Warns about what nobody asked for.
    pub(super) fn finish(&self, directive: &str, report: &mut Report) {
        let asked = self.asked.borrow();
        let is_shadowed = |param: &PbrtParam| self.list.iter().any(|p| p.used.get() && p.name == param.name);
        for param in self.list.iter().rev().filter(|p| !p.used.get() && !is_shadowed(p)) {
            let near = suggest(&param.name, asked.iter().map(String::as_str));
            let help = near.map(|near| format!("did you mean `{near}`?"));
            report.warn_with_help(
                format!("parameter `{}` of {directive} is not used", param.name),
                help,
                param.span,
            );
        }
    }
}

fn bad(param: &PbrtParam, wanted: &str) -> SceneError {
    let found = match &param.values {
        Values::Numbers(list) => format!("{} numbers as `{}`", list.len(), param.ty),
        Values::Texts(list) => format!("\"{}\" as `{}`", list.join("\" \""), param.ty),
        Values::Bools(_) => "a boolean".to_owned(),
    };
    SceneError::BadParam { param: param.name.clone(), wanted: wanted.to_owned(), found, at: param.span }
}

/// Pairs of wavelength and value; beyond them the spectrum is zero.
fn table(numbers: &[f64], param: &PbrtParam) -> Result<Tabulated, SceneError> {
    let lambda: Vec<f32> = numbers.iter().step_by(2).map(|&x| x as f32).collect();
    let values: Vec<f32> = numbers.iter().skip(1).step_by(2).map(|&x| x as f32).collect();
    let is_finite = lambda.iter().chain(&values).all(|x| x.is_finite());
    let ascends = lambda.windows(2).all(|pair| pair[0] < pair[1]);
    if numbers.is_empty() || lambda.len() != values.len() || !ascends || !is_finite {
        return Err(bad(param, "pairs of ascending wavelength and value"));
    }
    Ok(Tabulated { lambda, values })
}

/// A spectrum by name, or from a file of pairs.
fn named(name: &str, param: &PbrtParam, reader: &Reader<'_, '_>) -> Result<SpectrumSource, SceneError> {
    if let Some(found) = named_spectrum(name) {
        return Ok(SpectrumSource::Tabulated(found));
    }
    let path = reader.file(name);
    if !path.is_file() {
        return Err(SceneError::UnknownName {
            what: "spectrum",
            name: name.to_owned(),
            known: spectrum_names(),
            at: param.span,
        });
    }
    let table = spectrum_file::read(&path, reader.limits(), param.span)?;
    Ok(SpectrumSource::Tabulated(Arc::new(table)))
}

//! The directives: what changes the state, what nests, what includes.

use std::rc::Rc;

use aureole_desc::{SceneDesc, SceneError, SourceId, Span, suggest};
use aureole_math::{Point3, Transform, Vector3};

use super::color::{self, ColorSpace};
use super::lexer::{Lexer, Spanned, Token};
use super::params::{self, ParamSet, number};
use super::state::{PendingCamera, Reader, Saved, unknown};
use super::version3;
use crate::file;

/// All directives, for "did you mean".
const DIRECTIVES: &[&str] = &[
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "Texture",
    "Transform",
    "TransformBegin",
    "TransformEnd",
    "TransformTimes",
    "Translate",
    "WorldBegin",
    "WorldEnd",
];

/// What pbrt's accelerators are told.
const ACCELERATOR: [&str; 7] =
    ["emptybonus", "intersectcost", "maxdepth", "maxnodeprims", "maxprims", "splitmethod", "traversalcost"];

impl Reader<'_, '_> {
    /// Carries out all directives of a text. Those that make no sense are collected in the report while reading goes on;
    /// where the grammar is broken, it ends.
    pub(super) fn run(&mut self, text: &str, source: SourceId) -> Result<(), SceneError> {
        let mut lexer = Lexer::new(text, source);
        while let Some(Spanned { token, span }) = lexer.next()? {
            let Token::Word(word) = token else {
                return Err(SceneError::syntax("a directive is wanted here", span));
            };
            match self.directive(word, span, &mut lexer) {
                Ok(()) => {}
                Err(error @ (SceneError::Syntax { .. } | SceneError::Limit { .. })) => return Err(error),
                Err(error) => {
                    if let Some(last) = Some(&error).filter(|_| self.is_version3).and_then(version3::give_up)
                    {
                        return Err(last);
                    }
                    self.context.report.collect(error)?;
                    skip_to_directive(&mut lexer)?;
                }
            }
        }
        Ok(())
    }

    fn directive(&mut self, word: &str, at: Span, lexer: &mut Lexer<'_>) -> Result<(), SceneError> {
        match word {
            "Identity" => self.replace([Transform::IDENTITY; 2]),
            "Translate" => {
                let [x, y, z] = numbers(lexer, at)?;
                self.concat(Transform::translate(vector([x, y, z])));
            }
            "Scale" => {
                let [x, y, z] = numbers(lexer, at)?;
                let scale = Transform::scale(vector([x, y, z]));
                self.concat(invertible(Some(scale), at)?);
            }
            "Rotate" => {
                let [angle, x, y, z] = numbers(lexer, at)?;
                self.concat(Transform::rotate(vector([x, y, z]), angle));
            }
            "LookAt" => {
                let [ex, ey, ez, lx, ly, lz, ux, uy, uz] = numbers(lexer, at)?;
                let point = |p| vector(p).to_point();
                let world_from_camera =
                    Transform::look_at(point([ex, ey, ez]), point([lx, ly, lz]), vector([ux, uy, uz]));
                self.concat(invertible(world_from_camera, at)?.inverse());
            }
            "Transform" => {
                let matrix = matrix(lexer, at)?;
                self.replace([matrix; 2]);
            }
            "ConcatTransform" => {
                let matrix = matrix(lexer, at)?;
                self.concat(matrix);
            }
            "CoordinateSystem" => {
                let name = text(lexer, at)?.0;
                self.coordinate_systems.insert(name, self.state.ctm);
            }
            "CoordSysTransform" => {
                let (name, at) = text(lexer, at)?;
                // It sets both transforms, whichever are active.
                match self.coordinate_systems.get(&name) {
                    Some(transforms) => self.state.ctm = *transforms,
                    None => {
                        let error = unknown("coordinate system", &name, self.coordinate_systems.keys(), at);
                        self.warn(error.to_string(), at);
                    }
                }
            }
            "ActiveTransform" => self.active_transform(lexer, at)?,
            "TransformTimes" => {
                let [first, last] = numbers(lexer, at)?;
                if !(last > first && (last - first).is_finite()) {
                    return Err(SceneError::invalid(
                        "the second of the times must be later than the first",
                        at,
                    ));
                }
                self.transform_times = [first, last];
            }
            "ReverseOrientation" => self.state.reverse_orientation = !self.state.reverse_orientation,
            // An old name, which saves everything as well.
            "AttributeBegin" | "TransformBegin" => {
                self.save(Saved::Attributes(Box::new(self.state.clone())), at)?;
            }
            "AttributeEnd" | "TransformEnd" | "ObjectEnd" => self.restore(word, at)?,
            "Include" => self.include(lexer, at)?,
            "Import" => self.import(lexer, at)?,
            "Option" => self.option(lexer, at)?,
            "WorldBegin" => self.world_begin(),
            "WorldEnd" => {}
            _ => self.with_parameters(word, at, lexer)?,
        }
        Ok(())
    }

    /// Directives of a name and parameters.
    fn with_parameters(&mut self, word: &str, at: Span, lexer: &mut Lexer<'_>) -> Result<(), SceneError> {
        if !is_known(word) {
            let near = suggest(word, DIRECTIVES.iter().copied());
            let help = near.map_or_else(String::new, |near| format!(", did you mean `{near}`?"));
            return Err(SceneError::syntax(format!("unknown directive `{word}`{help}"), at));
        }
        let (name, name_at) = text(lexer, at)?;
        let at = at.to(name_at);
        match word {
            "NamedMaterial" => self.named_material(&name, name_at),
            "ObjectBegin" => self.object_begin(name, at),
            "ObjectInstance" => self.object_instance(&name, at),
            "MediumInterface" => {
                // The second name may be left out.
                if matches!(lexer.peek()?, Some(Spanned { token: Token::Text(_), .. })) {
                    lexer.next()?;
                }
                self.warn("participating media are not rendered yet", at);
                Ok(())
            }
            "ColorSpace" => {
                self.state.color_space = ColorSpace::named(&name).ok_or_else(|| SceneError::UnknownName {
                    what: "colour space",
                    name,
                    known: color::NAMES.map(str::to_owned).to_vec(),
                    at,
                })?;
                Ok(())
            }
            "Texture" => {
                let value_type = text(lexer, at)?.0;
                let (class, end) = text(lexer, at)?;
                let params = self.parameters(lexer, at.to(end), "texture")?;
                let kind = if value_type == "color" { &value_type } else { &class };
                self.look_for_version3("Texture", kind, &params);
                self.texture_directive(name, &value_type, &class, &params)
            }
            "Attribute" => {
                let params = params::parse(lexer, self.limits(), at, self.state.color_space)?;
                let targets = ["light", "material", "medium", "shape", "texture"];
                if !targets.contains(&name.as_str()) {
                    let known = targets.map(str::to_owned).to_vec();
                    return Err(SceneError::UnknownName { what: "target of `Attribute`", name, known, at });
                }
                let limits = *self.limits();
                let defaults = Rc::make_mut(&mut self.state.defaults).entry(name).or_default();
                defaults.extend(params.into_list());
                limits.check_params(defaults.len(), at)
            }
            _ => self.element(word, &name, at, lexer),
        }
    }

    /// Directives that describe an element of some kind.
    fn element(&mut self, word: &str, kind: &str, at: Span, lexer: &mut Lexer<'_>) -> Result<(), SceneError> {
        let target = match word {
            "Shape" => "shape",
            "LightSource" | "AreaLightSource" => "light",
            "Material" | "MakeNamedMaterial" => "material",
            "MakeNamedMedium" => "medium",
            _ => "",
        };
        let params = self.parameters(lexer, at, target)?;
        self.look_for_version3(word, kind, &params);
        match word {
            "Camera" => {
                let world_from_camera = self.moving_ctm(at)?.map(|t| t.inverse());
                self.coordinate_systems.insert("camera".into(), world_from_camera);
                self.camera = Some(PendingCamera { kind: kind.into(), params, world_from_camera });
            }
            "Film" => self.film_directive(kind, params)?,
            "Sampler" => self.sampler(kind, &params)?,
            "PixelFilter" => self.filter(kind, &params)?,
            "Integrator" => self.integrator(kind, &params)?,
            "Accelerator" => {
                // Aureole has its own.
                for name in ACCELERATOR {
                    params.get(name);
                }
                params.finish("Accelerator", self.context.report);
            }
            "Shape" => self.shape(kind, &params)?,
            "LightSource" => self.light(kind, &params)?,
            "AreaLightSource" => {
                if kind != "diffuse" {
                    self.warn(format!("area light `{kind}` is taken as `diffuse`"), at);
                }
                self.state.area_light = Some(params);
            }
            "Material" => self.state.material = Some(self.material(kind, &params)?),
            "MakeNamedMaterial" => self.make_named_material(kind, &params)?,
            "MakeNamedMedium" => {
                self.warn("participating media are not rendered yet", at);
            }
            _ => unreachable!("the list of directives is matched above"),
        }
        Ok(())
    }

    /// The parameters that follow, with the defaults for their target.
    fn parameters(&self, lexer: &mut Lexer<'_>, at: Span, target: &str) -> Result<ParamSet, SceneError> {
        let mut params = params::parse(lexer, self.limits(), at, self.state.color_space)?;
        if let Some(defaults) = self.state.defaults.get(target) {
            params.extend(defaults);
        }
        Ok(params)
    }

    fn active_transform(&mut self, lexer: &mut Lexer<'_>, at: Span) -> Result<(), SceneError> {
        let word = lexer.next()?;
        self.state.active = match word.as_ref().map(|w| &w.token) {
            Some(Token::Word("All")) => [true, true],
            Some(Token::Word("StartTime")) => [true, false],
            Some(Token::Word("EndTime")) => [false, true],
            _ => {
                let at = word.map_or(at, |w| w.span);
                return Err(SceneError::syntax("`All`, `StartTime` or `EndTime` is wanted here", at));
            }
        };
        Ok(())
    }

    pub(super) fn save(&mut self, saved: Saved, at: Span) -> Result<(), SceneError> {
        let limit = self.limits().max_nesting;
        if self.saved.len() >= limit {
            let found = self.saved.len() as u64 + 1;
            let (what, name) = ("nested blocks".into(), Some("max-nesting"));
            return Err(SceneError::Limit { what, found, limit: limit as u64, name, at });
        }
        self.saved.push((saved, at));
        Ok(())
    }

    fn restore(&mut self, word: &str, at: Span) -> Result<(), SceneError> {
        match (word, self.saved.pop()) {
            ("AttributeEnd" | "TransformEnd", Some((Saved::Attributes(state), _))) => self.state = *state,
            ("ObjectEnd", Some((Saved::Object(state), _))) => {
                self.state = *state;
                self.object_end();
            }
            _ => return Err(SceneError::syntax(format!("`{word}` ends nothing that was begun"), at)),
        }
        Ok(())
    }

    fn world_begin(&mut self) {
        self.in_world = true;
        self.state.ctm = [Transform::IDENTITY; 2];
        self.state.active = [true; 2];
        self.coordinate_systems.insert("world".into(), self.state.ctm);
    }

    fn include(&mut self, lexer: &mut Lexer<'_>, at: Span) -> Result<(), SceneError> {
        let (name, at) = text(lexer, at)?;
        let path = self.file(&name);
        if self.open_files.contains(&path) {
            return Err(SceneError::invalid(format!("`{name}` includes itself"), at));
        }
        let limit = self.limits().max_include_depth;
        if self.open_files.len() >= limit {
            let found = self.open_files.len() as u64 + 1;
            let (what, name) = ("nested includes".into(), Some("max-include-depth"));
            return Err(SceneError::Limit { what, found, limit: limit as u64, name, at });
        }
        let limits = *self.limits();
        let (source, text) = file::read_text(&path, &limits, self.context.sources, at)?;
        self.open_files.push(path);
        self.run(&text, source)?;
        self.open_files.pop();
        Ok(())
    }

    /// An included file whose changes of the state end with it, and which may not end what it did not begin.
    fn import(&mut self, lexer: &mut Lexer<'_>, at: Span) -> Result<(), SceneError> {
        let (state, outer) = (self.state.clone(), std::mem::take(&mut self.saved));
        let result = self.include(lexer, at);
        let open = std::mem::replace(&mut self.saved, outer);
        self.state = state;
        result?;
        match open.first() {
            Some((_, at)) => Err(SceneError::syntax("this block is not ended in its file", *at)),
            None => Ok(()),
        }
    }

    /// Builds what had to wait, and gives the description.
    pub(super) fn finish(mut self, source: SourceId) -> Result<SceneDesc, SceneError> {
        if let Some((_, at)) = self.saved.last() {
            return Err(SceneError::syntax("this block is not ended", *at));
        }
        if !self.in_world {
            self.warn("the file has no `WorldBegin`", Span::new(source, 0, 0));
        }
        self.finish_options()?;
        self.read_meshes()?;
        Ok(self.desc)
    }
}

/// Skips what is left of a directive.
fn skip_to_directive(lexer: &mut Lexer<'_>) -> Result<(), SceneError> {
    let is_directive = |word: &Spanned<'_>| matches!(word.token, Token::Word(w) if is_known(w));
    while lexer.peek()?.is_some_and(|word| !is_directive(word)) {
        lexer.next()?;
    }
    Ok(())
}

/// Whether a word is a directive.
fn is_known(word: &str) -> bool {
    DIRECTIVES.contains(&word)
}

fn vector(v: [f64; 3]) -> Vector3 {
    Point3::from(v.map(|x| x as f32)).to_vector()
}

fn invertible(transform: Option<Transform>, at: Span) -> Result<Transform, SceneError> {
    transform
        .filter(Transform::is_invertible)
        .ok_or_else(|| SceneError::invalid("this transform cannot be inverted", at))
}

/// So many numbers, with or without brackets.
fn numbers<const N: usize>(lexer: &mut Lexer<'_>, at: Span) -> Result<[f64; N], SceneError> {
    let mut found = [0.0; N];
    let has_brackets = matches!(lexer.peek()?, Some(Spanned { token: Token::Open, .. }));
    if has_brackets {
        lexer.next()?;
    }
    for slot in &mut found {
        match lexer.next()? {
            Some(Spanned { token: Token::Word(word), span }) => *slot = number(word, span)?,
            other => {
                let at = other.map_or(at, |w| w.span);
                return Err(SceneError::syntax(format!("{N} numbers are wanted here"), at));
            }
        }
    }
    if has_brackets && !matches!(lexer.next()?, Some(Spanned { token: Token::Close, .. })) {
        return Err(SceneError::syntax(format!("{N} numbers and a closing bracket are wanted here"), at));
    }
    Ok(found)
}

/// Sixteen numbers, column by column.
fn matrix(lexer: &mut Lexer<'_>, at: Span) -> Result<Transform, SceneError> {
    let m: [f64; 16] = numbers(lexer, at)?;
    let rows = std::array::from_fn(|i| std::array::from_fn(|j| m[4 * j + i]));
    invertible(Transform::from_rows(rows), at)
}

/// A string and its place.
fn text(lexer: &mut Lexer<'_>, at: Span) -> Result<(String, Span), SceneError> {
    match lexer.next()? {
        Some(Spanned { token: Token::Text(text), span }) => Ok((text, span)),
        other => {
            Err(SceneError::syntax("a name between quotes is wanted here", other.map_or(at, |w| w.span)))
        }
    }
}
